"""Pairs of parts of bodies that move along given poses: over a run, or along the motion of a linkage."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.collisions.course import Course
from kinform.collisions.pairs import PairTest, Shapes
from kinform.collisions.single import preserved
from kinform.model.kinematics import Joint
from kinform.model.names import PartName

__all__ = ["HIGHER", "Nodes", "course", "moving_pairs"]

Array = NDArray[np.float64]

HIGHER = ("point", "line")
"""Patches whose place on the parts changes as they move: such pairs are not tested."""
LOWER = ("revolute", "prismatic", "cylindrical", "spherical", "planar", "screw")
"""Joints whose twists stay the same in both bodies."""
SLACK = 1.05
"""Points between two poses may travel more than their straight distance."""


@dataclass(frozen=True, eq=False)
class Nodes:
    """Poses of bodies at parameters s (T,), displacements (T, B, 4, 4) of the world at the pose of the meshes, and
    (B, 4, 4) at any s between."""

    s: Array
    displacements: Array
    between: Callable[[float], Array]


def moving_pairs(
    shapes: Shapes, names: Sequence[str], joints: Sequence[Joint], nodes: Nodes
) -> tuple[list[tuple[PairTest, int, int]], list[tuple[PartName, PartName]]]:
    """Pairs of parts of bodies (`names`, in the order of the poses) that move relative to each other and may come near,
    with their bodies; and pairs that cannot be tested, as they roll or mesh."""
    joined = {frozenset(map(str, joint.bodies)): joint for joint in joints}
    out: list[tuple[PairTest, int, int]] = []
    rolling: list[tuple[PartName, PartName]] = []
    for a, first in enumerate(names):
        for b in range(a + 1, len(names)):
            second = names[b]
            relative = np.asarray(np.linalg.solve(nodes.displacements[:, a], nodes.displacements[:, b]), float)
            if np.abs(relative - relative[0]).max() < 1e-9:
                continue
            joint = joined.get(frozenset((first, second)))
            for one, other in _parts(shapes, first, second):
                found = _test(shapes, joint, one, other, relative)
                if found is not None:
                    out.append((found, a, b))
                elif joint is not None and joint.type not in LOWER:
                    rolling.append((PartName(min(one, other)), PartName(max(one, other))))
    return out, sorted(rolling)


def _parts(shapes: Shapes, first: str, second: str) -> Iterator[tuple[str, str]]:
    for one in sorted(shapes.body_parts.get(first, ())):
        for other in sorted(shapes.body_parts.get(second, ())):
            yield one, other


def _test(shapes: Shapes, joint: Joint | None, one: str, other: str, relative: Array) -> PairTest | None:
    """The pair with the facets that count; None where none can meet, or it cannot be tested."""
    patches = [shapes.contacts.patches[k] for k in shapes.patches(one, other)] if shapes.contacts is not None else []
    twists = np.zeros((0, 6))
    if joint is not None and joint.type != "fixed":
        if joint.type not in LOWER or any(patch.kind in HIGHER for patch in patches):
            return None
        twists = _units(joint.twists)
    facets = []
    for name in (one, other):
        labels = shapes.surfaces_of(name).labels
        keep = np.ones(len(labels), dtype=bool)
        if len(twists):
            keep = ~shapes.invariant(name, twists, shapes.allowed(one, other))[labels]
        facets.append(np.flatnonzero(keep))
    if not all(map(len, facets)):
        return None
    mates = [patch for patch in patches if len(twists) and preserved(patch, twists)]
    test = PairTest(shapes, one, other, (facets[0], facets[1]), mates)
    return test if _near(test, relative) else None


def _near(test: PairTest, relative: Array) -> bool:
    """Whether the boxes of the facets come near each other at any of the poses."""
    fixed, moved = test.corners(0), test.corners(1)
    low, high = fixed.min(axis=0), fixed.max(axis=0)
    places = np.einsum("tij,nj->tni", relative[:, :3, :3], moved) + relative[:, None, :3, 3]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1, initial=0.0) if len(places) > 1 else np.zeros(0)
    margin = np.append(steps, 0.0)[:, None]
    return bool(np.any(((places.min(axis=1) - margin <= high) & (places.max(axis=1) + margin >= low)).all(axis=1)))


def _units(twists: Array) -> Array:
    turning = np.linalg.norm(twists[:, :3], axis=1)
    sliding = np.linalg.norm(twists[:, 3:], axis=1)
    return np.asarray(twists / np.where(turning > 1e-12, turning, np.maximum(sliding, 1e-300))[:, None])


def course(test: PairTest, a: int, b: int, nodes: Nodes) -> Course:
    """How the second body of a pair moves relative to the first."""
    relative = np.linalg.solve(nodes.displacements[:, a], nodes.displacements[:, b])
    places = np.einsum("tij,nj->tni", relative[:, :3, :3], test.corners(1)) + relative[:, None, :3, 3]
    way = np.concatenate([[0.0], SLACK * np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1))])

    def displacement(s: float) -> Array:
        poses = nodes.between(s)
        return np.asarray(np.linalg.solve(poses[a], poses[b]))

    return Course(displacement, lambda s: float(np.interp(s, nodes.s, way)))
