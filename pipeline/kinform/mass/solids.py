"""A closed polyhedron as a solid: volume, centroid and second moments, exactly, and how far its mass may be off.

Knows geometry only: no density, no pose. Each facet makes a signed tetrahedron with a common apex,
whose moments are closed forms (Lien and Kajiya, IEEE CG&A 4(10), 1984; the same integrals as
Mirtich 1996). The apex is put in the middle of the solid first and in its centroid second, so that
no digits are lost when the solid lies far from the origin.

Facets lie within their sagitta of the true surface, so the volume between the two is at most
Σ sagitta · area. The sagitta of an analytic surface was measured when it was recovered; elsewhere it
is estimated from the turn of the surface across its smooth edges.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.edges import shared_edges
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class SolidIntegrals:
    """Integrals over the enclosed solid; unit density, frame of the vertices."""

    volume: float
    """m³; negative when the facets are wound inwards."""
    centroid: Array
    """(3,) m; nan when the volume is zero."""
    second: Array
    """(3, 3) m⁵: ∫ (x − centroid)(x − centroid)ᵀ dV; nan when the volume is zero."""

    @property
    def inertia(self) -> Array:
        """(3, 3) m⁵: inertia about the centroid at density 1."""
        inertia: Array = np.trace(self.second) * np.eye(3) - self.second
        return inertia


def integrate_solid(vertices: Array, faces: Ints) -> SolidIntegrals:
    """Integrals of the solid that the facets (F, 3) over vertices (V, 3), in metres, enclose.

    Means something only for a closed surface with consistent winding; the caller checks.
    """
    nothing = SolidIntegrals(0.0, np.full(3, np.nan), np.full((3, 3), np.nan))
    if len(faces) == 0:
        return nothing
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    volume, first, _ = _about(vertices - middle, faces)
    if volume == 0.0:
        return nothing
    centroid = middle + first / volume
    volume, rest, second = _about(vertices - centroid, faces)
    offset = rest / volume
    return SolidIntegrals(volume, centroid + offset, second - volume * np.outer(offset, offset))


def _about(vertices: Array, faces: Ints) -> tuple[float, Array, Array]:
    """Zeroth, first and second moments about the origin of tetrahedra (0, a, b, c).

    Rows are components, so that every sum runs along contiguous memory, where numpy adds pairwise.
    """
    a, b, c = (np.ascontiguousarray(vertices[faces[:, k]].T) for k in range(3))
    volumes = (
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    ) / 6.0
    total = a + b + c
    first = (total * volumes).sum(axis=1) / 4.0
    second = np.empty((3, 3))
    for i in range(3):
        for j in range(i, 3):
            products = a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + total[i] * total[j]
            second[i, j] = second[j, i] = (volumes * products).sum() / 20.0
    return float(volumes.sum()), first, second


def mass_bound(mesh: Mesh, volume: float, surfaces: MeshSurfaces | None, tolerances: Tolerances) -> float:
    """Relative bound of the error of the volume (m³); 0 for polyhedra.

    With `surfaces`, planes count nothing, curved surfaces their chord error, freeform facets the
    estimate; without, every facet the estimate.
    """
    if surfaces is None:
        return _estimate(mesh, np.arange(len(mesh.faces)), tolerances) / volume
    total = 0.0
    freeform: list[Ints] = []
    for surface in surfaces.surfaces:
        if surface.kind == "freeform":
            freeform.append(surface.faces)
        elif surface.kind != "plane":
            total += surface.chord * surface.area
    if freeform:
        total += _estimate(mesh, np.concatenate(freeform), tolerances)
    return total / volume


def _estimate(mesh: Mesh, facets: Ints, tolerances: Tolerances) -> float:
    """Σ area · sagitta of the facets (m³).

    Across an edge where the surface turns by δ, a facet of height w over that edge is a chord of an
    arc of δ: its sagitta is (w / 2)·tan(δ / 4). A facet's sagittas across its three edges are added.
    """
    corners = mesh.vertices[mesh.faces]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(doubled > 0.0, doubled, 1.0)[:, None]
    edges = shared_edges(mesh.faces, len(mesh.vertices))
    first, second = edges.facets.T
    cosine = np.einsum("ij,ij->i", normals[first], normals[second])
    sine = np.linalg.norm(cross(normals[first], normals[second]), axis=1)
    turn = np.arctan2(sine, cosine)
    turn[(turn > tolerances.smooth_edge) | (turn < tolerances.coplanar)] = 0.0
    turns = np.zeros(3 * len(mesh.faces))
    turns[edges.first] = turn
    turns[edges.second] = turn
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    height = doubled[:, None] / np.where(length > 0.0, length, np.inf)
    sagitta = (0.5 * height * np.tan(0.25 * turns.reshape(-1, 3))).sum(axis=1)
    return float((0.5 * doubled * sagitta)[facets].sum())
