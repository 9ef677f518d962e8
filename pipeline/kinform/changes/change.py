"""One change of behaviour, and the words for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kinform.changes.snapshot import Axis, Vector
from kinform.foundation.words import direction, length, place

__all__ = ["Change", "Said", "freedoms", "listed", "quoted", "signed"]


@dataclass(frozen=True)
class Change:
    """One thing that is not as it was."""

    kind: str
    """Hyphenated: "joint-type", "axis-moved", "mass", …"""
    subject: tuple[str, ...]
    """Names as they are now, or were where it is gone."""
    message: str
    """Without the subject: "moved by 0.3 mm"."""
    before: str | None = None
    after: str | None = None
    amount: float | None = None
    """SI and radians, after less before, or how far."""
    unit: str | None = None
    place: Vector | None = None
    """m, world: where it is now, as far as it is known."""


@dataclass(frozen=True)
class Said:
    """Lengths and places in the units of an assembly."""

    units: str

    def length(self, metres: float) -> str:
        """A length given in m."""
        return length(metres, self.units)

    def place(self, point: Vector) -> str:
        """A place given in m, world."""
        return place(point, self.units)

    def line(self, axis: Axis | None) -> str | None:
        """Where an axis points, and through which place."""
        if axis is None:
            return None
        return direction(axis.direction) + ("" if axis.point is None else f" through {self.place(axis.point)}")


def quoted(name: str) -> str:
    """A name in quotes."""
    return f"'{name}'"


def listed(names: list[str]) -> str:
    """Names in quotes, with commas."""
    return ", ".join(map(quoted, names))


def freedoms(count: int) -> str:
    """A number of freedoms with its noun."""
    return f"{count} freedom" + ("" if count == 1 else "s")


def signed(value: float, say: Callable[[float], str]) -> str:
    """A difference with its sign."""
    return say(value) if value < 0 else f"+{say(value)}"
