"""Laws of the manifest as functions of time in SI: value, rate and acceleration."""

from __future__ import annotations

import bisect
import math
from typing import Any, Protocol

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.function import Law

OVERSHOOT = 0.02
"""Share of a table's span that a spline may leave its rows: a sine of sixteen rows a turn does."""


class Signal(Protocol):
    """A function of time (s)."""

    @property
    def knots(self) -> tuple[float, ...]:
        """Times at which it is not smooth."""

    def value(self, t: float) -> float:
        """Value at t."""

    def rate(self, t: float) -> float:
        """First derivative just after t."""

    def acceleration(self, t: float) -> float:
        """Second derivative just after t, where it is finite."""


@dataclass(frozen=True)
class Constant:
    """`level` for ever."""

    level: float
    knots: tuple[float, ...] = ()

    def value(self, t: float) -> float:
        return self.level

    def rate(self, t: float) -> float:
        return 0.0

    def acceleration(self, t: float) -> float:
        return 0.0


STEADY = Constant(1.0)
"""As a factor: nothing changes."""


@dataclass(frozen=True)
class Ramp:
    """offset + slope·t."""

    offset: float
    slope: float
    knots: tuple[float, ...] = ()

    def value(self, t: float) -> float:
        return self.offset + self.slope * t

    def rate(self, t: float) -> float:
        return self.slope

    def acceleration(self, t: float) -> float:
        return 0.0


@dataclass(frozen=True)
class Sine:
    """offset + amplitude·sin(speed·t + phase); speed in rad/s, phase in rad."""

    offset: float
    amplitude: float
    speed: float
    phase: float
    knots: tuple[float, ...] = ()

    def value(self, t: float) -> float:
        return self.offset + self.amplitude * math.sin(self.speed * t + self.phase)

    def rate(self, t: float) -> float:
        return self.amplitude * self.speed * math.cos(self.speed * t + self.phase)

    def acceleration(self, t: float) -> float:
        return -self.amplitude * self.speed**2 * math.sin(self.speed * t + self.phase)


@dataclass(frozen=True)
class Table:
    """Straight lines between (times, levels), held outside; its rate jumps at the knots."""

    knots: tuple[float, ...]
    levels: tuple[float, ...]

    def value(self, t: float) -> float:
        return float(np.interp(t, self.knots, self.levels))

    def rate(self, t: float) -> float:
        k = bisect.bisect_right(self.knots, t)
        if k == 0 or k == len(self.knots):
            return 0.0
        return (self.levels[k] - self.levels[k - 1]) / (self.knots[k] - self.knots[k - 1])

    def acceleration(self, t: float) -> float:
        return 0.0


LAWS: dict[str, type[Signal]] = {"constant": Constant, "ramp": Ramp, "sine": Sine, "table": Table}
"""Signals that a file can hold, by the name of their law."""


def law_of(signal: Signal) -> str:
    """The name of its law. Raises ValueError for a signal that is none of kinform's."""
    for law, cls in LAWS.items():
        if type(signal) is cls:
            return law
    raise ValueError(f"a signal of the kind {type(signal).__name__} is none of kinform's")


