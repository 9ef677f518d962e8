"""The range of a joint that no loop closes over: one side of the assembly moves along a screw, the other rests."""

from __future__ import annotations

import heapq
import math
from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from kinform.collisions.constants import MEETING_MARGIN, SCREW_TURNS, SCREW_TURNS_MOST, STOP_ANGLE, STOP_LENGTH
from kinform.collisions.driving.meeting_spans import Spans, meeting_spans
from kinform.collisions.driving.swept_profiles import Profile, meeting
from kinform.collisions.driving.swept_spheres import first_touch
from kinform.collisions.pair.advancement import NOTHING, first_crossing
from kinform.collisions.pair.course import Course
from kinform.collisions.pair.distance_bounds import Wholes
from kinform.collisions.pair.mate_surfaces import Kept
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.displacements import displacement
from kinform.kinematics.mobility.guides import guide, joint_twist, preserved
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.kinematics import Joint
from kinform.model.names import PartName

Pair = tuple[PartName, PartName]


class _Candidate:
    """A pair of parts that the motion could bring together, the second part being the one that moves."""

    def __init__(self, shapes: Shapes, names: Pair, profiles: tuple[Profile, Profile], twist: Array):
        self.names, self._shapes, self.profiles, self._twist = names, shapes, profiles, twist
        self.turns = profiles[0].turns
        self._turning = float(twist[:3] @ twist[:3]) > 0.25

    def course(self, sign: int, radius: float | None = None) -> Course:
        """The motion to one side, for points no further from the axis than `radius` (m), by default all that can
        meet."""
        if radius is None:
            radius = min(profile.largest for profile in self.profiles)
        along = float(abs(self._twist[:3] @ self._twist[3:]))
        speed = math.hypot(radius, along) if self._turning else 1.0
        moved = lru_cache(maxsize=64)(lambda s: displacement(sign * s * self._twist))
        return Course(moved, lambda s: speed * s)

    def followed(self, sign: int) -> Course:
        """The motion to one side of the facets that can meet, and where they do, as far as that is known."""
        assert self.test is not None
        course, spans = self.course(sign, self.test[1]), self._meetings
        return course if spans is None else replace(course, meets=spans.towards(sign))

    def wholes(self) -> Wholes:
        """The parts with all their facets."""
        return Wholes(self._shapes, *self.names)

    def advance(self, wholes: Wholes, sign: int, s: float, end: float) -> tuple[float, bool]:
        """A parameter after s up to which they are certainly apart, and whether they have to be followed from there:
        where they come too near as wholes, it goes on with the facets that can meet."""
        if wholes.exact:
            assert self.test is not None
            return wholes.step(self.course(sign, self.test[1]), s, end)
        following, short = wholes.step(self.course(sign), s, end)
        if not short:
            return following, False
        if self.test is None:
            return math.inf, False
        wholes.by(self.test[0])
        return s, False

    @cached_property
    def test(self) -> tuple[PairTest, float] | None:
        """With the facets that can meet, and how far these are from the axis at most; None where none can."""
        shapes, twists, (first, second) = self._shapes, self._twist[None], self.names
        margin = MEETING_MARGIN * min(shapes.mesh(first).diagonal, shapes.mesh(second).diagonal)
        facets = meeting(*self.profiles, *shapes.moved_facets(first, second, twists), margin)
        if not (len(facets[0]) and len(facets[1])):
            return None
        mates = [patch for patch in shapes.patches(first, second) if preserved(patch, twists)]
        test = PairTest(shapes, first, second, facets, mates)
        return test, min(profile.radius(side) for profile, side in zip(self.profiles, facets, strict=True))

    @cached_property
    def _meetings(self) -> Spans | None:
        """Where facets of a turn or slide can meet that count, other than along mates; None where that is not known."""
        turns = self.turns
        if self.test is None or turns is None or not self.test[0].mates:
            return None
        test, first = self.test[0], self.profiles[0]

        def along(i: Ints, j: Ints, low: Array, high: Array) -> Flags:
            return test.mates.surely_along((i, j), Kept(low, high, turns, first.frame @ test.X_WA, first.span))

        parts = [
            (profile.corners(facets), test.counted(k))
            for k, (profile, facets) in enumerate(zip(self.profiles, test.facets, strict=True))
        ]
        return meeting_spans(parts, turns, MEETING_MARGIN * test.size, along)


