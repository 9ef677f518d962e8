"""Which coordinates of a mechanism determine the others, by the equations between their rates."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.model.arrays import Array

CLOSE_CHOICE = 0.7
"""Choices within this factor of the best count as equal, and the first is taken: the same on all machines, whatever the
last digits are. Chosen, not measured: any factor clearly below 1 does that."""


def free_columns(equations: Sequence[Array]) -> list[int]:
    """Columns, n − m of them, ascending, of which the others are functions by independent equations (m, n) in each of
    some poses: one after the other the first that still moves nearly as freely as any that they hold, in all poses."""
    bound = np.flatnonzero(np.any([rows.any(axis=0) for rows in equations], axis=0))
    # what no equation holds is free, and has no say in what else is
    chosen: list[int] = np.setdiff1d(np.arange(equations[0].shape[1]), bound).tolist()
    if not len(bound):
        return chosen
    spaces = [np.linalg.svd(rows[:, bound], full_matrices=True)[2][len(rows) :].T for rows in equations]
    while spaces[0].shape[1]:
        score = np.min([np.linalg.norm(space, axis=1) for space in spaces], axis=0)
        k = int(np.flatnonzero(score >= CLOSE_CHOICE * score.max())[0])
        chosen.append(int(bound[k]))
        spaces = [_without(space, k) for space in spaces]
    return sorted(chosen)


def _without(space: Array, k: int) -> Array:
    """An orthonormal basis of the vectors of `space` (n, m), orthonormal columns, whose component k is zero: reflected
    so that only the first has such a component, the other columns."""
    mirror = space[k].copy()
    mirror[0] += math.copysign(float(np.linalg.norm(mirror)), mirror[0])
    mirror /= np.linalg.norm(mirror)
    return np.asarray((space - 2.0 * np.outer(space @ mirror, mirror))[:, 1:])
