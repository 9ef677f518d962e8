"""When points of one part come to be deep inside another along a motion.

Each point is asked for again only after it may have travelled as far as it was away (conservative advancement); along
a turn or a slide, after it has passed through a facet (`passages`).
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from kinform.collisions.pair.constants import CERTAIN
from kinform.collisions.pair.course import Course, narrowed
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

UNSEEN = 0.5
"""Share of what mates may be deep that points may travel unseen: what comes in deeper than they may is then seen before
it is through. A choice below 1."""
REFINED = 2e-3
"""Share of what a contact is found to, to which the facets that cross first, or a point that comes in, are followed:
less than 1e-9 rad of a turn."""


@dataclass(frozen=True, eq=False)
class Entry:
    """Where one part comes into another: at `at` it is free, and at `hit` it is not."""

    at: float
    hit: float
    place: Array
    """(3,) m, in the frame of the first part."""
    deep: float
    """Where it was seen to be deeper than mates may be."""


class Inside:
    """The `probes` of a pair along a course, from `s` on: those that are deep inside there do not count until they are
    out.

    What is less deep than mates may be does not count either, nor where it began: it is met where it is deeper.
    """

    def __init__(self, test: PairTest, course: Course, s: float):
        self._test, self._course = test, course
        count = sum(len(probes.points) for probes in test.probes)
        speck = SOLVED * test.size
        self._every = np.arange(count)
        self._passages = None if course.path is None else test.passages(course.path)
        self._last = s
        """Up to where passages have been looked at."""
        heights = np.zeros(count)
        asked = self._every if self._passages is None else np.flatnonzero(self._passages.maybe_inside(s))
        heights[asked] = self._heights(s, asked)
        self._ignored = heights > test.loose
        self._sunk = self._ignored & test.solid_about
        """Those that are deep inside from the start, and have not been out since."""
        self.sunk: float = float(heights[self._sunk].max(initial=0.0))
        """m: how deep the deepest of them was."""
        self.place = (
            test.places(course.displacement(s))[int(np.argmax(np.where(self._sunk, heights, -1.0)))]
            if self.sunk
            else None
        )
        """(3,) m, first part's frame: where."""
        self.deeper = math.inf
        """Where they were seen to be deeper."""
        self._entered = np.where(heights > speck, s, np.nan)
        """Where each point that is inside was last outside."""
        self._least = np.where(heights > speck, test.loose, speck)
        """m: it is inside from there on."""
        self._due = np.zeros(count)
        self._outside = np.full(count, s)
        """Where each point was last asked for and not inside."""
        self._speck = speck
        # So far points near the other part may travel between two questions, as a share of the size of the pair: four
        # times `advancement.RESOLUTION`, as to ask whether they are inside is dear, and what came in is found by
        # halving anyhow.
        self._stride = max(UNSEEN * test.loose, 0.016 * test.size)
        self._next = course.travel(s) + self._stride
        """m travelled: nothing is asked before, so that points are asked together."""
        self._wait(course.travel(s), self._every, heights)

    def _heights(self, s: float, chosen: Ints) -> Array:
        return self._test.heights(self._course.displacement(s), chosen, self._passages is None)

    def _wait(self, travelled: float, chosen: Ints, heights: Array) -> None:
        """When points have to be asked for again: once they may be out, in, or deep."""
        inside = ~self._ignored[chosen] & (heights > 0.0)
        away = np.where(inside, self._test.loose - heights, np.abs(heights))
        self._due[chosen] = travelled + np.maximum(CERTAIN * away, self._stride)

    def met(self, right: float, end: float, fine: float, *, every: bool = False) -> Entry | None:
        """Whether points are deep inside at `right`: to within `fine`, where the first of them came
        in, and its place (first part's frame). Those that just came in are looked for a little further, up to `end`.
        Only those that are due are asked for, unless `every`."""
        travelled = self._course.travel(right)
        if not every and travelled < self._next:
            return None
        self._follow_sunk(right)
        asked = self._asked(right, travelled, every)
        if not len(asked):
            return None
        self._next = travelled + self._stride
        heights = self._heights(right, asked)
        out = heights <= self._speck
        self._ignored[asked[out]] = False
        self._sunk[asked[out]] = False
        self._least[asked[out]] = self._speck
        came = ~out & np.isnan(self._entered[asked]) & ~self._ignored[asked]
        self._entered[asked[out]] = np.nan
        self._entered[asked[came]] = self._outside[asked[came]]
        self._outside[asked[out]] = right
        self._wait(travelled, asked, heights)
        counts = ~out & ~self._ignored[asked]
        deep = asked[counts & (heights > self._test.loose)]
        first = self._first(deep, heights[np.isin(asked, deep)], right, fine)
        if first is not None:
            return first
        shallow = asked[came]
        if len(shallow):
            further = self._course.when(travelled + 2.0 * self._test.loose, right, end)
            later = self._heights(further, shallow)
            if (later > self._test.loose).any():
                return self._first(shallow[later > self._test.loose], later[later > self._test.loose], further, fine)
        return None

    @property
    def parted(self) -> bool:
        """Whether all that was deep inside at the start has been out."""
        return not self._sunk.any()

    def soon(self, end: float, fine: float) -> Entry | None:
        """Whether points that are a little inside at the start are deep soon after, as where faces are flush and go
        into each other: no facets meet on the way that could tell. They are stopped where they are."""
        start = self._last
        shallow = np.flatnonzero(~np.isnan(self._entered) & ~self._ignored)
        for way in (2.0 * self._test.loose, self._stride) if len(shallow) else ():
            further = self._course.when(self._course.travel(start) + way, start, end)
            heights = self._heights(further, shallow)
            deep = heights > self._test.loose
            first = self._first(shallow[deep], heights[deep], further, fine) if deep.any() else None
            if first is not None:
                return Entry(start, min(start + fine, first.hit), first.place, first.deep)
        return None

    def forget(self) -> None:
        """What is deep inside where it began has not been so from the start."""
        self._sunk[:] = False
        self.sunk, self.place = 0.0, None

    def _follow_sunk(self, right: float) -> None:
        """Whether those that were deep inside at the start go deeper, as long as they have not been out."""
        chosen = np.flatnonzero(self._sunk)
        if len(chosen):
            heights = self._heights(right, chosen)
            self._sunk[chosen[heights <= self._speck]] = False
            if heights.max() > self._test.going_deeper(self.sunk):
                self.deeper = min(self.deeper, right)

    def _asked(self, right: float, travelled: float, every: bool) -> Ints:
        """Points that are due at `right`, or all; of a turn or a slide, those that are inside, or have passed."""
        due = self._every if every else np.flatnonzero(self._due <= travelled)
        if self._passages is None:
            return due
        passed = self._passages.last(self._last, right)
        self._last = right
        asked = ~np.isnan(passed)
        outside = asked & np.isnan(self._entered)
        self._outside[outside] = passed[outside]
        asked[due] |= ~np.isnan(self._entered[due]) & ~self._ignored[due]
        return np.flatnonzero(asked)

    def _first(self, points: Ints, heights: Array, right: float, fine: float) -> Entry | None:
        """Where the first of points came in that are inside at `right`."""
        first, last, further = None, points, right
        while len(points):
            deepest = int(np.argmax(heights))
            point = points[deepest : deepest + 1]
            left, hit, height = self._entry(point, float(heights[deepest]), right, fine)
            # of meshes that are not closed some places seem to be inside: a point that comes in is at first not deep
            if height > self._least[point[0]] + self._course.travel(hit) - self._course.travel(left) + self._speck:
                self._ignored[point] = True
                points, heights = np.delete(points, deepest), np.delete(heights, deepest)
                continue
            first, last = (left, hit), point
            # of those that came in before, the next
            others = points[(points != point) & (self._entered[points] < left)]
            heights = self._heights(left, others)
            met = heights > self._least[others]
            points, heights, right = others[met], heights[met], left
        if first is None:
            return None
        left, hit = narrowed(*first, REFINED * fine, partial(self._is_in, last, []))
        return Entry(left, hit, self._middle(first[1], further), further)

    def _entry(self, point: Ints, height: float, right: float, fine: float) -> tuple[float, float, float]:
        """Where a point (1,) that is inside at `right` came in: outside and inside, and how deep it is there (m)."""
        depths = [height]
        left, right = narrowed(float(self._entered[point[0]]), right, fine, partial(self._is_in, point, depths))
        return left, right, depths[-1]

    def _is_in(self, point: Ints, depths: list[float], s: float) -> bool:
        """Whether a point (1,) is inside at s; its depth (m) is then noted."""
        there = float(self._heights(s, point)[0])
        if there > self._least[point[0]]:
            depths.append(there)
            return True
        return False

    def _middle(self, s: float, later: float) -> Array:
        """(3,) m, first part's frame: about where points come in at s, by those that are deeper a little later."""
        soon = self._course.when(self._course.travel(s) + self._test.loose, s, max(s, later))
        heights = np.where(self._ignored, -np.inf, self._heights(soon, self._every))
        places = self._test.places(self._course.displacement(s))[heights >= 0.5 * heights.max()]
        return np.asarray(places.mean(axis=0))
