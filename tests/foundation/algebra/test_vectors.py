"""Products column by column are those row by row, to the bit."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.foundation.algebra.vectors import cross, cross_columns
from kinform.foundation.constants import MANY


@pytest.mark.parametrize("count", [0, 1, 7, MANY])
@pytest.mark.parametrize("stored", [np.ascontiguousarray, np.asfortranarray])
def test_cross_products_of_columns(count, stored):
    draw = np.random.default_rng(count)
    a, b = (stored(draw.normal(size=(count, 3))) for _ in range(2))
    found = cross_columns(a, b)
    assert found.shape == (count, 3)
    assert found.T.flags.c_contiguous
    assert found.tobytes() == cross(a, b).tobytes()
