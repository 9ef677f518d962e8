"""The equations of motion: derivative of the state, and its projection onto closed loops."""

from __future__ import annotations

import math

from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Ints
from kinform.simulation.kernel.articulated import resist
from kinform.simulation.kernel.forces import between, drive, law, loads, meter
from kinform.simulation.kernel.loops import gained, gap_of
from kinform.simulation.kernel.masses import cholesky, inertias, mass_matrix, solve_cholesky, wrenches
from kinform.simulation.kernel.motion import place_links, twist_links
from kinform.simulation.kernel.reduction import factor, settle

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, LINKS, COLUMNS, CLOSURES, SIGNALS, SPRINGS, MODE, CONSTANTS, GEARS, PIECES, STATE, MASS, VECTORS,
    RANK, LED, POSITIONS, STATES, RATES, LENGTH, LAST, KIND, Q, FIRST, WIDTH, SCREW, SIGNAL, METER, TWIST, GAIN, WRENCH,
    CHOSEN, WAY, FORCE, ACC, NEED, GAP, KEPT, PULLED,
    Row, Table, Index, Nums, Work,
)  # fmt: skip

TORN_GAP = 1e-4
"""Gap (rad, or lengths) up to which rows that depended on others count as closed: what the rank overlooks
(`SolverSettings.free`)."""
SLOW_CORRECTION = 0.05
"""Corrections that leave more than this share of a gap are made by new factors: a choice."""
MOST_CORRECTIONS = 10
"""Corrections of a pose; they converge in three or four."""


def impose(links: Index, columns: Index, values: Table, pieces: Table, t: float, y: Row, first: int) -> None:
    """Puts led joints where their laws have them."""
    for i in range(1, len(links)):
        k = links[i][FIRST]
        if links[i][KIND] == SCREW and columns[k][SIGNAL] >= 0:
            value, rate, _ = law(values, pieces, columns[k][SIGNAL], t)
            y[links[i][Q]], y[first + k] = value, rate


def derivative(ints: Ints, nums: Nums, work: Work, t: float, y: Row, dy: Row) -> float:
    """Rate of change of the state y at t into dy; led joints in y are put on their laws.

    Returns how far the loops are from a singular pose (smallest pivot over the largest), −1 when a free
    motion has no mass.
    """
    counts, links, columns, closures, mode = ints[COUNTS], ints[LINKS], ints[COLUMNS], ints[CLOSURES], ints[MODE]
    constants, values, pieces = nums[CONSTANTS], nums[SIGNALS], nums[PIECES]
    state, matrix, vectors = work[STATE], work[MASS], work[VECTORS]
    n, rank, led, first = counts[0][RATES], counts[0][RANK], counts[0][LED], counts[0][POSITIONS]
    t = min(t, constants[0][LAST])
    if led > 0:
        impose(links, columns, values, pieces, t, y, first)
    place_links(ints, nums, work, y)
    twist_links(ints, work, y)
    articulated = mode[WAY][0] == 1
    if articulated:
        for i in range(1, len(links)):
            for c in range(WRENCH, WRENCH + 6):
                state[i][c] = 0.0
    else:
        inertias(ints, nums, work)
        wrenches(ints, nums, work)
    power = drive(ints, nums, vectors, t, y, dy)
    power += loads(ints, nums, state, t)
    power += between(ints[SPRINGS], nums[SPRINGS], state)
    if not articulated:
        mass_matrix(ints, nums, work, True)
    for k in range(n):
        if columns[k][METER] >= 0:
            meter(dy, columns[k][METER], 0.0, 0.0)
    margin = 1.0
    if rank == 0 and led == 0 and not articulated:
        if not cholesky(matrix, n):
            return -1.0
        for k in range(n):
            vectors[ACC][k], vectors[NEED][k] = vectors[FORCE][k], 0.0
        solve_cholesky(matrix, n, vectors[ACC])
    else:
        margin = factor(ints, nums, work)
        if margin <= 0.0:
            return margin
        for r in range(rank):
            vectors[GAP][r] = -gained(closures, nums[CLOSURES], state, constants[0][LENGTH], mode[CHOSEN][r], GAIN)
        for k in range(n):
            if columns[k][SIGNAL] >= 0:
                _, _, vectors[ACC][k] = law(values, pieces, columns[k][SIGNAL], t)
        if articulated:
            resist(ints, nums, work, y)
            vectors[KEPT][PULLED] = 1.0
        settle(ints, work)
        vectors[KEPT][PULLED] = 0.0
        for k in range(n):
            if columns[k][SIGNAL] >= 0:
                power += vectors[NEED][k] * y[first + k]
                if columns[k][METER] >= 0:
                    meter(dy, columns[k][METER], vectors[NEED][k], y[first + k])
    for i in range(1, len(links)):
        at, k = links[i][Q], first + links[i][FIRST]
        if links[i][KIND] == SCREW:
            dy[at] = y[k]
        else:
            w, a, b, c = y[at], y[at + 1], y[at + 2], y[at + 3]
            dy[at] = 0.5 * (-y[k] * a - y[k + 1] * b - y[k + 2] * c)
            dy[at + 1] = 0.5 * (y[k] * w + y[k + 1] * c - y[k + 2] * b)
            dy[at + 2] = 0.5 * (y[k + 1] * w + y[k + 2] * a - y[k] * c)
            dy[at + 3] = 0.5 * (y[k + 2] * w + y[k] * b - y[k + 1] * a)
    for k in range(n):
        dy[first + k] = vectors[ACC][k]
    dy[first + n + counts[0][STATES]] = power
    return margin


