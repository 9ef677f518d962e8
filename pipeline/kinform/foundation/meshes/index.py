"""Bounding volume hierarchies of meshes, one for each distinct mesh, and sliver probes against them.

A contact list of FCL between two meshes is not usable as a patch: it misses facets that touch exactly
and facets that penetrate in parallel. A thin triangle that stands across the surface does hit, whatever
the gap, so every question here is put as one BVH of such slivers against the BVH of a mesh. Slivers are
given in the mesh's own frame: the BVH never has to be built again for another pose.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import fcl
import numpy as np

from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.boxes import FacetBoxes, FlatBoxes, facet_boxes
from kinform.foundation.meshes.surface_table import SurfaceTable
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

__all__ = [
    "Hits",
    "MeshIndex",
    "MeshStore",
    "Region",
    "cross",
    "fcl_distance",
    "fcl_model",
    "fcl_pose",
    "inner_weights",
    "partial_model",
]


_UNIT = 2.0**20
"""What a metre is to FCL. The distance that it finds between triangles is 0 where their edges are shorter than about
2e-4 of what it counts in: it is given about micrometres, by a power of two, which rounds nothing."""
_WIDTH = 1e-3
"""Width of a sliver relative to its length: zero width misses most facets."""
_BALL, _PARTS = 0.012, 6
"""Share of a mesh's diagonal that balls about its facets are as small as, and divisions of a facet's side for it at most."""
_RAYS = np.array([[0.577, 0.523, 0.627], [-0.67, 0.31, 0.675], [0.21, -0.83, 0.517]])
"""Directions along which no designer lays an edge."""


def cross(a: Array, b: Array) -> Array:
    """Cross products of rows (n, 3); numpy's own spends most of its time on moving axes about."""
    out = np.empty_like(a)
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out


@dataclass(frozen=True, eq=False)
class Hits:
    """Facets that probes hit, ordered by probe, then by facet."""

    probe: Ints
    """(h,) index of the probe."""
    facet: Ints
    """(h,) index of the facet."""
    along: Array
    """(h,) m: where the probe's line meets the plane of the facet, from the probe's point."""
    facing: Array
    """(h,) cosine between the probe's direction and the facet's outward normal."""


def fcl_model(vertices: Array, faces: Ints) -> fcl.BVHModel:
    """FCL's model of triangles: vertices (V, 3) m and faces (F, 3). To be placed and measured by the two below."""
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(np.ascontiguousarray(_UNIT * vertices), np.ascontiguousarray(faces))
    model.endModel()
    return model


def fcl_pose(X: Array) -> fcl.Transform:
    """FCL's form of a pose (4, 4) of such a model."""
    return fcl.Transform(X[:3, :3], _UNIT * X[:3, 3])


def fcl_distance(
    first: fcl.CollisionObject, second: fcl.CollisionObject, result: fcl.DistanceResult | None = None
) -> float:
    """m between two such models, 0 where they touch or cross."""
    found = fcl.distance(first, second, fcl.DistanceRequest(), fcl.DistanceResult() if result is None else result)
    return max(float(found), 0.0) / _UNIT


def partial_model(vertices: Array, faces: Ints) -> fcl.BVHModel:
    """FCL's model of some facets, with the vertices that they use."""
    used, corners = np.unique(faces, return_inverse=True)
    return fcl_model(vertices[used], corners.reshape(-1, 3))


