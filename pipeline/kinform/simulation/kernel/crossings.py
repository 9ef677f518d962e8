"""Singular poses in the way of a step: where they are, and how a step is laid across one.

At a pose where independent rows of the loops become dependent, accelerations are a quotient of two
vanishing numbers. Their limit is finite where the motion goes straight through, but rounding errors grow
with the inverse square of the distance, and shorter steps only bring the method's evaluations nearer.
So a step is laid such that the pose falls into the widest gap between its evaluations.
"""

from __future__ import annotations

from kinform.simulation.kernel.layout import (
    C_ROW,
    COEFFICIENTS,
    COUNTS,
    CROSSING,
    FAR,
    FOLLOWED,
    FORMER,
    HITHER,
    MODE,
    NOW,
    PIVOT,
    RANK,
    SCALE,
    VECTORS,
)
from kinform.simulation.kernel.types import Ints, Nums, Row, Work

MIDDLE = 0.4667
"""Of the widest gap between evaluations: from a third to three fifths of the step."""
CLEAR = 0.08
"""A share of the step: evaluations nearer to a singular pose than this are to be avoided."""
BEYOND = 1.15
"""A pose this far, in steps, is near the step's end."""

__all__ = ["follow", "laid", "locate", "watch"]


def watch(ints: Ints, nums: Nums, work: Work, clock: Row, share: float) -> None:
    """Chooses the pivot to follow through the step, the smallest at its first evaluation."""
    low = 0.0
    for k in range(ints[COUNTS][0, RANK]):
        size = abs(work[VECTORS][PIVOT, k]) / nums[SCALE][ints[MODE][1, k], 0]
        if size > low:
            low, clock[FOLLOWED] = size, float(k)
    pivot = 1.0 / work[VECTORS][PIVOT, int(clock[FOLLOWED])]
    clock[HITHER], clock[HITHER + 1] = share, pivot
    clock[FORMER], clock[FORMER + 1] = -1.0, pivot
    clock[FAR], clock[FAR + 1] = 2.0, 0.0


def follow(work: Work, clock: Row, share: float) -> None:
    """Notes the pivot at a share of the step: HITHER and FORMER are the last two before its sign changes,
    FAR is the first after."""
    pivot = 1.0 / work[VECTORS][PIVOT, int(clock[FOLLOWED])]
    if pivot * clock[HITHER + 1] > 0.0:
        if share > clock[HITHER]:
            clock[FORMER], clock[FORMER + 1] = clock[HITHER], clock[HITHER + 1]
            clock[HITHER], clock[HITHER + 1] = share, pivot
        elif share > clock[FORMER]:
            clock[FORMER], clock[FORMER + 1] = share, pivot
    elif share < clock[FAR]:
        clock[FAR], clock[FAR + 1] = share, pivot


def locate(nums: Nums, clock: Row, h: float) -> bool:
    """Writes the time of a singular pose in the step or just after it to clock[CROSSING], if there is one;
    whether it is too near to an evaluation."""
    near, pivot = clock[HITHER], clock[HITHER + 1]
    if clock[FAR] < 2.0:
        share = near + (clock[FAR] - near) * pivot / (pivot - clock[FAR + 1])
    else:
        fall = (clock[FORMER + 1] - pivot) / (near - clock[FORMER])
        share = near + pivot / fall if pivot * fall > 0.0 else 2.0
    if not 0.0 < share < BEYOND:
        return False
    clock[CROSSING] = clock[NOW] + share * h
    for s in range(13):
        if abs(nums[COEFFICIENTS][C_ROW, s] - share) < CLEAR:
            return True
    return False


def laid(step: float, distance: float) -> float:
    """The step to take when `step` is wanted and a singular pose is `distance` ahead, negative behind."""
    if distance <= 0.0 or distance > (1.0 + MIDDLE) * step:
        return step
    if distance <= MIDDLE * step:
        return distance / MIDDLE
    return max(distance - MIDDLE * step, 0.2 * distance)
