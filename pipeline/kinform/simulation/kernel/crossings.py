"""Singular poses in the way of a step: where they are, and how a step is laid across one.

At a pose where independent rows of the loops become dependent, accelerations are a quotient of two
vanishing numbers. Their limit is finite where the motion goes straight through, but rounding errors grow
with the inverse square of the distance, and shorter steps only bring the method's evaluations nearer.
So a step is laid such that the pose falls into the widest gap between its evaluations.

The margin, smallest over largest pivot, falls and rises there like a V, whose tip is found from the margins
at the evaluations of a step.
"""

from __future__ import annotations

from kinform.simulation.constants import (
    CROSSING_AHEAD,
    CROSSING_CLEAR,
    CROSSING_PASSED,
    NEAREST_APPROACH,
    SLOPES_ALIKE,
    WIDEST_GAP,
)

from kinform.simulation.kernel.layout import (  # isort: skip
    COEFFICIENTS,
    C_ROW, ORDER_ROW,
    NOW, CROSSING, SPAN, MARGINS,
    Row, Nums,
)  # fmt: skip


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
        if max(ahead, behind) < SLOPES_ALIKE:
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
    if distance <= CROSSING_PASSED * step or distance > (1.0 + WIDEST_GAP) * step:
        return step
    if distance <= WIDEST_GAP * step:
        return distance / WIDEST_GAP
    return max(distance - WIDEST_GAP * step, NEAREST_APPROACH * distance)
