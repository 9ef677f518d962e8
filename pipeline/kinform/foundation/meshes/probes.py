"""Sliver probes against facets of a mesh.

A contact list of FCL between two meshes is not usable as a patch: it misses facets that touch exactly
and facets that penetrate in parallel. A thin triangle that stands across the surface does hit, whatever
the gap, so every question here is put as such slivers against facets: to all facets whose boxes they meet
(`slivers`), or, of very many, as one BVH against that of the mesh, which is the same question. Slivers are given in
the mesh's own frame: the BVH never has to be built again for another pose.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Protocol

import fcl
import numpy as np

from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.algebra.vectors import cross, dot, lengths, times
from kinform.foundation.concatenation import concatenated
from kinform.foundation.constants import SLIVER_WIDTH
from kinform.foundation.meshes.boxes import facet_boxes, triangle_boxes
from kinform.foundation.meshes.closest_facets import Triangles
from kinform.foundation.meshes.fcl_adapter import UNIT, fcl_distance, fcl_model, fcl_pose, partial_model, point_model
from kinform.foundation.meshes.slivers import beside, crossings, meetings
from kinform.foundation.sorting import distinct
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh

KEPT_TRIANGLES = 50_000
"""Facets up to which the corners of a mesh, or of those near another part, are kept, and their boxes: 6 MB."""
MET_AT_ONCE = 100_000
"""Triangles of which a model is made at a time, a kilobyte each, to ask whether they meet a mesh."""


class Facets(Protocol):
    """A mesh that tells the normals of its facets."""

    mesh: Mesh

    @property
    def bvh(self) -> fcl.BVHModel:
        """FCL's model of all of it (m)."""
        ...

    @property
    def is_large(self) -> bool:
        """Whether a model of all of it takes much memory."""
        ...

    @property
    def triangles(self) -> Triangles:
        """All of it (m)."""
        ...

    def model_near(self, low: Array, high: Array) -> tuple[fcl.BVHModel, Ints | None]:
        """FCL's model of facets, all that boxes (n, 3) meet among them, and which facets it is of (None: all)."""
        ...

    def normals(self, facets: Ints) -> Array:
        """(n, 3) unit, outward, part frame."""
        ...


_UNITS = np.eye(3)
"""x, y, z."""


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


