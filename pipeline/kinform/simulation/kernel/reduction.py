"""Efforts and rates with loops closed: the mass matrix of the motions that keep them so, and solutions by it.

With the rates in the order dependent d, free i, led l the loops say x_d = g − B x_il, and motions E = (−B; 1)
keep them closed. Rates x (accelerations, or corrections) balance the efforts, or are least by the mass matrix
when there are none: Eᵀ (M x − f) vanishes for the free ones, and is the effort that led ones need.
"""

from __future__ import annotations

from kinform.model.arrays import Ints
from kinform.simulation.kernel.articulated import articulate, settle_tree
from kinform.simulation.kernel.loops import back_substitute, eliminate, gather
from kinform.simulation.kernel.masses import cholesky, solve_cholesky

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, COLUMNS, MODE, MASS, ROWS, HALF, REDUCED, VECTORS, MOTIONS,
    RANK, LED, RATES, BEFORE, ORDER, WAY,
    FORCE, ACC, NEED, GAP, TRIAL, RIGHT,
    Row, Table, Index, Nums, Work,
)  # fmt: skip


def weigh(before: Index, matrix: Table, x: Row, n: int, out: Row) -> None:
    """Takes the mass matrix times x from `out`. The matrix has numbers where rates carry each other only."""
    for k in range(n):
        total, own, row = 0.0, x[k], matrix[k]
        j = before[k][BEFORE]
        while j >= 0:
            total += row[j] * x[j]
            out[j] -= row[j] * own
            j = before[j][BEFORE]
        out[k] -= total + row[k] * own


def reduce(ints: Ints, work: Work) -> float:
    """Lower triangle of the mass matrix of the motions that keep the loops closed, its free part factored.
    Returns −1 when a free motion has no mass."""
    n, rank, led = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], ints[COUNTS][0][LED]
    before, order, matrix, rows = ints[COLUMNS], ints[MODE][ORDER], work[MASS], work[ROWS]
    motions, half, small = work[MOTIONS], work[HALF], work[REDUCED]
    rest = n - rank
    for i in range(n):
        motion, product = motions[order[i]], half[i]
        for c in range(rest):
            motion[c], product[c] = 0.0, 0.0
    for d in range(rank):
        motion, row = motions[order[d]], rows[d]
        for c in range(rest):
            motion[c] = -row[rank + c]
    for c in range(rest):
        motions[order[rank + c]][c] = 1.0
    for k in range(n):
        j, product, motion = k, half[k], motions[k]
        while j >= 0:
            value, other, over = matrix[k][j], motions[j], half[j]
            for c in range(rest):
                product[c] += value * other[c]
            if j != k:
                for c in range(rest):
                    over[c] += value * motion[c]
            j = before[j][BEFORE]
    for i in range(rest):
        row, product = small[i], half[order[rank + i]]
        for c in range(i + 1):
            row[c] = product[c]
        for d in range(rank):
            value, product = rows[d][rank + i], half[order[d]]
            if value != 0.0:
                for c in range(i + 1):
                    row[c] -= value * product[c]
    return 0.0 if cholesky(small, rest - led) else -1.0


def factor(ints: Ints, nums: Nums, work: Work) -> float:
    """Independent rows of the loops at the present pose, and the mass matrix reduced by them.

    Returns how far the loops are from a singular pose (smallest pivot over the largest), 0 in one, −1 when
    a free motion has no mass; writes how good the pivots still are to work[VECTORS][KEPT].
    """
    gather(ints, nums, work, ints[COUNTS][0][RANK])
    margin = eliminate(ints, nums, work)
    if ints[MODE][WAY][0] == 1:
        return -1.0 if margin != 0.0 and articulate(ints, nums, work) < 0.0 else margin
    if margin != 0.0 and reduce(ints, work) < 0.0:
        return -1.0
    return margin


def settle(ints: Ints, work: Work) -> None:
    """Solves for work[VECTORS][ACC] from [FORCE], [GAP] (by independent rows) and led rates in [ACC], by what
    `factor` left. [NEED] is the effort that led rates take."""
    if ints[MODE][WAY][0] == 1:
        settle_tree(ints, work)
        return
    n, rank, led = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], ints[COUNTS][0][LED]
    before, order, matrix = ints[COLUMNS], ints[MODE][ORDER], work[MASS]
    rows, small, vectors = work[ROWS], work[REDUCED], work[VECTORS]
    force, x, need = vectors[FORCE], vectors[ACC], vectors[NEED]
    left, right = vectors[TRIAL], vectors[RIGHT]
    back_substitute(rows, ints[MODE], vectors, rank)
    free = n - rank - led
    for d in range(rank):
        total, row = vectors[GAP][d], rows[d]
        for k in range(rank + free, n):
            total -= row[k] * x[order[k]]
        x[order[d]] = total
    for k in range(rank, rank + free):
        x[order[k]] = 0.0
    for k in range(n):
        left[k] = force[k]
        need[k] = 0.0
    weigh(before, matrix, x, n, left)
    for i in range(rank, n):
        total = left[order[i]]
        for d in range(rank):
            total -= rows[d][i] * left[order[d]]
        right[i - rank] = total
    solve_cholesky(small, free, right)
    for i in range(free):
        value = right[i]
        x[order[rank + i]] = value
        for d in range(rank):
            x[order[d]] -= rows[d][rank + i] * value
    for k in range(free, free + led):
        total = -right[k]
        for j in range(free):
            total += small[k][j] * right[j]
        need[order[rank + k]] = total
