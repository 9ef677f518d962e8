"""Area-preserving maps between an analytic surface and the plane, where overlaps are cut as polygons.

Plane: itself. Cylinder and cone: developed. Sphere: Lambert's azimuthal projection. A chart has a
base direction (an azimuth, or a pole) that should point into the region of interest: the seam, or the
point that the projection cannot show, lies opposite. Lengths in m, one frame throughout.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Protocol

import numpy as np

from kinform.foundation.algebra import vectors
from kinform.foundation.algebra.vectors import cross, lengths, norm, times
from kinform.foundation.meshes.boxes import middles
from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

CHART_ARC = math.radians(15.0)
"""rad: angle of a curved surface that one sample stands for: its normal is then within 7.5°. Chosen, not measured."""
CHART_FAR = 1e3
"""Radii to which charts of cylinders and cones reach: more than any part that turns. Chosen, not measured."""
SEEN_FROM_AXIS = 1e-3
"""Distance from the axis or centre, in radii, below which a point gives no direction to look in. Chosen, not
measured."""


class Chart(Protocol):
    """What the overlay needs of a surface."""

    @property
    def step(self) -> tuple[float, float]:
        """Greatest size (m), along both coordinates, of a piece that one sample may stand for."""
        ...

    def flatten(self, triangles: Array) -> Array:
        """(n, 3, 3) facets as (m, 3, 2); facets across the seam come twice."""
        ...

    def window(self) -> Array | None:
        """(k, 2) polygon outside of which the map repeats itself; None where it does not."""
        ...

    def lift(self, flat: Array) -> Array:
        """(n, 2) → (n, 3) on the surface."""
        ...

    def normals(self, points: Array) -> Array:
        """(n, 3) unit normals at points: away from the axis or the centre; of a plane, its axis."""
        ...

    def heights(self, points: Array) -> Array:
        """(n,) m above the surface, along its normals."""
        ...


def perpendicular(axis: Array, hint: Array | None = None) -> Array:
    """A unit vector perpendicular to `axis`, towards `hint` where that says anything."""
    if hint is not None:
        across = hint - (hint @ axis) * axis
        length = norm(across)
        if length > SINGLE * max(norm(hint), TINY):
            return np.asarray(across / length)
    return -vectors.perpendicular(axis)[0]


def plane_basis(axis: Array) -> Array:
    """(2, 3) unit vectors that make a right-handed frame with the unit axis (3,)."""
    first = perpendicular(axis)
    return np.array([first, cross(axis, first)])


def _unit_rows(rows: Array) -> Array:
    """Vectors (…, 3) of length one; zero vectors stay."""
    length = lengths(rows)[..., None]
    if not length.all():
        length[length == 0.0] = 1.0
    return np.asarray(rows / length)


@dataclass(frozen=True, eq=False)
class PlaneChart:
    """A plane through `point` with unit normal `axis`."""

    axis: Array
    point: Array
    step: tuple[float, float] = (math.inf, math.inf)

    @cached_property
    def basis(self) -> Array:
        """(2, 3) of the coordinates."""
        return plane_basis(self.axis)

    def flatten(self, triangles: Array) -> Array:
        return times(triangles - self.point, self.basis.T)

    def window(self) -> Array | None:
        return None

    def lift(self, flat: Array) -> Array:
        return np.asarray(self.point + flat @ self.basis)

    def normals(self, points: Array) -> Array:
        return np.repeat(self.axis[None], len(points), axis=0)

    def heights(self, points: Array) -> Array:
        return np.asarray((points - self.point) @ self.axis)


@dataclass(frozen=True, eq=False)
class _Axial:
    """What charts about an axis share. `base`: unit, across the axis, azimuth 0."""

    axis: Array
    point: Array
    base: Array

    @cached_property
    def side(self) -> Array:
        """(3,) unit, across the axis, azimuth π/2."""
        return cross(self.axis, self.base)

    def _arms(self, points: Array) -> tuple[Array, Array]:
        """Height along the axis of points (…, 3), and what leads to them across it (…, 3)."""
        arm = points - self.point
        along = times(arm, self.axis)
        return along, arm - along[..., None] * self.axis

    def _azimuth(self, across: Array) -> Array:
        """(…,) in [−π, π] of vectors across the axis (…, 3)."""
        return np.asarray(np.arctan2(times(across, self.side), times(across, self.base)))

    def _unrolled(self, triangles: Array) -> tuple[Array, Array, Array]:
        """Height, radius and azimuth (n, 3) of the corners, each azimuth within π of its centroid's."""
        along, across = self._arms(triangles)
        radius = lengths(across)
        middle = self._azimuth(self._arms(middles(triangles))[1])[:, None]
        turn = self._azimuth(across) - middle
        turn -= 2.0 * math.pi * np.rint(turn / (2.0 * math.pi))
        turn = np.where(radius > SOLVED * radius.max(initial=0.0), turn, 0.0)
        return along, radius, middle + turn

    def _radial(self, azimuth: Array) -> Array:
        return np.asarray(np.cos(azimuth)[..., None] * self.base + np.sin(azimuth)[..., None] * self.side)


