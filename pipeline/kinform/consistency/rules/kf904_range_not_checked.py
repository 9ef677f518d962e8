"""The function states the range of a joint, and kinform does not check ranges yet.

The rule is inconclusive as long as there is one, also when a side is free (`inf`).

Why it matters: whether the parts collide inside the range is not known.

What to do: check the range by other means until ranges are supported.

Example: `range = [-110, 110]` for a shoulder.
"""

from __future__ import annotations

import math

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, inconclusive, skipped
from kinform.consistency._words import angle, counted, length
from kinform.model.function import IntendedJoint

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Every intended range."""
    ranged = [joint for joint in context.function.joints if joint.range is not None]
    if not ranged:
        return skipped("no intended joint states a range")
    findings = [
        RULE.finding(
            [joint.name],
            f"the range of joint '{joint.name}' is not checked yet",
            found="not checked",
            intended=_shown(joint, context.units),
            place=joint.point,
            declared=joint,
            remedy="Check it by other means.",
        )
        for joint in ranged
    ]
    return inconclusive(f"{counted(len(ranged), 'range')} not checked", findings)


def _shown(joint: IntendedJoint, units: str) -> str:
    assert joint.range is not None
    linear = joint.type == "prismatic"

    def side(value: float) -> str:
        if math.isinf(value):
            return "free"
        return length(value, units) if linear else angle(value)

    return f"{side(joint.range[0])} to {side(joint.range[1])}"


RULE = Rule("KF904", "range-not-checked", "note", __doc__, check)
