"""Collision geometry of links that overlaps in the pose of the file, where no joint joins the links.

Solids are cut with manifold3d: primitives and closed meshes as they are, other meshes as their convex hulls, as Bullet
and MuJoCo take them. Links that fixed joints join are one body. As in simulators, bodies that one joint joins are left
out; so are those between which there are only bodies without collision geometry.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.meshes.hulls import Hull, hull_of
from kinform.foundation.processes import threads_ran
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.descriptions import DescribedJoint, StartOverlap

DEEP = 0.02
"""Share of the smaller piece's size by which two pieces have to be in each other: contact margins, rounded poses and
facets of round covers stay below. Chosen, not measured."""
MOST_PAIRS = 2000
"""Pairs of pieces that are cut: a humanoid has some 300 whose boxes meet. Chosen, not measured."""
FINE = 20_000
"""Facets above which a mesh is taken as its hull: cutting would take longer than reading. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class CollisionPiece:
    """One piece of collision geometry, in the frame of the description."""

    points: Array
    """(n, 3) m."""
    faces: Ints
    """(m, 3), empty where they are not known."""
    line: int

    @property
    def box(self) -> tuple[Array, Array]:
        """Least and greatest corner (3,)."""
        return self.points.min(axis=0), self.points.max(axis=0)


def start_overlaps(
    pieces: Mapping[str, Sequence[CollisionPiece]], joints: Sequence[DescribedJoint]
) -> Iterator[StartOverlap]:
    """The deepest overlap of each two links that no joint joins, sorted by their names."""
    body, joined = _joined(pieces, joints)
    every = [(name, piece) for name in sorted(pieces) for piece in pieces[name]]
    boxes = [piece.box for _, piece in every]
    known: dict[int, tuple[Manifold, Hull, bool] | None] = {}

    def solid(k: int) -> tuple[Manifold, Hull, bool] | None:
        if k not in known:
            known[k] = _solid(every[k][1])
        return known[k]

    found: dict[tuple[str, str], StartOverlap] = {}
    asked = 0
    for i, j in combinations(range(len(every)), 2):
        first, second = every[i][0], every[j][0]
        if body[first] == body[second] or frozenset((body[first], body[second])) in joined:
            continue
        if (boxes[i][0] > boxes[j][1]).any() or (boxes[j][0] > boxes[i][1]).any():
            continue
        asked += 1
        one, other = (solid(i), solid(j)) if asked <= MOST_PAIRS else (None, None)
        if one is None or other is None:
            continue
        size = min(float(np.linalg.norm(high - low)) for low, high in (boxes[i], boxes[j]))
        depth = _depth(one[1], other[1])
        before = found.get((first, second))
        if depth <= DEEP * size or (before is not None and depth <= before.depth):
            continue
        common = one[0] ^ other[0]
        volume = float(common.volume())
        if volume <= 0.0:
            continue
        if not (_convex(*one[:2]) and _convex(*other[:2])):
            depth = min(depth, _thickness(common))
        # as thick as DEEP over an area of that size
        if depth <= DEEP * size or volume <= (DEEP * size) ** 3:
            continue
        place = np.asarray(common.to_mesh64().vert_properties)[:, :3].mean(axis=0)
        lines = (every[i][1].line, every[j][1].line)
        found[first, second] = StartOverlap((first, second), depth, volume, place, lines, not (one[2] and other[2]))
    yield from (found[pair] for pair in sorted(found))


def excluded_pairs(text: str) -> set[frozenset[str]]:
    """Pairs of bodies between which an MJCF excludes contact."""
    tags = re.findall(r"<exclude\b[^<>]{0,1000}>", text)
    names = [dict(re.findall(r"\b(body[12])\s*=\s*[\"']([^\"']*)[\"']", tag)) for tag in tags]
    return {frozenset(name.replace("/", "_") for name in pair.values()) for pair in names}


def _joined(
    pieces: Mapping[str, Sequence[CollisionPiece]], joints: Sequence[DescribedJoint]
) -> tuple[dict[str, int], set[frozenset[int]]]:
    """The rigid body of each link, and which bodies are neighbours."""
    names = sorted({*pieces, *(name for joint in joints for name in joint.between)})
    number, rigid = {name: k for k, name in enumerate(names)}, UnionFind(len(names))
    for joint in joints:
        if joint.kind == "fixed":
            rigid.union(*(number[name] for name in joint.between))
    body = {name: rigid.find(number[name]) for name in names}
    shaped = {body[name] for name in pieces if pieces[name]}
    beside: dict[int, set[int]] = {}
    for joint in joints:
        a, b = (body[name] for name in joint.between)
        if a != b:
            beside.setdefault(a, set()).add(b)
            beside.setdefault(b, set()).add(a)
    joined: set[frozenset[int]] = set()
    for start in shaped:
        seen, stack = {start}, [start]
        while stack:
            for other in sorted(beside.get(stack.pop(), ())):
                if other not in seen:
                    seen.add(other)
                    joined.add(frozenset((start, other)))
                    stack += [] if other in shaped else [other]
    return body, joined


def _solid(piece: CollisionPiece) -> tuple[Manifold, Hull, bool] | None:
    """The piece as a solid, its hull, and whether the solid is the piece itself; None where it has no volume."""
    hull = hull_of(piece.points)
    if hull is None or hull.volume <= 0.0:
        return None
    threads_ran()
    if 0 < len(piece.faces) <= FINE:
        vertices, index = np.unique(piece.points, axis=0, return_inverse=True)
        faces = index.reshape(-1)[piece.faces]
        exact = Manifold(Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(faces, dtype=np.uint64)))
        if exact.status() == Error.NoError and exact.volume() > 0.0:
            return exact, hull, True
    return Manifold.hull_points(np.ascontiguousarray(hull.corners)), hull, False


def _convex(solid: Manifold, hull: Hull) -> bool:
    # facets of coordinates in single precision miss a plane by so much
    return bool(solid.volume() >= (1.0 - SINGLE) * hull.volume)


def _thickness(common: Manifold) -> float:
    """m: least width of the largest piece of an overlap, as its hull: teeth in mesh overlap widely, and by nothing."""
    largest = max(common.decompose(), key=lambda piece: float(piece.volume()))
    hull = hull_of(np.asarray(largest.to_mesh64().vert_properties)[:, :3])
    return 0.0 if hull is None else float(np.ptp(hull.corners @ hull.planes[:, :3].T, axis=0).min())


def _depth(one: Hull, other: Hull) -> float:
    """m: how deep two hulls are in each other at most, by the normals of their faces; not positive where one parts
    them."""
    return min(
        float((-(these.planes[:, 3]) - (those.corners @ these.planes[:, :3].T).min(axis=0)).min())
        for these, those in ((one, other), (other, one))
    )