def move(links: Index, vectors: Table, y: Row) -> None:
    """Adds work[VECTORS][ACC], a displacement, to the positions in y."""
    for i in range(1, len(links)):
        at, k = links[i][Q], links[i][FIRST]
        if links[i][KIND] == SCREW:
            y[at] += vectors[ACC][k]
            continue
        d0, d1, d2 = vectors[ACC][k], vectors[ACC][k + 1], vectors[ACC][k + 2]
        w, a, b, c = y[at], y[at + 1], y[at + 2], y[at + 3]
        y[at] = w - 0.5 * (d0 * a + d1 * b + d2 * c)
        y[at + 1] = a + 0.5 * (d0 * w + d1 * c - d2 * b)
        y[at + 2] = b + 0.5 * (d1 * w + d2 * a - d0 * c)
        y[at + 3] = c + 0.5 * (d2 * w + d0 * b - d1 * a)


def pace_of(ints: Ints, nums: Nums, state: Table, y: Row, row: int) -> float:
    """How fast row `row` of the loops opens at the rates in y, which the links' twists have."""
    total = gained(ints[CLOSURES], nums[CLOSURES], state, nums[CONSTANTS][0][LENGTH], row, TWIST)
    gear = row - 6 * len(ints[CLOSURES])
    if gear >= 0:
        for k in range(ints[COUNTS][0][RATES]):
            total += nums[GEARS][gear][k] * y[ints[COUNTS][0][POSITIONS] + k]
    return total


def torn(ints: Ints, nums: Nums, work: Work, y: Row) -> float:
    """The greatest gap of the loops or of their rates in y, where `derivative` was just called."""
    state, most = work[STATE], 0.0
    for r in range(ints[COUNTS][0][RANK]):
        row = ints[MODE][CHOSEN][r]
        gap = gap_of(ints, nums, state, y, row)
        most = max(most, abs(gap), abs(pace_of(ints, nums, state, y, row)))
    return most


def normalise_balls(links: Index, y: Row) -> None:
    """Gives the quaternions of balls in y unit length."""
    for i in range(1, len(links)):
        if links[i][WIDTH] == 3:
            at = links[i][Q]
            a, b, c, d = y[at], y[at + 1], y[at + 2], y[at + 3]
            norm = math.sqrt(a * a + b * b + c * c + d * d)
            for j in range(4):
                y[at + j] /= norm


def close_rates(ints: Ints, nums: Nums, work: Work, y: Row) -> None:
    """Takes from the rates in y the least, by mass, that opens the loops, by the factors that there are."""
    vectors, n, first = work[VECTORS], ints[COUNTS][0][RATES], ints[COUNTS][0][POSITIONS]
    twist_links(ints, work, y)
    for r in range(ints[COUNTS][0][RANK]):
        vectors[GAP][r] = -pace_of(ints, nums, work[STATE], y, ints[MODE][CHOSEN][r])
    for k in range(n):
        vectors[ACC][k] = 0.0
    settle(ints, work)
    for k in range(n):
        y[first + k] += vectors[ACC][k]


def project(ints: Ints, nums: Nums, work: Work, t: float, y: Row, closed: float, factored: bool) -> float:
    """Closes the loops in y to `closed` by least corrections, by mass, of positions and then of rates.

    `factored`: `derivative` was just called at y, and what it left serves for all corrections while they
    shrink fast; else they are made anew as they must for loops closed to rounding. Quaternions get unit
    length. Returns the gap left, −1 when a free motion has no mass; writes how good the pivots still are to
    work[VECTORS][KEPT].
    """
    links, mode, state, vectors = ints[LINKS], ints[MODE], work[STATE], work[VECTORS]
    n, rank, first = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], ints[COUNTS][0][POSITIONS]
    if ints[COUNTS][0][LED] > 0:
        impose(links, ints[COLUMNS], nums[SIGNALS], nums[PIECES], min(t, nums[CONSTANTS][0][LAST]), y, first)
    normalise_balls(links, y)
    vectors[KEPT][0] = 1.0
    if rank == 0:
        return 0.0
    for k in range(n):
        vectors[FORCE][k] = 0.0
    before, size = 1e300, 1e300
    for count in range(MOST_CORRECTIONS):
        place_links(ints, nums, work, y)
        size = 0.0
        for r in range(rank):
            vectors[GAP][r] = -gap_of(ints, nums, state, y, mode[CHOSEN][r])
            size = max(size, abs(vectors[GAP][r]))
        stale = count > 0 and size > SLOW_CORRECTION * before if factored else before > SOLVED
        if stale:
            if mode[WAY][0] == 0:
                inertias(ints, nums, work)
                mass_matrix(ints, nums, work, False)
            margin = factor(ints, nums, work)
            if margin <= 0.0:
                return size if margin == 0.0 else -1.0
        if size <= closed or not size < before:
            break
        before = size
        for k in range(n):
            vectors[ACC][k] = 0.0
        settle(ints, work)
        move(links, vectors, y)
    if not factored:
        for row in range(6 * len(ints[CLOSURES]) + len(nums[GEARS])):
            # The rows that depend on the others at the start must stay closed too.
            rest = abs(gap_of(ints, nums, state, y, row))
            if rest > TORN_GAP:
                size = max(size, rest)
    for _ in range(2 if factored else 1):
        close_rates(ints, nums, work, y)
    return size
