"""The first place along a motion at which two parts cross: conservative advancement by distances.

Of an interval of the motion whose ends are free by d₀ and d₁, and along which no point of one part travels more
than ℓ relative to the other, nothing is to be feared while d₀ + d₁ > ℓ (Mirtich 1996); else it is halved, as far as
a resolution. What happens within the resolution, free at both ends, is a graze and not seen.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from kinform.collisions.pairs import NONE, Crossing, PairTest

__all__ = ["Course", "First", "first_crossing"]

Array = NDArray[np.float64]

WORK = 4000
"""Poses of one pair that one question may try."""
RESOLUTION = 4e-3
"""Share of the smaller part's diagonal that a part may travel unseen where others are in touch."""


@dataclass(frozen=True, eq=False)
class Course:
    """How the second body of a pair moves relative to the first, over a parameter s."""

    displacement: Callable[[float], Array]
    """(4, 4) of the world at the meshes' pose, at s."""
    travel: Callable[[float], float]
    """m that no point has travelled more than, up to s: it grows with s."""


@dataclass(frozen=True, eq=False)
class First:
    """`at` is free and `hit` is not, closer than asked; None: nothing was met. `overlaps`: the parts cross from the start
    and never part, so nothing is known. `exhausted`: how far it is free, where the work allowed was not enough."""

    at: float | None
    hit: float | None
    place: Array | None
    overlaps: bool = False
    exhausted: float | None = None


def first_crossing(test: PairTest, course: Course, end: float, fine: float, *, start: float = 0.0) -> First:
    """The first crossing of a pair while s goes from `start` up to `end`, to within `fine`."""
    if test.empty:
        return First(None, None, None)
    resolution = max(RESOLUTION * test.size, (course.travel(end) - course.travel(start)) / WORK * 2.0)
    search = _Search(test, course)
    search.muted = bool(search.state(start).crossing.surfaces)
    search.overlaps = search.muted and (test.overlapping or search.too_deep(start))
    left, stack = start, [end]
    while stack:
        right = stack[-1]
        way = course.travel(right) - course.travel(left)
        if search.state(left).distance + search.state(right).distance > (1.0 + 1e-6) * way + 1e-9 * test.size:
            left = stack.pop()
            search.pass_(left)
            continue
        if way > resolution and right - left > fine:
            if search.tried > WORK:
                return First(None, None, None, search.overlaps, left)
            stack.append(0.5 * (left + right))
            continue
        if search.crosses(right):
            if search.muted or search.real(right, end, resolution):
                return search.narrow(left, right, fine)
            search.muted = True
        if search.through(left, right):
            if right - left > fine:
                stack.append(0.5 * (left + right))
                continue
            if search.goes_in(left, end, resolution):
                return search.flat(left, right)
        left = stack.pop()
        search.pass_(left)
    return First(None, None, None, search.overlaps)


@dataclass(frozen=True, eq=False)
class _State:
    distance: float
    nearest: tuple[int, int]
    look: Callable[[], Crossing] | None
    """None: too far apart to cross."""

    @cached_property
    def crossing(self) -> Crossing:
        return NONE if self.look is None else self.look()


class _Search:
    def __init__(self, test: PairTest, course: Course):
        self.test, self.course = test, course
        self.muted = False
        """Overlapping since the start, or by no more than chord errors."""
        self.overlaps = False
        self.tried = 0
        self._known: dict[float, _State] = {}

    def state(self, s: float) -> _State:
        if s not in self._known:
            self.tried += 1
            D = self.course.displacement(s)
            distance, nearest = self.test.distance(D)
            self._known[s] = _State(distance, nearest, None if distance > 0.0 else partial(self.test.crossing, D))
        return self._known[s]

    def crosses(self, s: float) -> bool:
        if not self.muted:
            return bool(self.state(s).crossing.surfaces)
        return not self.overlaps and self.too_deep(s)

    def through(self, left: float, right: float) -> bool:
        """Whether faces that are parallel may have passed through each other, crossing nowhere."""
        before, after = self.state(left), self.state(right)
        if self.muted or (before.distance <= 0.0 and after.distance <= 0.0):
            return False
        nearest = before.nearest if before.distance > 0.0 else after.nearest
        heights = [self.test.height(self.course.displacement(s), nearest) for s in (left, right)]
        least = 1e-9 * self.test.size
        if before.distance <= 0.0 and abs(heights[0]) <= least:
            return heights[1] < -least
        return heights[0] > least >= heights[1]

    def goes_in(self, s: float, end: float, step: float) -> bool:
        """Whether the faces that pass each other at s are inside the parts a step later."""
        nearest = self.state(s).nearest
        further = self._after(s, step, end)
        way = self.course.travel(further) - self.course.travel(s)
        return self.test.inside(self.course.displacement(further), *nearest, 0.4 * way)

    def flat(self, left: float, right: float) -> First:
        """Where faces meet flat."""
        f, g = self.state(left).nearest
        place = self.test.middle(self.course.displacement(right), f, g)
        return First(left, right, (self.test.X_WA @ np.append(place, 1.0))[:3])

    def pass_(self, s: float) -> None:
        """Parts that overlapped so far, and have parted at s, count from here on."""
        self.muted = self.muted and bool(self.state(s).crossing.surfaces)
        self.overlaps = self.overlaps and self.muted
        self._known = {key: state for key, state in self._known.items() if key >= s}

    def too_deep(self, s: float) -> bool:
        """Whether the parts go deeper into each other at s than chord errors explain."""
        crossing = self.state(s).crossing
        if not crossing.surfaces:
            return False
        if crossing.slack <= 0.0:
            return True
        return self.test.depth(self.course.displacement(s), crossing, crossing.slack) > crossing.slack

    def real(self, s: float, end: float, step: float) -> bool:
        """Whether what crosses at s comes to be deeper than chord errors before it parts, or before the end."""
        while self.state(s).crossing.surfaces:
            if self.too_deep(s):
                return True
            further = self._after(s, step, end)
            if further <= s:
                return False
            s = further
        return False

    def _after(self, s: float, way: float, end: float) -> float:
        """The parameter after s by which points have travelled `way` (m), no more than `end`."""
        goal = self.course.travel(s) + way
        if self.course.travel(end) <= goal:
            return end
        low, high = s, end
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.course.travel(middle) < goal else (low, middle)
        return high

    def narrow(self, left: float, right: float, fine: float) -> First:
        while right - left > fine:
            middle = 0.5 * (left + right)
            if middle in (left, right):
                break
            if self.crosses(middle):
                right = middle
            else:
                left = middle
        at = np.append(self.state(right).crossing.segments.mean(axis=(0, 1)), 1.0)
        return First(left, right, (self.test.X_WA @ at)[:3])