def _repeated(azimuth: Array) -> tuple[Ints, Array]:
    """Rows to use and their azimuths, with rows that cross the seam at ±π repeated on its other side."""
    rows = np.arange(len(azimuth))
    if not len(rows) or max(float(azimuth.max()), -float(azimuth.min())) <= math.pi:
        return rows, azimuth
    over = np.nonzero((azimuth > math.pi).any(axis=1))[0]
    under = np.nonzero((azimuth < -math.pi).any(axis=1))[0]
    turned = [azimuth, azimuth[over] - 2.0 * math.pi, azimuth[under] + 2.0 * math.pi]
    return np.concatenate([rows, over, under]).astype(np.int64), np.concatenate(turned)


@dataclass(frozen=True, eq=False)
class CylinderChart(_Axial):
    """A cylinder: (arc length, height)."""

    radius: float

    @property
    def step(self) -> tuple[float, float]:
        return CHART_ARC * self.radius, math.inf

    def flatten(self, triangles: Array) -> Array:
        along, _, azimuth = self._unrolled(triangles)
        rows, turned = _repeated(azimuth)
        out = np.empty((*turned.shape, 2))
        np.multiply(self.radius, turned, out=out[..., 0])
        out[..., 1] = along if len(rows) == len(along) else along[rows]
        return out

    def window(self) -> Array | None:
        half, far = math.pi * self.radius, CHART_FAR * self.radius
        return np.array([[-half, -far], [half, -far], [half, far], [-half, far]])

    def lift(self, flat: Array) -> Array:
        radial = self._radial(flat[:, 0] / self.radius)
        return np.asarray(self.point + self.radius * radial + flat[:, 1:] * self.axis)

    def normals(self, points: Array) -> Array:
        return _unit_rows(self._arms(points)[1])

    def heights(self, points: Array) -> Array:
        return np.asarray(lengths(self._arms(points)[1]) - self.radius)


@dataclass(frozen=True, eq=False)
class ConeChart(_Axial):
    """A cone with its apex at `point`, opening along `axis`: developed about the apex."""

    half_angle: float
    middle: float
    """Radius in the region of interest (m)."""

    @property
    def step(self) -> tuple[float, float]:
        return CHART_ARC * self.middle, CHART_ARC * self.middle

    def flatten(self, triangles: Array) -> Array:
        along, radius, azimuth = self._unrolled(triangles)
        slant = along * math.cos(self.half_angle) + radius * math.sin(self.half_angle)
        rows, turned = _repeated(azimuth)
        angle = turned * math.sin(self.half_angle)
        return np.asarray(slant[rows][..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=2))

    def window(self) -> Array | None:
        half = math.pi * math.sin(self.half_angle)
        angles = np.linspace(-half, half, 9)
        far = CHART_FAR * self.middle / math.sin(self.half_angle)
        return np.concatenate([np.zeros((1, 2)), far * np.stack([np.cos(angles), np.sin(angles)], axis=1)])

    def lift(self, flat: Array) -> Array:
        slant = lengths(flat)
        azimuth = np.arctan2(flat[:, 1], flat[:, 0]) / math.sin(self.half_angle)
        ray = math.cos(self.half_angle) * self.axis + math.sin(self.half_angle) * self._radial(azimuth)
        return np.asarray(self.point + slant[:, None] * ray)

    def normals(self, points: Array) -> Array:
        radial = _unit_rows(self._arms(points)[1])
        return np.asarray(math.cos(self.half_angle) * radial - math.sin(self.half_angle) * self.axis)

    def heights(self, points: Array) -> Array:
        along, across = self._arms(points)
        radius = lengths(across)
        return np.asarray(radius * math.cos(self.half_angle) - along * math.sin(self.half_angle))


@dataclass(frozen=True, eq=False)
class SphereChart:
    """A sphere about `point`, seen from `pole` (unit): Lambert's azimuthal equal-area projection."""

    point: Array
    radius: float
    pole: Array

    @property
    def step(self) -> tuple[float, float]:
        return CHART_ARC * self.radius, CHART_ARC * self.radius

    @staticmethod
    def seen_from(centre: Array, radius: float, towards: Array) -> SphereChart:
        """The chart whose pole looks towards a point (3,)."""
        arm = towards - centre
        distance = norm(arm)
        seen = distance > SEEN_FROM_AXIS * radius
        return SphereChart(centre, radius, arm / distance if seen else np.array([0.0, 0.0, 1.0]))

    def flatten(self, triangles: Array) -> Array:
        rays = _unit_rows(triangles - self.point)
        rise = times(rays, self.pole)
        # beyond this angle from the pole Lambert's projection would tear facets apart
        shown = middles(rays) @ self.pole > -0.97
        rays, rise = rays[shown], rise[shown]
        stretch = self.radius * np.sqrt(2.0 / np.maximum(1.0 + rise, SOLVED))
        return np.asarray(stretch[..., None] * times(rays, plane_basis(self.pole).T))

    def window(self) -> Array | None:
        return None

    def lift(self, flat: Array) -> Array:
        distance = lengths(flat)
        angle = 2.0 * np.arcsin(np.clip(distance / (2.0 * self.radius), 0.0, 1.0))
        ray = (flat / np.where(distance > 0.0, distance, 1.0)[:, None]) @ plane_basis(self.pole)
        rise = np.cos(angle)[:, None] * self.pole + np.sin(angle)[:, None] * ray
        return np.asarray(self.point + self.radius * rise)

    def normals(self, points: Array) -> Array:
        return _unit_rows(points - self.point)

    def heights(self, points: Array) -> Array:
        return np.asarray(lengths(points - self.point) - self.radius)
