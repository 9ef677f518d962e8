"""What may become of one requirement: met, violated or undecided."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from kinform.frozen import dataclass
from kinform.model.findings import Witness

State = Literal["met", "violated", "undecided"]


@dataclass(frozen=True)
class Margin:
    """How far a value is inside of the nearest of its bounds, SI; negative beyond it."""

    value: float
    unit: str


@dataclass(frozen=True)
class Answer:
    """What became of one requirement. `message` ends the sentence "requirement 'name': …"."""

    state: State
    message: str
    found: str | None = None
    intended: str | None = None
    place: tuple[float, float, float] | None = None
    """m, world."""
    remedy: str | None = None
    margin: Margin | None = None
    witness: Witness | None = None
    """Of what is violated."""


def met(message: str, *, found: str | None = None, intended: str | None = None, margin: Margin | None = None) -> Answer:
    """The requirement holds; the message says how this is known."""
    return Answer("met", message, found, intended, margin=margin)


def violated(
    message: str, *, found: str, intended: str, remedy: str, place: Iterable[float] | None = None,
    margin: Margin | None = None, witness: Witness | None = None,
) -> Answer:  # fmt: skip
    """The requirement does not hold."""
    at = None if place is None else triple(place)
    return Answer("violated", message, found, intended, at, remedy, margin, witness)


def undecided(message: str, remedy: str, *, found: str | None = None, intended: str | None = None) -> Answer:
    """What is missing, and what would decide it."""
    return Answer("undecided", message, found, intended, None, remedy)


def worst_of(answers: Sequence[Answer]) -> Answer | None:
    """The first that is violated, else the first that is undecided; None where all are met."""
    by_state = {answer.state: answer for answer in reversed(answers)}
    return by_state.get("violated") or by_state.get("undecided")


def least(margins: Iterable[Margin | None]) -> Margin | None:
    """The least of several; None where one is not known, or they are of different units."""
    known = list(margins)
    units = {margin.unit if margin else None for margin in known}
    if len(units) != 1 or None in units:
        return None
    return min((margin for margin in known if margin), key=lambda margin: margin.value)


def triple(point: Iterable[float]) -> tuple[float, float, float]:
    """Three coordinates as plain numbers."""
    x, y, z = (float(value) for value in point)
    return (x, y, z)
