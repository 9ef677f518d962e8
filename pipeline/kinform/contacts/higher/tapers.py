"""Where a cone or a roller comes closest to a cone or in one: along a generator that both share, as tapered rollers
side by side and in their rings, or at a point, where they cross."""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.constants import FACING_OPPOSED
from kinform.contacts.higher.beside import beside
from kinform.contacts.higher.constants import ROLLER_SAMPLES
from kinform.contacts.higher.meeting import Meeting
from kinform.contacts.search.pair_view import SurfacePair
from kinform.foundation.algebra.vectors import cross, foot
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class _Generator:
    """A straight line on a cone, or on a cylinder, whose half-angle is nothing."""

    start: Array
    """(3,) m: the apex, or beside the point on the axis."""
    along: Array
    """(3,) unit, away from the apex."""
    normal: Array
    """(3,) away from the axis."""
    low: float
    high: float
    """m along it, from the start."""


def tapers(surfaces: SurfacePair, parallel: float) -> Meeting | None:
    """A convex cone or roller and another cone or roller; `parallel` (rad) is the angle up to which they share a
    generator."""
    line = _side_by_side(surfaces, parallel)
    if line is not None or surfaces.sides[1] < 0:
        return line
    return _crossed(surfaces, parallel)


def _generator(surfaces: SurfacePair, k: int, outward: Array) -> _Generator:
    """That of the first (0) or second (1) surface in the direction `outward`, a unit vector across its axis."""
    axis, half = surfaces.axes[k], surfaces.both("half_angles")[k]
    start = surfaces.points[k] if half else surfaces.points[k] + surfaces.radii[k] * outward
    low, high = surfaces.extents[k] / math.cos(half)
    along, normal = (
        math.cos(half) * axis + math.sin(half) * outward,
        math.cos(half) * outward - math.sin(half) * axis,
    )
    return _Generator(start, along, normal, float(low), float(high))


def _side_by_side(surfaces: SurfacePair, parallel: float) -> Meeting | None:
    """Both along a generator of the first in the plane of both axes: the nearer one of two."""
    towards = _towards(surfaces)
    if towards is None:
        return None
    lines = [_along(surfaces, _generator(surfaces, 0, sense * towards), parallel) for sense in (1.0, -1.0)]
    met = [line for line in lines if line is not None]
    return min(met, key=lambda line: float(np.abs(line.gaps).min())) if met else None


def _towards(surfaces: SurfacePair) -> Array | None:
    """(3,) unit: across the axis of the first surface, in the plane of both axes, in either sense; None where they are
    one. It is the direction to the other axis or, where that is nearly met, of it."""
    (axis, other), (point, far) = surfaces.axes, surfaces.points
    on_axis = foot(point, axis, surfaces.box()[0])
    scale = max(*surfaces.radii, float(np.abs(surfaces.extents[0]).max()))
    arms = [(foot(far, other, on_axis) - on_axis) / scale, other]
    across = [arm - float(arm @ axis) * axis for arm in arms]
    sizes = [float(np.linalg.norm(arm)) for arm in across]
    best = 0 if sizes[0] >= sizes[1] else 1
    return across[best] / sizes[best] if sizes[best] > SOLVED else None


def _along(surfaces: SurfacePair, line: _Generator, parallel: float) -> Meeting | None:
    """The second surface along a generator of the first."""
    ends = line.start + np.array([[line.low], [line.high]]) * line.along
    feet = _feet(surfaces, ends)
    if feet[0] == feet[1]:
        return None
    shares = np.sort((surfaces.extents[1] - feet[0]) / (feet[1] - feet[0]))
    low, high = (line.low + np.clip(shares, 0.0, 1.0) * (line.high - line.low)).tolist()
    if high <= low:
        return None
    on = line.start + (low + (high - low) * _SHARES)[:, None] * line.along
    met = beside(surfaces.b, surfaces.column, on)
    slope = float(np.abs(met.normals @ line.along).max())
    if slope > math.sin(parallel) or float((met.normals @ line.normal).max()) > FACING_OPPOSED:
        return None
    points = on - 0.5 * met.gaps[:, None] * met.normals
    middle = float(on.mean(axis=0) @ surfaces.axes[0])
    spacing, radius = (high - low) / ROLLER_SAMPLES, _radius(surfaces, 0, middle)
    hollow = surfaces.sides[1] < 0
    return Meeting(points, met.normals, met.gaps, True, spacing, along=line.along, radius=radius, bends=hollow)


def _crossed(surfaces: SurfacePair, parallel: float) -> Meeting | None:
    """At a point: its normal leans against either axis as all normals of that surface do."""
    (axis, other), (first, second) = surfaces.axes, (math.sin(half) for half in surfaces.both("half_angles"))
    across, cosine = cross(axis, other), float(axis @ other)
    square = float(across @ across)
    if square <= math.sin(parallel) ** 2:
        return None
    # outward from the first: minus the sine of its half-angle along its own axis, plus that of the other along that
    x, y = -(first + cosine * second) / square, (second + cosine * first) / square
    level = x * axis + y * other
    rest = (1.0 - float(level @ level)) / square
    if rest <= 0.0:
        return None
    best: Meeting | None = None
    for normal in (level + math.sqrt(rest) * across, level - math.sqrt(rest) * across):
        met = _at(surfaces, normal, parallel)
        if met is not None and (best is None or abs(met.gaps[0]) < abs(best.gaps[0])):
            best = met
    return best


def _at(surfaces: SurfacePair, normal: Array, parallel: float) -> Meeting | None:
    """The meeting of the two generators at which `normal` is that of the first, and its opposite that of the other."""
    lines = []
    for k, out in ((0, normal), (1, -normal)):
        across = out - float(out @ surfaces.axes[k]) * surfaces.axes[k]
        lines.append(_generator(surfaces, k, across / np.linalg.norm(across)))
    one, two = lines
    across = cross(one.along, two.along)
    square = float(across @ across)
    if square <= math.sin(parallel) ** 2:
        return None
    between = two.start - one.start
    s = float(cross(between, two.along) @ across) / square
    t = float(cross(between, one.along) @ across) / square
    if not (one.low <= s <= one.high and two.low <= t <= two.high):
        return None
    gap = float(between @ normal)
    point = one.start + s * one.along + 0.5 * gap * normal
    radius = _radius(surfaces, 0, float(point @ surfaces.axes[0]))
    return Meeting(point[None], -normal[None], np.array([gap]), False, 0.0, radius=radius)


def _feet(surfaces: SurfacePair, points: Array) -> Array:
    """(n,) m along the axis of the second surface, from its point, where it is nearest to points (n, 3)."""
    arm, axis, half = points - surfaces.points[1], surfaces.axes[1], surfaces.both("half_angles")[1]
    along = arm @ axis
    far = np.linalg.norm(arm - along[:, None] * axis, axis=1)
    return np.asarray(math.cos(half) * (math.cos(half) * along + math.sin(half) * far) if half else along)


def _radius(surfaces: SurfacePair, k: int, height: float) -> float:
    """m: of a surface at a height along its axis, from the origin."""
    half, start = surfaces.both("half_angles")[k], float(surfaces.points[k] @ surfaces.axes[k])
    return (height - start) * math.tan(half) if half else surfaces.radii[k]


_SHARES = (np.arange(ROLLER_SAMPLES) + 0.5) / ROLLER_SAMPLES
"""Shares of a line at which samples stand: the middles of its equal parts."""
