"""One step: the method of Dormand and Prince of order 8 with its dense output of order 7.

After Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section II.5 and their
program DOP853.
"""

from __future__ import annotations

import math

from kinform.model.arrays import Ints
from kinform.simulation.kernel.equations import derivative, project, torn
from kinform.simulation.kernel.masses import energies

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, STAGES, DENSE, COEFFICIENTS,
    RANK, SIZE, METERS, B_ROW, C_ROW, E3_ROW, E5_ROW, D_ROW, AT_END, TRIED, NEW, ROUND, FAILED,
    NOW, RTOL, ATOL, CLOSED, NEAR, MARGIN, TIGHTEST, LEAST, SPAN, MARGINS, ENERGY,
    SLOPES,
    Row, Counts, Nums, Work,
)  # fmt: skip

CLOSED_SHARE = 1e-4
"""Share of the tolerance to which loops are closed at an evaluation of a step: a choice, so that what is left open is
none of its error."""
DISTURBANCE = 2.0**-51
"""Share of a number by which it is disturbed to see what roundings do: twice the spacing of doubles."""
ROUNDING_NOISE = 1e-13
"""Relative rounding of accelerations, times the margin: loops are closed to 1e-14 (`SolverSettings.closed`), and a few
such gaps remain in them. Not a level of rounding: steps near singular poses are as long as it allows."""
LEAST_NOISY_MARGIN = 1e-5
"""Margin below which the noise is not taken to grow further: bounds a quotient. A choice, far below the margins at
which steps are laid across."""


def slope(ints: Ints, nums: Nums, work: Work, clock: Row, t: float, y: Row, dy: Row) -> float:
    """The derivative, in y closed first when a singular pose is near: accelerations depend on it there."""
    margin = derivative(ints, nums, work, t, y, dy)
    clock[LEAST] = min(clock[LEAST], abs(margin))
    if 0.0 <= margin < clock[NEAR] and ints[COUNTS][0][RANK] > 0:
        if margin < clock[MARGIN]:
            clock[MARGIN], clock[TIGHTEST] = margin, t
        # An error of accelerations grows with the inverse square of the margin.
        share = margin / clock[NEAR]
        closed = max(clock[CLOSED], CLOSED_SHARE * clock[RTOL] * share * share)
        if margin == 0.0 or torn(ints, nums, work, y) > closed:
            project(ints, nums, work, t, y, closed, margin > 0.0)
            margin = derivative(ints, nums, work, t, y, dy)
    return margin


def roundings(ints: Ints, nums: Nums, work: Work, clock: Row, tally: Counts, y: Row) -> None:
    """Writes to [ROUND] how far the slopes at y are known: what changes by a rounding of each number do to them; and to
    clock[ENERGY] which energies flow.

    Bodies of small inertia in mechanisms of much greater lose so many digits that tolerances cannot be kept.
    """
    t = clock[NOW]
    slopes, size = work[STAGES], ints[COUNTS][0][SIZE]
    tally[SLOPES] += 2
    for i in range(size):
        slopes[TRIED][i] = y[i]
    derivative(ints, nums, work, t, slopes[TRIED], slopes[ROUND])
    for i in range(size):
        slopes[TRIED][i] = y[i] * (1.0 + (DISTURBANCE if i % 3 != 1 else -DISTURBANCE))
    if derivative(ints, nums, work, t, slopes[TRIED], slopes[NEW]) < 0.0:
        return
    clock[ENERGY] = max(clock[ENERGY], energies(ints, nums, work))
    for i in range(size):
        slopes[ROUND][i] = abs(slopes[NEW][i] - slopes[ROUND][i])


