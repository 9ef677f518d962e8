"""Where a round surface comes closest to a plane or another: balls and rollers on each other, balls in bores, in
grooves of rings and on cones, tapered rollers on planes, on each other and in their rings.

Everything is analytic, so that the tessellation of neither side matters.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.higher.constants import BALL_BORE_SAMPLES, ROLLER_SAMPLES
from kinform.contacts.higher.meeting import Meeting
from kinform.contacts.higher.rings import ring
from kinform.contacts.higher.stations import evenly
from kinform.contacts.higher.tapers import tapers
from kinform.contacts.mating.charts import perpendicular
from kinform.contacts.search.pair_view import SurfacePair
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.model.arrays import Array


def meeting(surfaces: SurfacePair, parallel: float, limit: float) -> Meeting | None:
    """The closest points of a convex ball, roller or ring and of a plane or another round surface; `parallel` (rad) is
    the angle up to which a roller lies along the other, and within `limit` (m) rings are looked at. None where the
    pairing is none of these."""
    first, second = surfaces.kinds
    convex = surfaces.sides[1] > 0
    if first == "torus":
        # a ball comes first
        return None if second == "sphere" and convex else ring(surfaces, parallel, limit)
    if second == "plane":
        return _taper_on_plane(surfaces, parallel) if first == "cone" else on_plane(surfaces, parallel)
    if (first, second) == ("sphere", "sphere"):
        return _single(*surfaces.points, *surfaces.radii) if convex else _ball_in_bowl(surfaces)
    if (first, second) == ("sphere", "cylinder"):
        return _ball(surfaces)
    if (first, second) == ("sphere", "torus"):
        return _ball_on_ring(surfaces)
    if (first, second) == ("sphere", "cone"):
        return _ball_on_cone(surfaces)
    if (first, second) == ("cylinder", "cylinder"):
        return _rollers(surfaces, parallel) if convex else _roller_in_ring(surfaces, parallel)
    if second == "cone" or ((first, second) == ("cone", "cylinder") and not convex):
        return tapers(surfaces, parallel) if first in ("cylinder", "cone") else None
    return None


def on_plane(surfaces: SurfacePair, parallel: float, places: tuple[Array, float] | None = None) -> Meeting | None:
    """A ball or a roller on a plane, at `places` (n,) m along the roller, so far apart (m), else all along it."""
    (axis, normal), (point, origin), radius = surfaces.axes, surfaces.points, surfaces.radii[0]
    kind, along, spacing = surfaces.kinds[0], np.zeros(1), 0.0
    if kind == "cylinder":
        if math.asin(min(1.0, abs(float(axis @ normal)))) > parallel:
            return None
        along = evenly(*surfaces.extents[0])
        spacing = float(along[1] - along[0])
        if places is not None:
            along, spacing = places
    elif kind != "sphere":
        return None
    centres = point + along[:, None] * axis
    gaps = (centres - origin) @ normal - radius
    points = centres - (radius + 0.5 * gaps)[:, None] * normal
    return Meeting(points, np.tile(normal, (len(points), 1)), gaps, kind == "cylinder", spacing)


def _taper_on_plane(surfaces: SurfacePair, parallel: float) -> Meeting | None:
    """A cone on a plane, along the generator that is nearest to it."""
    (axis, normal), (apex, origin), half = surfaces.axes, surfaces.points, surfaces.both("half_angles")[0]
    below = axis * float(axis @ normal) - normal
    size = float(np.linalg.norm(below))
    if size < SOLVED:
        return None
    generator = math.cos(half) * axis + math.sin(half) * below / size
    if abs(float(generator @ normal)) > math.sin(parallel):
        return None
    low, high = surfaces.extents[0] / math.cos(half)
    along = low + (high - low) * (np.arange(ROLLER_SAMPLES) + 0.5) / ROLLER_SAMPLES
    on = apex + along[:, None] * generator
    gaps = (on - origin) @ normal
    radius = 0.5 * (low + high) * math.tan(half)
    normals = np.tile(normal, (len(on), 1))
    points, spacing = on - 0.5 * gaps[:, None] * normal, float(along[1] - along[0])
    return Meeting(points, normals, gaps, True, spacing, along=generator, radius=radius)


def _ball_on_cone(surfaces: SurfacePair) -> Meeting | None:
    """A ball on a cone, or seated in one all round: beside the ball, a cone is its tangent planes."""
    (centre, apex), axis, radius = surfaces.points, surfaces.axes[1], surfaces.radii[0]
    half, (low, high) = surfaces.both("half_angles")[1], surfaces.extents[1]
    arm = centre - apex
    along = float(arm @ axis)
    aside = arm - along * axis
    far = float(np.linalg.norm(aside))
    convex = surfaces.sides[1] > 0
    if convex and far < SOLVED * radius:
        return None
    base = perpendicular(axis, aside if far > SOLVED * radius else None)
    angle = 2 * math.pi * np.arange(1 if convex else BALL_BORE_SAMPLES) / BALL_BORE_SAMPLES
    outward = np.cos(angle)[:, None] * base + np.sin(angle)[:, None] * cross(axis, base)
    normals = surfaces.sides[1] * (math.cos(half) * outward - math.sin(half) * axis)
    distances = normals @ arm
    feet = along - distances * (normals @ axis)
    if not low <= float(feet[0]) <= high:
        return None
    gaps = distances - radius
    points = centre - (radius + 0.5 * gaps)[:, None] * normals
    spacing = 0.0 if convex else 2 * math.pi * radius * math.cos(half) / BALL_BORE_SAMPLES
    return Meeting(points, normals, gaps, not convex, spacing)


def _single(first: Array, second: Array, radius: float, other: float) -> Meeting | None:
    """Two balls, or two balls on the axes of what touches."""
    apart = first - second
    distance = float(np.linalg.norm(apart))
    if distance <= ARITHMETIC * (radius + other):
        return None
    normal, gap = apart / distance, distance - radius - other
    point = first - (radius + 0.5 * gap) * normal
    return Meeting(point[None], normal[None], np.array([gap]), False, 0.0)


def _ball_in_bowl(surfaces: SurfacePair) -> Meeting | None:
    """A ball that lies in a bowl, much wider than it: of one not much wider it is the ball of the socket."""
    (centre, middle), (radius, bowl) = surfaces.points, surfaces.radii
    aside = centre - middle
    distance = float(np.linalg.norm(aside))
    if distance <= ARITHMETIC * bowl or bowl <= radius:
        return None
    normal, gap = -aside / distance, bowl - radius - distance
    point, bend = centre - (radius + 0.5 * gap) * normal, bowl * radius / (bowl - radius)
    return Meeting(
        point[None], normal[None], np.array([gap]), False, 0.0, clearance=bowl - radius, radius=bend, bends=True
    )


def _ball(surfaces: SurfacePair) -> Meeting | None:
    """A ball on a roller, or in a bore."""
    (centre, point), axis, (radius, bore) = surfaces.points, surfaces.axes[1], surfaces.radii
    along = float((centre - point) @ axis)
    low, high = surfaces.extents[1]
    if not low <= along <= high:
        return None
    foot = point + along * axis
    if surfaces.sides[1] > 0:
        return _single(centre, foot, radius, bore)
    aside = centre - foot
    base = perpendicular(axis, aside if np.linalg.norm(aside) > SOLVED * bore else None)
    return _in_tube(centre, foot, axis, base, radius, bore)


def _ball_on_ring(surfaces: SurfacePair) -> Meeting | None:
    """A ball on a ring, or in the groove of one: beside the ball, a torus is a tube along its middle circle."""
    (centre, point), axis, (radius, ring) = surfaces.points, surfaces.axes[1], surfaces.radii
    tube = surfaces.both("minor_radii")[1]
    arm = centre - point
    radial = arm - axis * float(axis @ arm)
    far = float(np.linalg.norm(radial))
    if tube <= 0.0 or far <= SINGLE * ring:
        return None
    radial /= far
    foot = point + ring * radial
    if surfaces.sides[1] > 0:
        return _single(centre, foot, radius, tube)
    return _in_tube(centre, foot, cross(axis, radial), radial, radius, tube)


def _in_tube(centre: Array, foot: Array, axis: Array, base: Array, radius: float, bore: float) -> Meeting:
    """A ball at `centre` in a tube whose middle line passes `foot`, beside the ball, along `axis`; samples start
    in the direction `base`."""
    aside = centre - foot
    angle = 2 * math.pi * np.arange(BALL_BORE_SAMPLES) / BALL_BORE_SAMPLES
    outward = np.cos(angle)[:, None] * base + np.sin(angle)[:, None] * cross(axis, base)
    # how far the bore is from the ball, straight out from the ball's middle
    reach = outward @ aside
    gaps = np.sqrt(np.maximum(bore**2 - float(aside @ aside) + reach**2, 0.0)) - reach - radius
    points = centre + (radius + 0.5 * gaps)[:, None] * outward
    return Meeting(points, -outward, gaps, True, 2 * math.pi * bore / BALL_BORE_SAMPLES, bore - radius)


def _rollers(surfaces: SurfacePair, parallel: float) -> Meeting | None:
    """Two rollers, crossed or side by side."""
    (p, q), (d, e), radii = surfaces.points, surfaces.axes, surfaces.radii
    extent, other_extent = surfaces.extents
    across = cross(d, e)
    sine = float(np.linalg.norm(across))
    if sine > math.sin(parallel):
        s = float(cross(q - p, e) @ across) / sine**2
        t = float(cross(q - p, d) @ across) / sine**2
        if not (extent[0] <= s <= extent[1] and other_extent[0] <= t <= other_extent[1]):
            return None
        return _single(p + s * d, q + t * e, *radii)
    beside = _side_by_side(surfaces)
    if beside is None:
        return None
    on, apart, distance, spacing = beside
    normals, gaps = apart / distance[:, None], distance - sum(radii)
    return Meeting(on - (radii[0] + 0.5 * gaps)[:, None] * normals, normals, gaps, True, spacing)


def _roller_in_ring(surfaces: SurfacePair, parallel: float) -> Meeting | None:
    """A roller that lies along the inside of a ring, much wider than it: of one not much wider it is the shaft. About
    the normal it turns by no more than its play: its ends would go into the ring, which the line does not say."""
    (roller, ring), beside = surfaces.radii, None
    if float(np.linalg.norm(cross(*surfaces.axes))) <= math.sin(parallel):
        beside = _side_by_side(surfaces)
    if beside is None or ring <= roller:
        return None
    on, apart, distance, spacing = beside
    normals, gaps = -apart / distance[:, None], ring - roller - distance
    points, bend = on - (roller + 0.5 * gaps)[:, None] * normals, ring * roller / (ring - roller)
    return Meeting(points, normals, gaps, True, spacing, clearance=ring - roller, radius=bend, bends=True)


def _side_by_side(surfaces: SurfacePair) -> tuple[Array, Array, Array, float] | None:
    """Points (n, 3) on the axis of the first cylinder beside the other, from the other's axis to these (n, 3), how far
    that is (n,) m, and how far they are from each other (m). None where one lies on the other's axis, or neither is
    beside the other."""
    (p, q), (d, e), (extent, other_extent) = surfaces.points, surfaces.axes, surfaces.extents
    other = sorted(float((q - p) @ d) + math.copysign(1.0, float(d @ e)) * other_extent)
    low, high = max(extent[0], other[0]), min(extent[1], other[1])
    if high <= low:
        return None
    on = p + (low + (high - low) * (np.arange(ROLLER_SAMPLES) + 0.5) / ROLLER_SAMPLES)[:, None] * d
    apart = on - (q + ((on - q) @ e)[:, None] * e)
    distance = np.linalg.norm(apart, axis=1)
    if distance.min() <= ARITHMETIC * sum(surfaces.radii):
        return None
    return on, apart, distance, (high - low) / ROLLER_SAMPLES
