"""Numerical continuation: moves a mechanism along a path. Some joints are led, the others follow so that loops stay
closed.

From one closed pose to the next by prediction with the rates and correction by Newton, with steps short
enough to stay on the branch of the loop. A pose where the led joints no longer determine the others
ends the path: beyond it two assemblies of the loop meet, and choosing one would be a guess.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.rank import factor, rank_of
from kinform.model.arrays import Array, Ints
from kinform.simulation.mechanism.closure import closed
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.states import states_at
from kinform.simulation.settings import SolverSettings


@dataclass(frozen=True, eq=False)
class Led:
    """Joints with one freedom whose values are given along the path."""

    q: Ints
    """(k,) their positions."""
    v: Ints
    """(k,) their rates."""
    value: Callable[[float], Array]
    """(k,) values at a place on the path."""
    rate: Callable[[float], Array]
    """(k,) derivatives of the values by the place."""


@dataclass(frozen=True)
class PathEnd:
    """The path ends at `place`, and why."""

    place: float
    reason: str


class Follower:
    """Steps along one path. `rank` and the determined rates are decided at its start."""

    def __init__(self, mechanism: Mechanism, led: Led, q: Array, settings: SolverSettings):
        self.mechanism, self.led, self.settings = mechanism, led, settings
        self.q = q.copy()
        self._tightest = np.inf
        self.unknown: Ints = np.setdiff1d(np.arange(mechanism.rates), led.v)
        rows = mechanism.closure_at(self.q)
        scale = mechanism.scale
        self.rank = rank_of(rows[:, self.unknown], scale[self.unknown], settings.free)
        self.overdriven = self.rank < rank_of(rows, scale, settings.free)
        """The led joints cannot be chosen: the loops leave them no freedom at the start."""
        self.loose = factor(rows[:, self.unknown], scale[self.unknown], self.rank).null
        """(k, d) motions of the others that the led joints do not determine."""
        still = np.abs(self.loose / scale[self.unknown][:, None]).max(axis=1, initial=0.0) < SOLVED
        touched = np.abs(rows[:, self.unknown]).max(axis=0, initial=0.0) > 0.0
        self._determined: Ints = self.unknown[still & touched]
        self.undetermined: Ints = self.unknown[~still & touched]
        """Rates of loops that the led joints leave open."""

    def rates(self, place: float) -> Array:
        """(n,) rates at the present pose for the led rates at `place`; least rates where loose."""
        v = np.zeros(self.mechanism.rates)
        v[self.led.v] = self.led.rate(place)
        if self.mechanism.closed and self.rank:
            rows = self.mechanism.closure_at(self.q)
            gap = -rows @ v
            v[self.unknown] = factor(rows[:, self.unknown], self._scale, self.rank).solve(gap)
        return v

    def accelerations(self, v: Array, led: Array) -> Array:
        """(n,) rates of change of the rates `v` at the present pose for those of the led joints (k,); nan where the
        led joints do not determine them."""
        a = np.zeros(self.mechanism.rates)
        a[self.led.v] = led
        if self.mechanism.closed and self.rank:
            rows = self.mechanism.closure_at(self.q)
            carried = states_at(self.mechanism, self.q[None], v[None], np.zeros((1, len(v)))).accelerations[0]
            gap = -self.mechanism.closure_bias(carried) - rows @ a
            a[self.unknown] = factor(rows[:, self.unknown], self._scale, self.rank).solve(gap)
            a[self.undetermined] = np.nan
        return a

    def open_rates(self, place: float) -> float:
        """Greatest speed at which the loops would open at the rates of `place`."""
        return float(np.abs(self.mechanism.closure_at(self.q) @ self.rates(place)).max(initial=0.0))

    def go(self, start: float, end: float) -> PathEnd | None:
        """Move from `start` to `end` on the path; None when it got there."""
        if not self.mechanism.closed:
            self.q[self.led.q] = self.led.value(end)
            return None
        place, step = start, end - start
        shortest = (end - start) * 2.0**-self.settings.halvings
        while place < end:
            step = min(step, end - place)
            why = self._step(place, step)
            if why is None:
                place += step
                step *= 2.0
                margin = self._margin()
                if margin < self.settings.singular:
                    return PathEnd(place, self._singular())
                if self._tightest < min(margin, self.mechanism.narrow) and self.mechanism.folds(self.q, self.rank):
                    return PathEnd(place, self.mechanism.doubt())
                self._tightest = margin
                continue
            step *= 0.5
            if step < shortest:
                stuck = self._margin() < self.settings.doubtful
                return PathEnd(place, self._singular() if stuck else why)
        return None

    def _step(self, place: float, step: float) -> str | None:
        """One step, or why it was not taken."""
        mechanism, led = self.mechanism, self.led
        target = led.value(place + step)
        stride = np.abs(target - self.q[led.q]) / mechanism.scale[led.v]
        if float(stride.max(initial=0.0)) > self.settings.stride:
            return "the driven joints move too fast to follow"
        q = mechanism.advance(self.q, step * self.rates(place))
        q[led.q] = target
        found = closed(mechanism, q, self.unknown, self.rank)
        q, gap = found.q[0], float(found.residual[0])
        if not gap < self.settings.open:
            return f"the loop cannot be closed: a gap of {self._words(gap)} remains"
        if np.abs(found.change).max(initial=0.0) > self.settings.correction or self._turned_over(q):
            return self._singular()
        self.q = q
        return None

    def _turned_over(self, q: Array) -> bool:
        """Whether the determinant of the determined rates changes sign: a singular pose lies between."""
        columns, scale = self._determined, self.mechanism.scale[self._determined]
        if len(columns) == 0:
            return False
        before = self.mechanism.closure_at(self.q)[:, columns] * scale
        left, _, _ = np.linalg.svd(before, full_matrices=False)
        after = self.mechanism.closure_at(q)[:, columns] * scale
        return bool(np.linalg.det(left.T @ before) * np.linalg.det(left.T @ after) <= 0.0)

    def _margin(self) -> float:
        return factor(self.mechanism.closure_at(self.q)[:, self.unknown], self._scale, self.rank).margin

    @property
    def _scale(self) -> Array:
        return self.mechanism.scale[self.unknown]

    def _words(self, gap: float) -> str:
        return f"{gap:.3g} rad or {gap * self.mechanism.length:.3g} m"

    def _singular(self) -> str:
        if self.mechanism.at_limit(self.q, self.led.v, self.rank):
            return self.mechanism.limit(self.led.v)
        names = self.mechanism.joints_of(self.led.v)
        led = " and ".join(names) if names else "the driven joints"
        return f"the loop is singular: {led} no longer determines the other joints (a dead point)"