def stage(ints: Ints, nums: Nums, work: Work, clock: Row, tally: Counts, y: Row, s: int) -> float:
    """Evaluation number s of the step from y, from those before; its state stays in row TRIED."""
    slopes, shares, tried, h = work[STAGES], nums[COEFFICIENTS][s], work[STAGES][TRIED], clock[SPAN]
    for i in range(ints[COUNTS][0][SIZE]):
        total = 0.0
        for j in range(s):
            total += shares[j] * slopes[j][i]
        tried[i] = y[i] + h * total
    tally[SLOPES] += 1
    return slope(ints, nums, work, clock, clock[NOW] + nums[COEFFICIENTS][C_ROW][s] * h, tried, slopes[s])


def try_step(ints: Ints, nums: Nums, work: Work, clock: Row, tally: Counts, y: Row) -> float:
    """Slopes of the step from y and the new state; its error over the tolerance, FAILED where it has none."""
    slopes, new, size, h = work[STAGES], work[STAGES][NEW], ints[COUNTS][0][SIZE], clock[SPAN]
    meters = ints[COUNTS][0][METERS]
    b_row, e3_row, e5_row = nums[COEFFICIENTS][B_ROW], nums[COEFFICIENTS][E3_ROW], nums[COEFFICIENTS][E5_ROW]
    clock[LEAST] = 1.0
    for s in range(1, 12):
        margin = stage(ints, nums, work, clock, tally, y, s)
        if margin < 0.0:
            # So far off the motion that numbers overflow, most often: with a shorter step it may be well.
            return FAILED
        clock[MARGINS + s] = margin
    third, fifth = 0.0, 0.0
    for i in range(size):
        total, three, five = 0.0, 0.0, 0.0
        for j in range(12):
            value = slopes[j][i]
            total += b_row[j] * value
            three += e3_row[j] * value
            five += e5_row[j] * value
        new[i] = y[i] + h * total
        if size - 1 - meters <= i < size - 1:
            continue
        # Work is the small difference of great energies where a heavy thing goes on at its speed.
        least = clock[ATOL] * max(1.0, clock[ENERGY]) if i == size - 1 else clock[ATOL]
        # What rounding does to a slope no step can do better than.
        # Times what one disturbance does to the slopes that is allowed for: others do more. A choice.
        allowed = least + clock[RTOL] * max(abs(y[i]), abs(new[i])) + h * 4.0 * slopes[ROUND][i]
        three, five = three / allowed, five / allowed
        third += three * three
        fifth += five * five
    if fifth == 0.0 and third == 0.0:
        return 0.0
    # Near a singular pose rounding errors of the accelerations grow: no step can do better than they.
    noise = max(1.0, ROUNDING_NOISE / max(clock[LEAST], LEAST_NOISY_MARGIN) / clock[RTOL])
    # Weight of the estimate of order 3 beside that of order 5 in the error of a step: that of Hairer's DOP853.
    return float(h * fifth / math.sqrt((fifth + 0.01 * third) * (size - meters)) / noise)


def prepare(ints: Ints, nums: Nums, work: Work, clock: Row, tally: Counts, y: Row) -> None:
    """Coefficients of the dense output of the step from y to the new state."""
    slopes, table, dense, h = work[STAGES], nums[COEFFICIENTS], work[DENSE], clock[SPAN]
    for s in range(13, 16):
        stage(ints, nums, work, clock, tally, y, s)
    for i in range(ints[COUNTS][0][SIZE]):
        rise = slopes[NEW][i] - y[i]
        dense[0][i] = rise
        dense[1][i] = h * slopes[0][i] - rise
        dense[2][i] = 2.0 * rise - h * (slopes[AT_END][i] + slopes[0][i])
        for r in range(4):
            total, shares = 0.0, table[D_ROW + r]
            for j in range(16):
                total += shares[j] * slopes[j][i]
            dense[3 + r][i] = h * total


def interpolate(work: Work, y: Row, i: int, x: float) -> float:
    """Component i of the state at the share x of the step from y."""
    dense = work[DENSE]
    total = 0.0
    for r in range(6, -1, -1):
        total = (total + dense[r][i]) * (x if r % 2 == 0 else 1.0 - x)
    return float(y[i] + total)
