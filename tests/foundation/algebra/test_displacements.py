"""Displacements are the exponentials of twists, and twists their logarithms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from kinform.foundation.algebra.displacements import displacement, displacements_along, twist_of

TURN, SLIDE = np.array([2.0, -1.0, 2.0, 0.0, 0.0, 0.0]) / 3.0, np.array([0.0, 0.0, 0.0, 2.0, -1.0, 2.0]) / 3.0
BESIDE = np.array([0.0, 0.0, 0.0, 0.3, -5.0, 0.1])


@pytest.mark.parametrize("twist", [TURN, SLIDE, TURN + BESIDE, TURN + BESIDE + 0.2 * SLIDE])
@pytest.mark.parametrize("s", [0.0, 1e-9, -1e-5, 0.3, -3.0, 40.0])
def test_they_are_exponentials(twist, s):
    assert displacements_along(twist)(s) == pytest.approx(exponential(s * twist), rel=1e-12, abs=1e-12)


def exponential(twist):
    x, y, z, *v = twist
    return expm(np.array([[0.0, -z, y, v[0]], [z, 0.0, -x, v[1]], [-y, x, 0.0, v[2]], [0.0, 0.0, 0.0, 0.0]]))


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.0099, 0.0101, 0.049, 0.051, 1.0, 3.0])
def test_of_many_twists_at_once_too_and_back(angle):
    rng = np.random.default_rng(5)
    twists = rng.normal(size=(4, 5, 6))
    twists[..., :3] *= angle / np.linalg.norm(twists[..., :3], axis=-1, keepdims=True)
    X = displacement(twists)
    assert np.abs(X - [[exponential(twist) for twist in row] for row in twists]).max() < 1e-13
    assert np.abs(twist_of(X) - twists).max() < 1e-12
    assert np.array_equal(displacement(twists[1, 2]), X[1, 2])
    assert np.array_equal(twist_of(X[1, 2]), twist_of(X)[1, 2])
