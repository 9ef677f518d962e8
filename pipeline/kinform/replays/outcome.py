"""What a replay says of a witness."""

from __future__ import annotations

from typing import Literal, get_args

from kinform.frozen import dataclass

State = Literal["holds", "does not hold", "not replayed"]
STATES: tuple[State, ...] = get_args(State)


@dataclass(frozen=True)
class Outcome:
    """Whether a witness holds, and what the second method found."""

    state: State
    reason: str


class NotReplayed(Exception):
    """The second method cannot say: why."""


def held(reason: str) -> Outcome:
    """The second method finds the same."""
    return Outcome("holds", reason)


def refuted(reason: str) -> Outcome:
    """It finds something else."""
    return Outcome("does not hold", reason)
