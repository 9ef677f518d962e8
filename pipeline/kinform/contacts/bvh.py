"""Bounding volume hierarchies of meshes, one for each distinct mesh, and sliver probes against them.

A contact list of FCL between two meshes is not usable as a patch: it misses facets that touch exactly
and facets that penetrate in parallel. A thin triangle that stands across the surface does hit, whatever
the gap, so every question here is put as one BVH of such slivers against the BVH of a mesh. Slivers are
given in the mesh's own frame: the BVH never has to be built again for another pose.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import fcl
import numpy as np
from numpy.typing import NDArray

from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces

__all__ = ["Hits", "MeshIndex", "MeshStore"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

_WIDTH = 1e-3
"""Width of a sliver relative to its length: zero width misses most facets."""
_NEEDLE = 1e-7
"""Width of a ray relative to its length: it has to tell one facet from its neighbours."""
_RAYS = np.array([[0.577, 0.523, 0.627], [-0.67, 0.31, 0.675], [0.21, -0.83, 0.517]])
"""Directions along which no designer lays an edge."""


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


def _model(vertices: Array, faces: Ints) -> fcl.BVHModel:
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(np.ascontiguousarray(vertices), np.ascontiguousarray(faces))
    model.endModel()
    return model


class MeshIndex:
    """One mesh with its facet normals and areas, and its BVH, built when first asked for."""

    def __init__(self, mesh: Mesh):
        self.mesh = mesh
        corners = mesh.vertices[mesh.faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(cross, axis=1)
        self.areas: Array = 0.5 * length
        """(F,) m²."""
        self.normals: Array = cross / np.where(length > 0.0, length, 1.0)[:, None]
        """(F, 3) unit, part frame."""
        self._bvh: fcl.BVHModel | None = None
        self._borders: Ints | None = None

    @property
    def bvh(self) -> fcl.BVHModel:
        """FCL's model of the mesh in the part frame (m)."""
        if self._bvh is None:
            self._bvh = _model(self.mesh.vertices, self.mesh.faces)
        return self._bvh

    def borders(self, surfaces: MeshSurfaces) -> Ints:
        """(k, 2) pairs of surfaces that share an edge, both ways round, sorted."""
        if self._borders is None:
            faces = self.mesh.faces
            edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
            labels = np.tile(surfaces.labels, 3)
            order = np.lexsort((edges[:, 1], edges[:, 0]))
            edges, labels = edges[order], labels[order]
            shared = (edges[1:] == edges[:-1]).all(axis=1) & (labels[1:] != labels[:-1])
            pairs = np.stack([labels[:-1][shared], labels[1:][shared]], axis=1)
            self._borders = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
        return self._borders

    def rims(self, surfaces: MeshSurfaces) -> Array:
        """For each surface, the greatest chord error of the surfaces that share an edge with it (m).

        By so much the outline of a plane face may be off the curve that it stands for.
        """
        chords = np.array([surface.chord for surface in surfaces.surfaces])
        rims = np.zeros(len(chords))
        own, other = self.borders(surfaces).T
        np.maximum.at(rims, own, chords[other])
        return rims

    def cast(self, points: Array, directions: Array, reach: Array, width: float = _WIDTH) -> Hits:
        """Facets within `reach` (n,) m of `points` (n, 3) along ±`directions` (n, 3), part frame.

        `width` of the slivers, relative to their reach.
        """
        count = len(points)
        empty = np.zeros(0)
        if count == 0:
            return Hits(empty.astype(np.int64), empty.astype(np.int64), empty, empty)
        least = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
        across = np.cross(directions, least)
        across *= (width * reach / np.linalg.norm(across, axis=1))[:, None]
        tip = points + reach[:, None] * directions
        slivers = np.stack([points - reach[:, None] * directions, tip + across, tip - across], axis=1)
        probe_model = _model(slivers.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
        # Contact points stay off: they cost, come several to a facet, and depend on FCL's own tolerance.
        request = fcl.CollisionRequest(num_max_contacts=256 * count + 4096, enable_contact=False)
        result = fcl.CollisionResult()
        fcl.collide(fcl.CollisionObject(self.bvh), fcl.CollisionObject(probe_model), request, result)
        pairs = np.array([(c.b2, c.b1) for c in result.contacts], dtype=np.int64).reshape(-1, 2)
        pairs = np.unique(pairs, axis=0)
        probe, facet = pairs[:, 0], pairs[:, 1]
        normal = self.normals[facet]
        facing = np.einsum("ij,ij->i", normal, directions[probe])
        height = np.einsum("ij,ij->i", normal, self.mesh.vertices[self.mesh.faces[facet, 0]] - points[probe])
        steep = np.abs(facing) > 1e-3
        along = np.where(steep, height / np.where(steep, facing, 1.0), 0.0)
        return Hits(probe, facet, np.clip(along, -reach[probe], reach[probe]), facing)

    def depths(self, points: Array) -> tuple[Array, Ints]:
        """Distance (n,) m of points (n, 3) of the part frame to the mesh, and the nearest facets (n,)."""
        speck = 1e-9 * max(self.mesh.diagonal, 1e-300)
        corners = speck * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        point = fcl.CollisionObject(_model(corners, np.array([[0, 1, 2]])))
        mesh, request = fcl.CollisionObject(self.bvh), fcl.DistanceRequest()
        distance, facet = np.zeros(len(points)), np.zeros(len(points), dtype=np.int64)
        for k, p in enumerate(points):
            point.setTranslation(p)
            result = fcl.DistanceResult()
            distance[k] = max(fcl.distance(mesh, point, request, result), 0.0)
            facet[k] = result.b1
        return distance, facet

    def crosses(self, other: MeshIndex, X_SO: Array) -> bool:
        """Whether any facets of the two meshes intersect; `X_SO` (4, 4): pose of the other part here."""
        request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)
        placed = fcl.CollisionObject(other.bvh, fcl.Transform(X_SO[:3, :3], X_SO[:3, 3]))
        return bool(fcl.collide(fcl.CollisionObject(self.bvh), placed, request, fcl.CollisionResult()))

    def contains(self, points: Array) -> Flags:
        """(n,) whether points (n, 3) of the part frame lie inside: the median of three rays' crossings.

        Open and inside-out meshes have an inside as far as two of three rays agree on it.
        """
        half = np.full(len(points), 0.5 * self.mesh.diagonal + 1e-300)
        crossings = np.zeros((len(_RAYS), len(points)))
        for count, ray in zip(crossings, _RAYS, strict=True):
            direction = np.tile(ray / np.linalg.norm(ray), (len(points), 1))
            hits = self.cast(points + half[:, None] * direction, direction, half, width=_NEEDLE)
            ahead = hits.along > -half[hits.probe]
            np.add.at(count, hits.probe[ahead], np.sign(hits.facing[ahead]))
        return np.asarray(np.abs(np.median(crossings, axis=0)) > 0.5)


@dataclass
class MeshStore:
    """The indices of all distinct meshes, by digest."""

    indices: dict[str, MeshIndex] = field(default_factory=dict)

    def index(self, mesh: Mesh) -> MeshIndex:
        """The index of a mesh; meshes of one digest share it."""
        if mesh.digest not in self.indices:
            self.indices[mesh.digest] = MeshIndex(mesh)
        return self.indices[mesh.digest]
