"""Parity of rays: through how many facets a point leaves a mesh, less those that it enters through."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.foundation.meshes.boxes import FlatBoxes, facet_boxes
from kinform.model.arrays import Array
from kinform.model.assembly import Mesh


class Ray:
    """A mesh as seen along one direction."""

    def __init__(self, mesh: Mesh, ray: Array):
        ray = ray / np.linalg.norm(ray)
        u = -perpendicular(ray)[0]
        self._frame = np.stack([u, cross(ray, u), ray])
        self._vertices = mesh.vertices @ self._frame.T
        self._faces = mesh.faces
        self._boxes = FlatBoxes(*facet_boxes(self._vertices[:, :2], mesh.faces))

    def crossings(self, points: Array) -> Array:
        """(n,) facets that the ray from each point (n, 3) leaves through, less those that it enters through."""
        seen = points @ self._frame.T
        which, facets = self._boxes.around(seen[:, :2])
        corners = self._vertices[self._faces[facets]] - seen[which, None]
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (corners[:, i].T for i in range(3))
        a, b, c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
        total = a + b + c
        inside = ((a > 0) & (b > 0) & (c > 0)) | ((a < 0) & (b < 0) & (c < 0))
        height = (a * az + b * bz + c * cz) / np.where(total != 0, total, 1.0)
        leaving = np.where(inside & (height > 0), np.sign(total), 0.0)
        return np.asarray(np.bincount(which, leaving, minlength=len(points)), dtype=np.float64)
