"""Explicit integration: steps and their control, outputs, end stops.

Control of steps and the test for stiffness are those of Hairer, Nørsett and Wanner's program DOP853
(Solving Ordinary Differential Equations I, sections II.4 and IV.2). Loops are closed again after every
accepted step. How the stages of a step follow each other is told at the head of `kinform.simulation.solver`.
"""

from __future__ import annotations

import math

from kinform.foundation.rounding import ARITHMETIC
from kinform.model.arrays import Ints
from kinform.simulation.constants import HALVINGS, STEP_PARTS
from kinform.simulation.kernel.crossings import laid, tip, turns_corner
from kinform.simulation.kernel.equations import derivative, project
from kinform.simulation.kernel.steps import (
    LEAST_NOISY_MARGIN,
    ROUNDING_NOISE,
    interpolate,
    prepare,
    roundings,
    slope,
    try_step,
)

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, STOPS, VECTORS, STAGES, TIMES, OUT,
    RANK, POSITIONS, RATES, SIZE, METERS, STOP_Q, STOP_V, SENSE, HELD, AT_END, TRIED, NEW, FAILED,
    ACC, NEED, GIVEN, KEPT,
    NOW, END, STEP, CLOSED, OPEN, MARGIN, TIGHTEST, KEEP, LEAST, PATIENCE, CROSSING, SPAN, REACHED, ERROR, WEAR,
    GROWTH, MARGINS, APPROACH,
    STEPS, BUDGET, NEXT, PAUSE, STIFF, SLOPES, FRESH, HIT, LAYINGS,
    DONE, PAUSED, STUCK, STIFFENED, MASSLESS, OPENED, STOPPED, SPENT, WORN, TAKEN, REJECTED, TURNED, NEARING,
    Row, Counts, Nums, Work,
)  # fmt: skip

GREATEST_GROWTH = 2.5
"""Greatest growth of a step: DOP853 allows 6, with which one can land far outside the region of stability
unnoticed."""
SHORTEST_STEP = 1e-13
"""Share of the time (of 1 s at least) below which a step is none: 450 spacings of doubles, so that times within it are
still apart."""
REOPENED_SHRINK = 0.25
"""Share of a step to try where loops could not be closed at its end: a choice."""
SHORTEST_CLOSING_STEP = 1e-9
"""s: steps so short that still leave loops open end the run. A choice: nothing rigid moves measurably in a
nanosecond."""
STABLE_DECAY = 3.0
"""Step times the fastest decay to which steps are kept: half of about 6, up to which the method is stable."""
REAL_ROUGHNESS = 10.0
"""Times the noise of accelerations that a change of slopes has to be to count as a decay: a choice, an order of
magnitude above the estimate of the noise."""
MOST_LAYINGS = 4
"""Times that a step is laid anew to avoid a singular pose: a choice; each finds the tip of the V from nearer."""
LAID_ALIKE = 0.01
"""Share of a step: one that differs by less from the last puts evaluations where they were. A choice, an eighth of
`crossings.CROSSING_CLEAR`."""
ROUNDINGS_EVERY = 20
"""Steps after which roundings are measured again: two evaluations beside 240."""
CROSSING_AROUND = 0.1
"""Share of the step about the place where a singular pose is expected, within which it is: as `CROSSING_CLEAR`, a
little more. A choice."""


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


def beyond(ints: Ints, nums: Nums, work: Work, y: Row, k: int, x: float) -> float:
    """How far beyond stop k (rad or m) its joint is at the share x of the step from y."""
    stop = ints[STOPS][k]
    return float(stop[SENSE] * (interpolate(work, y, stop[STOP_Q], x) - nums[STOPS][k][0]))


def passing(ints: Ints, nums: Nums, work: Work, y: Row, k: int, end: float) -> tuple[float, float]:
    """Shares of the step, up to `end`, between which stop k is passed; the second is −1 when it is not.

    A joint that passes its stop and is back before the step ends has passed it: where it turns is looked at too.
    """
    rate, sense = ints[COUNTS][0][POSITIONS] + ints[STOPS][k][STOP_V], float(ints[STOPS][k][SENSE])
    low, pace = 0.0, sense * y[rate]
    for part in range(1, STEP_PARTS + 1):
        high = end * float(part) / float(STEP_PARTS)
        later = sense * interpolate(work, y, rate, high)
        if beyond(ints, nums, work, y, k, high) > ARITHMETIC:
            return low, high
        if pace > 0.0 and later < 0.0:
            out, back = low, high
            for _ in range(HALVINGS):
                middle = 0.5 * (out + back)
                if sense * interpolate(work, y, rate, middle) > 0.0:
                    out = middle
                else:
                    back = middle
            if beyond(ints, nums, work, y, k, out) > ARITHMETIC:
                return low, out
        low, pace = high, later
    return low, -1.0


