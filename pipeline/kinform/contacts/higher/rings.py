"""Where a ring, or another surface with a tube for its profile, comes closest to a surface: tyres on floors, links of
chains, rods through eyes, barrels in bores.

A tube is all balls about its middle circle, so that it is as far from a surface as that circle, less the radius of the
tube. Where it is so all round, as in a bore about the same axis, they touch along a line; elsewhere at the places where
the circle comes nearest.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import RIM_POINTS
from kinform.contacts.higher.beside import EXACT_KINDS, beside
from kinform.contacts.higher.constants import BALL_BORE_SAMPLES
from kinform.contacts.higher.meeting import Meeting
from kinform.contacts.higher.nearest import Circle, dips_of, evened, nearest
from kinform.contacts.mating.charts import perpendicular
from kinform.contacts.search.pair_view import SurfacePair
from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array


def ring(surfaces: SurfacePair, parallel: float, limit: float) -> Meeting | None:
    """A convex torus and another surface, no nearer and no further than `limit` (m); `parallel` (rad) is the angle up
    to which both turn about one axis."""
    if surfaces.kinds[1] not in EXACT_KINDS:
        return None
    middle, tube, kind = _middle(surfaces), surfaces.both("minor_radii")[0], surfaces.kinds[1]
    angles = _equal(RIM_POINTS)
    there = beside(surfaces.b, surfaces.column, middle.points(angles))
    low, high = tube - limit, tube + limit
    if float(there.gaps.min()) > high + middle.radius * angles[1]:
        return None
    if bool(((there.gaps >= low) & (there.gaps <= high)).all()) and _tilt(surfaces) <= parallel:
        angles = _equal(BALL_BORE_SAMPLES)
        there = beside(surfaces.b, surfaces.column, middle.points(angles))
        normals, spacing = evened(middle, angles, there.normals, kind), middle.radius * float(angles[1])
        met = _meeting(middle.points(angles), normals, there.gaps - tube, tube, spacing, middle.axis)
        return replace(met, bends=kind != "plane" and surfaces.sides[1] > 0)
    dips = dips_of(middle, angles, there, low - middle.radius * float(angles[1]), high)
    at = nearest(middle, surfaces.b, surfaces.column, dips)
    if not len(at):
        return None
    there = beside(surfaces.b, surfaces.column, middle.points(at))
    return _meeting(middle.points(at), there.normals, there.gaps - tube, tube)


def _middle(surfaces: SurfacePair) -> Circle:
    """The middle circle of the tube of the first surface."""
    axis = surfaces.axes[0]
    outward = perpendicular(axis)
    return Circle(axis, surfaces.points[0], surfaces.radii[0], np.stack([outward, cross(axis, outward)]))


def _equal(count: int) -> Array:
    """(count,) rad, evenly all round."""
    return 2.0 * math.pi * np.arange(count) / count


def _tilt(surfaces: SurfacePair) -> float:
    """rad from the axis of the first surface to that of the second, if it has one."""
    return math.asin(min(1.0, float(np.linalg.norm(cross(*surfaces.axes)))))


def _meeting(
    places: Array, normals: Array, gaps: Array, tube: float, spacing: float = 0.0, along: Array | None = None
) -> Meeting:
    """At places (n, 3) on the middle circle of a tube."""
    points = places - (tube + 0.5 * gaps)[:, None] * normals
    return Meeting(points, normals, gaps, along is not None, spacing, along=along, radius=tube)
