"""A run as it was computed, in the mechanism's coordinates."""

from __future__ import annotations

from dataclasses import fields, replace

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.simulation import Damping


@dataclass(frozen=True, eq=False)
class FrictionRecord:
    """What m frictions did at T output times."""

    effort: Array
    """(T, m) N·m or N on their rates, in the order of the actuation."""
    limit: Array
    """(T, m) what each could take at most at rest."""
    sticking: Flags
    """(T, m)."""


@dataclass(frozen=True, eq=False)
class Record:
    """T output times in order; `stopped` says why the run ended early, "" when it did not."""

    time: Array
    """(T,) s."""
    q: Array
    """(T, nq)."""
    v: Array
    """(T, n)."""
    acceleration: Array
    """(T, n); nan where unknown."""
    effort: Array
    """(T, n) by all drives and springs on shafts, what a prescribed motion needs included; nan where unknown."""
    needed: Array
    """(T, n) of that what prescribed motions and end stops need."""
    extra: Array
    """(T, states) of controllers and motors."""
    work: Array
    """(T,) J that drives, dampers and loads put in so far; nan where unknown."""
    stopped: str
    notes: tuple[str, ...] = ()
    """What is to be known of the run, in sentences."""
    dampings: tuple[Damping, ...] = ()
    friction: FrictionRecord | None = None
    """None without any."""

    def until(self, end: int, why: str) -> Record:
        """The first `end` output times, at which the run stopped for the reason `why`."""
        whole = ("stopped", "notes", "dampings", "friction")
        cut = {f.name: getattr(self, f.name)[:end] for f in fields(self) if f.name not in whole}
        friction = self.friction
        if friction is not None:
            friction = FrictionRecord(friction.effort[:end], friction.limit[:end], friction.sticking[:end])
        return replace(self, **cut, friction=friction, stopped=why)
