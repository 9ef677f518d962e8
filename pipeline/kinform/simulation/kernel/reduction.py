"""Efforts and rates with loops closed: the mass matrix of the motions that keep them so, and solutions by it.

Rates x (accelerations, or corrections) with x_d = g − B x_il balance the efforts, or are least by the mass
matrix when there are none. Rates are in the order of the mode throughout: dependent, free, led.
"""

from __future__ import annotations

from kinform.simulation.kernel.layout import (
    ACC,
    COUNTS,
    FORCE,
    GAP,
    HALF,
    KEPT,
    LED,
    MASS,
    MODE,
    NEED,
    RANK,
    RATES,
    REDUCED,
    RIGHT,
    ROWS,
    SCALE,
    TRIAL,
    VECTORS,
)
from kinform.simulation.kernel.loops import back_substitute, eliminate, gather
from kinform.simulation.kernel.masses import cholesky, solve_cholesky
from kinform.simulation.kernel.types import Index, Ints, Nums, Table, Work

__all__ = ["balance", "factor", "reduce", "settle"]


def reduce(matrix: Table, rows: Table, half: Table, small: Table, n: int, rank: int, led: int) -> bool:
    """Mass matrix of the motions E that keep the loops closed, its free part factored. False when a
    free motion has no mass."""
    rest = n - rank
    for i in range(n):
        for j in range(rest):
            half[i, j] = matrix[i, rank + j]
        for d in range(rank):
            value = matrix[i, d]
            if value != 0.0:
                for j in range(rest):
                    half[i, j] -= value * rows[d, rank + j]
    for i in range(rest):
        for j in range(rest):
            small[i, j] = half[rank + i, j]
        for d in range(rank):
            value = rows[d, rank + i]
            if value != 0.0:
                for j in range(rest):
                    small[i, j] -= value * half[d, j]
    return cholesky(small, rest - led)


def balance(matrix: Table, rows: Table, small: Table, mode: Index, vectors: Table, n: int, rank: int, led: int) -> None:
    """Solves for work[VECTORS][ACC] from [FORCE], [GAP] (dependent rates) and led rates in [ACC].

    [NEED] is the effort that led rates take.
    """
    rest, free = n - rank, n - rank - led
    # Efforts less what the gap takes, on the motions E.
    for i in range(n):
        total = vectors[FORCE, mode[1, i]]
        for d in range(rank):
            total -= matrix[i, d] * vectors[GAP, d]
        vectors[TRIAL, i] = total
    for j in range(rest):
        total = vectors[TRIAL, rank + j]
        for d in range(rank):
            total -= rows[d, rank + j] * vectors[TRIAL, d]
        vectors[RIGHT, j] = total
        vectors[NEED, j] = -total
    for j in range(free):
        for k in range(led):
            vectors[RIGHT, j] -= small[free + k, j] * vectors[ACC, mode[1, rank + free + k]]
    solve_cholesky(small, free, vectors[RIGHT])
    for j in range(free):
        vectors[ACC, mode[1, rank + j]] = vectors[RIGHT, j]
    for d in range(rank):
        total = vectors[GAP, d]
        for j in range(rest):
            total -= rows[d, rank + j] * vectors[ACC, mode[1, rank + j]]
        vectors[ACC, mode[1, d]] = total
    for k in range(led):
        total = vectors[NEED, free + k]
        for j in range(rest):
            # Rows of led rates keep the whole reduced matrix left of their own block.
            total += small[free + k, j] * vectors[ACC, mode[1, rank + j]]
        vectors[TRIAL, k] = total
    for k in range(n):
        vectors[NEED, k] = 0.0
    for k in range(led):
        vectors[NEED, mode[1, rank + free + k]] = vectors[TRIAL, k]


def factor(ints: Ints, nums: Nums, work: Work) -> float:
    """Independent rows of the loops at the present pose, and the mass matrix reduced by them.

    Returns how far the loops are from a singular pose (smallest pivot over the largest), 0 in one, −1 when
    a free motion has no mass; writes how good the pivots still are to work[VECTORS][KEPT].
    """
    n, rank, led = ints[COUNTS][0, RATES], ints[COUNTS][0, RANK], ints[COUNTS][0, LED]
    rows, vectors = work[ROWS], work[VECTORS]
    gather(ints, nums, work, rank)
    margin, vectors[KEPT, 0] = eliminate(rows, ints[MODE], nums[SCALE], vectors, rank, n)
    if margin != 0.0 and not reduce(work[MASS], rows, work[HALF], work[REDUCED], n, rank, led):
        return -1.0
    return margin


def settle(ints: Ints, work: Work) -> None:
    """Solves for work[VECTORS][ACC] and [NEED] from [FORCE], [GAP] (by independent rows) and led rates in
    [ACC], by what `factor` left."""
    n, rank, led = ints[COUNTS][0, RATES], ints[COUNTS][0, RANK], ints[COUNTS][0, LED]
    back_substitute(work[ROWS], work[VECTORS], rank)
    balance(work[MASS], work[ROWS], work[REDUCED], ints[MODE], work[VECTORS], n, rank, led)
