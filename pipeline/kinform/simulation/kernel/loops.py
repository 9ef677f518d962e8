"""Closes loops: independent rows and dependent rates, factors, and what follows from both.

Rows and rates are chosen once (`pivoting`) and kept while their pivots stay good; every evaluation eliminates
in that order, never by a tolerance of its own. With the rates in the
order dependent d, free i, led l the loops say x_d = g − B x_il; motions E = (−B; 1) keep them closed.
"""

from __future__ import annotations

from kinform.model.arrays import Ints
from kinform.simulation.kernel.vectors import along, cross, dot, place, six

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, LINKS, COLUMNS, CLOSURES, MODE, CONSTANTS, SCALE, GEARS, STATE, SCREWS, ROWS, VECTORS,
    RANK, POSITIONS, RATES, LENGTH, TIP, BEFORE, CHOSEN, ORDER, PLACE, LOWEST, REACH,
    GAP, PIVOT, REFERENCE, KEPT,
    Row, Table, Index, Nums, Work,
)  # fmt: skip


def line_of(frame: Row, tip: Row, length: float, axis: int) -> tuple[float, float, float, float, float, float]:
    """The wrench (τ; f) about the centre whose power is the rate of the gap along axis 0 to 5 of a loop,
    whose frame (row of nums[CLOSURES]) the tip carries."""
    e0, e1, e2 = along(tip, frame, 3 * (axis % 3))
    if axis < 3:
        return e0, e1, e2, 0.0, 0.0, 0.0
    e0, e1, e2 = e0 / length, e1 / length, e2 / length
    x, y, z = place(tip, frame, 9)
    m0, m1, m2 = cross(x, y, z, e0, e1, e2)
    return m0, m1, m2, e0, e1, e2


def gained(closures: Index, numbers: Table, state: Table, length: float, row: int, of: int) -> float:
    """What the links' motions in state from column `of` on add to the gap in row `row` of a loop: its rate
    for TWIST, its acceleration at constant rates for GAIN. 0 for gears, which know no links."""
    loop, axis = row // 6, row % 6
    if loop >= len(closures):
        return 0.0
    m0, m1, m2, f0, f1, f2 = line_of(numbers[loop], state[closures[loop][0]], length, axis)
    total = 0.0
    for side in range(2):
        w0, w1, w2, l0, l1, l2 = six(state[closures[loop][side]], of)
        total += (2.0 * side - 1.0) * (dot(m0, m1, m2, w0, w1, w2) + dot(f0, f1, f2, l0, l1, l2))
    return total


def gap_of(ints: Ints, nums: Nums, state: Table, y: Row, row: int) -> float:
    """What row `row` of the loops has open in the positions of y, which the links' poses have."""
    counts, closures, total = ints[COUNTS][0], ints[CLOSURES], 0.0
    loop, axis = row // 6, row % 6
    if loop >= len(closures):
        gear = nums[GEARS][row - 6 * len(closures)]
        for k in range(counts[POSITIONS]):
            total += gear[counts[RATES] + k] * y[k]
        return total
    a, b, frame = state[closures[loop][0]], state[closures[loop][1]], nums[CLOSURES][loop]
    e0, e1, e2 = along(a, frame, 3 * (axis % 3))
    if axis < 3:
        # Half the sum of cross products of the axes: the sine of the turn along its axis.
        for j in range(3):
            c0, c1, c2 = cross(a[j], a[3 + j], a[6 + j], b[j], b[3 + j], b[6 + j])
            total += 0.5 * dot(e0, e1, e2, c0, c1, c2)
        return total
    x0, x1, x2 = place(a, frame, 9)
    z0, z1, z2 = place(b, frame, 9)
    return dot(e0, e1, e2, z0 - x0, z1 - x1, z2 - x2) / nums[CONSTANTS][0][LENGTH]