class MeshIndex:
    """One mesh with what is asked of its facets; its BVH and their boxes are made when first asked for."""

    def __init__(self, mesh: Mesh):
        self.mesh = mesh
        self._bvh: fcl.BVHModel | None = None
        self._borders: Ints | None = None
        self._shells: Ints | None = None
        self._boxes: FacetBoxes | None = None
        self._rays: list[_Ray] | None = None
        self._near: list[tuple[cKDTree, float]] | None = None
        self._table: SurfaceTable | None = None
        self.low: Array = mesh.vertices.min(axis=0)
        self.high: Array = mesh.vertices.max(axis=0)
        """(3,) m, box in the part frame."""

    def spans(self, facets: Ints) -> Array:
        """(n, 3) cross products of two edges of each facet: outward, of twice its area (m²)."""
        corners = self.mesh.vertices[self.mesh.faces[facets]]
        return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    def areas(self, facets: Ints) -> Array:
        """(n,) m²."""
        spans = self.spans(facets)
        return np.asarray(0.5 * np.sqrt(np.einsum("ij,ij->i", spans, spans)))

    def normals(self, facets: Ints) -> Array:
        """(n, 3) unit, outward, part frame; zero for facets without area."""
        spans = self.spans(facets)
        length = np.sqrt(np.einsum("ij,ij->i", spans, spans))
        return np.asarray(spans / np.where(length > 0.0, length, 1.0)[:, None])

    @property
    def boxes(self) -> FacetBoxes:
        """Boxes of the facets in the part frame."""
        if self._boxes is None:
            vertices, faces = self.mesh.vertices, self.mesh.faces
            self._boxes = FacetBoxes(
                *facet_boxes((vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]))
            )
        return self._boxes

    def table(self, surfaces: MeshSurfaces) -> SurfaceTable:
        """The mesh's surfaces as arrays."""
        if self._table is None:
            self._table = SurfaceTable.of(surfaces, self.rims(surfaces))
        return self._table

    @property
    def bvh(self) -> fcl.BVHModel:
        """FCL's model of the mesh in the part frame (m)."""
        if self._bvh is None:
            self._bvh = fcl_model(self.mesh.vertices, self.mesh.faces)
        return self._bvh

    def region(self, facets: Ints) -> Region:
        """These facets (ascending) as something to cast probes against; all of them where they are most."""
        if 2 * len(facets) >= len(self.mesh.faces):
            return self.whole()
        model = partial_model(self.mesh.vertices, self.mesh.faces[facets]) if len(facets) else None
        return Region(self, model, facets)

    def whole(self) -> Region:
        """All facets."""
        return Region(self, self.bvh, None)

    def borders(self, surfaces: MeshSurfaces) -> Ints:
        """(k, 2) pairs of surfaces that share an edge, both ways round, sorted."""
        if self._borders is None:
            faces, count = self.mesh.faces, np.int64(len(self.mesh.vertices))
            first, second = faces.T.ravel(), np.roll(faces, -1, axis=1).T.ravel()
            key = np.minimum(first, second) * count + np.maximum(first, second)
            order = np.argsort(key, kind="stable")
            key, labels = key[order], np.tile(surfaces.labels, 3)[order]
            shared = (key[1:] == key[:-1]) & (labels[1:] != labels[:-1])
            pairs = np.unique(labels[:-1][shared] * np.int64(len(surfaces.surfaces)) + labels[1:][shared])
            pairs = np.stack(np.divmod(pairs, max(len(surfaces.surfaces), 1)), axis=1)
            self._borders = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
        return self._borders

    def neighbours(self, surfaces: MeshSurfaces, surface: int) -> list[int]:
        """Surfaces that share an edge with this one, ascending."""
        borders = self.borders(surfaces)
        first, last = np.searchsorted(borders[:, 0], [surface, surface + 1])
        return [int(k) for k in borders[first:last, 1]]

    @property
    def shells(self) -> Ints:
        """The lowest facet of each connected shell of the mesh."""
        if self._shells is None:
            faces, count = self.mesh.faces, len(self.mesh.vertices)
            edges = np.concatenate([faces[:, :2], faces[:, 1:]])
            shell = components(edges[:, 0], edges[:, 1], count)
            self._shells = np.unique(shell[faces[:, 0]], return_index=True)[1]
        return self._shells

    def rims(self, surfaces: MeshSurfaces) -> Array:
        """For each surface, the greatest chord error of the surfaces that share an edge with it (m).

        By so much the outline of a plane face may be off the curve that it stands for.
        """
        chords = np.array([surface.chord for surface in surfaces.surfaces])
        rims = np.zeros(len(chords))
        own, other = self.borders(surfaces).T
        np.maximum.at(rims, own, chords[other])
        return rims

    def away(self, points: Array) -> Array:
        """(n,) m that points (n, 3) of the part frame keep from the mesh at least: less than their distance, and quickly."""
        if self._near is None:
            self._near = _balls(self.mesh)
        out = np.full(len(points), np.inf)
        for tree, radius in self._near:
            out = np.minimum(out, tree.query(points)[0] - radius)
        return np.asarray(np.maximum(out, 0.0))

    def contains(self, points: Array) -> Flags:
        """(n,) whether points (n, 3) of the part frame lie inside: the median of three rays' crossings.

        Open and inside-out meshes have an inside as far as two of three rays agree on it.
        """
        out = np.asarray(((points >= self.low) & (points <= self.high)).all(axis=1))
        if not out.any():
            return out
        if self._rays is None:
            self._rays = [_Ray(self.mesh, ray) for ray in _RAYS]
        some = points[out]
        count = self._rays[0].crossings(some)
        # of a closed mesh, one ray that leaves through as many facets as it enters through says enough
        asked = np.flatnonzero(count) if self.mesh.health.watertight else np.arange(len(some))
        if len(asked):
            second = self._rays[1].crossings(some[asked])
            # two rays that agree are the median whatever the third says
            doubtful = count[asked] != second
            if doubtful.any():
                third = self._rays[2].crossings(some[asked[doubtful]])
                count[asked[doubtful]] = np.median([count[asked[doubtful]], second[doubtful], third], axis=0)
        out[out] = np.abs(count) > 0.5
        return out


