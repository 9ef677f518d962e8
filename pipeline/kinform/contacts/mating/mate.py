"""A mate: two analytic surfaces that could lie on each other, with the geometry that they share.

The common axis, direction or point of two surfaces is the mean of both, weighted by the inverse squares of their
uncertainties.
"""

from __future__ import annotations

import math
from dataclasses import field
from functools import cached_property

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.mating.charts import Chart
from kinform.contacts.search.pair_view import CLEARANCE_SHARE, PairView, SurfacePair
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.contacts import PatchKind

HALF_RADIUS_SHARE = 3.0
"""A radial gap of more than the radius divided by this is no fit. Chosen, not measured."""
MATING_TILT = math.radians(5.0)
"""rad: largest angle between two axes that mate, whatever the clearance. Chosen, not measured."""
MATING_OFFSET = 0.5
"""Distance, in contact tolerances, by which axes or centres of surfaces that mate may miss each other beyond the
clearance. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Mate:
    """A surface of a, one of b, and what they have in common.

    The gap at a point p is `gap + gradient · (p − point)`; only where it lies within ±`limit` there is
    contact. `chart` maps the surface half-way between the two; its normals times `sign` point out of a.
    """

    surfaces: SurfacePair
    kind: PatchKind
    chart: Chart
    sign: float
    axis: Array
    point: Array
    limit: float
    slack: float
    """m by which facets of either side may stand off the common surface, beyond half the gap."""
    uncertainty: tuple[float, float]
    mismatch: tuple[float, float]
    """Of misalignment (rad) and offset (m)."""
    radii: tuple[float, float] = (0.0, 0.0)
    gap: float = 0.0
    gradient: Array = field(default_factory=lambda: np.zeros(3))
    misalignment: float = 0.0
    offset: float = 0.0
    thin: float = 0.0
    """m: an overlap narrower than this is an artefact of how two outlines are tessellated."""
    corners: tuple[Array, Array] | None = None
    """Facets (n, 3, 3) of a and b to overlay, of one-sided mates: their gap is measured, not known."""

    def gaps(self, points: Array) -> Array:
        """(n,) m signed gaps at points (n, 3)."""
        if not self.slopes:
            return np.full(len(points), self.gap + 0.0)
        return np.asarray(self.gap + (points - self.point) @ self.gradient)

    @cached_property
    def slopes(self) -> bool:
        """Whether the gap differs from point to point."""
        return bool(self.gradient.any())


def radial_limit(play: float, radius: float) -> float:
    """Greatest radial gap or overlap at which curved surfaces mate (m): real coaxial clearances grow
    with the radius, and a gap of a third of the radius is no fit. `play` (m) is that of the pair."""
    return MATING_REACH * min(max(play, CLEARANCE_SHARE * radius), radius / HALF_RADIUS_SHARE)


def _shares(first: float, second: float) -> tuple[float, float]:
    """Weights of two estimates with these uncertainties, summing to 1."""
    floor = 1e-3 * max(first, second, TINY)
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
    mismatch: tuple[float, float]
    """Of misalignment (rad) and offset (m)."""


def mean_direction(first: Array, second: Array, uncertainty: tuple[float, float]) -> tuple[Array, float, float]:
    """Mean of two unit vectors that point the same way, the angle between them, and its uncertainty."""
    one, two = _shares(*uncertainty)
    mean = one * first + two * second
    angle = float(np.arctan2(norm(cross(first, second)), first @ second))
    spread = one * uncertainty[0] + two * uncertainty[1]
    return mean / norm(mean), angle, float(spread)


def mean_position(first: Array, second: Array, uncertainty: tuple[float, float]) -> tuple[Array, float]:
    """Mean of two points by their uncertainties, and the uncertainty of the mean (m)."""
    one, two = _shares(*uncertainty)
    return one * first + two * second, float(one * uncertainty[0] + two * uncertainty[1])


def mean_axes(surfaces: SurfacePair, middle: Array) -> Axes:
    """The common axis of two nearly coaxial surfaces, with its point beside `middle` (3,)."""
    first, second = surfaces.axes
    second = second if first @ second > 0.0 else -second
    axis, angle, turn = mean_direction(first, second, surfaces.turns)
    feet, shifts = [], []
    for direction, origin, shift, u_axis in zip(
        (first, second), surfaces.points, surfaces.shifts, surfaces.turns, strict=True
    ):
        reach = float((middle - origin) @ axis) / float(direction @ axis)
        feet.append(origin + reach * direction)
        shifts.append(shift + u_axis * abs(reach))
    point, shift = mean_position(feet[0], feet[1], (shifts[0], shifts[1]))
    apart = norm(feet[1] - feet[0])
    return Axes(axis, point, angle, apart, (turn, shift), (sum(surfaces.turns), sum(shifts)))


def aligned(pair: PairView, axes: Axes, clearance: float, length: float) -> bool:
    """Whether two axes agree: to what the clearance allows over the engaged length, or within `alignment`."""
    spare = max(clearance, 0.0)
    tilt = pair.tolerances.alignment + 2.0 * axes.uncertainty[0] + 2.0 * spare / max(length, ARITHMETIC)
    offset = spare + min(2.0 * axes.uncertainty[1], pair.tolerance) + MATING_OFFSET * pair.tolerance
    return axes.misalignment <= min(tilt, MATING_TILT) and axes.offset <= offset
