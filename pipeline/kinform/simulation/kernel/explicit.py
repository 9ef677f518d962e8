"""Explicit integration: steps and their control, outputs, end stops.

Control of steps and the test for stiffness are those of Hairer, Nørsett and Wanner's program DOP853
(Solving Ordinary Differential Equations I, sections II.4 and IV.2). Loops are closed again after every
accepted step.
"""

from __future__ import annotations

import math

from kinform.model.arrays import Ints
from kinform.simulation.kernel.crossings import laid, tip
from kinform.simulation.kernel.equations import derivative, project
from kinform.simulation.kernel.layout import (
    ACC,
    BUDGET,
    CLOSED,
    COUNTS,
    CROSSING,
    DONE,
    END,
    FRESH,
    GIVEN,
    HIT,
    KEEP,
    KEPT,
    LEAST,
    MARGIN,
    MARGINS,
    MASSLESS,
    NEED,
    NEW,
    NEXT,
    NOISE,
    NOW,
    OPEN,
    OPENED,
    OUT,
    PATIENCE,
    PAUSE,
    PAUSED,
    POSITIONS,
    RANK,
    RATES,
    SIZE,
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
    TIMES,
    TRIED,
    VECTORS,
    WORN,
)
from kinform.simulation.kernel.steps import interpolate, prepare, roundings, slope, try_step
from kinform.simulation.kernel.types import Counts, Nums, Row, Work

EDGE = 3.0
"""Step times the fastest decay: the method is stable up to about 6."""
LAYINGS = 4
"""Times that a step is laid anew to avoid a singular pose."""
AGAIN = 20
"""Steps after which roundings are looked at again."""
GROWTH = 2.5
"""Greatest growth of a step: with more, one can land far outside the region of stability unnoticed."""

PARTS = 4
"""Parts of a step in which a joint turns back at most once: steps are far shorter than what moves in them."""
AROUND = 0.1
"""Share of the step about the place where a singular pose is expected, within which it is."""
NARROWED = 12
"""Times that this is narrowed, to two thirds each."""
PASSED = 1e-12
"""Of a limit (rad or m) that is passed: less is rounding."""

__all__ = ["advance", "look", "sample", "stop_reached"]


def sample(ints: Ints, nums: Nums, work: Work, clock: Row, t: float, y: Row, out: Row) -> None:
    """Writes an output: the state with loops closed, accelerations, efforts given and needed."""
    n, size, vectors = ints[COUNTS][0][RATES], ints[COUNTS][0][SIZE], work[VECTORS]
    project(ints, nums, work, t, y, clock[CLOSED], False)
    derivative(ints, nums, work, t, y, work[STAGES][TRIED + 2])
    for i in range(size):
        out[i] = y[i]
    for k in range(n):
        out[size + k] = vectors[ACC][k]
        out[size + n + k] = vectors[GIVEN][k]
        out[size + 2 * n + k] = vectors[NEED][k]


def stop_reached(ints: Ints, nums: Nums, work: Work, y: Row, x: float) -> tuple[int, float]:
    """(stop that is passed first before the share x of the step, where); −1 and x when none is.

    A joint that passes its stop and is back before the step ends has passed it: where it turns is looked at too.
    """
    stops, limits, first = ints[STOPS], nums[STOPS], ints[COUNTS][0][POSITIONS]
    found, end = -1, x
    for k in range(len(stops)):
        if stops[k][3] != 0:
            continue
        at, rate, sense = stops[k][0], first + stops[k][1], float(stops[k][2])
        low, past, pace = 0.0, -1.0, sense * y[rate]
        for part in range(1, PARTS + 1):
            high = end * float(part) / float(PARTS)
            later = sense * interpolate(work, y, rate, high)
            if sense * (interpolate(work, y, at, high) - limits[k][0]) > PASSED:
                past = high
                break
            if pace > 0.0 and later < 0.0:
                out, back = low, high
                for _ in range(40):
                    middle = 0.5 * (out + back)
                    if sense * interpolate(work, y, rate, middle) > 0.0:
                        out = middle
                    else:
                        back = middle
                if sense * (interpolate(work, y, at, out) - limits[k][0]) > PASSED:
                    past = out
                    break
            low, pace = high, later
        if past < 0.0:
            continue
        high = past
        for _ in range(60):
            middle = 0.5 * (low + high)
            if sense * (interpolate(work, y, at, middle) - limits[k][0]) > 0.0:
                high = middle
            else:
                low = middle
        found, end = k, high
    return found, end


