"""Cubic splines through points of the plane or of space.

The same as scipy's `CubicSpline` with the ends "not-a-knot"; importing that takes longer (0.4 s) than all curves of an
assembly.
"""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class Cubics:
    """A curve of cubics, twice differentiable at its knots; beyond its ends the outer cubics go on."""

    knots: Array
    """(n,) ascending."""
    coefficients: Array
    """(4, n − 1, d): of the third to the zeroth power of what the parameter exceeds the knot before it by."""

    def __call__(self, s: Array | float, order: int = 0) -> Array:
        """Points (…, d) at the parameters s (…), or their derivatives of the first or second order."""
        c3, c2, c1, c0, t = self._pieces(s)
        if order == 0:
            return np.asarray(((c3 * t + c2) * t + c1) * t + c0)
        if order == 1:
            return np.asarray((3.0 * c3 * t + 2.0 * c2) * t + c1)
        return np.asarray(6.0 * c3 * t + 2.0 * c2)

    def with_derivatives(self, s: Array) -> tuple[Array, Array, Array]:
        """Points (…, d) at the parameters s (…), and their first and second derivatives."""
        c3, c2, c1, c0, t = self._pieces(s)
        return ((c3 * t + c2) * t + c1) * t + c0, (3.0 * c3 * t + 2.0 * c2) * t + c1, 6.0 * c3 * t + 2.0 * c2

    def place(self, s: float) -> list[tuple[float, float, float]]:
        """Each coordinate at one parameter, with its first and second derivative: as above, for one of many steps."""
        knots, inner, coefficients = self._numbers
        piece = bisect_right(inner, s)
        t = s - knots[piece]
        return [
            (((c3 * t + c2) * t + c1) * t + c0, (3.0 * c3 * t + 2.0 * c2) * t + c1, 6.0 * c3 * t + 2.0 * c2)
            for c3, c2, c1, c0 in coefficients[piece]
        ]

    def _pieces(self, s: Array | float) -> tuple[Array, Array, Array, Array, Array]:
        """The coefficients (…, d) that hold at the parameters s (…), and what they hold of (…, 1)."""
        s = np.asarray(s, dtype=float)
        piece = np.searchsorted(self.knots[1:-1], s, side="right")
        c3, c2, c1, c0 = self.coefficients[:, piece]
        return c3, c2, c1, c0, (s - self.knots[piece])[..., None]

    @cached_property
    def _numbers(self) -> tuple[list[float], list[float], list[list[list[float]]]]:
        """Knots, the inner ones, and coefficients by piece and coordinate."""
        knots: list[float] = self.knots.tolist()
        return knots, knots[1:-1], self.coefficients.transpose(1, 2, 0).tolist()


def through(knots: Array, points: Array) -> Cubics:
    """The spline through points (n, d) at ascending knots (n,), n ≥ 2: of four and more points, its third derivative is
    continuous at the second knot and at the last but one (de Boor, A Practical Guide to Splines, chapter IV); through
    three points the parabola, through two the line."""
    if len(knots) < 4:
        return _few(knots, points)
    return _hermite(knots, points, _slopes(knots, points))


def _few(knots: Array, points: Array) -> Cubics:
    """Of two or three points: one polynomial."""
    zero = np.zeros_like(points[0])
    slopes = np.diff(points, axis=0) / np.diff(knots)[:, None]
    bend = (slopes[1] - slopes[0]) / (knots[2] - knots[0]) if len(knots) == 3 else zero
    start = slopes[0] - bend * (knots[1] - knots[0])
    return Cubics(knots[[0, -1]], np.stack([zero, bend, start, points[0]])[:, None])


def _hermite(knots: Array, points: Array, slopes: Array) -> Cubics:
    """The cubics with these values and slopes (n, d) at the knots."""
    step = np.diff(knots)[:, None]
    chord = np.diff(points, axis=0) / step
    turn = (slopes[:-1] + slopes[1:] - 2.0 * chord) / step
    return Cubics(knots, np.stack([turn / step, (chord - slopes[:-1]) / step - turn, slopes[:-1], points[:-1]]))


def _slopes(knots: Array, points: Array) -> Array:
    """(n, d) derivatives at the knots: one tridiagonal system, solved by elimination, which needs no pivots here."""
    step, count = np.diff(knots), len(knots)
    chord = np.diff(points, axis=0) / step[:, None]
    first, last = step[0] + step[1], step[-2] + step[-1]
    right = np.empty_like(points)
    right[1:-1] = 3.0 * (step[1:, None] * chord[:-1] + step[:-1, None] * chord[1:])
    right[0] = ((step[0] + 2.0 * first) * step[1] * chord[0] + step[0] ** 2 * chord[1]) / first
    right[-1] = (step[-1] ** 2 * chord[-2] + (2.0 * last + step[-1]) * step[-2] * chord[-1]) / last
    below = [*step[1:].tolist(), float(last)]
    above = [float(first), *step[:-1].tolist()]
    main = [float(step[1]), *(2.0 * (step[:-1] + step[1:])).tolist(), float(step[-2])]
    rows = right.tolist()
    for k in range(1, count):
        share = below[k - 1] / main[k - 1]
        main[k] -= share * above[k - 1]
        rows[k] = [here - share * before for here, before in zip(rows[k], rows[k - 1], strict=True)]
    rows[-1] = [value / main[-1] for value in rows[-1]]
    for k in range(count - 2, -1, -1):
        rows[k] = [(here - above[k] * after) / main[k] for here, after in zip(rows[k], rows[k + 1], strict=True)]
    return np.array(rows)
