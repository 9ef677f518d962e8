"""Explicit integration: the method of Dormand and Prince of order 8 with its dense output of order 7.

After Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section II.5 and their
program DOP853, with their test for stiffness. Loops are closed again after every accepted step. The
equations of motion are arguments: compiled, they are called and not compiled again into what calls them.
"""

from __future__ import annotations

import math

from kinform.simulation.kernel.crossings import laid, tip
from kinform.simulation.kernel.layout import (
    ACC,
    ATOL,
    B_ROW,
    BUDGET,
    C_ROW,
    CLOSED,
    COEFFICIENTS,
    COUNTS,
    CROSSING,
    D_ROW,
    DENSE,
    DONE,
    E3_ROW,
    E5_ROW,
    END,
    FRESH,
    GIVEN,
    HIT,
    KEEP,
    LEAST,
    MARGIN,
    MARGINS,
    MASSLESS,
    NEAR,
    NEED,
    NEW,
    NEXT,
    NOISE,
    NOW,
    OPEN,
    OPENED,
    PATIENCE,
    PAUSE,
    PAUSED,
    RANK,
    RATES,
    ROUND,
    RTOL,
    SLOPES,
    SPENT,
    STAGES,
    STEP,
    STEPS,
    STIFF,
    STIFFENED,
    STOPPED,
    STOPS,
    STUCK,
    TIGHTEST,
    TRIED,
    VECTORS,
    WORN,
)
from kinform.simulation.kernel.types import Counts, Derivative, Ints, Nums, Project, Row, Table, Work

EDGE = 3.0
"""Step times the fastest decay: the method is stable up to about 6."""
LAYINGS = 4
"""Times that a step is laid anew to avoid a singular pose."""
EPSILON = 2.0**-51
"""A rounding or two of a number, as a share of it."""
ROUGH = 4.0
"""Times what one disturbance does to the slopes: others do more."""
AGAIN = 20
"""Steps after which roundings are looked at again."""
GROWTH = 2.5
"""Greatest growth of a step: with more, one can land far outside the region of stability unnoticed."""

__all__ = ["advance", "interpolate", "prepare", "roundings", "sample", "slope", "stop_reached", "try_step"]


def slope(
    derivative: Derivative,
    project: Project,
    ints: Ints,
    nums: Nums,
    work: Work,
    clock: Row,
    tally: Counts,
    t: float,
    y: Row,
    dy: Row,
) -> float:
    """The derivative, in y closed first when a singular pose is near: accelerations depend on it there."""
    tally[SLOPES] += 1
    margin = derivative(ints, nums, work, t, y, dy)
    clock[LEAST] = min(clock[LEAST], abs(margin))
    if 0.0 <= margin < clock[NEAR] and ints[COUNTS][0, RANK] > 0:
        if margin < clock[MARGIN]:
            clock[MARGIN], clock[TIGHTEST] = margin, t
        project(ints, nums, work, t, y, clock[CLOSED])
        margin = derivative(ints, nums, work, t, y, dy)
    return margin


def roundings(
    derivative: Derivative, ints: Ints, nums: Nums, work: Work, clock: Row, tally: Counts, y: Row, t: float
) -> None:
    """Writes to [ROUND] how far the slopes at y are known: what changes by a rounding of each number do to them.

    Bodies of small inertia in mechanisms of much greater lose so many digits that tolerances cannot be kept.
    """
    slopes, size = work[STAGES], len(y)
    tally[SLOPES] += 2
    for i in range(size):
        slopes[TRIED, i] = y[i]
    derivative(ints, nums, work, t, slopes[TRIED], slopes[ROUND])
    for i in range(size):
        slopes[TRIED, i] = y[i] * (1.0 + (EPSILON if i % 3 != 1 else -EPSILON))
    if derivative(ints, nums, work, t, slopes[TRIED], slopes[NEW]) < 0.0:
        return
    for i in range(size):
        slopes[ROUND, i] = abs(slopes[NEW, i] - slopes[ROUND, i])


