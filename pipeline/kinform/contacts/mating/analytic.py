"""Two analytic surfaces of one kind that mate: planes on planes, cylinders in bores, cones in cones, balls in sockets.

Planes oppose each other within the alignment. Of curved surfaces one is convex and one concave, with axes or centres as
close as clearance and fit allow; angle and offset are judged where the two surfaces engage, never at a far point of an
axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.mating.charts import (
    SEEN_FROM_AXIS,
    ConeChart,
    CylinderChart,
    PlaneChart,
    SphereChart,
    perpendicular,
)
from kinform.contacts.mating.mate import (
    MATING_OFFSET,
    MATING_TILT,
    Axes,
    Mate,
    aligned,
    mean_axes,
    mean_direction,
    mean_position,
    radial_limit,
)
from kinform.contacts.search.pair_view import PairView, SurfacePair
from kinform.foundation.algebra.vectors import cross, dot, lengths, norm
from kinform.model.arrays import Array, Flags
from kinform.model.surfaces import SurfaceKind

TILT_LIKELY = 1.5
"""Angles of axes up to this many times the limit are looked at: uncertainties add to it. Chosen, not measured."""


def analytic_mates(pair: PairView, reach: float) -> list[Mate]:
    """Mates of planes, then of cylinders, cones and spheres, of surfaces whose boxes come within `reach` (m)."""
    overlap = pair.overlap(reach)
    both = pair.near[0].present & pair.near[1].present
    return [mate for kind, mates in _MATES.items() if kind in both for mate in mates(pair, overlap)]


def _plane_mates(pair: PairView, overlap: Flags) -> Iterator[Mate]:
    """Opposed planes among the surfaces flagged in `overlap` (s, t)."""
    a, b = pair.near
    rows, columns, flags = pair.of_kinds(overlap, "plane")
    if not flags.any():
        return
    at, of = np.nonzero(flags)
    rows, columns = rows[at], columns[of]
    first, second = a.axes[rows], b.axes[columns]
    angle = np.arctan2(lengths(cross(first, second)), -dot(first, second))
    allowed = pair.tolerances.alignment + a.axis_uncertainty[rows] + b.axis_uncertainty[columns]
    for k in np.flatnonzero(angle <= allowed):
        mate = _plane_mate(pair.surfaces(rows[k], columns[k]), float(angle[k]), pair.tolerance)
        if mate is not None:
            yield mate


def _plane_mate(surfaces: SurfacePair, angle: float, tolerance: float) -> Mate | None:
    """The mate of two opposed planes, unless they are apart everywhere in their common box."""
    middle, size = surfaces.box()
    (first, second), (on_first, on_second) = surfaces.axes, surfaces.points
    normal, _, turn = mean_direction(first, -second, surfaces.turns)
    # Heights above both planes add up to the gap, whatever the point's own height in between.
    above_a, above_b = float((middle - on_first) @ first), float((middle - on_second) @ second)
    gap = above_a + above_b
    tilt = angle * norm(size)
    # the common box of two faces is thinnest across them: its middle side is their smaller extent
    # a gap of more than half of the smaller face is no contact
    limit = MATING_REACH * min(tolerance, 0.5 * sorted(size.tolist())[1])
    if abs(gap) > limit + tilt:
        return None
    half = middle + 0.5 * (above_b - above_a) * normal
    # mean width of a lens between an arc and its chord, over the greatest (2/3), rounded up: polygons with different
    # corners on one circle overlap in such lenses
    return Mate(
        surfaces,
        kind="plane",
        chart=PlaneChart(normal, half),
        sign=1.0,
        axis=normal,
        point=half,
        gap=gap,
        gradient=first + second,
        limit=limit,
        slack=surfaces.slack + tilt,
        misalignment=angle,
        uncertainty=(turn, sum(surfaces.shifts)),
        mismatch=(sum(surfaces.turns), sum(surfaces.shifts)),
        thin=min(0.7 * sum(surfaces.both("rims")), tolerance),
    )


def _cylinder_mates(pair: PairView, overlap: Flags) -> Iterator[Mate]:
    """Shafts in bores among the surfaces flagged in `overlap` (s, t)."""
    for surfaces in _nearly_coaxial(pair, overlap, "cylinder"):
        mate = cylinder_mate(pair, surfaces)
        if mate is not None:
            yield mate


def cylinder_mate(pair: PairView, surfaces: SurfacePair) -> Mate | None:
    """The mate of a shaft and a bore, unless their radii or axes do not agree."""
    radii, side = surfaces.radii, surfaces.sides[0]
    gap = (radii[1] - radii[0]) * side
    limit = radial_limit(pair.play, min(radii))
    length, middle = _engaged(surfaces)
    if abs(gap) > limit or length <= 0.0:
        return None
    axes = mean_axes(surfaces, middle)
    if not aligned(pair, axes, gap, length):
        return None
    radius = 0.5 * (radii[0] + radii[1])
    return Mate(
        surfaces,
        kind="cylinder",
        chart=CylinderChart(axes.axis, axes.point, _base(surfaces, axes, radius), radius),
        sign=side,
        axis=axes.axis,
        point=axes.point,
        radii=radii,
        gap=gap,
        limit=limit,
        slack=axes.offset + 0.5 * axes.misalignment * length + surfaces.slack,
        misalignment=axes.misalignment,
        offset=axes.offset,
        uncertainty=axes.uncertainty,
        mismatch=axes.mismatch,
    )


def _cone_mates(pair: PairView, overlap: Flags) -> Iterator[Mate]:
    """Tapers in sockets of the same half-angle among the surfaces flagged in `overlap` (s, t)."""
    limit = MATING_REACH * pair.tolerance
    for surfaces in _nearly_coaxial(pair, overlap, "cone"):
        angles, side = surfaces.both("half_angles"), surfaces.sides[0]
        unlike = abs(angles[1] - angles[0])
        first, second = surfaces.axes
        if first @ second < 0.0 or unlike > pair.tolerances.alignment + sum(surfaces.turns):
            continue
        length, middle = _engaged(surfaces)
        if length <= 0.0:
            continue
        axes = mean_axes(surfaces, middle)
        half = 0.5 * (angles[0] + angles[1])
        apexes = [float((point - axes.point) @ axes.axis) for point in surfaces.points]
        reach = [-apex * math.tan(angle) for apex, angle in zip(apexes, angles, strict=True)]
        gap = (reach[1] - reach[0]) * math.cos(half) * side
        if abs(gap) > limit or not aligned(pair, axes, gap, length):
            continue
        radius = 0.5 * (reach[0] + reach[1])
        apex = axes.point + 0.5 * (apexes[0] + apexes[1]) * axes.axis
        yield Mate(
            surfaces,
            kind="cone",
            chart=ConeChart(axes.axis, apex, _base(surfaces, axes, radius), half, radius),
            sign=side,
            axis=axes.axis,
            point=axes.point,
            radii=angles,
            gap=gap,
            gradient=(math.tan(angles[1]) - math.tan(angles[0])) * math.cos(half) * side * axes.axis,
            limit=limit,
            slack=axes.offset + 0.5 * (axes.misalignment + unlike) * length + surfaces.slack,
            misalignment=axes.misalignment,
            offset=axes.offset,
            uncertainty=axes.uncertainty,
            mismatch=axes.mismatch,
        )


def _sphere_mates(pair: PairView, overlap: Flags) -> Iterator[Mate]:
    """Balls in sockets among the surfaces flagged in `overlap` (s, t)."""
    a, b = pair.near
    rows, columns, flags = pair.of_kinds(overlap, "sphere")
    if not flags.any():
        return
    convex = a.sides[rows][:, None] * b.sides[columns][None] < 0.0
    for i, j in np.argwhere(flags & convex):
        surfaces = pair.surfaces(rows[i], columns[j])
        (first, second), radii, side = surfaces.points, surfaces.radii, surfaces.sides[0]
        gap = (radii[1] - radii[0]) * side
        offset = norm(second - first)
        limit = radial_limit(pair.play, min(radii))
        spare = max(gap, 0.0) + min(sum(surfaces.shifts), pair.tolerance) + MATING_OFFSET * pair.tolerance
        if abs(gap) > limit or offset > spare:
            continue
        centre, shift = mean_position(first, second, surfaces.shifts)
        radius = 0.5 * (radii[0] + radii[1])
        yield Mate(
            surfaces,
            kind="sphere",
            chart=SphereChart.seen_from(centre, radius, surfaces.box()[0]),
            sign=side,
            axis=np.zeros(3),
            point=centre,
            radii=radii,
            gap=gap,
            limit=limit,
            slack=surfaces.slack + offset,
            offset=offset,
            uncertainty=(0.0, shift),
            mismatch=(0.0, sum(surfaces.shifts)),
        )


def _nearly_coaxial(pair: PairView, overlap: Flags, kind: SurfaceKind) -> Iterator[SurfacePair]:
    """Surfaces of one kind, convex with concave, whose axes are roughly parallel."""
    a, b = pair.near
    rows, columns, flags = pair.of_kinds(overlap, kind)
    if not flags.any():
        return
    at, of = np.nonzero(flags)
    rows, columns = rows[at], columns[of]
    cosine = np.abs(dot(a.axes[rows], b.axes[columns]))
    convex = a.sides[rows] * b.sides[columns] < 0.0
    for k in np.flatnonzero(convex & (cosine > math.cos(TILT_LIKELY * MATING_TILT))):
        yield pair.surfaces(rows[k], columns[k])


def _engaged(surfaces: SurfacePair) -> tuple[float, Array]:
    """Length of the common range along the axis of a's surface, and its middle (3,)."""
    (axis, other_axis), (origin, other_origin) = surfaces.axes, surfaces.points
    extent, other_extent = surfaces.extents
    sense = math.copysign(1.0, float(axis @ other_axis))
    other = sorted(float((other_origin - origin) @ axis) + sense * other_extent)
    low, high = max(extent[0], other[0]), min(extent[1], other[1])
    return float(high - low), origin + 0.5 * (low + high) * axis


def _base(surfaces: SurfacePair, axes: Axes, radius: float) -> Array:
    """Azimuth that looks into the common box of the two surfaces, where it has one."""
    arm = surfaces.box()[0] - axes.point
    arm = arm - (arm @ axes.axis) * axes.axis
    return perpendicular(axes.axis, arm if norm(arm) > SEEN_FROM_AXIS * radius else None)


_MATES = {"plane": _plane_mates, "cylinder": _cylinder_mates, "cone": _cone_mates, "sphere": _sphere_mates}
"""Of surfaces of one kind, in this order."""
