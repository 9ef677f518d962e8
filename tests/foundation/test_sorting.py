"""Sorted keys, their orders, and medians, against numpy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinform.foundation.constants import MANY
from kinform.foundation.sorting import (
    DIGIT,
    FEW_BITS,
    among,
    ascending,
    coarse,
    distinct,
    median,
    numbered,
    occurrences,
    sorted_keys,
)


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, width=32), min_size=1, max_size=30))
def test_it_is_numpys_to_the_bit(values):
    assert median(values) == median(np.array(values)) == float(np.median(values))


@pytest.mark.parametrize("count", [0, 1, 2, MANY - 1, MANY, 5 * MANY])
@pytest.mark.parametrize("below", [1, 7, (1 << DIGIT) - 1, 1 << DIGIT, (1 << DIGIT) + 1, 1 << 40, 1 << 60])
def test_equal_keys_stay_as_they_come(count, below):
    keys = np.random.default_rng(count).integers(0, below, count)
    keys[: count // 2] = below - 1
    order = ascending(keys, below)
    assert order.tolist() == np.argsort(keys, kind="stable").tolist()


@pytest.mark.parametrize("count", [0, 1, MANY - 1, MANY, 5 * MANY])
@pytest.mark.parametrize("greatest", [0, (1 << FEW_BITS) - 1, 1 << FEW_BITS, (1 << FEW_BITS) + 1, (1 << 63) - 1])
def test_keys_of_few_and_of_many_bits_are_sorted(count, greatest):
    keys = np.random.default_rng(count).integers(0, greatest, count, endpoint=True)
    keys[count // 2 : count // 2 + 1] = greatest
    found = sorted_keys(keys)
    assert found.dtype == np.int64
    assert found.tolist() == sorted(keys.tolist())


@given(st.lists(st.integers(0, 1 << 40), max_size=40))
def test_distinct_keys_how_often_each_occurs_and_which_is_which(numbers):
    keys = np.array(numbers, dtype=np.int64)
    found, times = occurrences(keys)
    wanted, inverse, counted = np.unique(keys, return_inverse=True, return_counts=True)
    assert found.tolist() == distinct(keys).tolist() == wanted.tolist()
    assert times.tolist() == counted.tolist()
    those, places = numbered(keys, (1 << 40) + 1)
    assert those.tolist() == wanted.tolist()
    assert places.tolist() == inverse.tolist()


@given(st.lists(st.integers(0, 30), max_size=40), st.sets(st.integers(0, 30)))
def test_keys_are_found_among_ordered_ones(keys, ordered):
    found = among(np.array(keys, np.int64), np.array(sorted(ordered), np.int64))
    assert found.tolist() == [key in ordered for key in keys]


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
