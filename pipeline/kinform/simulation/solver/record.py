"""A run as it was computed, in the mechanism's coordinates."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from kinform.model.arrays import Array


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

    def until(self, end: int, why: str) -> Record:
        """The first `end` output times, at which the run stopped for the reason `why`."""
        cut = {f.name: getattr(self, f.name)[:end] for f in fields(self) if f.name not in ("stopped", "notes")}
        return replace(self, **cut, stopped=why)
