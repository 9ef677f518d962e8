"""The first place along a motion at which two parts cross: conservative advancement by distances.

Of an interval of the motion whose ends are free by d₀ and d₁, and along which no point of one part travels more
than ℓ relative to the other, nothing is to be feared while d₀ + d₁ > ℓ (Mirtich 1996); else it is halved, as far as
a resolution. What happens within the resolution, free at both ends, is a graze and not seen. What is too deep began
before that (`onsets`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from kinform.collisions.pair.course import Course
from kinform.collisions.pair.deep_entry import Entry, Inside
from kinform.collisions.pair.onsets import Onsets
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.pair.states import State, States
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array

WORK = 4000
"""Poses of one pair that one question may try before it is given up: a choice."""
STEPS_TOUCHED = 12
"""Steps in touch after which what crosses is told for several at once: as many as there were."""
RESOLUTION = 4e-3
"""So far a part may travel unseen where others are in touch, as a share of the size of the pair: a choice between time
and what thin features may be missed."""
OVERLAPPING = 5.0
"""Steps are so much longer while parts overlap: all that is asked is whether they separate. A choice."""


@dataclass(frozen=True, eq=False)
class First:
    """`at` is free and `hit` is not, closer than asked; None: nothing was met. `overlaps`: the parts overlap from the
    start and never part, so nothing is known. `exhausted`: how far it is free, where the work allowed was not
    enough."""

    at: float | None
    hit: float | None
    place: Array | None
    overlaps: bool = False
    exhausted: float | None = None
    before: float = 0.0
    """m: how deep the parts overlapped at the start, before they parted."""
    deeper: float = math.inf
    """Where they were seen to go deeper since, before they parted, or to lead on into each other: this way they ought
    not to go."""
    deep: float = math.inf
    """Where they were seen to be too deep in each other: up to there they may just scrape."""


NOTHING = First(None, None, None)


@dataclass(frozen=True, eq=False)
class _Hit(First):
    hit: float


def first_crossing(
    test: PairTest, course: Course, end: float, fine: float, *, start: float = 0.0, near: Near | None = None
) -> First:
    """The first crossing of a pair while s goes from `start` up to `end`, to within `fine`; `near` as of `Search`."""
    return NOTHING if test.empty else Search(test, course, start, end, fine, near).until(end, end)


@dataclass(frozen=True, eq=False)
class Near:
    """Facets that can meet on a piece of the way."""

    between: Callable[[float, float], PairTest]
    """The pair with these, between two parameters."""
    window: float
    """The length of a piece."""


class Search:
    """The first crossing of a pair on a course from `start` up to at most `end`, looked for piece by piece, to within
    `fine`."""

    def __init__(self, test: PairTest, course: Course, start: float, end: float, fine: float, near: Near | None = None):
        """`near`: where it is known which facets can meet other than along mates on a piece of the way."""
        self.test, self.course, self._near = test, course, near
        self._piece: tuple[float, float, PairTest] | None = None
        """From where to where what meets is asked of some facets only."""
        self._fine, self._end = fine, end
        self._resolution = max(RESOLUTION * test.size, (course.travel(end) - course.travel(start)) / WORK * 2.0)
        self.overlaps = False
        """Crossing since the start, by more than chord errors."""
        self.before = 0.0
        """m: overlap at the start."""
        self.place: Array | None = None
        """(3,) m, world: where."""
        self._deeper = math.inf
        """Where parts that have crossed since the start were seen to be deeper."""
        self._leads_in = math.inf
        """Where parts that overlap as they are drawn are seen to go on into each other."""
        self._states = States(course, self._asked)
        self._onsets = Onsets(test, course, self.state, start, fine, self._resolution)
        self._touched = 0
        """Steps that have been followed to the resolution, one after the other."""
        self._inside: Inside | None = None
        self._drawn = course.travel(start) <= 0.0
        """Whether it begins where the motion does: further on parts have been apart."""
        self._start = self._apart = self._left = start
        """From where on it is looked for; since where the parts have not overlapped; up to where it was looked for."""
        self._cover(start, end if near is None else min(start + near.window, end))
        self.begin(start)

    @property
    def overlapping(self) -> bool:
        """Whether the parts have overlapped since the start, as far as it was looked for: crossing, or flush, with
        points of one deep inside the other."""
        return self.overlaps or (self._inside is not None and not self._inside.parted)

    def until(self, limit: float, end: float) -> First:
        """What is met up to `limit`, from where it was looked for last; points that come in are looked for a little
        further, up to `end`. Of parts that overlap at the start and go deeper, or meet before they have parted and gone
        on by more than that, nothing is known."""
        soon = self._soon(end) if self._drawn and self._left <= self._start and not self.overlaps else None
        first = self._until(limit, end)
        if soon is not None and (first.hit is None or first.hit > soon.hit):
            first = soon
        inside = self._inside
        if first.hit is not None and inside is not None and not inside.parted:
            way = self.course.travel(first.hit) - self.course.travel(self._start)
            if way <= inside.sunk + self.test.loose:
                self._deeper = first.hit
        if self.deeper == math.inf and (self._leads_in <= limit or first.hit is not None):
            self._deeper = self._leads_in
        deeper = self.deeper < math.inf
        if deeper or (first.hit is None and first.exhausted is None and self.overlapping):
            return First(None, None, self.place, True, before=self.before, deeper=self.deeper)
        return first

    @property
    def deeper(self) -> float:
        """Where parts that have overlapped since the start were seen to be deeper; infinite where they were not."""
        return min(self._deeper, math.inf if self._inside is None else self._inside.deeper)

    def _until(self, limit: float, end: float) -> First:
        left, stack = self._left, [limit]
        self._cover(left, limit)
        while stack:
            if self.deeper < math.inf or left >= self._leads_in:
                break
            right, meets = self._step(left, stack)
            if not meets:
                entered = self.entered(right, end) if right >= end else None
                if entered is not None:
                    return entered
                left = self.skip(stack.pop())
                continue
            way = self.course.travel(right) - self.course.travel(left)
            self._look_ahead(left, stack)
            if self.state(left).distance + self.state(right).distance > (1.0 + SINGLE) * way + SOLVED * self.test.size:
                # nothing comes to be inside where no facets that count meet: the end is asked all the same
                entered = self.entered(right, end) if right >= end else None
                if entered is not None:
                    return entered
                self._touched = 0
                left = self.pass_(left, stack.pop())
                continue
            if self._long(left, right):
                if self._states.tried > WORK:
                    return First(None, None, None, self.overlaps, left)
                stack.append(self.course.middle(left, right))
                continue
            self._touched += 1
            if self.too_deep(right):
                return self.crossed(left, right)
            if self.through(left, right):
                if right - left > self._fine:
                    stack.append(self.course.middle(left, right))
                    continue
                if self.goes_in(left, end):
                    return self._met(self._onsets.flat(left, right))
            entered = self.entered(right, end)
            if entered is not None:
                return entered
            left = self.pass_(left, stack.pop())
        self._left = left
        return First(None, None, None, self.overlaps)

    def begin(self, start: float) -> None:
        """What crosses at the start is no stop as long as it is no deeper than chord errors, and else not known."""
        if self.course.meets is not None and not self.course.meets(start)[0]:
            return
        crossing = self.state(start).crossing
        self._onsets.begin(crossing.shared)
        self.overlaps = bool(crossing) and (self.test.overlapping or self.too_deep(start))
        if self.overlaps:
            depth = self._onsets.depth(start)
            self.before = depth if depth > SOLVED * self.test.size else 0.0
            middles = crossing.segments().mean(axis=1)
            self.place = self._world(middles[np.argmin(np.linalg.norm(middles - middles.mean(axis=0), axis=1))])
            self._look_where_it_leads(start)

    def _look_where_it_leads(self, start: float) -> None:
        """Whether parts that overlap as they are drawn are seen to go on into each other: deep enough, they would come
        out on the other side and seem to have parted."""
        at = self.test.leads_in(self.course.displacement, start, self._end) if self._drawn else None
        self._leads_in = math.inf if at is None else at

    def _step(self, left: float, stack: list[float]) -> tuple[float, bool]:
        """Where the step from `left` ends, which is put on the stack, and whether anything can meet in it."""
        if self.course.meets is None:
            return stack[-1], True
        meets, until = self.course.meets(left)
        if left < until < stack[-1]:
            stack.append(until)
        return stack[-1], meets

    def _long(self, left: float, right: float) -> bool:
        """Whether a step is to be halved where parts are in touch."""
        way = self.course.travel(right) - self.course.travel(left)
        return way > (OVERLAPPING if self.overlaps else 1.0) * self._resolution and right - left > self._fine

    def _look_ahead(self, left: float, stack: Sequence[float]) -> None:
        """Where parts have been in touch for some steps, make ready what is asked of as many more of them: they are
        likely to be so further on."""
        if self._touched < STEPS_TOUCHED or stack[-1] in self._states:
            return
        # What crosses is told for 48 steps at once at most. One of a thread took 2.5 ms alone, and 0.8 ms among 48.
        most, stack, places = min(self._touched, 48), list(stack), dict[float, None]()
        while stack and len(places) < most:
            right, meets = self._step(left, stack)
            if not meets:
                left = stack.pop()
                continue
            if right not in self._states:
                places[right] = None
            if self._long(left, right):
                stack.append(self.course.middle(left, right))
            else:
                left = stack.pop()
        self._states.expect(places, self.test.going_deeper(self.before) if self.overlaps else None)

    def state(self, s: float) -> State:
        """At s."""
        return self._states.at(s)

    def _cover(self, begin: float, end: float) -> None:
        """Ask from here to there what can meet there, in one piece."""
        if self._near is None:
            return
        test = self._near.between(begin, end)
        self._states.only(begin, test)
        self._piece = begin, end, test

    def _asked(self, s: float) -> PairTest:
        """The pair with the facets that count at s, or as far as they can meet there."""
        if self._near is None or self._piece is None:
            return self.test
        begin, end, test = self._piece
        return test if begin <= s <= end else self._near.between(s, s)

    def through(self, left: float, right: float) -> bool:
        """Whether faces that are parallel may have passed through each other, crossing nowhere."""
        before, after = self.state(left), self.state(right)
        if before.crossing or after.crossing or (before.distance <= 0.0 and after.distance <= 0.0):
            return False
        least = SOLVED * self.test.size
        if before.distance > least:
            low, high = self._heights(left, right, before)
            return low > least >= high
        # in touch, nearly: which facets are opposite is as well told by what is near afterwards
        heights = [self._heights(left, right, state) for state in (before, after) if state.distance > 0.0]
        return any(low > least >= high or (abs(low) <= least and high < -least) for low, high in heights)

    def _heights(self, left: float, right: float, state: State) -> tuple[float, float]:
        low, high = (state.test.height(self.course.displacement(s), state.nearest) for s in (left, right))
        return low, high

    def goes_in(self, s: float, end: float) -> bool:
        """Whether the faces that pass each other at s are inside the parts a step later; where parts are thin,
        sooner."""
        test, nearest = self.state(s).test, self.state(s).nearest
        begun = self.course.travel(s)
        # Shares of the resolution behind a face at which it is asked what is inside: parts may be thinner, so each is a
        # fifth of the one before. A choice.
        for share in (1.0, 0.2, 0.04):
            further = self.course.when(begun + share * self._resolution, s, end)
            way = self.course.travel(further) - begun
            # Nothing is asked behind a face nearer than this many times what a contact is found to: there it could not
            # be told from the contact. A choice.
            if further - s < 4.0 * self._fine:
                return False
            D = self.course.displacement(further)
            # Share of the way behind a face by which its points are then inside: less than half, so that those of a
            # face that is aslant count too. A choice.
            if test.faces(D, *nearest) if share < 1.0 else test.inside(D, *nearest, 0.4 * way):
                return True
        return False

    def crossed(self, left: float, right: float) -> First:
        """What is met where facets are too deep in each other at `right`, and were not at `left`; or points that came
        to be inside before."""
        crossed = self._onsets.crossed(left, right)
        point = None if self.overlaps else self._points.met(right, right, self._fine, every=True)
        if point is None or point.hit >= crossed.hit:
            return self._met(crossed, right)
        return self._met(self._onsets.entered(point), right)

    def entered(self, right: float, end: float) -> First | None:
        """Where points came to be deep inside the other part up to `right`, or a little further."""
        point = None if self.overlaps else self._points.met(right, end, self._fine, every=right >= end)
        return None if point is None else self._met(self._onsets.entered(point), point.deep)

    def _soon(self, end: float) -> _Hit | None:
        """Points that go in from the start."""
        point = self._points.soon(end, self._fine)
        return None if point is None else self._met(point)

    @property
    def _points(self) -> Inside:
        """The points that may come in, from where the parts do not cross on."""
        if self._inside is None:
            self._inside = Inside(self.test, self.course, self._apart)
            if not self._drawn or self._apart > self._start:
                self._inside.forget()
            elif self._inside.place is not None:
                self.before, self.place = self._inside.sunk, self._world(self._inside.place)
                self._look_where_it_leads(self._start)
        return self._inside

    def _met(self, onset: Entry, deep: float = -math.inf) -> _Hit:
        """What began there, and is too deep where the onset says, or further on."""
        deep = max(deep, onset.deep)
        return _Hit(onset.at, onset.hit, self._world(onset.place), before=self.before, deep=deep)

    def _world(self, place: Array) -> Array:
        """(3,) m, world: a place in the frame of the first part."""
        return np.asarray((self.test.X_WA @ np.append(place, 1.0))[:3])

    def pass_(self, left: float, right: float) -> float:
        """Go on from `right`: parts that overlapped from the start and have parted count from there."""
        crossing = self.state(right).crossing
        self._onsets.go_on(left, right, crossing.shared)
        if self.overlaps:
            self.overlaps, self._apart = bool(crossing), right
            if self.state(right).deeper(self.test.going_deeper(self.before)):
                self._deeper = right
        self._states.forget_before(right)
        return right

    def skip(self, right: float) -> float:
        """Go on from `right`, where nothing can cross, nor on the way there."""
        self._onsets.begin(())
        self._touched = 0
        if self.overlaps:
            self.overlaps, self._apart = False, right
        self._states.forget_before(right)
        return right

    def too_deep(self, s: float) -> bool:
        """Whether the parts go deeper into each other at s than chord errors explain, and did not from the start."""
        return not self.overlaps and self.state(s).deeper(self.state(s).crossing.slack)