def gather(ints: Ints, nums: Nums, work: Work, count: int) -> None:
    """Writes the first `count` rows of the mode into work[ROWS], rates in its order.

    Rows 6c to 6c + 5 are the turn and the displacement over the length of the target relative to the
    tip of loop c, along the axes of a frame that the tip carries; then come the gears.
    """
    n, closures, length = ints[COUNTS][0][RATES], ints[CLOSURES], nums[CONSTANTS][0][LENGTH]
    rank = ints[COUNTS][0][RANK]
    links, before, gears = ints[LINKS], ints[COLUMNS], nums[GEARS]
    chosen, places, lowest, highest = ints[MODE][CHOSEN], ints[MODE][PLACE], ints[MODE][LOWEST], ints[MODE][REACH]
    state, screws, rows, numbers = work[STATE], work[SCREWS], work[ROWS], nums[CLOSURES]
    for r in range(count):
        lowest[r] = r
    for r in range(count):
        loop, axis, row = chosen[r] // 6, chosen[r] % 6, rows[r]
        if loop >= len(closures):
            for c in range(n):
                row[c] = gears[chosen[r] - 6 * len(closures)][ints[MODE][ORDER][c]]
            lowest[0], highest[r] = r, rank - 1
            continue
        for c in range(n):
            row[c] = 0.0
        first, last = r, r
        m0, m1, m2, f0, f1, f2 = line_of(numbers[loop], state[closures[loop][0]], length, axis)
        # Both chains down to where they meet: what carries both moves neither relative to the other.
        one, other = links[closures[loop][0]][TIP], links[closures[loop][1]][TIP]
        while one != other:
            k = one if one > other else other
            w0, w1, w2, l0, l1, l2 = six(screws[k], 0)
            power = dot(m0, m1, m2, w0, w1, w2) + dot(f0, f1, f2, l0, l1, l2)
            if k == one:
                one = before[k][BEFORE]
                power = -power
            else:
                other = before[k][BEFORE]
            c = places[k]
            row[c] = power
            if c < rank:
                first = c if c < first else first
                last = c if c > last else last
        highest[r] = last
        if lowest[first] < r:
            lowest[first] = r


def eliminate(ints: Ints, nums: Nums, work: Work) -> float:
    """Factors the gathered rows in place, and reorders them, in the mode too, for stable pivots; the
    columns after the dependent ones become B. What [GAP] holds by rows is put in their order.

    Returns the smallest pivot over the largest; [KEPT] gets the smallest over that of its choice.
    """
    n, rank, mode = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], ints[MODE]
    rows, vectors, scale = work[ROWS], work[VECTORS], nums[SCALE]
    lowest, highest = mode[LOWEST], mode[REACH]
    low, high, last = 1e300, 0.0, 0
    vectors[KEPT][0] = 1.0
    for k in range(rank):
        best = k
        last = lowest[k] if lowest[k] > last else last
        lowest[k] = last
        for i in range(k + 1, last + 1):
            # Rows change places for a pivot so many times as large: a choice. Any order gives the same motion; fewer
            # changes keep rows sparse.
            if abs(rows[i][k]) > 1.5 * abs(rows[best][k]):
                best = i
        if best != k:
            # The same rows in an order that suits the pose, kept for the next: else a chain of loops
            # multiplies the roundings of each.
            for j in range(n):
                rows[k][j], rows[best][j] = rows[best][j], rows[k][j]
            mode[CHOSEN][k], mode[CHOSEN][best] = mode[CHOSEN][best], mode[CHOSEN][k]
            highest[k], highest[best] = highest[best], highest[k]
            vectors[GAP][k], vectors[GAP][best] = vectors[GAP][best], vectors[GAP][k]
        upper = rows[k]
        pivot = upper[k]
        size = abs(pivot) * scale[mode[ORDER][k]][0]
        if not size > 0.0:
            # nothing, or no number: a trial step went beyond what numbers can be
            vectors[KEPT][0] = 0.0
            return 0.0
        low, high = min(low, size), max(high, size)
        vectors[KEPT][0] = min(vectors[KEPT][0], size / vectors[REFERENCE][k])
        vectors[PIVOT][k] = 1.0 / pivot
        reach = highest[k]
        for i in range(k + 1, last + 1):
            row = rows[i]
            if row[k] != 0.0:
                factor = row[k] * vectors[PIVOT][k]
                row[k] = factor
                if highest[i] < reach:
                    highest[i] = reach
                for j in range(k + 1, reach + 1):
                    row[j] -= factor * upper[j]
                for j in range(rank, n):
                    row[j] -= factor * upper[j]
    for k in range(rank - 1, -1, -1):
        upper = rows[k]
        for i in range(k + 1, highest[k] + 1):
            factor, row = upper[i], rows[i]
            if factor != 0.0:
                for j in range(rank, n):
                    upper[j] -= factor * row[j]
        for j in range(rank, n):
            upper[j] *= vectors[PIVOT][k]
    return low / high if rank > 0 else 1.0


def back_substitute(rows: Table, mode: Index, vectors: Table, rank: int) -> None:
    """Turns work[VECTORS][GAP], by independent rows, into the dependent rates that make it up."""
    gaps = vectors[GAP]
    for i in range(rank):
        for k in range(i + 1, mode[LOWEST][i] + 1):
            gaps[k] -= rows[k][i] * gaps[i]
    for k in range(rank - 1, -1, -1):
        total, row = gaps[k], rows[k]
        for i in range(k + 1, mode[REACH][k] + 1):
            total -= row[i] * gaps[i]
        gaps[k] = total * vectors[PIVOT][k]