def look(ints: Ints, nums: Nums, work: Work, clock: Row, y: Row, h: float) -> None:
    """Finds the least margin where a singular pose is crossed in the step: its evaluations keep away from there."""
    state, slopes = work[STAGES][TRIED], work[STAGES][TRIED + 2]
    place = (clock[CROSSING] - clock[NOW]) / h
    low, high = max(0.0, place - AROUND), min(1.0, place + AROUND)
    first = 0.0
    for k in range(2 * NARROWED):
        x = low + (0.382 if k % 2 == 0 else 0.618) * (high - low)
        for i in range(ints[COUNTS][0][SIZE]):
            state[i] = interpolate(work, y, i, x)
        margin = abs(derivative(ints, nums, work, clock[NOW] + x * h, state, slopes))
        if margin < clock[MARGIN]:
            clock[MARGIN], clock[TIGHTEST] = margin, clock[NOW] + x * h
        if k % 2 == 0:
            first = margin
        elif first < margin:
            high = x
        else:
            low = low + 0.382 * (high - low)


def advance(ints: Ints, nums: Nums, work: Work, y: Row, clock: Row, tally: Counts, outputs: Nums) -> int:
    """Integrates y from clock[NOW] towards clock[END], filling outputs; says why it came back."""
    slopes, times, out = work[STAGES], outputs[TIMES][0], outputs[OUT]
    rank, size = ints[COUNTS][0][RANK], ints[COUNTS][0][SIZE]
    if tally[FRESH] == 1:
        clock[MARGINS] = slope(ints, nums, work, clock, tally, clock[NOW], y, slopes[0])
        if clock[MARGINS] < 0.0:
            return MASSLESS
        roundings(ints, nums, work, tally, y, clock[NOW])
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
            roundings(ints, nums, work, tally, y, clock[NOW])
        wanted = clock[STEP]
        h = min(laid(wanted, clock[CROSSING] - clock[NOW]), clock[END] - clock[NOW])
        if h < 1e-13 * max(1.0, abs(clock[NOW])) and h < clock[END] - clock[NOW]:
            return STUCK
        error = try_step(ints, nums, work, clock, tally, y, h)
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
        gap = project(ints, nums, work, later, slopes[NEW], clock[CLOSED], False)
        kept = work[VECTORS][KEPT][0]
        if rank > 0 and not 0.0 <= gap < clock[OPEN]:
            clock[STEP] = 0.25 * h
            if h < 1e-9:
                return MASSLESS if gap == -1.0 else OPENED
            continue
        rough, moved = 0.0, 0.0
        margin = slope(ints, nums, work, clock, tally, later, slopes[NEW], slopes[12])
        if margin < 0.0:
            return MASSLESS
        for i in range(size):
            change, way = slopes[12][i] - slopes[11][i], slopes[NEW][i] - slopes[TRIED][i]
            rough += change * change
            moved += way * way
        # What rounding leaves near a singular pose is no decay.
        least = max(clock[LEAST], 1e-6)
        real = math.sqrt(rough) > 10.0 * NOISE / (least * least)
        fastest = math.sqrt(rough / moved) if moved > 0.0 and real else 0.0
        tally[STIFF] = tally[STIFF] + 1 if h * fastest > EDGE else 0
        hit, share = -1, 1.0
        due = tally[NEXT] < len(out) and times[tally[NEXT]] <= later
        crossed = rank > 0 and clock[NOW] < clock[CROSSING] <= later
        if due or crossed or len(ints[STOPS]) > 0:
            prepare(ints, nums, work, clock, tally, y, h)
            if crossed:
                look(ints, nums, work, clock, y, h)
            hit, share = stop_reached(ints, nums, work, y, 1.0)
            reached = later if hit < 0 else clock[NOW] + share * h
            while tally[NEXT] < len(out) and times[tally[NEXT]] <= reached:
                t = times[tally[NEXT]]
                x = min(1.0, (t - clock[NOW]) / h)
                for i in range(size):
                    slopes[TRIED][i] = interpolate(work, y, i, x)
                sample(ints, nums, work, clock, t, slopes[TRIED], out[tally[NEXT]])
                tally[NEXT] += 1
            if hit >= 0:
                for i in range(size):
                    slopes[TRIED][i] = interpolate(work, y, i, share)
                for i in range(size):
                    y[i] = slopes[TRIED][i]
                clock[NOW] = reached
                tally[HIT], tally[FRESH] = hit, 1
                return STOPPED
        for i in range(size):
            y[i] = slopes[NEW][i]
            slopes[0][i] = slopes[12][i]
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
