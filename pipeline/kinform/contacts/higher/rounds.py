"""Where two round surfaces come closest: balls and rollers on each other, balls in bores and in grooves of rings.

Everything is analytic, so that the tessellation of neither side matters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinform.contacts.mating.charts import perpendicular
from kinform.contacts.search.placed import NearSurfaces
from kinform.model.arrays import Array
from kinform.model.surfaces import KINDS

__all__ = ["Meeting", "meeting"]


_AROUND = 16
"""Samples around a ball in a bore."""
_ALONG = 17
"""Samples along a line between two rollers."""


@dataclass(frozen=True, eq=False)
class Meeting:
    """Points (n, 3) between two surfaces, normals (n, 3) from the second towards the first, gaps (n,) m."""

    points: Array
    normals: Array
    gaps: Array
    line: bool
    spacing: float
    clearance: float | None = None
    """m: by how much a bore or groove is wider than the ball in it, as a radius."""


def meeting(a: NearSurfaces, b: NearSurfaces, row: int, column: int, parallel: float) -> Meeting | None:
    """The closest points of a convex ball or roller and of another round surface; `parallel` (rad) is the angle
    up to which two rollers lie side by side. None where the pairing is none of these."""
    kinds = (KINDS[a.kinds[row]], KINDS[b.kinds[column]])
    if kinds == ("sphere", "sphere") and b.sides[column] > 0:
        return _single(a.points[row], b.points[column], float(a.radii[row]), float(b.radii[column]))
    if kinds == ("sphere", "cylinder"):
        return _ball(a, b, row, column)
    if kinds == ("sphere", "torus"):
        return _ball_on_ring(a, b, row, column)
    if kinds == ("cylinder", "cylinder") and b.sides[column] > 0:
        return _rollers(a, b, row, column, parallel)
    return None


def _single(first: Array, second: Array, radius: float, other: float) -> Meeting | None:
    """Two balls, or two balls on the axes of what touches."""
    apart = first - second
    distance = float(np.linalg.norm(apart))
    if distance <= 1e-12 * (radius + other):
        return None
    normal, gap = apart / distance, distance - radius - other
    point = first - (radius + 0.5 * gap) * normal
    return Meeting(point[None], normal[None], np.array([gap]), False, 0.0)


def _ball(a: NearSurfaces, b: NearSurfaces, row: int, column: int) -> Meeting | None:
    """A ball on a roller, or in a bore."""
    centre, axis, radius, bore = a.points[row], b.axes[column], float(a.radii[row]), float(b.radii[column])
    along = float((centre - b.points[column]) @ axis)
    low, high = b.extents[column]
    if not low <= along <= high:
        return None
    foot = b.points[column] + along * axis
    if b.sides[column] > 0:
        return _single(centre, foot, radius, bore)
    aside = centre - foot
    base = perpendicular(axis, aside if np.linalg.norm(aside) > 1e-9 * bore else None)
    return _in_tube(centre, foot, axis, base, radius, bore)


def _ball_on_ring(a: NearSurfaces, b: NearSurfaces, row: int, column: int) -> Meeting | None:
    """A ball on a ring, or in the groove of one: beside the ball, a torus is a tube along its middle circle."""
    centre, axis, tube = a.points[row], b.axes[column], float(b.minor_radii[column])
    arm = centre - b.points[column]
    radial = arm - axis * float(axis @ arm)
    far = float(np.linalg.norm(radial))
    if tube <= 0.0 or far <= 1e-6 * float(b.radii[column]):
        return None
    radial /= far
    foot = b.points[column] + float(b.radii[column]) * radial
    if b.sides[column] > 0:
        return _single(centre, foot, float(a.radii[row]), tube)
    return _in_tube(centre, foot, np.cross(axis, radial), radial, float(a.radii[row]), tube)


def _in_tube(centre: Array, foot: Array, axis: Array, base: Array, radius: float, bore: float) -> Meeting:
    """A ball at `centre` in a tube whose middle line passes `foot`, beside the ball, along `axis`; samples start
    in the direction `base`."""
    aside = centre - foot
    angle = 2 * math.pi * np.arange(_AROUND) / _AROUND
    outward = np.cos(angle)[:, None] * base + np.sin(angle)[:, None] * np.cross(axis, base)
    # how far the bore is from the ball, straight out from the ball's middle
    reach = outward @ aside
    gaps = np.sqrt(np.maximum(bore**2 - float(aside @ aside) + reach**2, 0.0)) - reach - radius
    points = centre + (radius + 0.5 * gaps)[:, None] * outward
    return Meeting(points, -outward, gaps, True, 2 * math.pi * bore / _AROUND, bore - radius)


def _rollers(a: NearSurfaces, b: NearSurfaces, row: int, column: int, parallel: float) -> Meeting | None:
    """Two rollers, crossed or side by side."""
    (p, d), (q, e) = (a.points[row], a.axes[row]), (b.points[column], b.axes[column])
    radii = (float(a.radii[row]), float(b.radii[column]))
    across = np.cross(d, e)
    sine = float(np.linalg.norm(across))
    if sine > math.sin(parallel):
        s = float(np.cross(q - p, e) @ across) / sine**2
        t = float(np.cross(q - p, d) @ across) / sine**2
        if not (a.extents[row][0] <= s <= a.extents[row][1] and b.extents[column][0] <= t <= b.extents[column][1]):
            return None
        return _single(p + s * d, q + t * e, *radii)
    other = sorted(float((q - p) @ d) + math.copysign(1.0, float(d @ e)) * b.extents[column])
    low, high = max(a.extents[row][0], other[0]), min(a.extents[row][1], other[1])
    if high <= low:
        return None
    on = p + (low + (high - low) * (np.arange(_ALONG) + 0.5) / _ALONG)[:, None] * d
    feet = q + ((on - q) @ e)[:, None] * e
    apart = on - feet
    distance = np.linalg.norm(apart, axis=1)
    if distance.min() <= 1e-12:
        return None
    normals, gaps = apart / distance[:, None], distance - sum(radii)
    return Meeting(on - (radii[0] + 0.5 * gaps)[:, None] * normals, normals, gaps, True, (high - low) / _ALONG)