def _balls(mesh: Mesh) -> list[tuple[cKDTree, float]]:
    """Middles of balls that hold all facets, with their radius (m), by octaves of it."""
    from scipy.spatial import cKDTree

    corners = mesh.vertices[mesh.faces]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.clip(np.ceil(longest / max(_BALL * mesh.diagonal, 1e-300)), 1, _PARTS).astype(np.int64)
    middles, radii = [], []
    for number in np.unique(parts).tolist():
        some = parts == number
        middles.append((inner_weights(number) @ corners[some]).reshape(-1, 3))
        radii.append(np.repeat(2.0 / 3.0 * longest[some] / number, number * number))
    points, radius = np.concatenate(middles), np.concatenate(radii)
    size = max(mesh.diagonal, 1e-300)
    level = np.ceil(np.log2(np.maximum(radius / size, _BALL)))
    out = []
    for k in np.unique(level):
        # one for all that are in one cell of a grid
        largest, cell = float(radius[level == k].max()), 0.5 * float(2.0**k) * size
        place = np.round((points[level == k] - mesh.vertices.min(axis=0)) / cell).astype(np.int64)
        _, kept = np.unique((place[:, 0] << 40) + (place[:, 1] << 20) + place[:, 2], return_index=True)
        centres = mesh.vertices.min(axis=0) + cell * place[kept]
        out.append((cKDTree(centres), largest + 0.5 * float(np.sqrt(3.0)) * cell))
    return out


def inner_weights(number: int) -> Array:
    """(number², 3) weights of a triangle's corners for the middles of those that it is divided into, `number` a side."""
    up = [(3 * a + 1, 3 * b + 1) for a in range(number) for b in range(number - a)]
    down = [(3 * a + 2, 3 * b + 2) for a in range(number - 1) for b in range(number - 1 - a)]
    two = np.array(up + down, dtype=float) / (3.0 * number)
    return np.column_stack([two, 1.0 - two.sum(axis=1)])