_Entry = tuple[_Candidate, float]


def drive_alone(shapes: Shapes, joint: Joint, still: Sequence[str], moving: Sequence[str]) -> JointRange:
    """The range of a joint with the parts that rest and those that move (the side of its second body)."""
    twist = joint_twist(joint)
    profiles = {name: _profile(shapes, name, twist) for name in (*still, *moving)}
    candidates = _candidates(shapes, profiles, twist, still, moving)
    below, above = guide(*shapes.design(), joint, shapes.body_parts[joint.bodies[1]])
    if joint.type == "revolute":
        below, above = -math.pi, math.pi
    elif joint.type == "screw":
        return _screwed(joint, candidates, twist, below, above)
    else:
        reach = _clear(list(profiles.values()))
        below, above = max(below, -reach), min(above, reach)
    ends = {sign: _end(candidates, twist, sign, abs(limit), 0.0) for sign, limit in ((-1, below), (1, above))}
    if joint.type == "revolute":
        for sign in (-1, 1):
            # a turn that stops one way stops the other way too, before the same place is reached
            other = ends[-sign][0]
            if ends[sign][0].status == "unbounded" and other.status == "found" and other.value is not None:
                ends[sign] = _end(candidates, twist, sign, 2.0 * math.pi - abs(other.value), math.pi)
    left_out = {pair for _, pairs in ends.values() for pair in pairs}
    done = [_leaving(ends[sign][0], joint, limit) for sign, limit in ((-1, below), (1, above))]
    return JointRange(joint.name, done[0], done[1], tuple(sorted(left_out)))


def _screwed(joint: Joint, candidates: Sequence[_Candidate], twist: Array, below: float, above: float) -> JointRange:
    """The range of a screw whose threads are left at `below` and `above` (rad; infinite where that is not known)."""
    left_out: set[Pair] = set()
    done = []
    for sign, limit in ((-1, abs(below)), (1, above)):
        last = min(limit, 2.0 * math.pi * (SCREW_TURNS_MOST if math.isfinite(limit) else SCREW_TURNS))
        free, end = 0.0, RangeEnd("unbounded")
        while free < last and end.status == "unbounded":
            further = min(free + 2.0 * math.pi * SCREW_TURNS, last)
            end, pairs = _end(candidates, twist, sign, further, free)
            left_out.update(pairs)
            free = further
        if end.status == "unbounded" and last < limit:
            end = RangeEnd(
                "unknown", reason=f"nothing stops it in {last / (2.0 * math.pi):.6g} turns, and no further was tried"
            )
        done.append(_leaving(end, joint, sign * limit))
    return JointRange(joint.name, done[0], done[1], tuple(sorted(left_out)))


def _leaving(end: RangeEnd, joint: Joint, limit: float) -> RangeEnd:
    if end.status != "unbounded" or joint.type == "revolute":
        return end
    return RangeEnd("unbounded", reason="leaves its guide", leaves=limit)


def _profile(shapes: Shapes, name: str, twist: Array) -> Profile:
    mesh, X = shapes.mesh(name), shapes.part(name).X_WP
    return Profile(mesh.vertices @ X[:3, :3].T + X[:3, 3], mesh.faces, twist)


def _candidates(
    shapes: Shapes, profiles: dict[str, Profile], twist: Array, still: Sequence[str], moving: Sequence[str]
) -> list[_Candidate]:
    """Pairs whose parts sweep over places of each other."""
    if not (still and moving):
        return []
    (low, high), (from_, to) = (
        (np.stack(sides) for sides in zip(*(profiles[name].bounds for name in names), strict=True))
        for names in (still, moving)
    )
    near = (low[:, None] <= to).all(axis=2) & (from_ <= high[:, None]).all(axis=2)
    return [
        _Candidate(shapes, (PartName(still[i]), PartName(moving[j])), (profiles[still[i]], profiles[moving[j]]), twist)
        for i, j in np.argwhere(near).tolist()
    ]


