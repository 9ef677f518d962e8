"""Pairs of parts that a turn, slide or screw could bring together, and how they come near each other."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, lru_cache, partial

from kinform.collisions.driving.constants import MEETING_MARGIN
from kinform.collisions.driving.meeting_spans import Spans, meeting_spans
from kinform.collisions.driving.overlaps import Overlap, Pair
from kinform.collisions.driving.swept_profiles import Meeting, Profile, meeting
from kinform.collisions.pair.advancement import First, Near, Search, first_crossing
from kinform.collisions.pair.course import Course
from kinform.collisions.pair.distance_bounds import Apart, Counted, Wholes
from kinform.collisions.pair.mate_surfaces import Kept
from kinform.collisions.pair.passages import Path
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.displacements import displacements_along
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import preserved
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch

STOP_ANGLE = math.radians(2e-5)
"""rad: to which a stop of a turn is found. Chosen, not measured."""
STOP_LENGTH = 1e-5
"""To which a stop of a slide is found. Chosen, not measured."""
WINDOW_TURN = 2.0 * math.pi / 32
"""rad of a turn, ..."""
WINDOW_SLIDE = 0.05
"""... and share of the smaller part's diagonal of a slide, that parts which come near each other are followed with the
facets that can meet there. Chosen, not measured."""
MODEL_MOST = 0.7
"""Where more than this share of the facets that can meet at all can in a window, all are modelled. Chosen, not
measured."""


class Candidate:
    """A pair of parts that the motion could bring together, the second part being the one that moves."""

    def __init__(self, shapes: Shapes, names: Pair, profiles: tuple[Profile, Profile], twist: Array):
        self.names, self._shapes, self.profiles, self._twist = names, shapes, profiles, twist
        self.turns = profiles[0].turns
        turning = float(twist[:3] @ twist[:3]) > 0.25
        self._turning, self._size = turning, min(shapes.mesh(name).diagonal for name in names)
        self.fine = STOP_ANGLE if turning else STOP_LENGTH * self._size
        """rad or m to which a stop is found."""
        self.window = math.inf if self.turns is None else WINDOW_TURN if turning else WINDOW_SLIDE * self._size
        """rad or m along which parts that come near are followed with the facets that can meet there."""
        moved = displacements_along(twist)
        self._moved = {sign: lru_cache(maxsize=64)(partial(_moved, moved, sign)) for sign in (-1, 1)}
        self._tests: list[PairTest] = []
        self._modelled = 0
        """Facets of models of some so far."""

    @property
    def units(self) -> str:
        """Of the assembly, in which lengths are told."""
        return self._shapes.assembly.units

    @property
    def part_names(self) -> Pair:
        """Sorted."""
        first, second = sorted(self.names)
        return first, second

    def course(self, sign: int, facets: tuple[Ints, Ints] | None = None) -> Course:
        """The motion to one side, for points of some facets of both parts, by default all that can meet."""
        radii = [
            profile.largest if facets is None else profile.radius(facets[k]) for k, profile in enumerate(self.profiles)
        ]
        along = float(abs(self._twist[:3] @ self._twist[3:]))
        speed = math.hypot(min(radii), along) if self._turning else 1.0
        path = None if self.turns is None else Path(self.profiles[0].frame, self.turns, sign)
        return Course(self._moved[sign], lambda s: speed * s, path=path)

    @property
    def beyond(self) -> float:
        """rad or m behind where another pair is too deep that it is followed to see whether it met before."""
        # By this share of the size, further than where the first pair is too deep others are followed, which may have
        # met before it did: four steps of parts in touch.
        return 0.016 * self._size / max(self.course(1).travel(1.0), TINY)

    def wholes(self) -> Wholes:
        """The parts with all their facets."""
        return Wholes(self._shapes, *self.names)

    @property
    def steps_apart(self) -> int:
        """Steps as wholes that cost about as much as to ask whether they are apart for good."""
        # Facets of a pair of which it is asked which can meet at all, in the time of one step as wholes: nested parts
        # of 1,000 facets took 0.5 ms and 1 to 3 ms, those of an arm with 20,000 took 5 ms and 0.5 to 2 ms.
        return sum(len(self._shapes.mesh(name).faces) for name in self.names) // 2000

    @property
    def apart(self) -> bool:
        """Whether none of their facets can meet anywhere."""
        return not all(map(len, self._meeting.facets))

    @cached_property
    def _meeting(self) -> Meeting:
        facets = self._shapes.moved_facets(*self.names, self._twist[None])
        return meeting(*self.profiles, *facets, MEETING_MARGIN * self._size)

    def between(self, sign: int, begin: float, end: float) -> PairTest | None:
        """With the facets that can meet between two places of the motion to one side, some more where these have been
        asked for; None where none can. With all that can meet, where models of some of them would take more facets than
        one of all."""
        all_facets = sum(map(len, self._meeting.facets))
        if self._modelled > all_facets:
            return self.anywhere
        facets = self._meeting.within(*sorted((sign * begin, sign * end)))
        return self._shared(facets, all_facets)

    def _shared(self, facets: tuple[Ints, Ints], all_facets: int) -> PairTest | None:
        """With some facets, and some more where these have been asked for."""
        count = len(facets[0]) + len(facets[1])
        if not (len(facets[0]) and len(facets[1])):
            return None
        for test in self._tests:
            # A model that is there is used for up to eight times fewer of its facets.
            if sum(map(len, test.facets)) <= 8.0 * count and test.holds(facets):
                return test
        self._modelled += count if count <= MODEL_MOST * all_facets else all_facets + 1
        return self.anywhere if self._modelled > all_facets else self._test(facets)

    def _met(self, sign: int, begin: float, end: float) -> PairTest:
        """With the facets that can meet there other than along mates."""
        test, spans = self.anywhere, self._spans
        assert test is not None and spans is not None
        all_facets = sum(map(len, test.facets))
        if self._modelled > all_facets:
            return test
        counted = spans.facets(*sorted((sign * begin, sign * end)))
        first, second = (side[some] for side, some in zip(test.facets, counted, strict=True))
        return self._shared((first, second), all_facets) or test.some((first, second))

    @cached_property
    def anywhere(self) -> PairTest | None:
        """With the facets that can meet; None where none can."""
        return self._test(self._meeting.facets)

    def _test(self, facets: tuple[Ints, Ints]) -> PairTest | None:
        if not (len(facets[0]) and len(facets[1])):
            return None
        known = self.__dict__.get("anywhere")
        test = PairTest(self._shapes, *self.names, facets, self.mates) if known is None else known.some(facets)
        self._tests.append(test)
        return test

    @cached_property
    def mates(self) -> list[Patch]:
        """The patches by which the two mate as they move."""
        return [patch for patch in self._shapes.patches(*self.names) if preserved(patch, self._twist[None])]

    def search(self, sign: int, start: float, end: float, whole: float) -> Search | None:
        """Of the first crossing up to `end`, with all facets that can meet, and where they do as far as that is known;
        None where they do not. Its steps are those of the `whole` motion, however far it is followed."""
        test = self.anywhere
        if test is None:
            return None
        course = self.course(sign, test.facets)
        if self._spans is None:
            return Search(test, course, start, whole, self.fine)
        course = replace(course, meets=self._spans.towards(sign))
        if course.apart(start, end):
            return None
        near = Near(lambda begin, end: self._met(sign, begin, end), self.window)
        return Search(test, course, start, whole, self.fine, near)

    @property
    def told(self) -> bool:
        """Whether it is known where facets can meet other than along mates."""
        return self._spans is not None

    @cached_property
    def _spans(self) -> Spans | None:
        """Where facets of a turn or slide can meet that count, other than along mates; None where that is not known."""
        turns, test = self.turns, self.anywhere
        if test is None or turns is None or not test.mates:
            return None

        def along(i: Ints, j: Ints, low: Array, high: Array) -> Flags:
            kept = [
                Kept(low, high, turns, profile.frame @ X, profile.span)
                for profile, X in zip(self.profiles, (test.X_WA, test.X_WB), strict=True)
            ]
            return test.mates.surely_along((i, j), (kept[0], kept[1]))

        parts = [
            (profile.corners(facets), test.counted(k))
            for k, (profile, facets) in enumerate(zip(self.profiles, test.facets, strict=True))
        ]
        return meeting_spans(parts, turns, MEETING_MARGIN * test.size, along)


def _moved(moved: Callable[[float], Array], sign: int, s: float) -> Array:
    """(4, 4) of a motion at s to one side."""
    return moved(sign * s)


@dataclass(frozen=True, eq=False)
class _Window:
    """A piece of the way, with the facets that can meet in it."""

    test: PairTest
    course: Course
    apart: Apart
    until: float


class Approach:
    """A pair on the way to one side: up to `s` nothing is met.

    As long as its parts are far from each other as wholes it goes on in steps; when these have cost as much as asking
    which facets can meet at all, that is asked: nested parts stay near all the way, and never meet. From where they are
    not far, the facets that can meet in a window of the motion are looked at: where none can, or they stay apart, it
    goes on behind the window; where they come too near to go on in steps, they are followed to its end. Parts that are
    in touch there, or that mate, are followed all the way.
    """

    def __init__(self, candidate: Candidate, sign: int, s: float, whole: float):
        """From `s` on, of a motion that goes up to `whole`."""
        self._candidate, self._sign, self._start, self.s, self._whole = candidate, sign, s, s, whole
        self._wholes = candidate.wholes()
        self._window: _Window | None = None
        self._search: Search | None = None

    @property
    def overlap(self) -> Overlap | None:
        """How the parts overlap from the start, as far as they were followed; None where they do not."""
        search = self._search
        if search is None or not search.overlapping:
            return None
        return Overlap(self._candidate.part_names, search.before, search.place)

    def advance(self, reach: float) -> First | None:
        """One step, up to `reach`; what is met, and what is not known, at its end; None: it may go on."""
        if self._search is not None:
            return self._followed(self._search, reach)
        if self._window is not None:
            return self._through(self._window, reach)
        if self._wholes.steps >= self._candidate.steps_apart and self._candidate.apart:
            self.s = math.inf
            return None
        following, short = self._wholes.step(self._candidate.course(self._sign), self.s, reach)
        if short:
            self._open(reach)
        else:
            self.s = following
        return None

    def _open(self, reach: float) -> None:
        """The window that begins where it is; where nothing can meet in it, it goes on behind."""
        until = self._behind(self.s)
        mating = self.s <= self._start and self._candidate.mates
        if mating and self._candidate.told:
            self._follow(self.s, reach)
            return
        test = self._candidate.anywhere if mating else self._candidate.between(self._sign, self.s, until)
        if test is None:
            self.s = until
        else:
            course = self._candidate.course(self._sign, test.facets)
            self._window = _Window(test, course, Counted(test), until)

    def _behind(self, s: float) -> float:
        """Where the window ends that begins at s: wherever that is, they meet at the same places."""
        window = self._candidate.window
        # No less than a tenth of a window is left where it begins.
        return window if math.isinf(window) else window * (math.floor(s / window + 0.1) + 1.0)

    def _through(self, window: _Window, reach: float) -> First | None:
        """A step in a window, or all of the rest of it."""
        until = min(window.until, reach)
        following, short = window.apart.step(window.course, self.s, until)
        if short and self.s <= self._start and window.test.mates:
            self._follow(self.s, reach)
            return None
        if not short:
            self.s = following
            if following >= window.until:
                self._window = None
            return None
        first = first_crossing(window.test, window.course, until, self._candidate.fine, start=following)
        if first.at is not None or first.exhausted is not None:
            self.s = math.inf
            return first
        end = window.course.displacement(until)
        if first.overlaps or window.test.distance(end)[0] <= SOLVED * window.test.size:
            self._follow(following, reach)
        else:
            self.s, self._window = until, None
        return None

    def _follow(self, start: float, reach: float) -> None:
        """From here on with all facets that can meet."""
        self._window, self._search = None, self._candidate.search(self._sign, start, reach, self._whole)
        self.s = math.inf if self._search is None else start

    def _followed(self, search: Search, reach: float) -> First | None:
        """A piece of the way, followed."""
        limit = min(self._behind(self.s), reach)
        first = search.until(limit, reach)
        over = limit >= reach or first.at is not None or first.exhausted is not None or first.deeper < math.inf
        self.s = math.inf if over else limit
        return first if over else None