@dataclass(frozen=True, eq=False)
class Region:
    """Facets of a mesh that probes are cast against."""

    index: Facets
    facets: Ints | None
    """Ascending; None: all of them."""

    @property
    def empty(self) -> bool:
        """Whether it is of no facets."""
        return self.facets is not None and not len(self.facets)

    @property
    def is_large(self) -> bool:
        """Whether it is of so many facets, of a large mesh, that they are asked by models alone."""
        return self.index.is_large and not (self.facets is not None and self._is_kept)

    @cached_property
    def bvh(self) -> fcl.BVHModel:
        """FCL's model of them, made when first asked for; there is none of an empty region."""
        if self.facets is None:
            return self.index.bvh
        mesh = self.index.mesh
        return partial_model(mesh.vertices, mesh.faces[self.facets])

    def cast(self, points: Array, directions: Array, reach: Array, width: float = SLIVER_WIDTH) -> Hits:
        """Facets within `reach` (n,) m of `points` (n, 3) along ±`directions` (n, 3), part frame.

        `width` of the slivers, relative to their reach.
        """
        return cast_all([Cast(self, points, directions, reach)], width)[0]

    def depths(self, points: Array) -> tuple[Array, Ints]:
        """Distance (n,) m of points (n, 3) of the part frame to these facets, and the nearest of them (n,)."""
        if not self.is_large:
            told = self.triangles.nearest(points)
            if told is not None:
                return told[0], told[1] if self.facets is None else self.facets[told[1]]
        point = fcl.CollisionObject(point_model())
        mesh = fcl.CollisionObject(self.bvh)
        distance, facet = np.zeros(len(points)), np.zeros(len(points), dtype=np.int64)
        for k, p in enumerate(UNIT * points):
            point.setTranslation(p)
            result = fcl.DistanceResult()
            distance[k] = fcl_distance(mesh, point, result)
            facet[k] = result.b1
        return distance, facet if self.facets is None else self.facets[facet]

    def crosses(self, other: Region, X_SO: Array) -> bool:
        """Whether any facets of the two intersect; `X_SO` (4, 4): pose of the other part here."""
        return crossings_of([(self, other, X_SO)])[0]

    def crosses_in_trees(self, other: Region, X_SO: Array) -> bool:
        """The same, of large meshes, by their models."""
        request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)
        placed = fcl.CollisionObject(other._beside(self, inverse(X_SO)), fcl_pose(X_SO))
        base = fcl.CollisionObject(self._beside(other, X_SO))
        return bool(fcl.collide(base, placed, request, fcl.CollisionResult()))

    def meets(self, triangles: Array) -> bool:
        """Whether any triangles (n, 3, 3) of the part frame meet these facets; of many, as `crosses`."""
        if self.empty or not len(triangles):
            return False
        whole = self.facets is not None or not self.index.is_large
        mine = fcl.CollisionObject(self.bvh if whole else self.index.model_near(*triangle_boxes(triangles))[0])
        request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)
        for start in range(0, len(triangles), MET_AT_ONCE):
            corners = triangles[start : start + MET_AT_ONCE].reshape(-1, 3)
            other = fcl.CollisionObject(fcl_model(corners, np.arange(len(corners)).reshape(-1, 3)))
            if fcl.collide(mine, other, request, fcl.CollisionResult()):
                return True
        return False

    def corners(self) -> Array:
        """(n, 3, 3) m of the facets."""
        return self.triangles.corners

    @property
    def triangles(self) -> Triangles:
        """The facets (m), kept of those that are not very many."""
        if self.facets is None:
            return self.index.triangles
        return self._kept if self._is_kept else self._made(self.facets)

    @property
    def boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners (n, 3) m of the boxes of the facets."""
        mesh = self.index.mesh
        if self._is_kept:
            return self.triangles.boxes
        return facet_boxes(mesh.vertices, mesh.faces if self.facets is None else mesh.faces[self.facets])

    def corners_of(self, places: Ints) -> Array:
        """(n, 3, 3) m of some of the facets, at these places (n,) among them."""
        if self._is_kept:
            return self.triangles.corners.take(places, axis=0)
        mesh, facets = self.index.mesh, places if self.facets is None else self.facets.take(places)
        return np.asarray(mesh.vertices.take(mesh.faces.take(facets, axis=0), axis=0))

    @property
    def _is_kept(self) -> bool:
        return len(self.index.mesh.faces if self.facets is None else self.facets) <= KEPT_TRIANGLES

    @cached_property
    def _kept(self) -> Triangles:
        assert self.facets is not None
        return self._made(self.facets)

    def _made(self, facets: Ints) -> Triangles:
        mesh = self.index.mesh
        return Triangles(mesh.vertices.take(mesh.faces.take(facets, axis=0), axis=0))

    def _beside(self, other: Region, X_SO: Array) -> fcl.BVHModel:
        """FCL's model of facets, all that those of the other region can meet among them."""
        if self.facets is not None or not self.index.is_large:
            return self.bvh
        mesh = other.index.mesh
        faces = mesh.faces if other.facets is None else mesh.faces[other.facets]
        return self.index.model_near(*facet_boxes(mesh.vertices @ X_SO[:3, :3].T + X_SO[:3, 3], faces))[0]


def crossings_of(asked: Sequence[tuple[Region, Region, Array]]) -> list[bool]:
    """Whether any facets of one region intersect any of the other, of several pairs of them at once, with the pose
    (4, 4) of the part of the second in the frame of the first."""
    some = [
        k
        for k, (first, second, _) in enumerate(asked)
        if not (first.empty or second.empty or first.is_large or second.is_large)
    ]
    triangles = [
        (first.corners(), times(second.corners(), X_SO[:3, :3].T) + X_SO[:3, 3])
        for first, second, X_SO in (asked[k] for k in some)
    ]
    told = dict(zip(some, crossings(triangles), strict=True))
    out = []
    for k, (first, second, X_SO) in enumerate(asked):
        answer = False if first.empty or second.empty else told.get(k)
        out.append(first.crosses_in_trees(second, X_SO) if answer is None else answer)
    return out


@dataclass(frozen=True, eq=False)
class Cast:
    """Probes of one region: `points` and `directions` (n, 3) in its part's frame, `reach` (n,) m to either side."""

    region: Region
    points: Array
    directions: Array
    reach: Array


