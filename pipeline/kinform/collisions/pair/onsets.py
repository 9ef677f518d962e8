"""Where along a motion the contact of two parts began that stops them: seen where they are too deep in each other, it
is followed back to the surfaces that came to cross for it.

It is the same whether facets that cross too deeply were seen first or points that came in: either tells that there is a
stop, and both of what began shortly before where it is. Points lie inside of facets, and come in after their edges.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator
from functools import partial

from kinform.collisions.pair.course import Course, narrowed
from kinform.collisions.pair.deep_entry import REFINED, Entry
from kinform.collisions.pair.mate_surfaces import SurfacePair
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.pair.states import State
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Ints

TOGETHER = 8.0
"""Surfaces that come to cross within so many chord errors of travel belong to one collision, and so does a point that
comes in. A choice."""


Step = tuple[float, float]
"""From where to where the pair was followed at once."""


class Onsets:
    """Surfaces of a pair that cross along a course, and since which step."""

    def __init__(
        self, test: PairTest, course: Course, state: Callable[[float], State], start: float, fine: float, step: float
    ):
        """Followed from `start` on, to within `fine`; `step` (m): the longest in touch."""
        self._test, self._course, self._state = test, course, state
        self._start, self._fine, self._step = start, fine, step
        self._since: dict[SurfacePair, Step | None] = {}
        """The step in which surfaces that cross began to; None: at the start."""
        self._ended: dict[SurfacePair, tuple[Step, float]] = {}
        """Of surfaces that have crossed, the step in which they last began to, and up to where they did."""

    def begin(self, pairs: Iterable[SurfacePair]) -> None:
        """These cross at the start."""
        self._since = dict.fromkeys(pairs)

    def go_on(self, left: float, right: float, pairs: Iterable[SurfacePair]) -> None:
        """These cross after a step."""
        before, self._since = self._since, {pair: self._since.get(pair, (left, right)) for pair in pairs}
        for pair, step in before.items():
            if step is not None and pair not in self._since:
                self._ended[pair] = step, right

    def crossed(self, left: float, right: float) -> Entry:
        """Where what all together is too deep at `right`, and was not at `left`, began: with the surfaces that came to
        cross last, as far as these alone are too deep. Facets of mates may have crossed by chord errors long before."""
        crossing = self._state(right).crossing
        since = {pair: self._since.get(pair, (left, right)) for pair in crossing.shared}
        began = {pair: step for pair, step in since.items() if step is not None}
        for earliest in self._earliest(began.values(), crossing.slack):
            newest = frozenset(pair for pair, step in began.items() if step >= earliest)
            if newest == since.keys() or self._deep(right, newest):
                return self._begun(*earliest, newest)
        return self._risen(right)

    def entered(self, point: Entry) -> Entry:
        """Where what a point shows that came in began: with the surfaces that cross there, and came to cross shortly
        before."""
        crossing = self._state(point.hit).crossing
        if not crossing:
            return point
        # thin parts may be through a face within a step
        last = self._course.when(self._course.travel(point.hit) - self._step, self._start, point.hit), point.hit
        began = {pair: step for pair in crossing.shared if (step := self._began(pair, point, last)) is not None}
        own = point.at, point.hit
        earliest = next(self._earliest([own, *began.values()], max(self._test.loose, crossing.slack)))
        if earliest == own:
            return point
        first = self._begun(*earliest, frozenset(pair for pair, step in began.items() if step >= earliest))
        return first if first.hit < point.hit else point

    def _began(self, pair: SurfacePair, point: Entry, last: Step) -> Step | None:
        """The step in which surfaces began to cross that do so where a point came in; `last`: where they were not seen
        to, None: at the start."""
        if pair in self._since:
            step = self._since[pair]
            return step if step is None or step[0] <= point.at else last
        step, until = self._ended.get(pair, (last, -math.inf))
        return step if step[0] <= point.at <= until else last

    def flat(self, left: float, right: float) -> Entry:
        """Where faces meet flat: one passes through the other between `left` and `right`."""
        state = self._state(left)
        left, right = narrowed(left, right, REFINED * self._fine, partial(self._behind, state))
        return Entry(left, right, state.test.middle(self._course.displacement(right), *state.nearest), right)

    def depth(self, s: float) -> float:
        """m: how deep the parts go into each other where they cross."""
        crossing = self._state(s).crossing
        return self._test.depth(self._course.displacement(s), crossing.segments()) if crossing else 0.0

    def _earliest(self, steps: Iterable[Step], slack: float) -> Iterator[Step]:
        """Of steps that follow each other closely the first: of the last such, then of those before."""
        near = TOGETHER * slack + 2.0 * self._step
        order = sorted(set(steps), reverse=True)
        for step, before in zip(order, [*order[1:], None][: len(order)], strict=True):
            if before is None or self._course.travel(step[0]) - self._course.travel(before[1]) > near:
                yield step

    def _behind(self, state: State, s: float) -> bool:
        height = state.test.height(self._course.displacement(s), state.nearest)
        return height <= SOLVED * self._test.size

    def _deep(self, s: float, pairs: Collection[SurfacePair]) -> bool:
        crossing = self._state(s).crossing
        segments = crossing.segments(pairs)
        return self._test.depth(self._course.displacement(s), segments, crossing.slack) > crossing.slack

    def _risen(self, right: float) -> Entry:
        """Where surfaces that have crossed since the start began to go deeper into each other, up to `right`: from the
        start, if they do so within the first step."""
        low, least = right, self.depth(right)
        place, slack, travel = right, self._state(right).crossing.slack, self._course.travel
        while place > self._start:
            place = self._course.when(travel(place) - self._step, self._start, place)
            depth = self.depth(place)
            # Share of the same by which a depth that grows may have been greater before, as it is measured at some
            # points only: a choice.
            if depth >= least + 0.1 * slack:
                break
            if depth < least:
                low, least = place, depth
        # Share of what may be overlap of mates or chord errors by which the depth has to grow: a choice.
        least += 0.02 * slack
        left, hit = narrowed(low, right, self._fine, lambda s: self.depth(s) > least)
        if travel(hit) - travel(self._start) <= self._step:
            left, hit = self._start, min(self._start + self._fine, hit)
        return self._hit(left, hit)

    def _crosses(self, pairs: Collection[SurfacePair], s: float) -> bool:
        return not self._state(s).crossing.shared.keys().isdisjoint(pairs)

    def _begun(self, left: float, right: float, pairs: Collection[SurfacePair]) -> Entry:
        """Where pairs of surfaces begin to cross between `left` and `right`.

        Of the facets that cross at `right` the first is found; where others cross before that, they take their place,
        also those of surfaces that have parted again at `right`. What is found does not hang on the steps in which it
        was come near to.
        """
        before = self._state(left).crossing.shared.keys()
        for to in (self._fine, REFINED * self._fine):
            # So often the facets that cross first are looked for among those that cross a little later: a choice; each
            # time they are found to the resolution of the one before.
            for _ in range(4):
                state = self._state(right)
                hits = state.test.of_surfaces(state.hits, pairs)
                low, high = narrowed(left, right, to, partial(self._cross, state.test, hits))
                pairs = frozenset(pairs) | (self._state(low).crossing.shared.keys() - before)
                if low <= left or not self._crosses(pairs, low):
                    left, right = low, high
                    break
                right = low
            else:
                left, right = narrowed(left, right, to, partial(self._crosses, pairs))
        return self._hit(left, right)

    def _cross(self, test: PairTest, hits: Ints, s: float) -> bool:
        return bool(test.crossing(self._course.displacement(s), hits))

    def _hit(self, left: float, right: float) -> Entry:
        return Entry(left, right, self._state(right).crossing.segments().mean(axis=(0, 1)), right)
