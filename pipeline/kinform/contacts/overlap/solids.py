"""Overlap of two closed meshes by manifold3d: its pieces, and which facets of either part bound them.

Coordinates are centred on the part whose frame is that of the pair, and scaled by a power of two to the order of 1
before the boolean, because manifold3d's tolerances are relative to the size of what it is given.
"""

from __future__ import annotations

import math
from dataclasses import field
from functools import cached_property
from itertools import pairwise

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from kinform.contacts.search.pair_view import PartView
from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.graphs.components import components
from kinform.foundation.processes import threads_ran
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import ascending, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh


@dataclass(frozen=True, eq=False)
class Piece:
    """One connected piece of the overlap, in the frame of the pair."""

    volume: float
    """m³."""
    area: float
    """m², of its boundary."""
    centroid: Array
    """(3,) m."""
    corners: Array
    """(t, 3, 3) m, its facets."""
    part: Ints
    """(t,) 0 or 1: whose surface the facet is cut from."""
    facet: Ints
    """(t,) index of that facet in the part's mesh."""


@dataclass(frozen=True, eq=False)
class Overlap:
    """An overlap in its connected pieces, the facets of each in an order of their own, as it was cut: centred and
    scaled."""

    cut: Array
    """(t, 3, 3) corners of all facets, piece by piece."""
    part: Ints
    facet: Ints
    """(t,) as of `Piece`."""
    ends: list[int]
    """Where the facets of each piece begin, and where all end."""
    middle: Array
    scale: float
    """(3,) m and m: where the origin of what was cut is, and its unit."""

    @property
    def pieces(self) -> list[Piece]:
        """Its pieces in the frame of the pair, largest first."""
        every = [
            _piece(self.cut[i:j], self.part[i:j], self.facet[i:j], self.middle, self.scale)
            for i, j in pairwise(self.ends)
        ]
        return sorted(every, key=lambda piece: (-piece.volume, tuple(piece.centroid)))

    @property
    def corners(self) -> Array:
        """(t, 3, 3) m of all facets, piece by piece."""
        return np.asarray(self.cut * self.scale + self.middle)

    @cached_property
    def sizes(self) -> tuple[Array, Array]:
        """(p,) m³ and (p,) m² of the pieces, but for rounding."""
        starts = self.ends[:-1]
        origins = np.repeat(self.cut[starts, 0], np.diff(self.ends), axis=0)
        a, b, c = (self.cut[:, k] - origins for k in range(3))
        volumes = np.add.reduceat(dot(a, cross(b, c)), starts) / 6.0
        spans = cross(b - a, c - a)
        areas = 0.5 * np.add.reduceat(np.sqrt(dot(spans, spans)), starts)
        return volumes * self.scale**3, areas * self.scale**2


@dataclass(frozen=True, eq=False)
class ScaledSolid:
    """A mesh as a manifold, whose origin is at `middle` (3,) m and whose unit is `scale` m."""

    solid: Manifold
    middle: Array
    scale: float

    def of(self, other: ScaledSolid, X: Array) -> Manifold:
        """Another solid at a pose (4, 4) in the frame of this one's mesh, in this one's unit, from its origin."""
        place = np.concatenate(
            [X[:3, :3] * other.scale, (X[:3, :3] @ other.middle + X[:3, 3] - self.middle)[:, None]], axis=1
        )
        return other.solid.transform(place / self.scale)


def scaled_solid(mesh: Mesh, role: int = 0) -> ScaledSolid | None:
    """A mesh that bounds a volume as a manifold whose facets remember their number; None where manifold3d does not take
    it."""
    solid = _solid(mesh, role)
    return None if solid is None else ScaledSolid(solid, *_scaling(mesh))


def overlap_of(first: ScaledSolid, second: Manifold, least: float) -> Overlap:
    """The overlap of two solids, the second in the unit of the first and from its origin, in pieces of more than
    `least` (m³)."""
    return _overlap(first.solid ^ second, 0.5 * least / first.scale**3, first.middle, first.scale)


def _scaling(mesh: Mesh) -> tuple[Array, float]:
    """Centre (3,) and scale (a power of two) that bring a mesh to the order of 1."""
    low, high = mesh.box
    middle = 0.5 * (low + high)
    return middle, 2.0 ** math.ceil(math.log2(max(mesh.diagonal, TINY)))