def _end(
    candidates: Sequence[_Candidate], twist: Array, sign: int, limit: float, start: float
) -> tuple[RangeEnd, list[Pair]]:
    """How far one side goes, up to `limit`; and the pairs of which something was left out."""
    reach, left_out = limit, []
    best: tuple[float, PairTest, Array] | None = None
    exhausted: tuple[float, Pair] | None = None
    turning = float(twist[:3] @ twist[:3]) > 0.25
    order = _in_order(candidates, sign, start, limit)
    entry = next(order, None)
    while entry is not None:
        candidate, free = entry
        if candidate.test is not None:
            test, _ = candidate.test
            fine = STOP_ANGLE if turning else STOP_LENGTH * test.size
            course = candidate.followed(sign)
            first = NOTHING if course.apart(free, reach) else first_crossing(test, course, reach, fine, start=free)
            if first.overlaps:
                left_out.append(test.part_names)
            if first.exhausted is not None and (exhausted is None or first.exhausted < exhausted[0]):
                exhausted = (first.exhausted, test.part_names)
            if first.at is not None and first.place is not None:
                reach, best = first.at, (first.at, test, first.place)
        entry = _following(order, reach)
    if exhausted is not None and exhausted[0] < reach:
        return RangeEnd("unknown", reason=f"{' and '.join(exhausted[1])} stay too close to be followed"), left_out
    if best is not None:
        return RangeEnd("found", sign * best[0], best[1].part_names, best[2]), left_out
    if left_out:
        few = ", ".join(" and ".join(pair) for pair in sorted(left_out)[:3])
        return RangeEnd("unknown", reason=f"overlap from the start: {few}"), left_out
    return RangeEnd("unbounded"), left_out


def _following(order: Generator[_Entry, float, None], reach: float) -> _Entry | None:
    try:
        return order.send(reach)
    except StopIteration:
        return None


def _in_order(
    candidates: Sequence[_Candidate], sign: int, start: float, reach: float
) -> Generator[_Entry, float, None]:
    """Pairs that come near each other before `reach`, with how far they are certainly apart: those that come near first
    are first, and those that touch from the start, which are slow to follow, last. It is told how `reach` shrinks."""
    touching: list[_Candidate] = []
    waiting: list[tuple[float, int, Wholes | None]] = list(_apart(candidates, sign, start, reach))
    heapq.heapify(waiting)
    while waiting and waiting[0][0] < reach:
        s, n, known = heapq.heappop(waiting)
        candidate, wholes = candidates[n], known or candidates[n].wholes()
        if s <= start and wholes.exact and wholes.touch(candidate.course(sign).displacement(start)):
            touching.append(candidate)
            continue
        s, short = candidate.advance(wholes, sign, s, reach)
        if short:
            reach = yield candidate, s
        elif s < reach:
            heapq.heappush(waiting, (s, n, wholes))
    for candidate in touching:
        if start < reach:
            reach = yield candidate, start


def _apart(candidates: Sequence[_Candidate], sign: int, start: float, end: float) -> Iterator[tuple[float, int, None]]:
    """Those that may meet before `end`, by one sphere about each part: how far they are certainly apart."""
    if not candidates or candidates[0].turns is None:
        yield from ((start, n, None) for n in range(len(candidates)))
        return
    first, second = (np.array([candidate.profiles[k].sphere for candidate in candidates]).T for k in (0, 1))
    apart = first_touch(first, second, candidates[0].turns, sign, start)
    yield from ((float(apart[n]), int(n), None) for n in np.flatnonzero(apart < end))


def _clear(profiles: Sequence[Profile]) -> float:
    """m of a slide after which nothing is left in its way."""
    spans = [profile.span for profile in profiles]
    return max(max(high for _, high in spans) - min(low for low, _ in spans), 0.0) if spans else 0.0
