"""Cylinders in cylinders and cones in cones: convex in concave, axes as close as clearance and fit allow.

Angle and offset are judged where the two surfaces engage, never at a far point of an axis.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.mating.charts import ConeChart, CylinderChart, perpendicular
from kinform.contacts.mating.mates import EDGE, Axes, Mate, box_centre, mean_axes, radial_limit
from kinform.contacts.search.placed import NearSurfaces
from kinform.model.arrays import Array, Flags
from kinform.model.tolerances import Tolerances

__all__ = ["aligned", "cone_mates", "cylinder_mates"]

_TILT = math.radians(5.0)
"""No clearance excuses a greater angle between two mating axes."""
_OFFSET = 0.5
"""Share of the contact tolerance by which mating axes may miss each other beyond the clearance."""


def _likely(a: NearSurfaces, b: NearSurfaces, overlap: Flags, kind: str) -> list[tuple[int, int]]:
    """Pairs of one kind, convex with concave, whose axes are roughly parallel."""
    rows, columns = a.of_kind(kind), b.of_kind(kind)
    cosine = np.abs(a.axes[rows] @ b.axes[columns].T)
    convex = a.sides[rows][:, None] * b.sides[columns][None] < 0.0
    found = overlap[np.ix_(rows, columns)] & convex & (cosine > math.cos(1.5 * _TILT))
    return [(int(rows[i]), int(columns[j])) for i, j in np.argwhere(found)]


def _engaged(a: NearSurfaces, b: NearSurfaces, row: int, column: int) -> tuple[float, Array]:
    """Length of the common range along the axis of a's surface, and its middle (3,)."""
    axis, origin = a.axes[row], a.points[row]
    sense = math.copysign(1.0, float(axis @ b.axes[column]))
    shift = float((b.points[column] - origin) @ axis)
    other = sorted(shift + sense * b.extents[column])
    low, high = max(a.extents[row][0], other[0]), min(a.extents[row][1], other[1])
    return float(high - low), origin + 0.5 * (low + high) * axis


def aligned(axes: Axes, clearance: float, length: float, tolerance: float, tolerances: Tolerances) -> bool:
    """Whether two axes agree: to what the clearance allows over the engaged length, or within `alignment`."""
    spare = max(clearance, 0.0)
    tilt = tolerances.alignment + 2.0 * axes.uncertainty[0] + 2.0 * spare / max(length, 1e-12)
    offset = spare + min(2.0 * axes.uncertainty[1], tolerance) + _OFFSET * tolerance
    return axes.misalignment <= min(tilt, _TILT) and axes.offset <= offset


def cylinder_mates(
    a: NearSurfaces, b: NearSurfaces, overlap: Flags, tolerance: float, tolerances: Tolerances
) -> list[Mate]:
    """Shafts in bores among the pairs flagged in `overlap` (s, t)."""
    mates = []
    for row, column in _likely(a, b, overlap, "cylinder"):
        radii = (float(a.radii[row]), float(b.radii[column]))
        gap = (radii[1] - radii[0]) * float(a.sides[row])
        limit = radial_limit(tolerance, min(radii))
        length, middle = _engaged(a, b, row, column)
        if abs(gap) > limit or length <= 0.0:
            continue
        axes = mean_axes(a, b, row, column, middle)
        if not aligned(axes, gap, length, tolerance, tolerances):
            continue
        centre, _ = box_centre(a, b, row, column)
        radius = 0.5 * (radii[0] + radii[1])
        base = _base(axes, centre, radius)
        chart = CylinderChart(axes.axis, axes.point, base, radius)
        slack = axes.offset + 0.5 * axes.misalignment * length
        mates.append(_mate(a, b, (row, column), "cylinder", chart, axes, radii, gap, 0.0, limit, slack))
    return mates


def cone_mates(
    a: NearSurfaces, b: NearSurfaces, overlap: Flags, tolerance: float, tolerances: Tolerances
) -> list[Mate]:
    """Tapers in sockets of the same half-angle among the pairs flagged in `overlap` (s, t)."""
    mates = []
    for row, column in _likely(a, b, overlap, "cone"):
        angles = (float(a.half_angles[row]), float(b.half_angles[column]))
        spread = float(a.axis_uncertainty[row] + b.axis_uncertainty[column])
        if a.axes[row] @ b.axes[column] < 0.0 or abs(angles[1] - angles[0]) > tolerances.alignment + spread:
            continue
        length, middle = _engaged(a, b, row, column)
        if length <= 0.0:
            continue
        axes = mean_axes(a, b, row, column, middle)
        half = 0.5 * (angles[0] + angles[1])
        apexes = ((a.points[row] - axes.point) @ axes.axis, (b.points[column] - axes.point) @ axes.axis)
        reach = [-float(apex) * math.tan(angle) for apex, angle in zip(apexes, angles, strict=True)]
        side = float(a.sides[row])
        gap = (reach[1] - reach[0]) * math.cos(half) * side
        if abs(gap) > EDGE * tolerance or not aligned(axes, gap, length, tolerance, tolerances):
            continue
        middle_radius = 0.5 * (reach[0] + reach[1])
        centre, _ = box_centre(a, b, row, column)
        apex = axes.point + 0.5 * float(apexes[0] + apexes[1]) * axes.axis
        chart = ConeChart(axes.axis, apex, _base(axes, centre, middle_radius), half, middle_radius)
        slope = (math.tan(angles[1]) - math.tan(angles[0])) * math.cos(half) * side
        slack = axes.offset + 0.5 * (axes.misalignment + abs(angles[1] - angles[0])) * length
        mates.append(_mate(a, b, (row, column), "cone", chart, axes, angles, gap, slope, EDGE * tolerance, slack))
    return mates


def _base(axes: Axes, centre: Array, radius: float) -> Array:
    """Azimuth that looks into the common box of the two surfaces, where it has one."""
    arm = centre - axes.point
    arm = arm - (arm @ axes.axis) * axes.axis
    return perpendicular(axes.axis, arm if np.linalg.norm(arm) > 1e-3 * radius else None)


def _mate(
    a: NearSurfaces,
    b: NearSurfaces,
    rows: tuple[int, int],
    kind: str,
    chart: CylinderChart | ConeChart,
    axes: Axes,
    radii: tuple[float, float],
    gap: float,
    slope: float,
    limit: float,
    slack: float,
) -> Mate:
    return Mate(
        rows=rows,
        kind=kind,
        chart=chart,
        sign=float(a.sides[rows[0]]),
        axis=axes.axis,
        point=axes.point,
        radii=radii,
        gap=gap,
        gradient=slope * axes.axis,
        limit=limit,
        slack=slack + float(a.slacks[rows[0]] + b.slacks[rows[1]]),
        misalignment=axes.misalignment,
        offset=axes.offset,
        uncertainty=axes.uncertainty,
        chord=float(a.chords[rows[0]] + b.chords[rows[1]]),
    )
