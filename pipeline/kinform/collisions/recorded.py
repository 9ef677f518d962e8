"""Pairs of parts of bodies that move along given poses: over a run, or along the motion of a linkage."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinform.collisions.coarse import Wholes
from kinform.collisions.course import Course
from kinform.collisions.pairs import PairTest
from kinform.collisions.shapes import Shapes
from kinform.collisions.single import preserved
from kinform.foundation.algebra.displacements import inverse
from kinform.model.arrays import Array, Ints
from kinform.model.kinematics import Joint

__all__ = ["HIGHER", "Moving", "Nodes", "moving_pairs"]


HIGHER = ("point", "line")
"""Patches whose place on the parts changes as they move."""
LOWER = ("revolute", "prismatic", "cylindrical", "spherical", "planar", "screw")
"""Joints whose twists stay the same in both bodies."""
STILL = 1e-9
"""rad, and share of the assembly's size, that bodies at rest to each other move by rounding."""
REMEMBERED = 64
"""Displacements of a pair that are kept: the same are asked for several times."""
SLACK = 1.05
"""Points between two poses may travel more than their straight distance."""


@dataclass(frozen=True, eq=False)
class Nodes:
    """Poses of bodies at parameters s (T,), displacements (T, B, 4, 4) of the world at the pose of the meshes, and
    (B, 4, 4) at any s between."""

    s: Array
    displacements: Array
    between: Callable[[float], Array]


@dataclass(frozen=True, eq=False)
class Moving:
    """Two parts of bodies `first` and `second` (places in the order of the poses) that a motion may bring together."""

    test: PairTest
    first: int
    second: int
    course: Course
    free: float
    """Up to where they are certainly apart."""
    rolls: bool
    """Whether the place on the parts where they touch changes as they move: rollers, cams, teeth."""


def moving_pairs(shapes: Shapes, names: Sequence[str], joints: Sequence[Joint], nodes: Nodes) -> list[Moving]:
    """Pairs of parts of bodies (`names`, in the order of the poses) that move relative to each other and come near."""
    joined = {frozenset(map(str, joint.bodies)): joint for joint in joints}
    out: list[Moving] = []
    for a, first in enumerate(names):
        for b in range(a + 1, len(names)):
            second = names[b]
            relative = inverse(nodes.displacements[:, a]) @ nodes.displacements[:, b]
            change = np.abs(relative - relative[0]).max(axis=0)
            if max(change[:3, :3].max(), change[:3, 3].max() / shapes.size) < STILL:
                continue
            joint = joined.get(frozenset((first, second)))
            for one, other in _parts(shapes, first, second):
                moving = _moving(shapes, joint, (one, other), (a, b), nodes, relative)
                if moving is not None:
                    out.append(moving)
    return out


def _moving(
    shapes: Shapes, joint: Joint | None, names: tuple[str, str], bodies: tuple[int, int], nodes: Nodes, relative: Array
) -> Moving | None:
    steps = _steps(relative, *(_corners(shapes, name) for name in names))
    if steps is None:
        return None
    course = _course(bodies, nodes, steps)
    free = Wholes(shapes, *names).clear_until(course, float(nodes.s[0]), float(nodes.s[-1]))
    if free >= nodes.s[-1]:
        return None
    test, rolls = _test(shapes, joint, *names)
    if test.empty:
        return None
    steps = _steps(relative, *(_corners(shapes, name, own) for name, own in zip(names, test.facets, strict=True)))
    return None if steps is None else Moving(test, *bodies, _course(bodies, nodes, steps), free, rolls)


def _steps(relative: Array, fixed: Array, moved: Array) -> Array | None:
    """(T-1,) m that the corners (8, 3) of a box move between displacements (T, 4, 4); None where it stays out of another."""
    places = np.einsum("tij,nj->tni", relative[:, :3, :3], moved) + relative[:, None, :3, 3]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1)
    low, high, margin = fixed.min(axis=0), fixed.max(axis=0), np.append(steps, 0.0)[:, None]
    near = (places.min(axis=1) - margin <= high) & (places.max(axis=1) + margin >= low)
    return np.asarray(steps) if near.all(axis=1).any() else None


def _corners(shapes: Shapes, name: str, facets: Ints | None = None) -> Array:
    """(8, 3) corners of the box of a part, or of some of its facets, in the world."""
    mesh, X = shapes.mesh(name), shapes.part(name).X_WP
    points = mesh.vertices if facets is None else mesh.vertices[np.unique(mesh.faces[facets])]
    bits = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
    corners = np.where(bits, points.max(axis=0), points.min(axis=0))
    return np.asarray(corners @ X[:3, :3].T + X[:3, 3])


def _parts(shapes: Shapes, first: str, second: str) -> Iterator[tuple[str, str]]:
    for one in sorted(shapes.body_parts.get(first, ())):
        for other in sorted(shapes.body_parts.get(second, ())):
            yield one, other


def _test(shapes: Shapes, joint: Joint | None, one: str, other: str) -> tuple[PairTest, bool]:
    """The pair with the facets that count, and whether they roll or mesh."""
    patches = [shapes.contacts.patches[k] for k in shapes.patches(one, other)] if shapes.contacts is not None else []
    twists, rolls = np.zeros((0, 6)), False
    if joint is not None and joint.type != "fixed":
        rolls = joint.type not in LOWER or any(patch.kind in HIGHER for patch in patches)
        if joint.type in LOWER:
            twists = _units(joint.twists)
    facets = []
    for name in (one, other):
        labels = shapes.surfaces_of(name).labels
        keep = np.ones(len(labels), dtype=bool)
        if len(twists):
            keep = ~shapes.invariant(name, twists, shapes.allowed(one, other))[labels]
        facets.append(np.flatnonzero(keep))
    mates = [patch for patch in patches if len(twists) and preserved(patch, twists)]
    return PairTest(shapes, one, other, (facets[0], facets[1]), mates), rolls


def _units(twists: Array) -> Array:
    turning = np.linalg.norm(twists[:, :3], axis=1)
    sliding = np.linalg.norm(twists[:, 3:], axis=1)
    return np.asarray(twists / np.where(turning > 1e-12, turning, np.maximum(sliding, 1e-300))[:, None])


def _course(bodies: tuple[int, int], nodes: Nodes, steps: Array) -> Course:
    """How the second body of a pair moves relative to the first; no point of it further between poses than `steps` (m)."""
    way = [0.0, *(SLACK * np.cumsum(steps)).tolist()]
    known = nodes.s.tolist()
    first, second = bodies

    @lru_cache(maxsize=REMEMBERED)
    def displacement(s: float) -> Array:
        poses = nodes.between(s)
        out, turned = np.eye(4), poses[first][:3, :3].T
        out[:3, :3] = turned @ poses[second][:3, :3]
        out[:3, 3] = turned @ (poses[second][:3, 3] - poses[first][:3, 3])
        return out

    def travel(s: float) -> float:
        n = min(max(bisect_right(known, s) - 1, 0), len(known) - 2)
        share = (s - known[n]) / (known[n + 1] - known[n])
        return float(way[n] + min(max(share, 0.0), 1.0) * (way[n + 1] - way[n]))

    return Course(displacement, travel, nodes.s)
