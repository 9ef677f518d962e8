"""Cubic splines, against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from kinform.foundation.algebra.splines import through


@pytest.mark.parametrize("dimensions", [1, 2, 3])
@pytest.mark.parametrize("count", [2, 3, 4, 5, 8, 60])
def test_it_is_scipys_spline_with_its_derivatives_inside_and_beyond(count, dimensions):
    rng = np.random.default_rng(100 * count + dimensions)
    for scale in (1e-4, 1.0, 1e3):
        knots = scale * np.cumsum(rng.uniform(0.05, 1.0, count))
        points = scale * rng.normal(size=(count, dimensions))
        ours, theirs = through(knots, points), CubicSpline(knots, points)
        s = np.concatenate([knots, rng.uniform(knots[0] - 0.1 * scale, knots[-1] + 0.1 * scale, 200)])
        for order in (0, 1, 2):
            expected = theirs(s, order)
            np.testing.assert_allclose(ours(s, order), expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
            np.testing.assert_allclose(ours(s[0], order), expected[0], rtol=0.0, atol=1e-10 * np.abs(expected).max())
            assert ours.with_derivatives(s)[order].tobytes() == ours(s, order).tobytes()
            one_by_one = [[coordinate[order] for coordinate in ours.place(float(x))] for x in s]
            np.testing.assert_allclose(one_by_one, ours(s, order), rtol=1e-12, atol=1e-14 * np.abs(expected).max())


def test_a_cubic_is_itself():
    knots = np.array([-1.0, -0.4, 0.1, 0.2, 2.0])
    points = np.column_stack([knots**3 - 2.0 * knots, 4.0 * knots**2])
    s = np.linspace(-1.5, 2.5, 50)
    np.testing.assert_allclose(through(knots, points)(s, 1), np.column_stack([3.0 * s**2 - 2.0, 8.0 * s]), atol=1e-12)
