"""The equations of motion: derivative of the state, and its projection onto closed loops.

Both solve the same system: rates x (accelerations, or corrections) with x_d = g − B x_il that balance
the efforts, or are least by the mass matrix when there are none.
"""

from __future__ import annotations

import math

from kinform.simulation.kernel.forces import between, drive, loads
from kinform.simulation.kernel.layout import (
    ACC,
    ACTORS,
    CLOSURES,
    COLUMNS,
    CONSTANTS,
    COUNTS,
    FORCE,
    GAIN,
    GAP,
    GEARS,
    HALF,
    KIND,
    LAST,
    LED,
    LENGTH,
    LINKS,
    LOADS,
    MASS,
    MODE,
    NEED,
    PIECES,
    POSITIONS,
    RANK,
    RATES,
    REDUCED,
    RIGHT,
    ROWS,
    SCALE,
    SCREW,
    SCREWS,
    SIGNAL,
    SIGNALS,
    SPRINGS,
    STATE,
    STATES,
    TRIAL,
    TWIST,
    VECTORS,
    WIDTH,
    Q,
)
from kinform.simulation.kernel.loops import back_substitute, eliminate, gained, gap_of, gather
from kinform.simulation.kernel.masses import cholesky, inertias, mass_matrix, solve_cholesky, wrenches
from kinform.simulation.kernel.motion import place_links, twist_links
from kinform.simulation.kernel.signals import law
from kinform.simulation.kernel.types import Index, Ints, Nums, Row, Table, Work

TORN = 1e-4
"""Rows that depended on others leave a gap (rad, or lengths) at most as large as the rank overlooks."""

__all__ = ["balance", "derivative", "impose", "move", "project", "reduce"]


def impose(links: Index, columns: Index, values: Table, pieces: Table, t: float, y: Row, first: int) -> None:
    """Puts led joints where their laws have them."""
    for i in range(1, len(links)):
        k = links[i, 3]
        if links[i, KIND] == SCREW and columns[k, SIGNAL] >= 0:
            value, rate, _ = law(values, pieces, columns[k, SIGNAL], t)
            y[links[i, Q]], y[first + k] = value, rate


def reduce(matrix: Table, rows: Table, half: Table, small: Table, mode: Index, n: int, rank: int, led: int) -> bool:
    """Mass matrix of the motions E that keep the loops closed, its free part factored. False when a
    free motion has no mass."""
    for k in range(n):
        for j in range(k):
            matrix[j, k] = matrix[k, j]
    rest = n - rank
    for i in range(n):
        own = mode[1, i]
        for j in range(rest):
            half[i, j] = matrix[own, mode[1, rank + j]]
        for d in range(rank):
            value = matrix[own, mode[1, d]]
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
            total -= matrix[mode[1, i], mode[1, d]] * vectors[GAP, d]
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


def derivative(ints: Ints, nums: Nums, work: Work, t: float, y: Row, dy: Row) -> float:
    """Rate of change of the state y at t into dy; led joints in y are put on their laws.

    Returns how far the loops are from a singular pose (smallest pivot over the largest), −1 when a free
    motion has no mass.
    """
    counts, links, columns, closures, mode = ints[COUNTS], ints[LINKS], ints[COLUMNS], ints[CLOSURES], ints[MODE]
    state, screws, matrix, rows, small = work[STATE], work[SCREWS], work[MASS], work[ROWS], work[REDUCED]
    constants, values, pieces, vectors = nums[CONSTANTS], nums[SIGNALS], nums[PIECES], work[VECTORS]
    n, rank, led, first = counts[0, RATES], counts[0, RANK], counts[0, LED], counts[0, POSITIONS]
    t = min(t, constants[0, LAST])
    if led > 0:
        impose(links, columns, values, pieces, t, y, first)
    place_links(links, nums[LINKS], state, screws, y)
    twist_links(links, state, screws, y, first)
    inertias(links, nums[LINKS], state)
    wrenches(links, state, constants)
    power = drive(ints[ACTORS], nums[ACTORS], values, pieces, vectors, t, y, dy, first, n)
    power += loads(ints[LOADS], nums[LOADS], state)
    power += between(ints[SPRINGS], nums[SPRINGS], state)
    mass_matrix(links, columns, state, screws, matrix, vectors, True)
    margin = 1.0
    if rank == 0 and led == 0:
        if not cholesky(matrix, n):
            return -1.0
        for k in range(n):
            vectors[ACC, k], vectors[NEED, k] = vectors[FORCE, k], 0.0
        solve_cholesky(matrix, n, vectors[ACC])
    else:
        gather(ints, nums, work, rank)
        margin, _ = eliminate(rows, mode, nums[SCALE], vectors, rank, n)
        if margin == 0.0:
            return 0.0
        if not reduce(matrix, rows, work[HALF], small, mode, n, rank, led):
            return -1.0
        for r in range(rank):
            vectors[GAP, r] = -gained(closures, nums[CLOSURES], state, constants[0, LENGTH], mode[0, r], GAIN)
        back_substitute(rows, vectors, rank)
        for k in range(n):
            if columns[k, SIGNAL] >= 0:
                _, _, vectors[ACC, k] = law(values, pieces, columns[k, SIGNAL], t)
        balance(matrix, rows, small, mode, vectors, n, rank, led)
        for k in range(n):
            if columns[k, SIGNAL] >= 0:
                power += vectors[NEED, k] * y[first + k]
    for i in range(1, len(links)):
        at, k = links[i, Q], first + links[i, 3]
        if links[i, KIND] == SCREW:
            dy[at] = y[k]
        else:
            w, a, b, c = y[at], y[at + 1], y[at + 2], y[at + 3]
            dy[at] = 0.5 * (-y[k] * a - y[k + 1] * b - y[k + 2] * c)
            dy[at + 1] = 0.5 * (y[k] * w + y[k + 1] * c - y[k + 2] * b)
            dy[at + 2] = 0.5 * (y[k + 1] * w + y[k + 2] * a - y[k] * c)
            dy[at + 3] = 0.5 * (y[k + 2] * w + y[k] * b - y[k + 1] * a)
    for k in range(n):
        dy[first + k] = vectors[ACC, k]
    dy[first + n + counts[0, STATES]] = power
    return margin


