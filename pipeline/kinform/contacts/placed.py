"""A part as a pair sees it: the facets and surfaces that come near the other part, in the frame of the pair.

The frame of a pair is the part frame of its first part, so that moving a whole assembly changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinform.contacts.bvh import MeshIndex, Region
from kinform.contacts.proximity import near_boxes
from kinform.model.assembly import Part
from kinform.model.surfaces import KINDS, MeshSurfaces

__all__ = ["NearSurfaces", "PlacedPart", "facing", "near_facets", "near_surfaces", "place"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PlacedPart:
    """A part with all its facets in the frame of the pair (m)."""

    part: Part
    index: MeshIndex
    surfaces: MeshSurfaces
    X_FP: Array
    """(4, 4) pose of the part frame in the frame of the pair."""
    vertices: Array
    """(V, 3)."""
    normals: Array
    """(F, 3) outward."""
    rims: Array
    """For each surface of the mesh, the greatest chord error of its neighbours (m)."""
    low: Array
    high: Array
    """(3,) bounding box."""
    region: Region
    """The facets that probes of the pair can meet."""
    known: float
    """m: no other facet is nearer than this to a facet of the other part."""

    @property
    def faces(self) -> Ints:
        """(F, 3)."""
        return self.index.mesh.faces

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


def place(part: Part, index: MeshIndex, surfaces: MeshSurfaces, X_FP: Array) -> PlacedPart:
    """The part at pose `X_FP` (4, 4) in the frame of the pair."""
    R_FP = X_FP[:3, :3]
    vertices = index.mesh.vertices @ R_FP.T + X_FP[:3, 3]
    normals = index.normals @ R_FP.T
    columns = np.ascontiguousarray(vertices.T)
    low, high = columns.min(axis=1), columns.max(axis=1)
    region = Region(index, None, np.zeros(0, np.int64))
    return PlacedPart(part, index, surfaces, X_FP, vertices, normals, index.rims(surfaces), low, high, region, 0.0)


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
    vertices, faces = placed.vertices, placed.faces
    beside = ((vertices < low) @ _BITS[:3]) | ((vertices > high) @ _BITS[3:])
    a, b, c = faces.T
    some = np.flatnonzero((beside[a] & beside[b] & beside[c]) == 0)
    first, second, third = (vertices[faces[some, k]] for k in range(3))
    low_f = np.minimum(np.minimum(first, second), third)
    high_f = np.maximum(np.maximum(first, second), third)
    return some, low_f, high_f


MOST = 3000
"""Surfaces of one part that a pair looks at."""

_BITS = np.array([1, 2, 4, 8, 16, 32], dtype=np.int64)
"""One for each side of a box that a vertex can lie beyond."""


@dataclass(frozen=True, eq=False)
class NearSurfaces:
    """Surfaces of one part with facets near the other part, as arrays (s surfaces, frame of the pair)."""

    ids: Ints
    """(s,) index of each surface in the part's MeshSurfaces."""
    kinds: Ints
    """(s,) index into KINDS."""
    axes: Array
    """(s, 3)."""
    points: Array
    """(s, 3)."""
    radii: Array
    half_angles: Array
    sides: Array
    axis_uncertainty: Array
    point_uncertainty: Array
    slacks: Array
    """(s,) m that facets may stand off the surface: chord error and residual of the fit."""
    chords: Array
    rims: Array
    """(s,) m: greatest chord error of the surfaces that share an edge with this one."""
    extents: Array
    """(s, 2) m along the axis from the point."""
    areas: Array
    """(s,) m² of the whole surface."""
    lows: Array
    """(s, 3) box of the near facets."""
    highs: Array
    facets: tuple[Ints, ...]
    """Near facets of each surface."""

    def of_kind(self, *kinds: str) -> Ints:
        """Positions of the surfaces of these kinds."""
        wanted = [KINDS.index(kind) for kind in kinds]
        return np.nonzero(np.isin(self.kinds, wanted))[0]


def near_surfaces(placed: PlacedPart, low: Array, high: Array) -> NearSurfaces:
    """Surfaces of the part that have facets whose boxes meet the box from `low` to `high` (3,)."""
    near, low_f, high_f = near_facets(placed, low, high)
    labels = placed.surfaces.labels[near]
    order = np.argsort(labels, kind="stable")
    near, labels, low_f, high_f = near[order], labels[order], low_f[order], high_f[order]
    ids, starts = np.unique(labels, return_index=True)
    if len(ids) > MOST:
        # a crumpled mesh, every facet a surface of its own: the largest decide, and memory stays bounded
        areas = np.array([placed.surfaces.surfaces[i].area for i in ids])
        largest = np.sort(np.lexsort((ids, -areas))[:MOST])
        keep = np.isin(labels, ids[largest])
        near, labels, low_f, high_f = near[keep], labels[keep], low_f[keep], high_f[keep]
        ids, starts = np.unique(labels, return_index=True)
    chosen = [placed.surfaces.surfaces[i] for i in ids]
    R_FP, p_FP = placed.X_FP[:3, :3], placed.X_FP[:3, 3]

    def column(values: list[float]) -> Array:
        return np.array(values, dtype=np.float64)

    def stacked(values: list[Array], width: int) -> Array:
        return np.array(values, dtype=np.float64).reshape(-1, width)

    empty = np.zeros((0, 3))
    return NearSurfaces(
        ids=ids.astype(np.int64),
        kinds=np.array([KINDS.index(s.kind) for s in chosen], dtype=np.int64),
        axes=stacked([s.axis for s in chosen], 3) @ R_FP.T,
        points=stacked([s.point for s in chosen], 3) @ R_FP.T + p_FP,
        radii=column([s.radius for s in chosen]),
        half_angles=column([s.half_angle for s in chosen]),
        sides=column([float(s.side) for s in chosen]),
        axis_uncertainty=column([s.axis_uncertainty for s in chosen]),
        point_uncertainty=column([s.point_uncertainty for s in chosen]),
        slacks=column([s.chord + s.residual for s in chosen]),
        chords=column([s.chord for s in chosen]),
        rims=placed.rims[ids],
        extents=stacked([np.array(s.extent) for s in chosen], 2),
        areas=column([s.area for s in chosen]),
        lows=np.minimum.reduceat(low_f, starts) if len(ids) else empty,
        highs=np.maximum.reduceat(high_f, starts) if len(ids) else empty,
        facets=tuple(np.split(near, starts[1:])) if len(ids) else (),
    )