def cast_all(casts: Sequence[Cast], width: float = SLIVER_WIDTH) -> list[Hits]:
    """What each of some casts hits, all at once; `width` of the slivers, relative to their reach."""
    empty = np.zeros(0)
    out = [Hits(empty.astype(np.int64), empty.astype(np.int64), empty, empty)] * len(casts)
    some = [k for k, cast in enumerate(casts) if len(cast.points) and not cast.region.empty]
    if not some:
        return out
    ends = [0, *accumulate(len(casts[k].points) for k in some)]
    points, directions, reach = (
        concatenated([getattr(casts[k], name) for k in some]) for name in ("points", "directions", "reach")
    )
    across = cross(directions, _UNITS.take(np.abs(directions).argmin(axis=1), axis=0))
    across *= (width * reach / lengths(across))[:, None]
    arms = reach[:, None] * directions
    tip, slivers = points + arms, np.empty((len(points), 3, 3))
    np.subtract(points, arms, out=slivers[:, 0])
    np.add(tip, across, out=slivers[:, 1])
    np.subtract(tip, across, out=slivers[:, 2])
    regions = [casts[k].region for k in some]
    met = _meetings(regions, [slivers[i:j] for i, j in pairwise(ends)])
    meshes = [region.index.mesh for region in regions]
    probe = np.concatenate([probe + start for (probe, _), start in zip(met, ends, strict=False)])
    normal = concatenated([region.index.normals(facet) for region, (_, facet) in zip(regions, met, strict=True)])
    corner = concatenated(
        [mesh.vertices.take(mesh.faces[facet, 0], axis=0) for mesh, (_, facet) in zip(meshes, met, strict=True)]
    )
    facing = dot(normal, directions.take(probe, axis=0))
    height = dot(normal, corner - points.take(probe, axis=0))
    # Least cosine between a probe and the normal of a facet at which their intersection is known: below, rounding of
    # the facet moves it by more than a thousand times as much.
    steep = np.abs(facing) > 1e-3
    along = height / facing if steep.all() else np.where(steep, height / np.where(steep, facing, 1.0), 0.0)
    far = reach.take(probe)
    along = np.minimum(np.maximum(along, -far), far)
    hits = [0, *accumulate(len(probe) for probe, _ in met)]
    for k, (i, j), (own, facet) in zip(some, pairwise(hits), met, strict=True):
        out[k] = Hits(own, facet, along[i:j], facing[i:j])
    return out


def _meetings(regions: Sequence[Region], slivers: Sequence[Array]) -> list[tuple[Ints, Ints]]:
    """Slivers (n, 3, 3) of each region and the facets that they meet, by sliver, then by facet."""
    asked, near = [], []
    for region, own in zip(regions, slivers, strict=True):
        near.append(beside(own, *region.boxes))
        asked.append((own, region.corners_of(near[-1])))
    out = []
    for region, own, facets, met in zip(regions, slivers, near, meetings(asked), strict=True):
        if met is None:
            out.append(_met_by_trees(region, own))
        else:
            facet = facets.take(met[1])
            out.append((met[0], facet if region.facets is None else region.facets.take(facet)))
    return out


def _met_by_trees(region: Region, slivers: Array) -> tuple[Ints, Ints]:
    """The same of many slivers of one region."""
    mesh = region.index.mesh
    probe_model = fcl_model(slivers.reshape(-1, 3), np.arange(3 * len(slivers)).reshape(-1, 3))
    # Contact points stay off: they cost, come several to a facet, and depend on FCL's own tolerance.
    # FCL lists the facets that are hit: a few hundred a probe are more than any part has in a row
    most = 256 * (len(slivers) + 16)
    request = fcl.CollisionRequest(num_max_contacts=most, enable_contact=False)
    result = fcl.CollisionResult()
    if region.facets is None:
        model, of_model = region.index.model_near(*triangle_boxes(slivers))
    else:
        model, of_model = region.bvh, region.facets
    fcl.collide(fcl.CollisionObject(model), fcl.CollisionObject(probe_model), request, result)
    pairs = np.array([(c.b2, c.b1) for c in result.contacts], dtype=np.int64).reshape(-1, 2)
    facets = np.int64(max(len(mesh.faces), 1))
    probe, facet = np.divmod(distinct(pairs[:, 0] * facets + pairs[:, 1]), facets)
    return probe, facet if of_model is None else of_model[facet]
