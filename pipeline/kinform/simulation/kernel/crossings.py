"""Singular poses in the way of a step: where they are, and how a step is laid across one.

At a pose where independent rows of the loops become dependent, accelerations are a quotient of two
vanishing numbers. Their limit is finite where the motion goes straight through, but rounding errors grow
with the inverse square of the distance, and shorter steps only bring the method's evaluations nearer.
So a step is laid such that the pose falls into the widest gap between its evaluations.

The margin, smallest over largest pivot, falls and rises there like a V, whose tip is found from the margins
at the evaluations of a step.
"""

from __future__ import annotations

from kinform.simulation.kernel.layout import C_ROW, COEFFICIENTS, CROSSING, MARGINS, NOW
from kinform.simulation.kernel.types import Nums, Row

ORDER = (0, 1, 2, 3, 6, 4, 7, 5, 9, 8, 10, 11)
"""Evaluations in the order of their times."""
MIDDLE = 0.4667
"""Of the widest gap between evaluations: from a third to three fifths of the step."""
CLEAR = 0.08
"""A share of the step: evaluations nearer to a singular pose than this are to be avoided."""
BEYOND = 1.2
"""A pose so far, in steps, is near the step's end."""
ALIKE = 0.5
"""Slopes of a line agree when the lesser is more than this share of the greater."""

__all__ = ["alike", "laid", "tip"]


def alike(a: float, b: float) -> float:
    """The lesser of two slopes over the greater; 0 when one is not positive."""
    return min(a, b) / max(a, b) if a > 0.0 and b > 0.0 else 0.0


def tip(nums: Nums, clock: Row, h: float) -> bool:
    """Writes the time of a singular pose in the step or just after it to clock[CROSSING], if there is one;
    whether it is too near to an evaluation."""
    times = nums[COEFFICIENTS][C_ROW]
    low = 0
    for k in range(1, 12):
        if clock[MARGINS + ORDER[k]] < clock[MARGINS + ORDER[low]]:
            low = k
    if low == 0:
        return False
    x, f = times[ORDER[low]], clock[MARGINS + ORDER[low]]
    left, before = x - times[ORDER[low - 1]], clock[MARGINS + ORDER[low - 1]]
    if low == 11:
        place = x + f * left / (before - f) if before > f else BEYOND
        near = place < BEYOND
    else:
        right, after = times[ORDER[low + 1]] - x, clock[MARGINS + ORDER[low + 1]]
        # The tip is on that side where one line falls to it and another rises from it as steeply.
        ahead, behind = alike((before - f) / left, (f + after) / right), alike((after - f) / right, (before + f) / left)
        if max(ahead, behind) < ALIKE:
            return False
        place = x + right * f / (f + after) if ahead > behind else x - left * f / (f + before)
        near = False
        for s in range(1, 12):
            near = near or abs(times[s] - place) < CLEAR
    if place < BEYOND:
        clock[CROSSING] = clock[NOW] + place * h
    return near


def laid(step: float, distance: float) -> float:
    """The step to take when `step` is wanted and a singular pose is `distance` ahead, negative behind."""
    if distance <= 0.05 * step or distance > (1.0 + MIDDLE) * step:
        return step
    if distance <= MIDDLE * step:
        return distance / MIDDLE
    return max(distance - MIDDLE * step, 0.2 * distance)
