"""The range of a joint that no loop closes over: one side of the assembly moves along a screw, the other rests."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.collisions.pairs import PRESERVED, PairTest, Shapes
from kinform.collisions.scan import Course, first_crossing
from kinform.collisions.sweeps import largest_radius, meeting
from kinform.kinematics.displacements import displacement
from kinform.kinematics.screws import cross
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint
from kinform.model.names import PartName

__all__ = ["drive_alone", "guide", "joint_twist", "preserved"]

Array = NDArray[np.float64]
Pair = tuple[PartName, PartName]

ANGLE = math.radians(2e-4)
"""rad: to which a stop of a turn is found."""
LENGTH = 1e-5
"""To which a stop of a slide is found, relative to the size of the smaller part."""
TURNS = 20
"""Turns of a screw that are tried to each side."""


def preserved(patch: Patch, twists: Array) -> bool:
    """Whether the relative motions `twists` (k, 6) leave the two sides of a patch in contact."""
    for twist in twists:
        velocity = twist[3:] + cross(np.broadcast_to(twist[:3], patch.points.shape), patch.points)
        fastest = float(np.linalg.norm(velocity, axis=1).max(initial=0.0))
        if np.any(np.abs(np.einsum("ij,ij->i", velocity, patch.normals)) > PRESERVED * fastest):
            return False
    return True


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A pair of parts that the motion could bring together, the second part being the one that moves."""

    test: PairTest
    speed: float
    """m per unit of s that a point where they meet could travel."""


def drive_alone(shapes: Shapes, joint: Joint, still: Sequence[str], moving: Sequence[str]) -> JointRange:
    """The range of a joint with the parts that rest and those that move (the side of its second body)."""
    twist = joint_twist(joint)
    candidates = list(_candidates(shapes, twist, still, moving))
    below, above = guide(shapes, joint, twist)
    if joint.type == "revolute":
        below, above = -math.pi, math.pi
    elif joint.type == "screw":
        most = 2.0 * math.pi * TURNS
        below, above = max(below, -most), min(above, most)
    else:
        reach = _clear(shapes, twist, still, moving)
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


def joint_twist(joint: Joint) -> Array:
    """(6,) twist of a joint's value: |ω| 1 for turns, |v| 1 for slides, in the sense of its axis."""
    axis, point = joint.axis, joint.point
    assert axis is not None
    if joint.type == "prismatic":
        return np.concatenate([np.zeros(3), axis])
    assert point is not None
    pitch = joint.pitch or 0.0
    return np.concatenate([axis, cross(point, axis) + pitch / (2.0 * math.pi) * axis])


def _leaving(end: RangeEnd, joint: Joint, limit: float) -> RangeEnd:
    if end.status != "unbounded" or joint.type == "revolute":
        return end
    return RangeEnd("unbounded", reason="leaves its guide", leaves=limit)


def _candidates(shapes: Shapes, twist: Array, still: Sequence[str], moving: Sequence[str]) -> Iterator[_Candidate]:
    twists = twist[None]
    for first in still:
        for second in moving:
            allowed = shapes.allowed(first, second)
            kept, triangles = [], []
            for name in (first, second):
                slides = shapes.invariant(name, twists, allowed)
                mesh, surfaces, X = shapes.mesh(name), shapes.surfaces_of(name), shapes.part(name).X_WP
                own = np.flatnonzero(~slides[surfaces.labels])
                kept.append(own)
                triangles.append((mesh.vertices @ X[:3, :3].T + X[:3, 3])[mesh.faces[own]])
            if not all(map(len, kept)):
                continue
            margin = 1e-6 * min(shapes.mesh(first).diagonal, shapes.mesh(second).diagonal)
            near = meeting(triangles[0], triangles[1], twist, margin)
            facets = (kept[0][near[0]], kept[1][near[1]])
            if not (len(facets[0]) and len(facets[1])):
                continue
            patches = [shapes.contacts.patches[k] for k in shapes.patches(first, second)] if shapes.contacts else []
            test = PairTest(shapes, first, second, facets, [p for p in patches if preserved(p, twists)])
            radius = min(largest_radius(t[n], twist) for t, n in zip(triangles, near, strict=True))
            turning = float(twist[:3] @ twist[:3]) > 0.25
            along = float(abs(twist[:3] @ twist[3:])) if turning else 1.0
            yield _Candidate(test, math.hypot(radius, along) if turning else 1.0)


