"""Pairs of parts of bodies that move along given poses: over a run, or along the motion of a linkage."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np

from kinform.collisions.pair.constants import CERTAIN
from kinform.collisions.pair.course import Course
from kinform.collisions.pair.distance_bounds import Wholes
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.meshes.box_pairs import meeting_boxes
from kinform.foundation.meshes.boxes import box_corners
from kinform.foundation.rounding import ARITHMETIC, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import preserved
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.kinematics import Joint

HIGHER_KINDS = ("point", "line")
"""Patches whose place on the parts changes as they move."""
LOWER_TYPES = ("revolute", "prismatic", "cylindrical", "spherical", "planar", "screw")
"""Joints whose twists stay the same in both bodies."""
REMEMBERED = 64
"""Displacements of a pair that are kept, as the same are asked for several times: the steps of one search."""
CHORD_SLACK = 1.05
"""Times their straight distance that points may travel between two poses: on an arc of 1 rad it is 1.04."""


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
    parts = [sorted(shapes.body_parts.get(name, ())) for name in names]
    near = _Near(shapes, parts, nodes.displacements)
    out: list[Moving] = []
    for a, first in enumerate(names):
        for b in near.after(a):
            relative = near.relative(a, b)
            if relative is None:
                continue
            joint = joined.get(frozenset((first, names[b])))
            for one, other in near.among(a, b):
                moving = _moving(shapes, joint, (one, other), (a, b), nodes, relative)
                if moving is not None:
                    out.append(moving)
    return out


class _Near:
    """Which parts of bodies may come near each other: bodies that move as one are looked at together."""

    def __init__(self, shapes: Shapes, parts: Sequence[Sequence[str]], displacements: Array) -> None:
        self._shapes, self._parts, self._displacements = shapes, parts, displacements
        numbers: dict[bytes, int] = {}
        self._motion = [
            numbers.setdefault(displacements[:, n].tobytes(), len(numbers)) for n in range(displacements.shape[1])
        ]
        self._may = self._may_meet(len(numbers))
        self._relative: dict[tuple[int, int], Array | None] = {}
        self._among: dict[tuple[int, int], dict[tuple[int, int], list[tuple[str, str]]]] = {}

    def _may_meet(self, count: int) -> Flags:
        """(M, M) which motions have bodies that may come near each other, by boxes of all parts of a motion in the
        world, over some outputs at once."""
        parts: list[list[str]] = [[] for _ in range(count)]
        for motion, names in zip(self._motion, self._parts, strict=True):
            parts[motion] += names
        lows, highs = np.full((2, count, len(self._displacements), 3), [[[[np.inf]]], [[[-np.inf]]]])
        for motion, body in {motion: body for body, motion in enumerate(self._motion)}.items():
            own = parts[motion]
            if not own:
                continue
            corners = np.concatenate([_corners(self._shapes, name) for name in own])
            box = box_corners(corners.min(axis=0), corners.max(axis=0), np.eye(4))
            places, steps = _moved(self._displacements[:, body], box)
            spare = CHORD_SLACK * np.append(steps, 0.0)[:, None] + SOLVED * self._shapes.size
            lows[motion], highs[motion] = places.min(axis=1) - spare, places.max(axis=1) + spare
        out = np.zeros((count, count), bool)
        # Times for which bodies are boxed in the world, to see which of them stay away from each other: a choice.
        for begin, end in pairwise(np.unique(np.linspace(0, lows.shape[1], 64 + 1).astype(int)).tolist()):
            boxes = lows[:, begin:end].min(axis=1), highs[:, begin:end].max(axis=1)
            met = meeting_boxes(boxes, boxes)
            if met is None:
                return np.ones((count, count), bool)
            out[met] = True
        return out

    def after(self, a: int) -> list[int]:
        """The bodies after one of which parts may come near."""
        may = self._may[self._motion[a]]
        return [b for b in range(a + 1, len(self._motion)) if may[self._motion[b]]]

    def relative(self, a: int, b: int) -> Array | None:
        """(T, 4, 4) of the second body, as the first sees it; None where they do not move relative to each other."""
        key = self._motion[a], self._motion[b]
        if key not in self._relative:
            relative = inverse(self._displacements[:, a]) @ self._displacements[:, b]
            change = np.abs(relative - relative[0]).max(axis=0)
            still = max(change[:3, :3].max(), change[:3, 3].max() / self._shapes.size) < SOLVED
            self._relative[key] = None if still else relative
        return self._relative[key]

    def among(self, a: int, b: int) -> list[tuple[str, str]]:
        """The pairs of parts of two bodies whose boxes meet on the way, and few others, in the order of their names."""
        key = self._motion[a], self._motion[b]
        relative = self.relative(a, b)
        if relative is None:
            return []
        if key not in self._among:
            self._among[key] = self._met(key, relative)
        return self._among[key].get((a, b), [])

    def _met(self, motions: tuple[int, int], relative: Array) -> dict[tuple[int, int], list[tuple[str, str]]]:
        """Those of all bodies of two motions."""
        every = [
            [(body, name) for body, own in enumerate(self._motion) if own == motion for name in self._parts[body]]
            for motion in motions
        ]
        out: dict[tuple[int, int], list[tuple[str, str]]] = {}
        if not every[0] or not every[1]:
            return out
        fixed = np.array([_corners(self._shapes, name) for _, name in every[0]])
        moved = np.array([_corners(self._shapes, name) for _, name in every[1]])
        for rows, column in _meeting(relative, fixed, moved, SOLVED * self._shapes.size):
            body, other = every[1][column]
            for row in rows.tolist():
                first, one = every[0][row]
                if first < body:
                    out.setdefault((first, body), []).append((one, other))
        return {bodies: sorted(pairs) for bodies, pairs in out.items()}


def _meeting(relative: Array, fixed: Array, moved: Array, spare: float) -> Iterator[tuple[Ints, int]]:
    """Which boxes of corners (n, 8, 3) those of each of (m, 8, 3) that move by (T, 4, 4) meet, as `_steps` tells it,
    and those that they miss by no more than `spare` (m)."""
    low, high = fixed.min(axis=1) - spare, fixed.max(axis=1) + spare
    for column, corners in enumerate(moved):
        places, steps = _moved(relative, corners)
        margin = np.append(steps, 0.0)[:, None]
        lowest, highest = places.min(axis=1) - margin, places.max(axis=1) + margin
        rows = np.flatnonzero((lowest.min(axis=0) <= high).all(axis=1) & (highest.max(axis=0) >= low).all(axis=1))
        if not len(rows):
            continue
        meets = np.ones((len(relative), len(rows)), dtype=bool)
        for axis in range(3):
            meets &= lowest[:, axis, None] <= high[rows, axis]
            meets &= highest[:, axis, None] >= low[rows, axis]
        yield rows[meets.any(axis=0)], column


def _moving(
    shapes: Shapes, joint: Joint | None, names: tuple[str, str], bodies: tuple[int, int], nodes: Nodes, relative: Array
) -> Moving | None:
    """Two parts of two bodies that move by `relative` (T, 4, 4); None where they stay away from each other."""
    fixed, moved = (_corners(shapes, name) for name in names)
    places, steps = _moved(relative, moved)
    near = np.flatnonzero(~_apart(places, steps, fixed))
    if not len(near):
        return None
    # as wholes they are asked only from where to where their boxes are not apart
    course = _course(bodies, nodes, steps)
    begin, end = (float(s) for s in nodes.s[[near[0], near[-1] + 1]])
    free = Wholes(shapes, *names).clear_until(course, begin, end)
    if free >= end:
        return None
    test, rolls = _test(shapes, joint, *names)
    if test.empty:
        return None
    counted = _steps(
        relative, *(_corners(shapes, name, facets) for name, facets in zip(names, test.facets, strict=True))
    )
    return None if counted is None else Moving(test, *bodies, _course(bodies, nodes, counted), free, rolls)


def _steps(relative: Array, fixed: Array, moved: Array) -> Array | None:
    """(T-1,) m that the corners (8, 3) of a box move between displacements (T, 4, 4); None where it stays out of
    another."""
    places, steps = _moved(relative, moved)
    low, high, margin = fixed.min(axis=0), fixed.max(axis=0), np.append(steps, 0.0)[:, None]
    near = (places.min(axis=1) - margin <= high) & (places.max(axis=1) + margin >= low)
    return np.asarray(steps) if near.all(axis=1).any() else None


def _apart(places: Array, steps: Array, fixed: Array) -> Flags:
    """(T-1,) whether a box stays out of another, of corners (8, 3), from each of the places (T, 8, 3) of its corners to
    the next, between which they move by `steps` (m): by how far the boxes are apart at both."""
    low, high = fixed.min(axis=0), fixed.max(axis=0)
    beyond = np.maximum(np.maximum(places.min(axis=1) - high, low - places.max(axis=1)), 0.0)
    apart = CERTAIN * np.sqrt((beyond * beyond).sum(axis=1))
    return np.asarray(apart[:-1] + apart[1:] > CHORD_SLACK * steps)


def _moved(relative: Array, corners: Array) -> tuple[Array, Array]:
    """Where displacements (T, 4, 4) take corners (n, 3), (T, n, 3), and how far the corners move between them at most,
    (T-1,)."""
    places = np.einsum("tij,nj->tni", relative[:, :3, :3], corners) + relative[:, None, :3, 3]
    return places, np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1)


def _corners(shapes: Shapes, name: str, facets: Ints | None = None) -> Array:
    """(8, 3) corners of the box of a part, or of some of its facets, in the world."""
    mesh, X = shapes.mesh(name), shapes.part(name).X_WP
    points = mesh.vertices if facets is None else mesh.vertices[np.unique(mesh.faces[facets])]
    return box_corners(points.min(axis=0), points.max(axis=0), X)


def _test(shapes: Shapes, joint: Joint | None, one: str, other: str) -> tuple[PairTest, bool]:
    """The pair with the facets that count, and whether they roll or mesh."""
    patches = shapes.patches(one, other)
    twists, rolls = np.zeros((0, 6)), False
    if joint is not None and joint.type != "fixed":
        rolls = joint.type not in LOWER_TYPES or any(patch.kind in HIGHER_KINDS for patch in patches)
        if joint.type in LOWER_TYPES:
            twists = _units(joint.twists)
    mates = [patch for patch in patches if len(twists) and preserved(patch, twists)]
    return PairTest(shapes, one, other, shapes.moved_facets(one, other, twists), mates), rolls


def _units(twists: Array) -> Array:
    """Twists (k, 6) of unit turn, or of unit slide where they do not turn."""
    turning = np.linalg.norm(twists[:, :3], axis=1)
    sliding = np.linalg.norm(twists[:, 3:], axis=1)
    return np.asarray(twists / np.where(turning > ARITHMETIC, turning, np.maximum(sliding, TINY))[:, None])


def _course(bodies: tuple[int, int], nodes: Nodes, steps: Array) -> Course:
    """How the second body of a pair moves relative to the first; no point of it further between poses than `steps`
    (m)."""
    way = [0.0, *(CHORD_SLACK * np.cumsum(steps)).tolist()]
    nodes_s = nodes.s.tolist()
    first, second = bodies

    @lru_cache(maxsize=REMEMBERED)
    def displacement(s: float) -> Array:
        poses = nodes.between(s)
        out, turned = np.eye(4), poses[first][:3, :3].T
        out[:3, :3] = turned @ poses[second][:3, :3]
        out[:3, 3] = turned @ (poses[second][:3, 3] - poses[first][:3, 3])
        return out

    def travel(s: float) -> float:
        n = min(max(bisect_right(nodes_s, s) - 1, 0), len(nodes_s) - 2)
        share = (s - nodes_s[n]) / (nodes_s[n + 1] - nodes_s[n])
        return float(way[n] + min(max(share, 0.0), 1.0) * (way[n + 1] - way[n]))

    return Course(displacement, travel, nodes.s, way)
