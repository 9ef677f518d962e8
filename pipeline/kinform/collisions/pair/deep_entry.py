"""When points of one part come to be deep inside another along a motion.

Each point is asked for again only after it may have travelled as far as it was away (conservative advancement).
"""

from __future__ import annotations

import numpy as np

from kinform.collisions.constants import CERTAIN, SPARSE, SPECK, UNSEEN
from kinform.collisions.pair.course import Course
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.model.arrays import Array, Ints


class Inside:
    """The `probes` of a pair along a course, from `s` on: those that are deep inside there do not count until they are
    out.

    What is less deep than mates may be does not count either, nor where it began: it is met where it is deeper.
    """

    def __init__(self, test: PairTest, course: Course, s: float):
        self._test, self._course = test, course
        count = sum(len(probes.points) for probes in test.probes)
        speck = SPECK * test.size
        self._every = np.arange(count)
        heights = self._heights(s, self._every)
        self._ignored = heights > test.loose
        self._entered = np.where(heights > speck, s, np.nan)
        """Where each point that is inside was last outside."""
        self._least = np.where(heights > speck, test.loose, speck)
        """m: it is inside from there on."""
        self._due = np.zeros(count)
        self._outside = np.full(count, s)
        """Where each point was last asked for and not inside."""
        self._speck = speck
        self._stride = max(UNSEEN * test.loose, SPARSE * test.size)
        self._next = course.travel(s) + self._stride
        """m travelled: nothing is asked before, so that points are asked together."""
        self._wait(course.travel(s), self._every, heights)

    def _heights(self, s: float, chosen: Ints) -> Array:
        return self._test.heights(self._course.displacement(s), chosen)

    def _wait(self, travelled: float, chosen: Ints, heights: Array) -> None:
        """When points have to be asked for again: once they may be out, in, or deep."""
        inside = ~self._ignored[chosen] & (heights > 0.0)
        away = np.where(inside, self._test.loose - heights, np.abs(heights))
        self._due[chosen] = travelled + np.maximum(CERTAIN * away, self._stride)

    def met(self, right: float, end: float, fine: float, *, every: bool = False) -> tuple[float, float, Array] | None:
        """Whether points are deep inside at `right`: to within `fine`, where the first of them came
        in, and its place (first part's frame). Those that just came in are looked for a little further, up to `end`.
        Only those that are due are asked for, unless `every`."""
        travelled = self._course.travel(right)
        if not every and travelled < self._next:
            return None
        asked = self._every if every else np.flatnonzero(self._due <= travelled)
        if not len(asked):
            return None
        self._next = travelled + self._stride
        heights = self._heights(right, asked)
        out = heights <= self._speck
        self._ignored[asked[out]] = False
        self._least[asked[out]] = self._speck
        came = ~out & np.isnan(self._entered[asked]) & ~self._ignored[asked]
        self._entered[asked[out]] = np.nan
        self._entered[asked[came]] = self._outside[asked[came]]
        self._outside[asked[out]] = right
        self._wait(travelled, asked, heights)
        counts = ~out & ~self._ignored[asked]
        deep = asked[counts & (heights > self._test.loose)]
        if len(deep):
            return self._first(deep, heights[np.isin(asked, deep)], right, fine)
        shallow = asked[came]
        if len(shallow):
            further = self._course.when(travelled + 2.0 * self._test.loose, right, end)
            later = self._heights(further, shallow)
            if (later > self._test.loose).any():
                return self._first(shallow[later > self._test.loose], later[later > self._test.loose], further, fine)
        return None

    def _first(self, points: Ints, heights: Array, right: float, fine: float) -> tuple[float, float, Array]:
        """Where the first of points came in that are inside at `right`."""
        left, further = right, right
        while len(points):
            deepest = points[[int(np.argmax(heights))]]
            left, least = float(self._entered[deepest[0]]), float(self._least[deepest[0]])
            while right - left > fine:
                middle = 0.5 * (left + right)
                if middle in (left, right):
                    break
                left, right = (left, middle) if self._heights(middle, deepest)[0] > least else (middle, right)
            # of those that came in before, the next
            others = points[(points != deepest[0]) & (self._entered[points] < left)]
            heights = self._heights(left, others)
            met = heights > self._least[others]
            points, heights = others[met], heights[met]
            right = left if len(points) else right
        return left, right, self._middle(right, further)

    def _middle(self, s: float, later: float) -> Array:
        """(3,) m, first part's frame: about where points come in at s, by those that are deeper a little later."""
        soon = self._course.when(self._course.travel(s) + self._test.loose, s, max(s, later))
        heights = np.where(self._ignored, -np.inf, self._heights(soon, self._every))
        places = self._test.places(self._course.displacement(s))[heights >= 0.5 * heights.max()]
        return np.asarray(places.mean(axis=0))
