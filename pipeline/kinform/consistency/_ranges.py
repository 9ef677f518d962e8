"""Intended ranges of joints beside what geometry lets them reach."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome
from kinform.consistency._words import angle, length
from kinform.function import resolve
from kinform.model.function import IntendedJoint

__all__ = ["Range", "compared_ranges", "shown_range"]


@dataclass(frozen=True)
class Range:
    """One intended range, and the found one in the designer's sign; None with the reason where not known."""

    intended: IntendedJoint
    found: tuple[float, float] | None
    reason: str = ""


def compared_ranges(context: Context) -> tuple[Range, ...] | Outcome:
    """Every intended range, sorted by name of the joint."""
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return kinematics
    out = []
    for intended in sorted(context.function.joints, key=lambda j: j.name):
        if intended.range is None:
            continue
        resolution = resolve(context.assembly, kinematics, intended.name)
        joint = resolution.joint
        if joint is None:
            out.append(Range(intended, None, resolution.reason))
        elif joint.range_status == "unknown" or (joint.range_lower is None and joint.range_upper is None):
            unbounded = joint.range_status == "unbounded"
            out.append(
                Range(intended, (-math.inf, math.inf)) if unbounded
                else Range(intended, None, "no range was found for it")
            )  # fmt: skip
        else:
            low = -math.inf if joint.range_lower is None else joint.range_lower
            high = math.inf if joint.range_upper is None else joint.range_upper
            out.append(Range(intended, (low, high) if resolution.sign > 0 else (-high, -low)))
    return tuple(out)


def shown_range(bounds: tuple[float, float], joint: IntendedJoint, units: str) -> str:
    """ "-30° to 30°"."""

    def side(value: float) -> str:
        if math.isinf(value):
            return "free"
        return length(value, units) if joint.type == "prismatic" else angle(value, 4)

    return f"{side(bounds[0])} to {side(bounds[1])}"
