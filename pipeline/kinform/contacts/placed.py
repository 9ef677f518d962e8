"""A part as a pair sees it: the facets and surfaces that come near the other part, in the frame of the pair.

The frame of a pair is the part frame of its first part, so that moving a whole assembly changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.contacts.bvh import MeshIndex
from kinform.model.assembly import Part
from kinform.model.surfaces import KINDS, MeshSurfaces

__all__ = ["NearSurfaces", "PlacedPart", "near_surfaces", "place"]

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

    @property
    def faces(self) -> Ints:
        """(F, 3)."""
        return self.index.mesh.faces

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
    return PlacedPart(part, index, surfaces, X_FP, vertices, normals, index.rims(surfaces))


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
    corners = placed.vertices[placed.faces]
    low_f, high_f = corners.min(axis=1), corners.max(axis=1)
    near = np.nonzero(((low_f <= high) & (high_f >= low)).all(axis=1))[0]
    labels = placed.surfaces.labels[near]
    order = np.argsort(labels, kind="stable")
    near, labels = near[order], labels[order]
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
        lows=np.minimum.reduceat(low_f[near], starts) if len(ids) else empty,
        highs=np.maximum.reduceat(high_f[near], starts) if len(ids) else empty,
        facets=tuple(np.split(near, starts[1:])) if len(ids) else (),
    )
