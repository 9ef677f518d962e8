"""Rims: full circles in which a plane of a mesh ends at a surface of revolution. World frame, SI.

The centre comes from the axis of that surface; the mesh only tells that the circle is there and goes all round.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinform.model.assembly import Mesh, Part
from kinform.model.surfaces import MeshSurfaces, Surface

__all__ = ["rims_of"]

Array = NDArray[np.float64]

ROUND = frozenset({"cylinder", "cone", "torus", "revolution"})
UPRIGHT = math.cos(math.radians(0.5))
WHOLE = 0.9 * 2 * math.pi
"""Least angle that the edges of a rim cover."""
SCATTER = 0.01
"""Greatest spread of the distances of a rim's vertices from its axis, of their mean."""


def rims_of(part: Part, surfaces: MeshSurfaces, plane: int) -> list[tuple[Array, float]]:
    """(centre on the plane (3,), radius) of the rims of one plane surface, by the index of the other surface."""
    assert part.mesh is not None
    out = []
    R_WP, p_WP = part.X_WP[:3, :3], part.X_WP[:3, 3]
    flat = surfaces.surfaces[plane]
    for index, edges in _border(part.mesh, surfaces, plane):
        other = surfaces.surfaces[index]
        if other.kind not in ROUND or abs(float(other.axis @ flat.axis)) < UPRIGHT:
            continue
        radius = _circle(part.mesh.vertices[edges], other)
        if radius is not None:
            height = float((flat.point - other.point) @ flat.axis) / float(other.axis @ flat.axis)
            out.append((R_WP @ (other.point + height * other.axis) + p_WP, radius))
    return out


def _border(mesh: Mesh, surfaces: MeshSurfaces, plane: int) -> list[tuple[int, NDArray[np.int64]]]:
    """(index of the surface beyond, (n, 2) vertices of the edges that it shares with the plane), by index."""
    on_plane = np.zeros(len(mesh.vertices), dtype=np.bool_)
    on_plane[mesh.faces[surfaces.labels == plane]] = True
    near = np.flatnonzero(on_plane[mesh.faces].sum(axis=1) >= 2)
    ends = np.sort(mesh.faces[near][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    keys = ends[:, 0] * len(mesh.vertices) + ends[:, 1]
    owner = np.repeat(surfaces.labels[near], 3)
    inside = owner == plane
    beyond = ~inside & np.isin(keys, keys[inside])
    return [(int(k), ends[beyond & (owner == k)]) for k in np.unique(owner[beyond])]


def _circle(edges: Array, surface: Surface) -> float | None:
    """Radius about the axis of a surface, of edges (n, 2, 3) that go all round it on one circle."""
    offset = edges - surface.point
    across = offset - (offset @ surface.axis)[..., None] * surface.axis
    distance = np.linalg.norm(across, axis=2)
    radius = float(distance.mean())
    if radius <= 0.0 or float(np.ptp(distance)) > SCATTER * radius:
        return None
    cosine = np.clip(np.einsum("ij,ij->i", across[:, 0], across[:, 1]) / distance.prod(axis=1), -1.0, 1.0)
    return radius if float(np.arccos(cosine).sum()) >= WHOLE else None