def _end(
    candidates: Sequence[_Candidate], twist: Array, sign: int, limit: float, start: float
) -> tuple[RangeEnd, list[Pair]]:
    """How far one side goes, up to `limit`; and the pairs of which something was left out."""
    best: tuple[float, PairTest, Array] | None = None
    reach, left_out, exhausted = limit, [], None
    turning = float(twist[:3] @ twist[:3]) > 0.25
    for candidate in candidates:
        course = Course(lambda s: displacement(sign * s * twist), lambda s, speed=candidate.speed: speed * s)  # type: ignore[misc]
        fine = ANGLE if turning else LENGTH * candidate.test.size
        if reach <= start:
            break
        found = first_crossing(candidate.test, course, reach, fine, start=start)
        if found.overlaps:
            left_out.append(candidate.test.part_names)
        if found.exhausted is not None:
            exhausted = candidate.test.part_names
        if found.at is not None and found.place is not None:
            reach, best = found.at, (found.at, candidate.test, found.place)
    if exhausted is not None:
        return RangeEnd("unknown", reason=f"{' and '.join(exhausted)} stay too close to be followed"), left_out
    if best is not None:
        return RangeEnd("found", sign * best[0], best[1].part_names, best[2]), left_out
    if left_out:
        few = ", ".join(" and ".join(pair) for pair in sorted(left_out)[:3])
        return RangeEnd("unknown", reason=f"overlap from the start: {few}"), left_out
    return RangeEnd("unbounded"), left_out


def guide(shapes: Shapes, joint: Joint, twist: Array) -> tuple[float, float]:
    """Values (rad or m) at which the last of the patches along which a joint slides is left; ±inf without patches."""
    if shapes.contacts is None or joint.axis is None:
        return -math.inf, math.inf
    rate = 1.0 if joint.type == "prismatic" else (joint.pitch or 0.0) / (2.0 * math.pi)
    ends = []
    for k in joint.patches:
        patch = shapes.contacts.patches[k]
        if not preserved(patch, twist[None]):
            continue
        spans = [_span(shapes, name, n, joint.axis) for name, n in zip(patch.parts, patch.surfaces, strict=True)]
        if patch.parts[1] not in shapes.body_parts[joint.bodies[1]]:
            spans.reverse()
        (a0, a1), (b0, b1) = spans
        ends.append((a0 - b1, a1 - b0))
    if not ends or rate == 0.0:
        return -math.inf, math.inf
    low, high = min(e[0] for e in ends), max(e[1] for e in ends)
    pair = (low / rate, high / rate)
    return min(pair), max(pair)


def _span(shapes: Shapes, name: str, surface: int, axis: Array) -> tuple[float, float]:
    """Lowest and highest place (m) along `axis` of a surface of a part."""
    mesh, X = shapes.mesh(name), shapes.part(name).X_WP
    corners = mesh.vertices[np.unique(mesh.faces[shapes.surfaces_of(name).labels == surface])]
    heights = (corners @ X[:3, :3].T + X[:3, 3]) @ axis
    return float(heights.min()), float(heights.max())


def _clear(shapes: Shapes, twist: Array, still: Sequence[str], moving: Sequence[str]) -> float:
    """m of a slide after which nothing is left in its way."""
    low, high = np.inf, -np.inf
    for name in (*still, *moving):
        mesh, X = shapes.mesh(name), shapes.part(name).X_WP
        heights = (mesh.vertices @ X[:3, :3].T + X[:3, 3]) @ twist[3:]
        low, high = min(low, float(heights.min())), max(high, float(heights.max()))
    return max(high - low, 0.0)