def stop_reached(ints: Ints, nums: Nums, work: Work, y: Row) -> tuple[int, float]:
    """(stop that is passed first in the step from y, at which share of it); −1 and 1 when none is."""
    first, end = -1, 1.0
    for k in range(len(ints[STOPS])):
        if ints[STOPS][k][HELD] != 0:
            continue
        low, high = passing(ints, nums, work, y, k, end)
        if high < 0.0:
            continue
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if beyond(ints, nums, work, y, k, middle) > 0.0:
                high = middle
            else:
                low = middle
        first, end = k, high
    return first, end


def look(ints: Ints, nums: Nums, work: Work, clock: Row, y: Row) -> None:
    """Finds the least margin where a singular pose is crossed in the step: its evaluations keep away from there."""
    state, slopes, h = work[STAGES][TRIED], work[STAGES][TRIED + 2], clock[SPAN]
    place = (clock[CROSSING] - clock[NOW]) / h
    low, high = max(0.0, place - CROSSING_AROUND), min(1.0, place + CROSSING_AROUND)
    first = 0.0
    # Twelve times this is narrowed by the golden section, to 0.62 each: to 3e-3 of it, 3e-4 of the step.
    for k in range(2 * 12):
        # The two places of a golden section, one after the other.
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


def fitting(error: float) -> float:
    """Share of a step of that error over the tolerance that would keep it: the error of order 8 goes with the eighth
    power of the length."""
    # Share of the step that would just keep the tolerance: that of Hairer's DOP853.
    return float(0.9 * error**-0.125)


def shrink(error: float, least: float) -> float:
    """Share of a step of that error over the tolerance to try next, `least` at least."""
    return max(least, fitting(error)) if error < FAILED else least


def set_out(clock: Row) -> bool:
    """Lays out the next step, to clock[SPAN] and [REACHED]; False when it would be too short to be one."""
    now, end = clock[NOW], clock[END]
    h = min(laid(clock[STEP], clock[CROSSING] - now), end - now)
    later = now + h
    if end - later < SHORTEST_STEP * max(1.0, abs(later)):
        later = end
    clock[SPAN], clock[REACHED] = h, later
    return not (h < SHORTEST_STEP * max(1.0, abs(now)) and h < end - now)


def lay_anew(nums: Nums, clock: Row, tally: Counts) -> bool:
    """Whether the step tried had an evaluation too near to a singular pose, and laying it differently helps."""
    error, h = clock[ERROR], clock[SPAN]
    if not (error < FAILED and tally[LAYINGS] < MOST_LAYINGS and tip(nums, clock)):
        return False
    if error > 1.0:
        # Perhaps the evaluation near the pose is to blame, perhaps the step is too long besides. Near a singular pose,
        # where the error may be that of one evaluation, a step shrinks to no less than 0.6: a choice.
        clock[STEP] *= shrink(error, 0.6)
    again = laid(clock[STEP], clock[CROSSING] - clock[NOW])
    return abs(again - h) > LAID_ALIKE * h and clock[NOW] + again < clock[END]


def attempt(ints: Ints, nums: Nums, work: Work, y: Row, clock: Row, tally: Counts) -> int:
    """One step tried from y: TAKEN, its end with loops closed in stage NEW and its slope in stage AT_END; REJECTED,
    with the length to try next in clock[STEP]; or why the run cannot go on."""
    slopes, rank = work[STAGES], ints[COUNTS][0][RANK]
    if not set_out(clock):
        return STUCK
    clock[ERROR] = try_step(ints, nums, work, clock, tally, y)
    if rank > 0 and lay_anew(nums, clock, tally):
        tally[LAYINGS] += 1
        return REJECTED
    tally[LAYINGS] = 0
    if not clock[ERROR] < 1.0:
        # Share of a step below which the next is not made after an error, however great: a choice; DOP853 has a third.
        clock[STEP] = clock[SPAN] * shrink(clock[ERROR], 0.2)
        clock[GROWTH] = 1.0
        return REJECTED
    gap = project(ints, nums, work, clock[REACHED], slopes[NEW], clock[CLOSED], False)
    clock[WEAR] = work[VECTORS][KEPT][0]
    if rank > 0 and not 0.0 <= gap < clock[OPEN]:
        clock[STEP] = REOPENED_SHRINK * clock[SPAN]
        if clock[SPAN] < SHORTEST_CLOSING_STEP:
            return MASSLESS if gap == -1.0 else OPENED
        return REJECTED
    tally[SLOPES] += 1
    margin = slope(ints, nums, work, clock, clock[REACHED], slopes[NEW], slopes[AT_END])
    clock[MARGINS + AT_END] = margin
    return TAKEN if margin >= 0.0 else MASSLESS


def fastest_decay(ints: Ints, work: Work, clock: Row, tally: Counts) -> float:
    """Fastest decay (1/s) that the last two evaluations of the step show; tally[STIFF] counts the steps in a row that
    it keeps short."""
    slopes, rough, moved = work[STAGES], 0.0, 0.0
    # Nothing depends on meters and work: how they change is no decay.
    for i in range(ints[COUNTS][0][SIZE] - 1 - ints[COUNTS][0][METERS]):
        change, way = slopes[AT_END][i] - slopes[AT_END - 1][i], slopes[NEW][i] - slopes[TRIED][i]
        rough += change * change
        moved += way * way
    # What rounding leaves near a singular pose is no decay.
    least = max(clock[LEAST], LEAST_NOISY_MARGIN)
    real = math.sqrt(rough) > REAL_ROUGHNESS * ROUNDING_NOISE / (least * least)
    fastest = math.sqrt(rough / moved) if moved > 0.0 and real else 0.0
    tally[STIFF] = tally[STIFF] + 1 if clock[SPAN] * fastest > STABLE_DECAY else 0
    return fastest


