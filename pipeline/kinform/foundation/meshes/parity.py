"""Parity of rays: through how many facets a point leaves a mesh, less those that it enters through."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.foundation.meshes.boxes import FlatBoxes, facet_boxes
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh


class Ray:
    """A mesh as seen along one direction."""

    def __init__(self, mesh: Mesh, ray: Array):
        ray = ray / np.linalg.norm(ray)
        u = -perpendicular(ray)[0]
        self._frame = np.stack([u, cross(ray, u), ray])
        vertices = mesh.vertices @ self._frame.T
        self._columns = np.ascontiguousarray(vertices.T)
        self._corners = np.ascontiguousarray(mesh.faces.T)
        self._boxes = FlatBoxes(*facet_boxes(vertices[:, :2], mesh.faces))

    def crossings(self, points: Array) -> Array:
        """(n,) facets that the ray from each point (n, 3) leaves through, less those that it enters through."""
        seen = points @ self._frame.T
        which, facets = self._boxes.around(seen[:, :2])
        (ax, ay), (bx, by), (cx, cy) = (self._from(seen, which, facets, corner, (0, 1)) for corner in range(3))
        a, b, c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
        held = np.flatnonzero(((a > 0) & (b > 0) & (c > 0)) | ((a < 0) & (b < 0) & (c < 0)))
        # most facets whose box a ray meets are beside it: only of the others is it asked on which side of the point
        which, facets, a, b, c = which[held], facets[held], a[held], b[held], c[held]
        az, bz, cz = (self._from(seen, which, facets, corner, (2,))[0] for corner in range(3))
        total = a + b + c
        leaving = np.where((a * az + b * bz + c * cz) / total > 0, np.sign(total), 0.0)
        return np.asarray(np.bincount(which, leaving, minlength=len(points)), dtype=np.float64)

    def _from(self, seen: Array, which: Ints, facets: Ints, corner: int, axes: tuple[int, ...]) -> list[Array]:
        """(k,) each: where one corner of facets (k,) lies from points, along some axes of the frame."""
        vertices = self._corners[corner][facets]
        return [self._columns[axis][vertices] - seen[which, axis] for axis in axes]