class Spline:
    """A cubic curve through a table that comes to rest at both ends, held outside.

    Its rate is continuous, so that a finite effort can follow it. It is the cubic spline, whose acceleration is
    continuous too, while that stays between the rows to within OVERSHOOT; through coarser tables the monotone curve of
    Fritsch and Carlson (1980), which rests where the table does and never leaves its rows.
    """

    def __init__(self, table: Table):
        """The cubic spline through the rows, at rest at both ends; where it would leave the rows, the monotone one."""
        from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

        self.knots = table.knots
        self._ends = (table.levels[0], table.levels[-1])
        levels = np.asarray(table.levels)
        self.curve: Any = CubicSpline(table.knots, levels, bc_type="clamped")
        # Places in each stretch of a table at which a spline is compared with its straight line: ends and sixteenths.
        places = np.linspace(table.knots[:-1], table.knots[1:], 17)
        between = self.curve(places)
        low, high = np.minimum(levels[:-1], levels[1:]), np.maximum(levels[:-1], levels[1:])
        outside = max(float((between - high).max()), float((low - between).max()))
        self.monotone = outside > OVERSHOOT * float(levels.max() - levels.min())
        """Whether the cubic spline would leave the rows of the table."""
        if self.monotone:
            slopes = PchipInterpolator(table.knots, levels).derivative()(table.knots)
            slopes[[0, -1]] = 0.0
            self.curve = CubicHermiteSpline(table.knots, levels, slopes)
        self._rate: Any = self.curve.derivative(1)
        self._acceleration: Any = self.curve.derivative(2)
        gap = self.curve(places) - np.interp(places, table.knots, table.levels)
        self.deviation = float(np.abs(gap).max())
        """Greatest difference from the straight lines of the table."""

    def coefficients(self, stretch: int) -> list[float]:
        """Coefficients of the powers 0 … 3 of the time since the knot that begins the stretch."""
        return [float(c) for c in self.curve.c[::-1, stretch]]

    def value(self, t: float) -> float:
        if t <= self.knots[0]:
            return self._ends[0]
        return self._ends[1] if t >= self.knots[-1] else float(self.curve(t))

    def rate(self, t: float) -> float:
        return float(self._rate(t)) if self.knots[0] < t < self.knots[-1] else 0.0

    def acceleration(self, t: float) -> float:
        return float(self._acceleration(t)) if self.knots[0] <= t < self.knots[-1] else 0.0


def signal(law: Law, scale: float) -> Signal:
    """The law with its values times `scale`, which makes them SI and gives them kinform's sign.

    Raises ValueError, with what is wrong, for a law that is no function of time.
    """
    numbers = (law.value, law.amplitude, law.frequency, law.phase, law.offset, law.rate)
    if not all(math.isfinite(x) for x in (*numbers, *law.times, *law.values, scale)):
        raise ValueError("its law contains a value that is not a finite number")
    if law.type == "constant":
        return Constant(scale * law.value)
    if law.type == "ramp":
        return Ramp(scale * law.offset, scale * law.rate)
    if law.type == "sine":
        speed, phase = 2.0 * math.pi * law.frequency, math.radians(law.phase)
        return Sine(scale * law.offset, scale * law.amplitude, speed, phase)
    if law.type == "table":
        return _table(law, scale)
    raise ValueError(f'its law is of the unknown type "{law.type}"')


def smooth(signal: Signal, until: float = math.inf) -> Signal:
    """The same signal, or for a table what a body with mass can follow until that time (s): the straight line, where
    its rows lie on one and none of its ends is before; else the spline."""
    if not isinstance(signal, Table):
        return signal
    return _straight(signal, until) or Spline(signal)


def _straight(table: Table, until: float) -> Ramp | None:
    """The line on which the rows of a table lie, where they reach from the start to that time."""
    times, levels = np.asarray(table.knots), np.asarray(table.levels)
    if times[0] > 0.0 or times[-1] < until:
        return None
    slope = float((levels[-1] - levels[0]) / (times[-1] - times[0]))
    off = float(np.abs(levels - levels[0] - slope * (times - times[0])).max())
    if off > SOLVED * float(np.ptp(levels)):
        return None
    return Ramp(float(levels[0] - slope * times[0]), slope)


def _table(law: Law, scale: float) -> Signal:
    if not law.times or len(law.times) != len(law.values):
        raise ValueError(f"its table has {len(law.times)} times and {len(law.values)} values")
    if any(later <= earlier for earlier, later in zip(law.times, law.times[1:], strict=False)):
        raise ValueError("the times of its table do not increase")
    if len(law.times) == 1:
        return Constant(scale * law.values[0])
    return Table(law.times, tuple(scale * value for value in law.values))
