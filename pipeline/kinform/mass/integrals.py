"""Volume, centroid and second moments of a closed polyhedron, exactly.

Knows geometry only: no density, no pose. Each facet makes a signed tetrahedron with a common apex,
whose moments are closed forms (Lien and Kajiya, IEEE CG&A 4(10), 1984; the same integrals as
Mirtich 1996). The apex is put in the middle of the solid first and in its centroid second, so that
no digits are lost when the solid lies far from the origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Array

__all__ = ["SolidIntegrals", "integrate_solid"]


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


def integrate_solid(vertices: Array, faces: NDArray[np.int64]) -> SolidIntegrals:
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


def _about(vertices: Array, faces: NDArray[np.int64]) -> tuple[float, Array, Array]:
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
