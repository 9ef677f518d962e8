"""What is said to open nowhere without a linear program opens nowhere in the linear program."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from support.diagonal import first

from kinform.kinematics.separation.cone import nothing_opens, nothing_opens_in_each
from kinform.kinematics.separation.lifting import LARGEST_TWIST


def fastest(rows, fixed):
    """The greatest sum of speeds, each up to 1, of motions that no row forbids."""
    n, size = rows.shape
    upper = np.block([[-rows, np.zeros((n, n))], [-rows, np.eye(n)]])
    held = {"A_eq": np.hstack([fixed, np.zeros((len(fixed), n))]), "b_eq": np.zeros(len(fixed))} if len(fixed) else {}
    bounds = [(-LARGEST_TWIST, LARGEST_TWIST)] * size + [(0.0, 1.0)] * n
    aim = np.concatenate([np.zeros(size), -np.ones(n)])
    return -linprog(aim, A_ub=upper, b_ub=np.zeros(2 * n), bounds=bounds, method="highs", **held).fun


def program(seed):
    """Unit rows (n, d) and fixed rows (m, d)."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(3, 13))
    fixed = rng.normal(size=(int(rng.integers(0, size)), size))
    rows = rng.normal(size=(int(rng.integers(1, 2 * size)), size))
    if seed % 2:
        # rows that pull against each other, and, of every third, by a hair not quite
        rows = np.vstack([rows, -rng.uniform(0.5, 2.0, len(rows)) @ rows])
        rows = rows + (10.0 ** -rng.integers(2, 9) * rng.normal(size=rows.shape) if seed % 3 == 0 else 0.0)
    return rows / np.linalg.norm(rows, axis=1)[:, None], fixed


@pytest.mark.parametrize("seed", range(40))
def test_what_opens_nowhere_for_certain_opens_nowhere(seed):
    rows, fixed = program(seed)
    if nothing_opens(rows, fixed):
        assert fastest(rows, fixed) < 0.5
    elif seed % 2 and seed % 3:
        pytest.fail("rows with a positive sum of nought are not recognised")


def test_rows_of_what_is_held_open_nowhere_and_others_do():
    across, along = np.eye(6)[:3], np.eye(6)[3:4]
    assert nothing_opens(across[:2], across)
    assert not nothing_opens(along, across)
    assert nothing_opens(np.vstack([along, -along]), across)


@pytest.mark.parametrize("seed", first(1, range(5)))
def test_what_is_said_of_a_block_does_not_depend_on_the_others(seed):
    programs = [program(k) for k in range(60)]
    programs += [(rows, fixed[:0]) for rows, fixed in programs[:10]]
    programs += [(rows[:1] * 0.0, fixed) for rows, fixed in programs[:10]]
    alone = [nothing_opens(*one) for one in programs]
    assert set(alone) == {True, False}
    rng = np.random.default_rng(seed)
    chosen = rng.permutation(len(programs))[: int(rng.integers(2, len(programs) + 1))].tolist()
    assert nothing_opens_in_each([programs[k] for k in chosen]) == [alone[k] for k in chosen]