def try_step(
    derivative: Derivative,
    project: Project,
    ints: Ints,
    nums: Nums,
    work: Work,
    clock: Row,
    tally: Counts,
    y: Row,
    h: float,
) -> float:
    """Slopes of one step and the new state; its error over the tolerance."""
    slopes, table = work[STAGES], nums[COEFFICIENTS]
    size = len(y)
    clock[LEAST] = 1.0
    for s in range(1, 12):
        for i in range(size):
            total = 0.0
            for j in range(s):
                total += table[s, j] * slopes[j, i]
            slopes[TRIED, i] = y[i] + h * total
        margin = slope(
            derivative,
            project,
            ints,
            nums,
            work,
            clock,
            tally,
            clock[NOW] + table[C_ROW, s] * h,
            slopes[TRIED],
            slopes[s],
        )
        if margin < 0.0:
            # So far off the motion that numbers overflow, most often: with a shorter step it may be well.
            return 1e300
        clock[MARGINS + s] = margin
    third, fifth = 0.0, 0.0
    for i in range(size):
        total, three, five = 0.0, 0.0, 0.0
        for j in range(12):
            total += table[B_ROW, j] * slopes[j, i]
            three += table[E3_ROW, j] * slopes[j, i]
            five += table[E5_ROW, j] * slopes[j, i]
        slopes[NEW, i] = y[i] + h * total
        # What rounding does to a slope no step can do better than.
        allowed = clock[ATOL] + clock[RTOL] * max(abs(y[i]), abs(slopes[NEW, i])) + h * ROUGH * slopes[ROUND, i]
        # Products, not powers: those of numpy's numbers are not rounded as those of compiled ones.
        three, five = three / allowed, five / allowed
        third += three * three
        fifth += five * five
    if fifth == 0.0 and third == 0.0:
        return 0.0
    # Near a singular pose rounding errors of the accelerations grow: no step can do better than they.
    noise = max(1.0, NOISE / max(clock[LEAST], 1e-5) / clock[RTOL])
    return float(h * fifth / math.sqrt((fifth + 0.01 * third) * size) / noise)


def prepare(
    derivative: Derivative,
    project: Project,
    ints: Ints,
    nums: Nums,
    work: Work,
    clock: Row,
    tally: Counts,
    y: Row,
    h: float,
) -> None:
    """Coefficients of the dense output of the step from y to the new state."""
    slopes, table, dense = work[STAGES], nums[COEFFICIENTS], work[DENSE]
    size = len(y)
    for s in range(13, 16):
        for i in range(size):
            total = 0.0
            for j in range(s):
                total += table[s, j] * slopes[j, i]
            slopes[TRIED, i] = y[i] + h * total
        slope(
            derivative,
            project,
            ints,
            nums,
            work,
            clock,
            tally,
            clock[NOW] + table[C_ROW, s] * h,
            slopes[TRIED],
            slopes[s],
        )
    for i in range(size):
        rise = slopes[NEW, i] - y[i]
        dense[0, i] = rise
        dense[1, i] = h * slopes[0, i] - rise
        dense[2, i] = 2.0 * rise - h * (slopes[12, i] + slopes[0, i])
        for r in range(4):
            total = 0.0
            for j in range(16):
                total += table[D_ROW + r, j] * slopes[j, i]
            dense[3 + r, i] = h * total


def interpolate(work: Work, y: Row, i: int, x: float) -> float:
    """Component i of the state at the share x of the step from y."""
    dense = work[DENSE]
    total = 0.0
    for r in range(6, -1, -1):
        total = (total + dense[r, i]) * (x if r % 2 == 0 else 1.0 - x)
    return float(y[i] + total)


def sample(
    derivative: Derivative, project: Project, ints: Ints, nums: Nums, work: Work, clock: Row, t: float, y: Row, out: Row
) -> None:
    """Writes an output: the state with loops closed, accelerations, efforts given and needed."""
    n, vectors, size = ints[COUNTS][0, RATES], work[VECTORS], len(y)
    project(ints, nums, work, t, y, clock[CLOSED])
    derivative(ints, nums, work, t, y, work[STAGES][TRIED + 2])
    for i in range(size):
        out[i] = y[i]
    for k in range(n):
        out[size + k] = vectors[ACC, k]
        out[size + n + k] = vectors[GIVEN, k]
        out[size + 2 * n + k] = vectors[NEED, k]


def stop_reached(ints: Ints, nums: Nums, work: Work, y: Row, x: float) -> tuple[int, float]:
    """(stop that is passed first before the share x of the step, where); −1 and x when none is."""
    stops, limits = ints[STOPS], nums[STOPS]
    found, end = -1, x
    for k in range(len(stops)):
        if stops[k, 3] != 0:
            continue
        at, sense = stops[k, 0], float(stops[k, 2])
        if not sense * (interpolate(work, y, at, end) - limits[k, 0]) > 1e-12:
            continue
        low, high = 0.0, end
        for _ in range(60):
            middle = 0.5 * (low + high)
            if sense * (interpolate(work, y, at, middle) - limits[k, 0]) > 0.0:
                high = middle
            else:
                low = middle
        found, end = k, high
    return found, end