class _Ray:
    """A mesh as seen along one direction."""

    def __init__(self, mesh: Mesh, ray: Array):
        ray = ray / np.linalg.norm(ray)
        u = np.cross(ray, np.eye(3)[np.argmin(np.abs(ray))])
        u /= np.linalg.norm(u)
        self._frame = np.stack([u, np.cross(ray, u), ray])
        self._vertices = mesh.vertices @ self._frame.T
        self._faces = mesh.faces
        flat = self._vertices[:, :2]
        self._boxes = FlatBoxes(*facet_boxes((flat[mesh.faces[:, 0]], flat[mesh.faces[:, 1]], flat[mesh.faces[:, 2]])))

    def crossings(self, points: Array) -> Array:
        """(n,) facets that the ray from each point (n, 3) leaves through, less those that it enters through."""
        seen = points @ self._frame.T
        which, facets = self._boxes.around(seen[:, :2])
        corners = self._vertices[self._faces[facets]] - seen[which, None]
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (corners[:, i].T for i in range(3))
        a, b, c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
        total = a + b + c
        inside = ((a > 0) & (b > 0) & (c > 0)) | ((a < 0) & (b < 0) & (c < 0))
        height = (a * az + b * bz + c * cz) / np.where(total != 0, total, 1.0)
        leaving = np.where(inside & (height > 0), np.sign(total), 0.0)
        return np.asarray(np.bincount(which, leaving, minlength=len(points)), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Region:
    """Facets of a mesh that probes are cast against."""

    index: MeshIndex
    bvh: fcl.BVHModel | None
    facets: Ints | None
    """Facets of the BVH in the mesh; None: all of them in order."""

    def cast(self, points: Array, directions: Array, reach: Array, width: float = _WIDTH) -> Hits:
        """Facets within `reach` (n,) m of `points` (n, 3) along ±`directions` (n, 3), part frame.

        `width` of the slivers, relative to their reach.
        """
        count, mesh = len(points), self.index.mesh
        empty = np.zeros(0)
        if count == 0 or self.bvh is None:
            return Hits(empty.astype(np.int64), empty.astype(np.int64), empty, empty)
        least = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
        across = cross(directions, least)
        across *= (width * reach / np.linalg.norm(across, axis=1))[:, None]
        tip = points + reach[:, None] * directions
        slivers = np.stack([points - reach[:, None] * directions, tip + across, tip - across], axis=1)
        probe_model = fcl_model(slivers.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
        # Contact points stay off: they cost, come several to a facet, and depend on FCL's own tolerance.
        request = fcl.CollisionRequest(num_max_contacts=256 * count + 4096, enable_contact=False)
        result = fcl.CollisionResult()
        fcl.collide(fcl.CollisionObject(self.bvh), fcl.CollisionObject(probe_model), request, result)
        pairs = np.array([(c.b2, c.b1) for c in result.contacts], dtype=np.int64).reshape(-1, 2)
        pairs = np.unique(pairs, axis=0)
        probe, facet = pairs[:, 0], pairs[:, 1]
        if self.facets is not None:
            facet = self.facets[facet]
        normal = self.index.normals(facet)
        facing = np.einsum("ij,ij->i", normal, directions[probe])
        height = np.einsum("ij,ij->i", normal, mesh.vertices[mesh.faces[facet, 0]] - points[probe])
        steep = np.abs(facing) > 1e-3
        along = np.where(steep, height / np.where(steep, facing, 1.0), 0.0)
        return Hits(probe, facet, np.clip(along, -reach[probe], reach[probe]), facing)

    def depths(self, points: Array) -> tuple[Array, Ints]:
        """Distance (n,) m of points (n, 3) of the part frame to these facets, and the nearest of them (n,)."""
        # a triangle without size: FCL takes one that reaches through a facet for as far off as the facet's edges
        point = fcl.CollisionObject(fcl_model(np.zeros((3, 3)), np.array([[0, 1, 2]])))
        mesh = fcl.CollisionObject(self.bvh)
        distance, facet = np.zeros(len(points)), np.zeros(len(points), dtype=np.int64)
        for k, p in enumerate(_UNIT * points):
            point.setTranslation(p)
            result = fcl.DistanceResult()
            distance[k] = fcl_distance(mesh, point, result)
            facet[k] = result.b1
        return distance, facet if self.facets is None else self.facets[facet]

    def crosses(self, other: Region, X_SO: Array) -> bool:
        """Whether any facets of the two intersect; `X_SO` (4, 4): pose of the other part here."""
        if self.bvh is None or other.bvh is None:
            return False
        request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)
        placed = fcl.CollisionObject(other.bvh, fcl_pose(X_SO))
        return bool(fcl.collide(fcl.CollisionObject(self.bvh), placed, request, fcl.CollisionResult()))


@dataclass
class MeshStore:
    """The indices of all distinct meshes, by digest."""

    indices: dict[str, MeshIndex] = field(default_factory=dict)

    def index(self, mesh: Mesh) -> MeshIndex:
        """The index of a mesh; meshes of one digest share it."""
        if mesh.digest not in self.indices:
            self.indices[mesh.digest] = MeshIndex(mesh)
        return self.indices[mesh.digest]
