"""A mate: two analytic surfaces that could lie on each other, with the geometry that they share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.contacts.mating.charts import Chart
from kinform.contacts.search.placed import NearSurfaces
from kinform.model.arrays import Array, Flags

__all__ = [
    "EDGE",
    "Axes",
    "Mate",
    "box_centre",
    "box_overlap",
    "mean_axes",
    "mean_direction",
    "mean_position",
    "radial_limit",
]


EDGE = 1.02
"""Limits reach this much beyond the contact tolerance: designers put clearances of exactly 0.5 mm, and
rounding must not decide whether those are contacts."""


@dataclass(frozen=True, eq=False)
class Mate:
    """Surfaces at positions `rows` of the near surfaces of a and b, and what they have in common.

    The gap at a point p is `gap + gradient · (p − point)`; only where it lies within ±`limit` there is
    contact. `chart` maps the surface half-way between the two; its normals times `sign` point out of a.
    """

    rows: tuple[int, int]
    kind: str
    chart: Chart
    sign: float
    axis: Array
    point: Array
    radii: tuple[float, float]
    gap: float
    gradient: Array
    limit: float
    slack: float
    """m by which facets of either side may stand off the common surface, beyond half the gap."""
    misalignment: float
    offset: float
    uncertainty: tuple[float, float]
    chord: float
    thin: float = 0.0
    """m: an overlap narrower than this is an artefact of how two outlines are tessellated."""
    corners: tuple[Array, Array] | None = None
    """Facets (n, 3, 3) of a and b to overlay, of one-sided mates: their gap is measured, not known."""

    def gaps(self, points: Array) -> Array:
        """(n,) m signed gaps at points (n, 3)."""
        return np.asarray(self.gap + (points - self.point) @ self.gradient)


def box_overlap(a: NearSurfaces, b: NearSurfaces, margin: float) -> Flags:
    """(s, t): the boxes of surface s of a and t of b come within `margin` (m)."""
    apart = np.maximum(a.lows[:, None] - b.highs[None], b.lows[None] - a.highs[:, None])
    return np.asarray((apart <= margin).all(axis=2))


def box_centre(a: NearSurfaces, b: NearSurfaces, row: int, column: int) -> tuple[Array, Array]:
    """Middle and size (3,) of the common box of two surfaces."""
    low = np.maximum(a.lows[row], b.lows[column])
    high = np.minimum(a.highs[row], b.highs[column])
    return 0.5 * (low + high), np.maximum(high - low, 0.0)


def radial_limit(tolerance: float, radius: float) -> float:
    """Greatest radial gap or overlap at which curved surfaces mate (m): real coaxial clearances grow
    with the radius, and a gap of a third of the radius is no fit."""
    return EDGE * min(max(tolerance, 0.03 * radius), radius / 3.0)


def _shares(first: float, second: float) -> tuple[float, float]:
    """Weights of two estimates with these uncertainties, summing to 1."""
    floor = 1e-3 * max(first, second, 1e-300)
    one, two = 1.0 / max(first, floor) ** 2, 1.0 / max(second, floor) ** 2
    return one / (one + two), two / (one + two)


@dataclass(frozen=True, eq=False)
class Axes:
    """The mean of two axes, along the first, by the uncertainties of both."""

    axis: Array
    point: Array
    misalignment: float
    offset: float
    uncertainty: tuple[float, float]


def mean_direction(first: Array, second: Array, uncertainty: tuple[float, float]) -> tuple[Array, float, float]:
    """Mean of two unit vectors that point the same way, the angle between them, and its uncertainty."""
    one, two = _shares(*uncertainty)
    mean = one * first + two * second
    angle = float(np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second))
    spread = one * uncertainty[0] + two * uncertainty[1]
    return mean / np.linalg.norm(mean), angle, float(spread)


def mean_position(first: Array, second: Array, uncertainty: tuple[float, float]) -> tuple[Array, float]:
    """Mean of two points by their uncertainties, and the uncertainty of the mean (m)."""
    one, two = _shares(*uncertainty)
    return one * first + two * second, float(one * uncertainty[0] + two * uncertainty[1])


def mean_axes(a: NearSurfaces, b: NearSurfaces, row: int, column: int, middle: Array) -> Axes:
    """The common axis of two nearly coaxial surfaces, with its point beside `middle` (3,)."""
    first, second = a.axes[row], b.axes[column]
    second = second if first @ second > 0.0 else -second
    turns = (float(a.axis_uncertainty[row]), float(b.axis_uncertainty[column]))
    axis, angle, turn = mean_direction(first, second, turns)
    feet, shifts = [], []
    for near, number, own, u_axis in ((a, row, first, turns[0]), (b, column, second, turns[1])):
        reach = float((middle - near.points[number]) @ axis) / float(own @ axis)
        feet.append(near.points[number] + reach * own)
        shifts.append(float(near.point_uncertainty[number]) + u_axis * abs(reach))
    point, shift = mean_position(feet[0], feet[1], (shifts[0], shifts[1]))
    return Axes(axis, point, angle, float(np.linalg.norm(feet[1] - feet[0])), (turn, shift))
