"""Parts stop a joint, or its slider leaves its guide, before the end of the range that the function states.

A finding for each side of a stated range that is longer than what the meshes leave, from their pose and with all
joints outside of its loops at rest, by more than 0.02° or 0.1 % of the range. A side stated as free (`inf`) must not
be stopped. A slide or screw that contact determines has left its guide where the last of the surfaces along which it
goes ends; of one that is taken as stated the guide is in no mesh.

Why it matters: the device cannot do what it is for.

What to do: cut away what is in the way, move the stop, lengthen the guide, or state the range that is needed.

Example: a gimbal that shall turn by 45° hits its housing at 39°.
"""

from __future__ import annotations

import math

from kinform.consistency.comparisons.ranges import RangeComparison, joint_as_intended, range_comparisons, shown
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.questions.proofs import beyond_guide, beyond_stop
from kinform.consistency.rule import Rule
from kinform.foundation.words import quoted
from kinform.model.collisions import RangeEnd
from kinform.model.findings import Finding, Witness

SHORT_TURN = math.radians(0.02)
"""rad by which a turn may fall short: a stop on facets is not where it is on the surface. Chosen, not measured."""
SHORT_SLIDE = 1e-3
"""Share of a stated length by which a slide may fall short: as `SHORT_TURN` of a turn of 20°."""


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
            reach = _reach(end, stated)
            if end is None or reach is None:
                continue
            value = item.sign * reach
            if toward * (stated - value) > allowed:
                span = upper - lower
                short = toward * (stated - value) / span if math.isfinite(span) else math.inf
                found.append((-short, _finding(context, item, side, stated, value, end)))
    found.sort(key=lambda entry: (entry[0], entry[1].message))
    return decided(finding for _, finding in found)


def _reach(end: RangeEnd | None, stated: float) -> float | None:
    """rad or m, of the joint: how far it goes to one side; None where nothing is known to end it. No guide is endless,
    and a side stated as free asks for none that is."""
    if end is None:
        return None
    if end.status == "unbounded":
        return end.leaves if math.isfinite(stated) else None
    return end.value if end.status == "found" else None


def _finding(context: Context, item: RangeComparison, side: str, stated: float, value: float, end: RangeEnd) -> Finding:
    joint = item.intended
    end_value, intended = shown(value, joint, context.units), shown(stated, joint, context.units)
    by = f"{quoted(end.parts)} meet" if end.parts else end.reason
    what, remedy = f"stops at {end_value}", "Cut away what is in the way, or state the range that is needed."
    if end.status == "unbounded":
        what = f"goes only to {end_value}"
        remedy = "Lengthen the guide, add an end stop, or state the range that is needed."
    return RULE.finding(
        [joint.name, *end.parts],
        f"joint '{joint.name}' {what} on the {side} side ({by}), intended is {intended}",
        found=end_value,
        intended=intended,
        place=end.place if end.place is not None else joint.point,
        declared=joint,
        remedy=remedy,
        witness=_witness(context, item, stated, end),
    )


def _witness(context: Context, item: RangeComparison, stated: float, end: RangeEnd) -> Witness | None:
    """Parts in each other beyond the stop, or a slider that has left its guide before it."""
    comparison = next((c for c in context.comparisons if c.intended is item.intended), None)
    match = None if comparison is None else joint_as_intended(comparison)
    if match is None:
        return None
    if end.status == "unbounded":
        return beyond_guide(context, match[0], item.sign * stated)
    return None if end.value is None else beyond_stop(context, match[0], end.parts, end.value, item.sign * stated)


RULE = Rule("KF412", "joint-range-short", "error", __doc__, check)
