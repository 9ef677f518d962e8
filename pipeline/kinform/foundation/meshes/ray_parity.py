"""Parity of rays: through how many facets a point leaves a mesh, less those that it enters through.

A facet that a file has twice is one: counted twice, it would make an inside of all that lies before it.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.foundation.constants import ROWS
from kinform.foundation.meshes.boxes import FlatBoxes, facet_boxes
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh

RAYS = np.array([[0.577, 0.523, 0.627], [-0.67, 0.31, 0.675], [0.21, -0.83, 0.517]])
"""(3, 3) directions that no designer lays an edge along: rays rarely graze an edge."""


class Ray:
    """A mesh as seen along one direction."""

    def __init__(self, mesh: Mesh, ray: Array):
        ray = ray / np.linalg.norm(ray)
        u = -perpendicular(ray)[0]
        self._frame = np.stack([u, cross(ray, u), ray])
        vertices = mesh.vertices @ self._frame.T
        self._columns = np.ascontiguousarray(vertices.T)
        faces = once(mesh.faces) if mesh.health.duplicate_facets else mesh.faces
        self._corners = np.ascontiguousarray(faces.T)
        self._boxes = FlatBoxes(*facet_boxes(vertices[:, :2], faces), facet_boxes(self._columns[2], faces)[1])

    def crossings(self, points: Array) -> Array:
        """(n,) facets that the ray from each point (n, 3) leaves through, less those that it enters through."""
        seen = points @ self._frame.T
        # of a facet that lies behind a point, all three terms of its place along the ray are below 0
        which, facets = self._boxes.around(seen[:, :2], seen[:, 2])
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


class Inside:
    """What of space a mesh holds: the median of the crossings of three rays.

    Open and inside-out meshes have an inside as far as two of three rays agree on it.
    """

    def __init__(self, mesh: Mesh):
        self._mesh = mesh
        self._rays: dict[int, Ray] = {}

    def contains(self, points: Array) -> Flags:
        """(n,) whether points (n, 3) of the part frame lie inside."""
        low, high = self._mesh.box
        out = np.asarray(((points >= low) & (points <= high)).all(axis=1))
        if not out.any():
            return out
        within = points[out]
        count = self._crossings(0, within)
        # of a closed mesh, one ray that leaves through as many facets as it enters through says enough
        asked = np.flatnonzero(count) if self._mesh.health.watertight else np.arange(len(within))
        if len(asked):
            second = self._crossings(1, within[asked])
            # two rays that agree are the median whatever the third says
            doubtful = count[asked] != second
            if doubtful.any():
                third = self._crossings(2, within[asked[doubtful]])
                count[asked[doubtful]] = np.sort([count[asked[doubtful]], second[doubtful], third], axis=0)[1]
        out[out] = np.abs(count) > 0.5
        return out

    def _crossings(self, ray: int, points: Array) -> Array:
        """(n,) of one of the three rays from points; the last one is rarely asked for."""
        if ray not in self._rays:
            self._rays[ray] = Ray(self._mesh, RAYS[ray])
        return self._rays[ray].crossings(points)


def winding(mesh: Mesh, points: Array) -> Array:
    """(n,) how often the facets go round points (n, 3): 1 inside of a closed mesh, 0 outside, and between the two
    beside what is missing of an open one, ½ in the middle of a gap. Each facet by the solid angle that it is seen under
    (Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30, 1983)."""
    columns, corners = np.ascontiguousarray(mesh.vertices.T), once(mesh.faces).T
    out = np.zeros(len(points))
    for begin in range(0, corners.shape[1], ROWS):
        facets = columns[:, corners[:, begin : begin + ROWS]]
        some = max(1, ROWS // facets.shape[2])
        for start in range(0, len(points), some):
            out[start : start + some] += _solid_angles(facets, points[start : start + some]).sum(axis=1)
    return out / (4.0 * np.pi)


def _solid_angles(facets: Array, points: Array) -> Array:
    """(n, m) of facets (3, 3, m), coordinate by coordinate and corner by corner, from points (n, 3)."""
    x, y, z = (column[:, None] - points[:, axis, None] for axis, column in enumerate(facets))
    (ax, bx, cx), (ay, by, cy), (az, bz, cz) = x, y, z
    la, lb, lc = np.sqrt(x * x + y * y + z * z)
    ab, bc, ca = ax * bx + ay * by + az * bz, bx * cx + by * cy + bz * cz, cx * ax + cy * ay + cz * az
    above = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return np.asarray(2.0 * np.arctan2(above, la * lb * lc + ab * lc + bc * la + ca * lb))


def once(faces: Ints) -> Ints:
    """Facets (m, 3) without those that are there already, the same way round."""
    begun = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    _, first = np.unique(begun, axis=0, return_index=True)
    return np.ascontiguousarray(faces[np.sort(first)])
