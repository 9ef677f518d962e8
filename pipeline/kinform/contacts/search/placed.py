"""A part as a pair sees it: the facets and surfaces that come near the other part, in the frame of the pair.

The frame of a pair is the part frame of the one that has more facets, so that moving a whole assembly changes
nothing, and a large part is never placed anew for each of its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kinform.foundation.meshes.boxes import facet_boxes
from kinform.foundation.meshes.index import MeshIndex
from kinform.foundation.meshes.probes import Region
from kinform.foundation.meshes.proximity import near_boxes
from kinform.foundation.meshes.surface_table import SurfaceTable
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Part
from kinform.model.surfaces import KINDS, MeshSurfaces

__all__ = ["NearSurfaces", "PlacedPart", "facing", "near_facets", "near_surfaces", "place"]


@dataclass(frozen=True, eq=False)
class PlacedPart:
    """A part with all its facets in the frame of the pair (m)."""

    part: Part
    index: MeshIndex
    surfaces: MeshSurfaces
    table: SurfaceTable
    X_FP: Array
    """(4, 4) pose of the part frame in the frame of the pair."""
    at_home: bool
    """Whether the frame of the pair is the part's own."""
    vertices: Array
    """(V, 3)."""
    low: Array
    high: Array
    """(3,) bounding box."""
    region: Region
    """The facets that probes of the pair can meet."""
    known: float
    """m: no other facet is nearer than this to a facet of the other part."""

    @property
    def rims(self) -> Array:
        """For each surface of the mesh, the greatest chord error of its neighbours (m)."""
        return self.table.rims

    @property
    def faces(self) -> Ints:
        """(F, 3)."""
        return self.index.mesh.faces

    def normals(self, facets: Ints) -> Array:
        """(n, 3) unit, outward, of facets (n,), in the frame of the pair."""
        return np.asarray(self.index.normals(facets) @ self.X_FP[:3, :3].T)

    def depths(self, points: Array) -> tuple[Array, Ints]:
        """Distance (n,) m to the mesh of points (n, 3) on the other part, and the nearest facets (n,).

        Points are in the frame of the pair. Facets outside the region are asked only about points that they may be nearest to.
        """
        if self.region.bvh is None:
            return self.index.whole().depths(self.to_part(points))
        distance, facet = self.region.depths(self.to_part(points))
        if self.region.facets is not None:
            far = distance > self.known
            if far.any():
                distance[far], facet[far] = self.index.whole().depths(self.to_part(points[far]))
        return distance, facet

    def to_part(self, points: Array) -> Array:
        """Points (n, 3) of the frame of the pair in the part frame."""
        return np.asarray((points - self.X_FP[:3, 3]) @ self.X_FP[:3, :3])

    def turn_to_part(self, directions: Array) -> Array:
        """Directions (n, 3) of the frame of the pair in the part frame."""
        return np.asarray(directions @ self.X_FP[:3, :3])


def place(part: Part, index: MeshIndex, surfaces: MeshSurfaces, X_FP: Array | None) -> PlacedPart:
    """The part at pose `X_FP` (4, 4) in the frame of the pair; None: that frame is the part's own."""
    table = index.table(surfaces)
    region = Region(index, None, np.zeros(0, np.int64))
    if X_FP is None:
        vertices, low, high = index.mesh.vertices, index.low, index.high
    else:
        R_FP = X_FP[:3, :3]
        vertices = index.mesh.vertices @ R_FP.T + X_FP[:3, 3]
        columns = np.ascontiguousarray(vertices.T)
        low, high = columns.min(axis=1), columns.max(axis=1)
    pose = np.eye(4) if X_FP is None else X_FP
    return PlacedPart(part, index, surfaces, table, pose, X_FP is None, vertices, low, high, region, 0.0)


def facing(a: PlacedPart, b: PlacedPart, low: Array, high: Array, margin: float) -> tuple[PlacedPart, PlacedPart]:
    """Both parts, with the facets in the box from `low` to `high` (3,) that come within `margin` (m) of the other
    as those that probes can meet."""
    (own_a, low_a, high_a), (own_b, low_b, high_b) = near_facets(a, low, high), near_facets(b, low, high)
    keep_a, keep_b = near_boxes(low_a, high_a, low_b, high_b, margin)
    return (
        replace(a, region=a.index.region(own_a[keep_a]), known=margin),
        replace(b, region=b.index.region(own_b[keep_b]), known=margin),
    )


def near_facets(placed: PlacedPart, low: Array, high: Array) -> tuple[Ints, Array, Array]:
    """Facets whose boxes meet the box from `low` to `high` (3,), ascending, and their boxes (n, 3)."""
    if placed.at_home:
        boxes = placed.index.boxes
        some = boxes.meeting(low, high)
        return some, boxes.low[some], boxes.high[some]
    vertices, faces = placed.vertices, placed.faces
    beside = ((vertices < low) @ _BITS[:3]) | ((vertices > high) @ _BITS[3:])
    a, b, c = faces.T
    some = np.flatnonzero((beside[a] & beside[b] & beside[c]) == 0)
    low_f, high_f = facet_boxes((vertices[a[some]], vertices[b[some]], vertices[c[some]]))
    return some, low_f, high_f


MOST = 3000
"""Surfaces of one part that a pair looks at."""

_BITS = np.array([1, 2, 4, 8, 16, 32], dtype=np.int64)
"""One for each side of a box that a vertex can lie beyond."""


@dataclass(frozen=True, eq=False)
class NearSurfaces(SurfaceTable):
    """Surfaces of one part with facets near the other part, in the frame of the pair."""

    ids: Ints
    """(s,) index of each surface in the part's MeshSurfaces."""
    lows: Array
    """(s, 3) box of the near facets."""
    highs: Array
    facets: tuple[Ints, ...]
    """Near facets of each surface."""

    def of_kind(self, *kinds: str) -> Ints:
        """Positions of the surfaces of these kinds."""
        wanted = np.zeros(len(self.kinds), dtype=bool)
        for kind in kinds:
            wanted |= self.kinds == KINDS.index(kind)
        return np.flatnonzero(wanted)


def near_surfaces(placed: PlacedPart, low: Array, high: Array) -> NearSurfaces:
    """Surfaces of the part that have facets whose boxes meet the box from `low` to `high` (3,)."""
    near, low_f, high_f = near_facets(placed, low, high)
    labels = placed.surfaces.labels[near]
    order = np.argsort(labels, kind="stable")
    near, labels, low_f, high_f = near[order], labels[order], low_f[order], high_f[order]
    ids, starts = np.unique(labels, return_index=True)
    if len(ids) > MOST:
        # a crumpled mesh, every facet a surface of its own: the largest decide, and memory stays bounded
        largest = np.sort(np.lexsort((ids, -placed.table.areas[ids]))[:MOST])
        keep = np.isin(labels, ids[largest])
        near, labels, low_f, high_f = near[keep], labels[keep], low_f[keep], high_f[keep]
        ids, starts = np.unique(labels, return_index=True)
    empty = np.zeros((0, 3))
    return NearSurfaces(
        **placed.table.placed(ids, placed.X_FP),  # type: ignore[arg-type]
        ids=ids.astype(np.int64),
        lows=np.minimum.reduceat(low_f, starts) if len(ids) else empty,
        highs=np.maximum.reduceat(high_f, starts) if len(ids) else empty,
        facets=tuple(np.split(near, starts[1:])) if len(ids) else (),
    )
