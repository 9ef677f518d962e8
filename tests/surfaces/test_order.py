"""The order of surfaces: what is equal but for rounding is ordered by its facets, on every processor."""

from __future__ import annotations

import numpy as np

from kinform.foundation.sorting import coarse


def test_values_that_rounding_parts_are_equal_and_others_keep_their_order():
    rng = np.random.default_rng(4)
    values = np.concatenate([10.0 ** rng.uniform(-12, 3, 1000), [0.0, 1.0, 0.5, 2.0**-20]])
    shaken = values * (1.0 + rng.uniform(-4e-16, 4e-16, len(values)))
    # but for those that lie on a limit between two
    assert np.count_nonzero(coarse(values) != coarse(shaken)) <= 1
    apart = np.sort(values)
    apart = apart[np.r_[True, np.diff(apart) > 1e-7 * apart[1:]]]
    assert np.all(np.diff(coarse(apart)) > 0.0)
    np.testing.assert_array_equal(coarse(np.array([0.0, 1.0, 0.5, 3.0])), [0.0, 1.0, 0.5, 3.0])
    assert coarse(np.array([1.0 - 1e-16]))[0] == coarse(np.array([1.0 + 1e-15]))[0] == 1.0
