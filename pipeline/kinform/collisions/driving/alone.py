"""The range of a joint that no loop closes over: one side of the assembly moves along a screw, the other rests."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator, Sequence

import numpy as np

from kinform.collisions.driving.candidates import Approach, Candidate
from kinform.collisions.driving.overlaps import Overlap, Pair, overlap_words
from kinform.collisions.driving.swept_profiles import Profile
from kinform.collisions.driving.swept_spheres import first_touch
from kinform.collisions.parts.shapes import Shapes
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import guide, joint_twist
from kinform.model.arrays import Array
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.kinematics import Joint
from kinform.model.names import PartName

SCREW_TURNS = 20
"""Turns of a screw that are tried at once to each side. Chosen, not measured."""
SCREW_TURNS_MOST = 400
"""Turns of a screw that are tried in all, where its threads end. Chosen, not measured."""


def drive_alone(shapes: Shapes, joint: Joint, still: Sequence[str], moving: Sequence[str]) -> JointRange:
    """The range of a joint with the parts that rest and those that move (the side of its second body)."""
    twist = joint_twist(joint)
    profiles = {name: _profile(shapes, name, twist) for name in (*still, *moving)}
    candidates = _candidates(shapes, profiles, twist, still, moving)
    if joint.type == "revolute":
        below, above = -math.pi, math.pi
    else:
        below, above = guide(*shapes.design(), joint, shapes.body_parts[joint.bodies[1]])
    if joint.type == "screw":
        return _screwed(joint, candidates, below, above)
    if joint.type == "prismatic":
        reach = _clear(list(profiles.values()))
        below, above = max(below, -reach), min(above, reach)
    ends = {sign: _end(candidates, sign, abs(limit), 0.0) for sign, limit in ((-1, below), (1, above))}
    if joint.type == "revolute":
        for sign in (-1, 1):
            # a turn that stops one way stops the other way too, before the same place is reached
            other = ends[-sign][0]
            if ends[sign][0].status == "unbounded" and other.status != "unbounded":
                ends[sign] = _end(candidates, sign, 2.0 * math.pi - abs(other.value or 0.0), math.pi)
                if ends[sign][0].status == "unbounded" and other.status == "unknown":
                    ends[sign] = (other, ends[sign][1])
    left_out = {pair for _, pairs in ends.values() for pair in pairs}
    stuck = _stuck([ends[sign][0] for sign in (-1, 1)], candidates)
    if stuck:
        end = RangeEnd("unknown", reason=overlap_words(stuck, candidates[0].units))
        return JointRange(joint.name, end, end, tuple(sorted(left_out | {overlap.pair for overlap in stuck})))
    done = [_leaving(ends[sign][0], joint, limit) for sign, limit in ((-1, below), (1, above))]
    return JointRange(joint.name, done[0], done[1], tuple(sorted(left_out)))


def slide_end(shapes: Shapes, direction: Array, still: Sequence[str], moving: Sequence[str]) -> RangeEnd:
    """How far parts go along a unit direction (3,) m while the others rest, whatever guides them; unbounded where they
    get past all of these."""
    twist = np.concatenate([np.zeros(3), direction])
    profiles = {name: _profile(shapes, name, twist) for name in (*still, *moving)}
    candidates = _candidates(shapes, profiles, twist, still, moving)
    end, _ = _end(candidates, 1, _clear(list(profiles.values())), 0.0)
    stuck = _stuck([end], candidates)
    return RangeEnd("unknown", reason=overlap_words(stuck, candidates[0].units)) if stuck else end


def _stuck(ends: Sequence[RangeEnd], candidates: Sequence[Candidate]) -> list[Overlap]:
    """What overlaps as it is drawn, where that stops a joint both ways before it has moved: it is drawn too tight, by
    less than mates may overlap, and how far it would go is not known. Parts that just touch both ways overlap in
    nothing: they are stopped."""
    out = []
    for end in ends:
        candidate = next((c for c in candidates if end.status == "found" and c.part_names == end.parts), None)
        test = None if candidate is None else candidate.anywhere
        if candidate is None or test is None or end.value is None:
            return []
        if candidate.course(1).travel(abs(end.value)) > test.loose:
            return []
        depth, place = test.sunk(np.eye(4))
        if depth > 0.0:
            out.append(Overlap(candidate.part_names, depth, place))
    return out


def _screwed(joint: Joint, candidates: Sequence[Candidate], below: float, above: float) -> JointRange:
    """The range of a screw whose threads are left at `below` and `above` (rad; infinite where that is not known)."""
    left_out: set[Pair] = set()
    done = []
    for sign, limit in ((-1, abs(below)), (1, above)):
        last = min(limit, 2.0 * math.pi * (SCREW_TURNS_MOST if math.isfinite(limit) else SCREW_TURNS))
        free, end = 0.0, RangeEnd("unbounded")
        while free < last and end.status == "unbounded":
            further = min(free + 2.0 * math.pi * SCREW_TURNS, last)
            end, pairs = _end(candidates, sign, further, free)
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
) -> list[Candidate]:
    """Pairs whose parts may meet on the way, as far as the places tell that they sweep over, and spheres about them."""
    if not (still and moving):
        return []
    (low, high), (from_, to) = (
        (np.stack(sides) for sides in zip(*(profiles[name].bounds for name in names), strict=True))
        for names in (still, moving)
    )
    row, column = np.nonzero((low[:, None] <= to).all(axis=2) & (from_ <= high[:, None]).all(axis=2))
    if profiles[moving[0]].turns:
        # what turns sweeps over places that it never comes to
        first, second = (np.array([profiles[name].sphere for name in names]).T for names in (still, moving))
        meet = np.isfinite(first_touch(first[:, row], second[:, column], True, 1, 0.0))
        row, column = row[meet], column[meet]
    return [
        Candidate(shapes, (PartName(still[i]), PartName(moving[j])), (profiles[still[i]], profiles[moving[j]]), twist)
        for i, j in zip(row.tolist(), column.tolist(), strict=True)
    ]


@dataclass(frozen=True, eq=False)
class _Stop:
    """Where parts stop a joint that are seen to be too deep in each other at `deep`: not too far `beyond` the first."""

    at: float
    parts: Pair
    place: Array
    deep: float
    beyond: float


def _end(candidates: Sequence[Candidate], sign: int, limit: float, start: float) -> tuple[RangeEnd, list[Pair]]:
    """How far one side goes, up to `limit`; and the pairs of which something was left out. The pair that is known to be
    free for the shortest way goes on first: none goes much further than where another is too deep, and the end is where
    the first of those met that are so about there, whichever was asked first. Where parts that overlap as they are
    drawn go deeper before that, nothing is known of this side."""
    deep = math.inf
    overlaps: list[Overlap] = []
    deeper: list[tuple[float, Overlap]] = []
    stops: list[_Stop] = []
    left: list[Approach | None] = []
    exhausted: tuple[float, Pair] | None = None
    waiting: list[tuple[float, int, Approach | None]] = list(_apart(candidates, sign, start, limit))
    heapq.heapify(waiting)
    while waiting:
        s, n, known = heapq.heappop(waiting)
        reach = min(limit, deep + candidates[n].beyond)
        if s >= reach:
            left.append(known)
            continue
        approach = known or Approach(candidates[n], sign, s, limit)
        first = approach.advance(reach)
        if approach.s < limit:
            heapq.heappush(waiting, (approach.s, n, approach))
        if first is None:
            continue
        names = candidates[n].part_names
        if first.overlaps:
            overlaps.append(Overlap(names, first.before, first.place))
        if first.deeper < math.inf:
            deeper.append((first.deeper, overlaps[-1]))
        if first.exhausted is not None and (exhausted is None or first.exhausted < exhausted[0]):
            exhausted = (first.exhausted, names)
        if first.at is not None and first.place is not None:
            stops.append(_Stop(first.at, names, first.place, first.deep, candidates[n].beyond))
            deep = min(deep, first.deep)
    counted = [stop for stop in stops if stop.deep <= deep + stop.beyond]
    best = min(counted, key=lambda stop: stop.at, default=None)
    overlaps += [overlap for known in left if known is not None and (overlap := known.overlap) is not None]
    left_out = [overlap.pair for overlap in overlaps]
    at = limit if best is None else best.at
    into = [overlap for s, overlap in deeper if s < at]
    unknown = into if into or best is not None else overlaps
    if unknown:
        return RangeEnd("unknown", reason=overlap_words(unknown, candidates[0].units)), left_out
    if exhausted is not None and exhausted[0] < at:
        return RangeEnd(
            "unknown",
            reason=f"{' and '.join(exhausted[1])} stay too close to be followed: give them clearance",
        ), left_out
    if best is not None:
        return RangeEnd("found", sign * at + 0.0, best.parts, best.place), left_out
    return RangeEnd("unbounded"), left_out


def _apart(candidates: Sequence[Candidate], sign: int, start: float, end: float) -> Iterator[tuple[float, int, None]]:
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