def pass_through(ints: Ints, nums: Nums, work: Work, y: Row, clock: Row, tally: Counts, outputs: Nums) -> int:
    """Goes through the step taken, by its dense output: fills the outputs that are due and finds the least margin.

    TAKEN, or STOPPED where an end stop is passed in it: y and clock[NOW] are then where and when, tally[HIT] which.
    """
    times, out, size = outputs[TIMES][0], outputs[OUT], ints[COUNTS][0][SIZE]
    later, tried = clock[REACHED], work[STAGES][TRIED]
    due = tally[NEXT] < len(out) and times[tally[NEXT]] <= later
    crossed = ints[COUNTS][0][RANK] > 0 and clock[NOW] < clock[CROSSING] <= later
    if not (due or crossed or len(ints[STOPS]) > 0):
        return TAKEN
    prepare(ints, nums, work, clock, tally, y)
    if crossed:
        look(ints, nums, work, clock, y)
    hit, share = stop_reached(ints, nums, work, y)
    if hit >= 0:
        later = clock[NOW] + share * clock[SPAN]
    while tally[NEXT] < len(out) and times[tally[NEXT]] <= later:
        t = times[tally[NEXT]]
        x = min(1.0, (t - clock[NOW]) / clock[SPAN])
        for i in range(size):
            tried[i] = interpolate(work, y, i, x)
        sample(ints, nums, work, clock, t, tried, out[tally[NEXT]])
        tally[NEXT] += 1
    if hit < 0:
        return TAKEN
    for i in range(size):
        tried[i] = interpolate(work, y, i, share)
    for i in range(size):
        y[i] = tried[i]
    clock[NOW] = later
    tally[HIT], tally[FRESH] = hit, 1
    return STOPPED


def accept(ints: Ints, work: Work, y: Row, clock: Row, fastest: float) -> None:
    """Goes on from the end of the step, with the length of the next by the error of this and the fastest decay."""
    slopes, h, wanted, error = work[STAGES], clock[SPAN], clock[STEP], clock[ERROR]
    for i in range(ints[COUNTS][0][SIZE]):
        y[i] = slopes[NEW][i]
        slopes[0][i] = slopes[AT_END][i]
    clock[MARGINS] = clock[MARGINS + AT_END]
    clock[NOW] = clock[REACHED]
    growth = clock[GROWTH]
    step = h * (min(growth, fitting(error)) if error > 0.0 else growth)
    # Error over the tolerance below which a step that was cut short does not shorten the next: a choice.
    if h < wanted and error < 0.4:
        # Laid shorter than the error called for: the next need not be.
        step = max(step, wanted)
    if fastest * step > STABLE_DECAY:
        # Within half the region of stability, for the dense output too.
        step = STABLE_DECAY / fastest
    clock[STEP] = step
    clock[GROWTH] = GREATEST_GROWTH


def advance(ints: Ints, nums: Nums, work: Work, y: Row, clock: Row, tally: Counts, outputs: Nums) -> int:
    """Integrates y from clock[NOW] towards clock[END], filling outputs; says why it came back."""
    if tally[FRESH] == 1:
        tally[SLOPES] += 1
        clock[MARGINS] = slope(ints, nums, work, clock, clock[NOW], y, work[STAGES][0])
        if clock[MARGINS] < 0.0:
            return MASSLESS
        roundings(ints, nums, work, clock, tally, y)
        tally[FRESH] = 0
    clock[GROWTH], tally[LAYINGS], spent = GREATEST_GROWTH, 0, 0
    while clock[NOW] < clock[END]:
        if tally[NEXT] >= tally[PAUSE]:
            return PAUSED
        if spent >= tally[BUDGET]:
            return SPENT
        spent += 1
        tally[STEPS] += 1
        if tally[STEPS] % ROUNDINGS_EVERY == 0:
            roundings(ints, nums, work, clock, tally, y)
        status = attempt(ints, nums, work, y, clock, tally)
        if status == REJECTED:
            continue
        if status != TAKEN:
            return status
        if turns_corner(ints, nums, work, clock):
            return TURNED
        fastest = fastest_decay(ints, work, clock, tally)
        if pass_through(ints, nums, work, y, clock, tally, outputs) == STOPPED:
            return STOPPED
        nearing = clock[MARGINS + AT_END] < clock[APPROACH] and clock[MARGINS + AT_END] < clock[MARGINS]
        accept(ints, work, y, clock, fastest)
        if nearing:
            return NEARING
        if clock[WEAR] < clock[KEEP]:
            return WORN
        if tally[STIFF] >= clock[PATIENCE]:
            tally[FRESH] = 1
            return STIFFENED
    return DONE
