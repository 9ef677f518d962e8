"""Singular poses in the way of a step: where they are, and how a step is laid across one.

At a pose where independent rows of the loops become dependent, accelerations are a quotient of two
vanishing numbers. Their limit is finite where the motion goes straight through, but rounding errors grow
with the inverse square of the distance, and shorter steps only bring the method's evaluations nearer.
So a step is laid such that the pose falls into the widest gap between its evaluations.

Where branches part just before they would meet, by lengths that differ less than they are known, the motion turns a
corner of the size of the margin there (`turns_corner`): such a run ends, as either branch would be a guess.

The margin, smallest over largest pivot, falls and rises there like a V, whose tip is found from the margins
at the evaluations of a step.
"""

from __future__ import annotations

import math

from kinform.model.arrays import Ints

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, SCALE, COEFFICIENTS, STAGES,
    POSITIONS, RATES, C_ROW, ORDER_ROW, AT_END, NEW,
    NOW, CROSSING, SPAN, MARGINS, NARROW,
    Row, Nums, Work,
)  # fmt: skip

WIDEST_GAP = 0.4667
"""Share of the step: middle of the widest gap between evaluations, from a third to three fifths."""
CROSSING_CLEAR = 0.08
"""A share of the step: evaluations nearer to a singular pose than this are to be avoided. A choice: the widest gap
between evaluations leaves 0.13 to either side."""
CROSSING_AHEAD = 1.2
"""A pose so far, in steps, is near the step's end: the next step would begin too near to it. A choice."""


def alike(a: float, b: float) -> float:
    """The lesser of two slopes over the greater; 0 when one is not positive."""
    return min(a, b) / max(a, b) if a > 0.0 and b > 0.0 else 0.0


def tip(nums: Nums, clock: Row) -> bool:
    """Writes the time of a singular pose in the step or just after it to clock[CROSSING], if there is one;
    whether it is too near to an evaluation."""
    times, order = nums[COEFFICIENTS][C_ROW], nums[COEFFICIENTS][ORDER_ROW]
    low = 0
    for k in range(1, 12):
        if clock[MARGINS + int(order[k])] < clock[MARGINS + int(order[low])]:
            low = k
    if low == 0:
        return False
    tightest, last = int(order[low]), int(order[low - 1])
    x, f = times[tightest], clock[MARGINS + tightest]
    left, before = x - times[last], clock[MARGINS + last]
    if low == 11:
        place = x + f * left / (before - f) if before > f else CROSSING_AHEAD
        near = place < CROSSING_AHEAD
    else:
        later = int(order[low + 1])
        right, after = times[later] - x, clock[MARGINS + later]
        # The tip is on that side where one line falls to it and another rises from it as steeply.
        ahead, behind = alike((before - f) / left, (f + after) / right), alike((after - f) / right, (before + f) / left)
        # Slopes of a line agree when the lesser is more than this share of the greater: a choice; branches are nearly
        # straight over a step.
        if max(ahead, behind) < 0.5:
            return False
        place = x + right * f / (f + after) if ahead > behind else x - left * f / (f + before)
        near = False
        for s in range(1, 12):
            near = near or abs(times[s] - place) < CROSSING_CLEAR
    if place < CROSSING_AHEAD:
        clock[CROSSING] = clock[NOW] + place * clock[SPAN]
    return near


def laid(step: float, distance: float) -> float:
    """The step to take when `step` is wanted and a singular pose is `distance` ahead, negative behind."""
    # Share of the step: a pose nearer ahead than this counts as passed: a step laid across would be twenty times
    # shorter. A choice.
    if distance <= 0.05 * step or distance > (1.0 + WIDEST_GAP) * step:
        return step
    if distance <= WIDEST_GAP * step:
        return distance / WIDEST_GAP
    # Least share of the way to a singular pose that a step towards it goes: a choice, so that it is reached in a few
    # steps.
    return max(distance - WIDEST_GAP * step, 0.2 * distance)


def turns_corner(ints: Ints, nums: Nums, work: Work, clock: Row) -> bool:
    """Whether the motion turns, at the end of the step, from one branch into another where both nearly meet.

    Branches that meet are straight on the scale of their distance, the margin; those that part just before bend with
    about that radius. Curvature of the motion is |a⊥| over |v|², in rad and shares of the length.
    """
    margin, state, slopes = clock[MARGINS + AT_END], work[STAGES][NEW], work[STAGES][AT_END]
    if margin >= clock[NARROW]:
        return False
    first, size, along, bend = ints[COUNTS][0][POSITIONS], 0.0, 0.0, 0.0
    for k in range(ints[COUNTS][0][RATES]):
        unit = 1.0 / (nums[SCALE][k][0] * nums[SCALE][k][0])
        size += unit * state[first + k] * state[first + k]
        along += unit * state[first + k] * slopes[first + k]
    if size == 0.0:
        return False
    for k in range(ints[COUNTS][0][RATES]):
        across = (slopes[first + k] - along / size * state[first + k]) / nums[SCALE][k][0]
        bend += across * across
    # Curvature of the motion times the margin from which on it turns from one branch of the loops into another. At the
    # tip of such a corner it is 0.2 to 3, wherever lengths differ by 1e-12 to 1e-3 of themselves; where branches cross
    # it is the margin times the curvature of either, below 0.005.
    return math.sqrt(bend) * margin > 0.05 * size
