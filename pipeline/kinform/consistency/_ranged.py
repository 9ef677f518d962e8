"""Stated ranges of joints beside those that the parts leave."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kinform.consistency._compare import Comparison
from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome
from kinform.consistency._words import angle, length
from kinform.model.collisions import RangeEnd
from kinform.model.function import IntendedJoint

__all__ = ["Ranged", "ranged", "shown"]


@dataclass(frozen=True, eq=False)
class Ranged:
    """One stated range: what was found to its sides in the designer's sense, or why nothing was."""

    intended: IntendedJoint
    lower: RangeEnd | None = None
    upper: RangeEnd | None = None
    sign: float = 1.0
    """−1 where the designer's values run against those of kinform."""
    left_out: tuple[tuple[str, str], ...] = ()
    """Pairs of parts of which nothing is known, as they overlap from the start."""
    reason: str = ""


def ranged(context: Context) -> list[Ranged]:
    """Every intended joint that states a range, sorted by name."""
    joints = sorted((j for j in context.function.joints if j.range is not None), key=lambda joint: joint.name)
    compared = context.comparisons
    if isinstance(compared, Outcome):
        return [Ranged(joint, reason=compared.reason) for joint in joints]
    by_name = {comparison.intended.name: comparison for comparison in compared}
    return [_ranged(context, joint, by_name[joint.name]) for joint in joints]


def _ranged(context: Context, intended: IntendedJoint, comparison: Comparison) -> Ranged:
    run, joint = context.design.simulation, comparison.joint
    if not comparison.right_type or joint is None or joint.type != intended.type or joint.axis is None:
        return Ranged(intended, reason="no joint of that type was found directly between its parts")
    if run is None or run.ranges is None:
        return Ranged(intended, reason="ranges have not been computed: run `kinform simulate`")
    found = next((item for item in run.ranges if item.joint == joint.name), None)
    if found is None or intended.axis is None:
        return Ranged(intended, reason="no range was computed for it")
    sign = 1.0 if float(joint.axis @ intended.axis) >= 0.0 else -1.0
    if comparison.bodies[0].name != joint.bodies[0]:
        sign = -sign
    ends = (found.lower, found.upper) if sign > 0.0 else (found.upper, found.lower)
    return Ranged(intended, *ends, sign=sign, left_out=found.left_out)


def shown(value: float, joint: IntendedJoint, units: str) -> str:
    """A value of a range in words."""
    if math.isinf(value):
        return "free"
    return length(value, units) if joint.type == "prismatic" else angle(value)
