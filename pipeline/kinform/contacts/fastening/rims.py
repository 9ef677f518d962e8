"""Rims: full circles in which a plane of a mesh ends at a surface of revolution. World frame, SI.

The centre comes from the axis of that surface; the mesh only tells that the circle is there and goes all round.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.contacts.constants import ROUND_SWEEP
from kinform.contacts.fastening.constants import AXES_PARALLEL
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.meshes.edges import edge_ends
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh, Part
from kinform.model.surfaces import MeshSurfaces, Surface

RIM_KINDS = frozenset({"cylinder", "cone", "torus", "revolution"})
"""Surfaces at which a rim ends."""


def rims_of(part: Part, surfaces: MeshSurfaces, plane: int) -> list[tuple[Array, float]]:
    """(centre on the plane (3,), radius) of the rims of one plane surface, by the index of the other surface."""
    assert part.mesh is not None
    out = []
    R_WP, p_WP = part.X_WP[:3, :3], part.X_WP[:3, 3]
    flat = surfaces.surfaces[plane]
    upright = [
        s
        for s in surfaces.surfaces
        if s.kind in RIM_KINDS and abs(float(s.axis @ flat.axis)) >= math.cos(AXES_PARALLEL)
    ]
    for other, edges in _borders(part.mesh, flat, upright):
        radius = _circle(part.mesh.vertices[edges], other)
        if radius is not None:
            height = float((flat.point - other.point) @ flat.axis) / float(other.axis @ flat.axis)
            out.append((R_WP @ (other.point + height * other.axis) + p_WP, radius))
    return out


def _borders(mesh: Mesh, plane: Surface, others: Sequence[Surface]) -> list[tuple[Surface, Ints]]:
    """Those of the other surfaces that share edges with the plane, with the (n, 2) vertices of these edges."""
    if not others:
        return []
    on_plane = np.zeros(len(mesh.vertices), dtype=np.bool_)
    on_plane[mesh.faces[plane.faces]] = True
    inside = np.sort(_keys(edge_ends(mesh.faces[plane.faces]), mesh))
    owner = np.repeat(np.arange(len(others)), [len(other.faces) for other in others])
    one, two, three = corners = mesh.faces[np.concatenate([other.faces for other in others])].T
    beside = np.flatnonzero(on_plane[one].astype(np.int8) + on_plane[two] + on_plane[three] >= 2)
    ends, owner = edge_ends(corners.T[beside]), np.repeat(owner[beside], 3)
    keys = _keys(ends, mesh)
    place = np.minimum(np.searchsorted(inside, keys), len(inside) - 1)
    shared = inside[place] == keys
    ends, owner = ends[shared], owner[shared]
    return [(others[k], ends[owner == k]) for k in np.unique(owner).tolist()]


def _keys(edges: Ints, mesh: Mesh) -> Ints:
    """One number an edge."""
    return edges[:, 0] * len(mesh.vertices) + edges[:, 1]


def _circle(edges: Array, surface: Surface) -> float | None:
    """Radius about the axis of a surface, of edges (n, 2, 3) that go all round it on one circle."""
    offset = edges - surface.point
    across = offset - (offset @ surface.axis)[..., None] * surface.axis
    distance = np.linalg.norm(across, axis=2)
    radius = float(distance.mean())
    # the vertices of a rim are as far from its axis to within 1 %
    if radius <= 0.0 or float(np.ptp(distance)) > 0.01 * radius:
        return None
    cosine = np.clip(dot(across[:, 0], across[:, 1]) / distance.prod(axis=1), -1.0, 1.0)
    return radius if float(np.arccos(cosine).sum()) >= ROUND_SWEEP else None
