"""Solutions of triangles, whole or truncated, are those by all singular values."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.mechanism.least_change import REDUCED_RATES, least_change, regular_solution, truncated_solution
from kinform.mechanism.rank import Rank


def equations(rng, count, left_out, gap):
    """A triangle of which so many singular values are below a share of the others, a right side, the solution by
    singular values, and vectors near those that are left out."""
    left, right = (np.linalg.qr(rng.normal(size=(count, count)))[0] for _ in range(2))
    values = np.sort(np.exp(rng.uniform(-5.0, 0.0, count)))[::-1]
    values[count - left_out :] = gap * values[count - left_out - 1] * np.sort(rng.random(left_out))[::-1]
    triangle = np.linalg.qr(left * values @ right.T, mode="r")
    wanted = rng.normal(size=count)
    outer, found, inner = np.linalg.svd(triangle)
    kept = count - left_out
    solution = inner[:kept].T @ (outer[:, :kept].T @ wanted / found[:kept])
    beside = right[:, kept:] + 0.1 / np.sqrt(count) * rng.normal(size=(count, left_out))
    return triangle, wanted, solution, np.linalg.qr(beside)[0].T


@pytest.mark.parametrize("gap", [0.1, 1e-3, 1e-9, 1e-14])
@pytest.mark.parametrize("left_out", [1, 2, 5])
def test_it_is_the_solution_by_singular_values(left_out, gap):
    triangle, right, wanted, beside = equations(np.random.default_rng(left_out), 80, left_out, gap)
    found = truncated_solution(triangle, right, beside)
    assert found is not None
    assert np.abs(found - wanted).max() < 1e-11 * np.abs(wanted).max()


def test_without_a_gap_it_is_not_found():
    triangle, right, _, beside = equations(np.random.default_rng(0), 80, 2, 0.999)
    assert truncated_solution(triangle, right, beside) is None


def test_where_more_is_singular_than_is_left_out_it_is_not_found():
    triangle, right, _, beside = equations(np.random.default_rng(0), 80, 3, 1e-14)
    assert truncated_solution(triangle, right, beside[:1]) is None
    assert truncated_solution(np.zeros((4, 4)), np.ones(4), np.eye(4)[:1]) is None


def graded(least, count=80, seed=0):
    """A triangle whose singular values go from 1 down to `least`, a right side, and the solution by all of them."""
    rng = np.random.default_rng(seed)
    left, right = (np.linalg.qr(rng.normal(size=(count, count)))[0] for _ in range(2))
    values = np.geomspace(1.0, least, count)
    triangle, wanted = np.linalg.qr(left * values @ right.T, mode="r"), rng.normal(size=count)
    outer, found, inner = np.linalg.svd(triangle)
    return triangle, wanted, inner.T @ (outer.T @ wanted / found)


@pytest.mark.parametrize("least", [0.5, 1e-3, 1e-6, 1e-9])
def test_where_all_values_count_it_is_the_solution(least):
    triangle, right, wanted = graded(least)
    found = regular_solution(triangle, right)
    assert found is not None
    assert np.abs(found - wanted).max() < 1e-13 / least * np.abs(wanted).max()


@pytest.mark.parametrize("least", [1e-12, 1e-13, 1e-16])
def test_where_one_may_not_count_none_is_given(least):
    triangle, right, _ = graded(least)
    assert regular_solution(triangle, right) is None
    assert regular_solution(np.zeros((4, 4)), np.ones(4)) is None


def test_steps_of_large_blocks_are_those_by_singular_values():
    """Equations in a batch, some of full rank, one with a direction that nothing holds, all with rows of zeros."""
    rng = np.random.default_rng(3)
    count, rows = REDUCED_RATES + 5, 2 * REDUCED_RATES
    jacobian, missed = rng.normal(size=(4, rows, count)), rng.normal(size=(4, rows))
    jacobian[:, ::7] = 0.0
    jacobian[2, :, 3] = jacobian[2, :, 4]
    found = least_change(jacobian, missed, Rank(share=1e-12))
    for one, equation, right in zip(found, jacobian, missed, strict=True):
        np.testing.assert_allclose(one, np.linalg.pinv(equation, rcond=1e-12) @ right, atol=1e-10)