def move(links: Index, vectors: Table, y: Row) -> None:
    """Adds work[VECTORS][ACC], a displacement, to the positions in y."""
    for i in range(1, len(links)):
        at, k = links[i, Q], links[i, 3]
        if links[i, KIND] == SCREW:
            y[at] += vectors[ACC, k]
            continue
        d0, d1, d2 = vectors[ACC, k], vectors[ACC, k + 1], vectors[ACC, k + 2]
        w, a, b, c = y[at], y[at + 1], y[at + 2], y[at + 3]
        y[at] = w - 0.5 * (d0 * a + d1 * b + d2 * c)
        y[at + 1] = a + 0.5 * (d0 * w + d1 * c - d2 * b)
        y[at + 2] = b + 0.5 * (d1 * w + d2 * a - d0 * c)
        y[at + 3] = c + 0.5 * (d2 * w + d0 * b - d1 * a)


def project(ints: Ints, nums: Nums, work: Work, t: float, y: Row, closed: float) -> tuple[float, float]:
    """Closes the loops in y to `closed` by least corrections, by mass, of positions and then of rates.

    Quaternions get unit length. Returns (gap left, smallest pivot over that of its choice); −1 for the
    first when a free motion has no mass.
    """
    counts, links, columns, closures, mode = ints[COUNTS], ints[LINKS], ints[COLUMNS], ints[CLOSURES], ints[MODE]
    state, screws, matrix, rows, small = work[STATE], work[SCREWS], work[MASS], work[ROWS], work[REDUCED]
    length, vectors = nums[CONSTANTS][0, LENGTH], work[VECTORS]
    n, rank, led, first = counts[0, RATES], counts[0, RANK], counts[0, LED], counts[0, POSITIONS]
    if led > 0:
        impose(links, columns, nums[SIGNALS], nums[PIECES], min(t, nums[CONSTANTS][0, LAST]), y, first)
    for i in range(1, len(links)):
        if links[i, WIDTH] == 3:
            at = links[i, Q]
            norm = math.sqrt(y[at] * y[at] + y[at + 1] * y[at + 1] + y[at + 2] * y[at + 2] + y[at + 3] * y[at + 3])
            for j in range(4):
                y[at + j] /= norm
    if rank == 0:
        return 0.0, 1.0
    for k in range(n):
        vectors[FORCE, k] = 0.0
    before, size, kept, factored = 1e300, 1e300, 1.0, False
    for _ in range(10):
        place_links(links, nums[LINKS], state, screws, y)
        size = 0.0
        for r in range(rank):
            vectors[GAP, r] = -gap_of(closures, nums[CLOSURES], nums[GEARS], state, y, length, n, mode[0, r])
            size = max(size, abs(vectors[GAP, r]))
        if not factored or before > 1e-9:
            inertias(links, nums[LINKS], state)
            mass_matrix(links, columns, state, screws, matrix, vectors, False)
            gather(ints, nums, work, rank)
            margin, kept = eliminate(rows, mode, nums[SCALE], vectors, rank, n)
            if margin == 0.0:
                return size, 0.0
            if not reduce(matrix, rows, work[HALF], small, mode, n, rank, led):
                return -1.0, kept
            factored = True
        if size <= closed or not size < before:
            break
        before = size
        back_substitute(rows, vectors, rank)
        for k in range(n):
            vectors[ACC, k] = 0.0
        balance(matrix, rows, small, mode, vectors, n, rank, led)
        move(links, vectors, y)
    for row in range(6 * len(closures) + len(nums[GEARS])):
        # The rows that depend on the others at the start must stay closed too.
        rest = abs(gap_of(closures, nums[CLOSURES], nums[GEARS], state, y, length, n, row))
        if rest > TORN:
            size = max(size, rest)
    twist_links(links, state, screws, y, first)
    for r in range(rank):
        total, gear = gained(closures, nums[CLOSURES], state, length, mode[0, r], TWIST), mode[0, r] - 6 * len(closures)
        if gear >= 0:
            for k in range(n):
                total += nums[GEARS][gear, k] * y[first + k]
        vectors[GAP, r] = -total
    back_substitute(rows, vectors, rank)
    for k in range(n):
        vectors[ACC, k] = 0.0
    balance(matrix, rows, small, mode, vectors, n, rank, led)
    for k in range(n):
        y[first + k] += vectors[ACC, k]
    return size, kept
