"""Medians, against numpy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinform.foundation.sorting import median


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, width=32), min_size=1, max_size=30))
def test_it_is_numpys_to_the_bit(values):
    assert median(values) == median(np.array(values)) == float(np.median(values))