@dataclass
class SolidStore:
    """Manifolds of meshes, by digest and by their role (0, 1) in a pair."""

    solids: dict[tuple[str, int], ScaledSolid | None] = field(default_factory=dict)

    def overlap(self, a: PartView, b: PartView, least: float) -> Overlap | None:
        """The overlap of two meshes that bound volumes, in pieces of more than `least` (m³); None where manifold3d does
        not take one."""
        home, guest, roles = (a, b, (0, 1)) if a.at_home else (b, a, (1, 0))
        first, second = self._solid(home.index.mesh, roles[0]), self._solid(guest.index.mesh, roles[1])
        if first is None or second is None:
            return None
        return overlap_of(first, first.of(second, guest.X_FP), least)

    def forget(self, digest: str) -> None:
        """What is known of a mesh that is asked no more."""
        for role in (0, 1):
            self.solids.pop((digest, role), None)

    def _solid(self, mesh: Mesh, role: int) -> ScaledSolid | None:
        key = (mesh.digest, role)
        try:
            return self.solids[key]
        except KeyError:
            return self.solids.setdefault(key, scaled_solid(mesh, role))


def bounds_volume(mesh: Mesh) -> bool:
    """Whether a cut can be made of it."""
    return mesh.health.watertight and mesh.health.manifold_status == "NoError"


def _solid(mesh: Mesh, role: int) -> Manifold | None:
    """The mesh as a manifold whose facets remember their number; inside-out meshes are turned."""
    threads_ran()
    middle, scale = _scaling(mesh)
    faces = mesh.faces if mesh.health.volume >= 0.0 else mesh.faces[:, ::-1]
    solid = Manifold(
        Mesh64(
            np.ascontiguousarray((mesh.vertices - middle) / scale),
            np.ascontiguousarray(faces, dtype=np.uint64),
            run_index=np.array([0, 3 * len(faces)], dtype=np.uint64),
            run_original_id=np.array([role], dtype=np.uint32),
            face_id=np.arange(len(faces), dtype=np.uint64),
        )
    )
    return solid if solid.status() == Error.NoError and not solid.is_empty() else None


def _overlap(solid: Manifold, least: float, middle: Array, scale: float) -> Overlap:
    """The connected pieces, of more than `least`, of a solid that is centred on `middle` (3,) and scaled. manifold3d's
    own `decompose` goes through all of it for each of them."""
    mesh = solid.to_mesh64()
    vertices, faces = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)
    if not len(faces):
        none = np.zeros(0, np.int64)
        return Overlap(np.zeros((0, 3, 3)), none, none, [0], middle, scale)
    owners, runs = (np.asarray(column, dtype=np.int64) for column in (mesh.run_original_id, mesh.run_index))
    part, facet = np.repeat(owners, np.diff(runs // 3)), np.asarray(mesh.face_id, dtype=np.int64)
    piece = components(faces[:, :2].ravel(), faces[:, 1:].ravel(), len(vertices))[faces[:, 0]]
    order = ascending(piece, len(faces))
    corners, part, facet = vertices[faces[order]], part[order], facet[order]
    ends = [*heads(piece[order]).nonzero()[0].tolist(), len(faces)]
    a, b, c = (corners[:, k] - corners[0, 0] for k in range(3))
    counts = np.diff(ends)
    large = np.add.reduceat(dot(a, cross(b, c)) / 6.0, ends[:-1]) > least
    rows, number = np.flatnonzero(np.repeat(large, counts)), np.repeat(np.arange(int(large.sum())), counts[large])
    # Facets in an order of their own, so that sums do not depend on how manifold3d went about it.
    rows = rows[np.lexsort((*corners[rows].reshape(-1, 9).T[::-1], number))]
    return Overlap(corners[rows], part[rows], facet[rows], [0, *np.cumsum(counts[large]).tolist()], middle, scale)


def _piece(corners: Array, part: Ints, facet: Ints, middle: Array, scale: float) -> Piece:
    """A connected piece in the frame of the pair, of its facets' corners (t, 3, 3), parts and numbers (t,)."""
    origin = corners.reshape(-1, 3).mean(axis=0)
    a, b, c = (corners[:, k] - origin for k in range(3))
    volumes = dot(a, cross(b, c)) / 6.0
    volume = float(volumes.sum())
    moment = volumes @ (a + b + c) / 4.0
    centroid = origin + (moment / volume if volume > 0.0 else 0.0)
    area = 0.5 * float(np.linalg.norm(cross(b - a, c - a), axis=1).sum())
    return Piece(volume * scale**3, area * scale**2, centroid * scale + middle, corners * scale + middle, part, facet)
