"""One change of behaviour, and the words for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from kinform.changes.behaviours import Axis, Vector
from kinform.changes.tolerance import Tolerance
from kinform.foundation.words import counted, direction, length, place
from kinform.frozen import dataclass


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
class Measure:
    """What counts as the same, and lengths and places in the units of an assembly."""

    within: Tolerance
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

    def displacement(
        self, kind: str, subject: tuple[str, ...], what: str, old: Vector, new: Vector, away: float
    ) -> Iterator[Change]:
        """The change of a point that is `away` (m) from where it was, where that does not count as the same."""
        if away > self.within.length:
            message = f"{what} moved by {self.length(away)}"
            yield Change(kind, subject, message, self.place(old), self.place(new), away, "m", new)


def quoted(*names: str) -> str:
    """Names in quotes, with commas."""
    return ", ".join(f"'{name}'" for name in names)


def freedoms_changed(by: int) -> str:
    """ "1 freedom gained", "2 freedoms lost"."""
    return f"{counted(abs(by), 'freedom')} {'gained' if by > 0 else 'lost'}"


def signed(value: float, words: Callable[[float], str]) -> str:
    """A difference with its sign."""
    return words(value) if value < 0 else f"+{words(value)}"
