"""Displacements along one twist are the exponentials of its multiples."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from kinform.foundation.algebra.displacements import displacements_along

TURN, SLIDE = np.array([2.0, -1.0, 2.0, 0.0, 0.0, 0.0]) / 3.0, np.array([0.0, 0.0, 0.0, 2.0, -1.0, 2.0]) / 3.0
BESIDE = np.array([0.0, 0.0, 0.0, 0.3, -5.0, 0.1])


@pytest.mark.parametrize("twist", [TURN, SLIDE, TURN + BESIDE, TURN + BESIDE + 0.2 * SLIDE])
@pytest.mark.parametrize("s", [0.0, 1e-9, -1e-5, 0.3, -3.0, 40.0])
def test_they_are_exponentials(twist, s):
    x, y, z, *v = twist
    matrix = np.array([[0.0, -z, y, v[0]], [z, 0.0, -x, v[1]], [-y, x, 0.0, v[2]], [0.0, 0.0, 0.0, 0.0]])
    assert displacements_along(twist)(s) == pytest.approx(expm(s * matrix), rel=1e-12, abs=1e-12)
