"""Sums by group, against sums of each group by itself."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinform.surfaces.groups import group_mean, group_sum, normal_equations, sums_of

NUMBERS = st.lists(st.integers(0, 9), max_size=60)


def values_of(numbers, columns=1):
    return np.random.default_rng(len(numbers)).normal(size=(len(numbers), columns))


@given(NUMBERS)
def test_a_sum_is_that_of_the_group_alone_in_any_company(numbers):
    """To the bit: whatever other groups there are, before, between or after."""
    groups, values = np.array(numbers, dtype=np.int64), values_of(numbers)[:, 0]
    found = sums_of(groups, 10)(values)
    for group in range(10):
        own = values[groups == group]
        assert found[group] == sums_of(np.zeros(len(own), np.int64), 1)(own)[0]
        assert np.isclose(found[group], float(sum(own.tolist())), rtol=1e-12, atol=1e-12)


@given(NUMBERS)
def test_the_order_of_groups_changes_nothing(numbers):
    groups, values = np.array(numbers, dtype=np.int64), values_of(numbers, 3)
    order = np.argsort(groups, kind="stable")
    assert (group_sum(groups, values, 10) == group_sum(groups[order], values[order], 10)).all()
    assert (group_mean(groups, values, 10) == group_mean(groups[order], values[order], 10)).all()


@given(NUMBERS)
def test_normal_equations_are_products_of_the_rows(numbers):
    groups, rows = np.array(numbers, dtype=np.int64), values_of(numbers, 4)
    matrix, right = normal_equations(sums_of(groups, 10), rows[:, :3].T, rows[:, 3])
    for group in range(10):
        own = rows[groups == group]
        assert np.allclose(matrix[group], own[:, :3].T @ own[:, :3], rtol=0.0, atol=1e-12)
        assert np.allclose(right[group], own[:, :3].T @ own[:, 3], rtol=0.0, atol=1e-12)