def advance(
    derivative: Derivative,
    project: Project,
    ints: Ints,
    nums: Nums,
    work: Work,
    y: Row,
    clock: Row,
    tally: Counts,
    times: Row,
    out: Table,
) -> int:
    """Integrates y from clock[NOW] towards clock[END], filling outputs; says why it came back."""
    slopes, size = work[STAGES], len(y)
    rank = ints[COUNTS][0, RANK]
    if tally[FRESH] == 1:
        clock[MARGINS] = slope(derivative, project, ints, nums, work, clock, tally, clock[NOW], y, slopes[0])
        if clock[MARGINS] < 0.0:
            return MASSLESS
        roundings(derivative, ints, nums, work, clock, tally, y, clock[NOW])
        tally[FRESH] = 0
    spent, growth, layings = 0, GROWTH, 0
    while clock[NOW] < clock[END]:
        if tally[NEXT] >= tally[PAUSE]:
            return PAUSED
        if spent >= tally[BUDGET]:
            return SPENT
        spent += 1
        tally[STEPS] += 1
        if tally[STEPS] % AGAIN == 0:
            roundings(derivative, ints, nums, work, clock, tally, y, clock[NOW])
        wanted = clock[STEP]
        h = min(laid(wanted, clock[CROSSING] - clock[NOW]), clock[END] - clock[NOW])
        if h < 1e-13 * max(1.0, abs(clock[NOW])) and h < clock[END] - clock[NOW]:
            return STUCK
        error = try_step(derivative, project, ints, nums, work, clock, tally, y, h)
        if rank > 0 and error < 1e300 and layings < LAYINGS and tip(nums, clock, h):
            if error > 1.0:
                # Perhaps the evaluation near the pose is to blame, perhaps the step is too long besides.
                wanted *= max(0.6, 0.9 * error**-0.125) if error < 1e30 else 0.6
                clock[STEP] = wanted
            again = laid(wanted, clock[CROSSING] - clock[NOW])
            if abs(again - h) > 0.01 * h and clock[NOW] + again < clock[END]:
                layings += 1
                continue
        layings = 0
        if not error < 1.0:
            clock[STEP] = h * (max(0.2, 0.9 * error**-0.125) if error < 1e30 else 0.2)
            growth = 1.0
            continue
        later = clock[NOW] + h
        if clock[END] - later < 1e-13 * max(1.0, abs(later)):
            later = clock[END]
        gap, kept = project(ints, nums, work, later, slopes[NEW], clock[CLOSED])
        if rank > 0 and not 0.0 <= gap < clock[OPEN]:
            clock[STEP] = 0.25 * h
            if h < 1e-9:
                return MASSLESS if gap == -1.0 else OPENED
            continue
        rough, moved = 0.0, 0.0
        margin = slope(derivative, project, ints, nums, work, clock, tally, later, slopes[NEW], slopes[12])
        if margin < 0.0:
            return MASSLESS
        for i in range(size):
            bent, gone = slopes[12, i] - slopes[11, i], slopes[NEW, i] - slopes[TRIED, i]
            rough += bent * bent
            moved += gone * gone
        # What rounding leaves near a singular pose is no decay.
        real = rough > (10.0 * NOISE / max(clock[LEAST], 1e-6) ** 2) ** 2
        fastest = math.sqrt(rough / moved) if moved > 0.0 and real else 0.0
        tally[STIFF] = tally[STIFF] + 1 if h * fastest > EDGE else 0
        hit, share = -1, 1.0
        due = tally[NEXT] < len(times) and times[tally[NEXT]] <= later
        if due or len(ints[STOPS]) > 0:
            prepare(derivative, project, ints, nums, work, clock, tally, y, h)
            hit, share = stop_reached(ints, nums, work, y, 1.0)
            reached = later if hit < 0 else clock[NOW] + share * h
            while tally[NEXT] < len(times) and times[tally[NEXT]] <= reached:
                t = times[tally[NEXT]]
                x = min(1.0, (t - clock[NOW]) / h)
                for i in range(size):
                    slopes[TRIED, i] = interpolate(work, y, i, x)
                sample(derivative, project, ints, nums, work, clock, t, slopes[TRIED], out[tally[NEXT]])
                tally[NEXT] += 1
            if hit >= 0:
                for i in range(size):
                    slopes[TRIED, i] = interpolate(work, y, i, share)
                for i in range(size):
                    y[i] = slopes[TRIED, i]
                clock[NOW] = reached
                tally[HIT], tally[FRESH] = hit, 1
                return STOPPED
        for i in range(size):
            y[i] = slopes[NEW, i]
            slopes[0, i] = slopes[12, i]
        clock[MARGINS] = margin
        clock[NOW] = later
        clock[STEP] = h * (min(growth, 0.9 * error**-0.125) if error > 0.0 else growth)
        if h < wanted and error < 0.4:
            # Laid shorter than the error called for: the next need not be.
            clock[STEP] = max(clock[STEP], wanted)
        if fastest * clock[STEP] > EDGE:
            # Within half the region of stability, for the dense output too.
            clock[STEP] = EDGE / fastest
        growth = GROWTH
        if kept < clock[KEEP]:
            return WORN
        if tally[STIFF] >= clock[PATIENCE]:
            tally[FRESH] = 1
            return STIFFENED
    return DONE
