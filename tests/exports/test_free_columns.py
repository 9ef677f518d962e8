"""The coordinates that are written as free determine the others, in every pose; those that nothing holds are free."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinform.exports.free_columns import free_columns

seeds = st.integers(0, 2**32 - 1)


def drawn(seed: int) -> list[np.ndarray]:
    """Independent equations in some poses, most of them with columns in which they have nothing."""
    rng = np.random.default_rng(seed)
    held = int(rng.integers(0, 5))
    columns = held + int(rng.integers(0, 5))
    rows = rng.normal(size=(int(rng.integers(1, 4)), held, columns))
    out = np.zeros((len(rows), held, columns + int(rng.integers(0, 4))))
    out[:, :, rng.permutation(out.shape[2])[:columns]] = rows
    return list(out)


@given(seeds)
def test_the_others_are_functions_of_them(seed: int) -> None:
    equations = drawn(seed)
    held, count = equations[0].shape
    free = free_columns(equations)
    assert free == sorted(set(free))
    assert len(free) == count - held
    others = np.setdiff1d(np.arange(count), free)
    assert all(np.linalg.matrix_rank(rows[:, others]) == held for rows in equations)


@given(seeds)
def test_what_nothing_holds_is_free_and_says_nothing_of_the_others(seed: int) -> None:
    equations = drawn(seed)
    loose = np.flatnonzero(~np.any([rows.any(axis=0) for rows in equations], axis=0))
    free = free_columns(equations)
    assert set(loose.tolist()) <= set(free)
    wider = [np.concatenate([rows, np.zeros((len(rows), 2))], axis=1) for rows in equations]
    count = equations[0].shape[1]
    assert free_columns(wider) == [*free, count, count + 1]


def test_the_first_of_those_that_move_nearly_as_freely_is_chosen() -> None:
    # a + b + 0.1 c = 0: c moves most freely, then a as much as b
    assert free_columns([np.array([[1.0, 1.0, 0.1]])]) == [0, 2]
    assert free_columns([np.array([[1.0, 0.2, 0.1]])]) == [1, 2]
