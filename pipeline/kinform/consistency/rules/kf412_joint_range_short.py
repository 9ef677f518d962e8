"""Parts stop a joint before the end of the range that the function states.

A finding for each side of a stated range that is longer than what the meshes leave, from their pose and with all
joints outside of its loops at rest, by more than 0.02° or 0.1 % of the range. A side stated as free (`inf`) must not
be stopped.

Why it matters: the device cannot do what it is for.

What to do: cut away what is in the way, move the stop, or state the range that is needed.

Example: a gimbal that shall turn by 45° hits its housing at 39°.
"""

from __future__ import annotations

import math

from kinform.consistency.comparisons.ranges import RangeComparison, range_comparisons, shown
from kinform.consistency.constants import SHORT_SLIDE, SHORT_TURN
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import quoted
from kinform.model.collisions import RangeEnd
from kinform.model.findings import Finding


def check(context: Context) -> Outcome:
    """Both sides of every stated range."""
    ranges = [item for item in range_comparisons(context) if not item.reason]
    if not ranges:
        return skipped("no range to compare")
    found: list[tuple[float, Finding]] = []
    for item in ranges:
        lower, upper = item.intended.range or (-math.inf, math.inf)
        allowed = (
            SHORT_SLIDE * (upper - lower)
            if item.intended.type == "prismatic" and math.isfinite(upper - lower)
            else SHORT_TURN
        )
        for side, stated, end, toward in (("lower", lower, item.lower, -1.0), ("upper", upper, item.upper, 1.0)):
            if end is None or end.value is None or end.status != "found":
                continue
            value = item.sign * end.value
            if toward * (stated - value) > allowed:
                span = upper - lower
                short = toward * (stated - value) / span if math.isfinite(span) else math.inf
                found.append((-short, _finding(context, item, side, stated, value, end)))
    found.sort(key=lambda entry: (entry[0], entry[1].message))
    return decided(finding for _, finding in found)


def _finding(context: Context, item: RangeComparison, side: str, stated: float, value: float, end: RangeEnd) -> Finding:
    joint = item.intended
    end_value, intended = shown(value, joint, context.units), shown(stated, joint, context.units)
    by = f"{quoted(end.parts)} meet" if end.parts else end.reason
    return RULE.finding(
        [joint.name, *end.parts],
        f"joint '{joint.name}' stops at {end_value} on the {side} side ({by}), intended is {intended}",
        found=end_value,
        intended=intended,
        place=end.place if end.place is not None else joint.point,
        declared=joint,
        remedy="Cut away what is in the way, or state the range that is needed.",
    )


RULE = Rule("KF412", "joint-range-short", "error", __doc__, check)
