"""How far the mass of a tessellated solid may be from the mass of the solid that it stands for.

Facets lie within their sagitta of the true surface, so the volume between the two is at most
Σ sagitta · area. The sagitta of an analytic surface was measured when it was recovered; elsewhere it
is estimated from the turn of the surface across its smooth edges.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.meshes.edges import shared_edges
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances

__all__ = ["mass_bound"]


def mass_bound(mesh: Mesh, volume: float, surfaces: MeshSurfaces | None, tolerances: Tolerances) -> float:
    """Relative bound of the error of the volume (m³); 0 for polyhedra.

    With `surfaces`, planes count nothing, curved surfaces their chord error, freeform facets the
    estimate; without, every facet the estimate.
    """
    if surfaces is None:
        return _estimate(mesh, np.arange(len(mesh.faces)), tolerances) / volume
    total = 0.0
    freeform: list[NDArray[np.int64]] = []
    for surface in surfaces.surfaces:
        if surface.kind == "freeform":
            freeform.append(surface.faces)
        elif surface.kind != "plane":
            total += surface.chord * surface.area
    if freeform:
        total += _estimate(mesh, np.concatenate(freeform), tolerances)
    return total / volume


def _estimate(mesh: Mesh, facets: NDArray[np.int64], tolerances: Tolerances) -> float:
    """Σ area · sagitta of the facets (m³).

    Across an edge where the surface turns by δ, a facet of height w over that edge is a chord of an
    arc of δ: its sagitta is (w / 2)·tan(δ / 4). A facet's sagittas across its three edges are added.
    """
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(doubled > 0.0, doubled, 1.0)[:, None]
    edges = shared_edges(mesh.faces, len(mesh.vertices))
    first, second = edges.facets.T
    cosine = np.einsum("ij,ij->i", normals[first], normals[second])
    sine = np.linalg.norm(np.cross(normals[first], normals[second]), axis=1)
    turn = np.arctan2(sine, cosine)
    turn[(turn > tolerances.smooth_edge) | (turn < tolerances.coplanar)] = 0.0
    turns = np.zeros(3 * len(mesh.faces))
    turns[edges.first] = turn
    turns[edges.second] = turn
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    height = doubled[:, None] / np.where(length > 0.0, length, np.inf)
    sagitta = (0.5 * height * np.tan(0.25 * turns.reshape(-1, 3))).sum(axis=1)
    return float((0.5 * doubled * sagitta)[facets].sum())
