"""A pair at places of its course: how far apart it is, what touches and what crosses, each asked once.

Where parts go on touching, what crosses is told for several places at once (`expect`): numpy takes as long for the few
facets that cross at one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property

from kinform.collisions.pair.course import Course
from kinform.collisions.pair.prepared_pair import NONE, Crossing, PairTest
from kinform.model.arrays import Array, Ints


class State:
    """A pair at one displacement (4, 4); `touching`: whether it is likely to touch there."""

    def __init__(self, test: PairTest, D: Array, touching: bool):
        self.test, self._D = test, D
        # to ask for what touches costs no more than to ask how far apart it is
        known = test.hits(D) if touching else None
        self.distance = 0.0 if known is not None and len(known) else self._found[0]
        """m: of the facets that count."""
        if known is not None:
            self.hits = known
        self._shallow: float | None = None

    @cached_property
    def _found(self) -> tuple[float, tuple[int, int]]:
        return self.test.distance(self._D)

    @property
    def nearest(self) -> tuple[int, int]:
        """The facets that are nearest to each other."""
        return self._found[1]

    @cached_property
    def hits(self) -> Ints:
        """(n, 2) facets that touch or cross."""
        return self.test.hits(self._D)

    @cached_property
    def crossing(self) -> Crossing:
        """What crosses; where facets are apart there is nothing."""
        return NONE if self.distance > 0.0 else self.test.crossing(self._D, self.hits)

    def deeper(self, least: float) -> bool:
        """Whether the parts go deeper into each other where they cross than by `least` (m)."""
        if not self.crossing or self._shallow == least:
            return False
        return self.test.depth(self._D, self.crossing.segments(), least) > least

    @staticmethod
    def cross(states: Iterable[State], least: float | None) -> None:
        """Tell of states of one pair together what crosses, and whether it is deeper than `least` (m; None: than mates
        may be)."""
        touching = [state for state in states if state.distance <= 0.0]
        if not touching:
            return
        test = touching[0].test
        found = test.crossings([state._D for state in touching], [state.hits for state in touching])
        for state, crossing in zip(touching, found, strict=True):
            state.crossing = crossing
        crossed = [state for state in touching if state.crossing]
        if not crossed:
            return
        allowed = [state.crossing.slack if least is None else least for state in crossed]
        shallow = test.shallow([s._D for s in crossed], [s.crossing.segments() for s in crossed], allowed)
        for state, deep, none in zip(crossed, allowed, shallow, strict=True):
            state._shallow = deep if none else None


class States:
    """Those of a course; `asked` gives the pair with the facets that are asked about at a place."""

    def __init__(self, course: Course, asked: Callable[[float], PairTest]):
        self._course, self._asked = course, asked
        self._known: dict[float, State] = {}
        self._expected: dict[float, State] = {}
        self._touching = False
        """Whether the pair touched where it was last asked."""
        self.tried = 0
        """Places that were asked for."""

    def __contains__(self, s: float) -> bool:
        return s in self._known or s in self._expected

    def at(self, s: float) -> State:
        """At one place."""
        if s not in self._known:
            self.tried += 1
            state = self._expected.pop(s, None) or self._made(s, self._touching)
            self._known[s] = state
            self._touching = state.distance <= 0.0
        return self._known[s]

    def expect(self, places: Iterable[float], least: float | None) -> None:
        """Make those at places ready that will be asked for if the pair goes on touching; how deep it is: `least` as of
        `State.cross`."""
        made: list[State] = []
        for s in places:
            state = self._made(s, True)
            if made and state.test is not made[0].test:
                break
            made.append(state)
            self._expected[s] = state
        State.cross(made, least)

    def _made(self, s: float, touching: bool) -> State:
        return State(self._asked(s), self._course.displacement(s), touching)

    def only(self, s: float, test: PairTest) -> None:
        """Forget all but that at one place, and that too where it is of another pair of facets."""
        here = self._known.get(s)
        self._known = {s: here} if here is not None and here.test is test else {}
        self._expected = {}

    def forget_before(self, s: float) -> None:
        """Forget those that have been passed."""
        self._known = {key: state for key, state in self._known.items() if key >= s}
        self._expected = {key: state for key, state in self._expected.items() if key >= s}
