"""Parts stop a joint, or its slider leaves its guide, before the end of the range that the function states.

A finding for each side of a stated range that is longer than what the meshes leave, from their pose, by more than
0.02° or 0.1 % of the range. Joints of the same loops, and joints that the function couples (mimic joints), move along;
all others are at rest. A side stated as free (`inf`) must not
be stopped. A slide or screw that contact determines has left its guide where the last of the surfaces along which it
goes ends; of one that is taken as stated the guide is in no mesh. Where the same range with the other sign is free, the
sign of the axis is asked about.

Any finding is an error in a design. In a robot description it is one where more than a tenth of the range is blocked,
beyond the contact tolerance of the parts that meet, and a warning else.

Why it matters: the device cannot do what it is for.

What to do: cut away what is in the way, move the stop, lengthen the guide, or state the range that is left, which the
remedy has in the unit and sense of the file.

Example: a gimbal that shall turn by 45° hits its housing at 39°.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.consistency.comparisons.as_written import range_as_written
from kinform.consistency.comparisons.ranges import (
    RangeComparison,
    free_reversed,
    joint_as_intended,
    range_comparisons,
    shown,
)
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.questions.proofs import beyond_guide, beyond_stop
from kinform.consistency.rule import Rule
from kinform.foundation.words import number, quoted
from kinform.model.collisions import RangeEnd
from kinform.model.findings import Finding, Severity, Witness

SHORT_TURN = math.radians(0.02)
"""rad by which a turn may fall short: a stop on facets is not where it is on the surface. Chosen, not measured."""
WRONG_SIGN = 0.1
"""Share of the range that has to be short where the axis is asked about: less is a matter of a stop. A choice."""
SHORT_SLIDE = 1e-3
"""Share of a stated length by which a slide may fall short: as `SHORT_TURN` of a turn of 20°."""
DESCRIBED = 0.1
"""Share of a range that a description states, up to which it may fall short with a warning: meshes of descriptions are
for looking at, and their limits are rounded. Chosen, not measured."""


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
                rule = RULE.at(_severity(context, item, end, toward * (stated - value), span))
                found.append((-short, _finding(context, rule, item, side, stated, value, end)))
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


def _severity(context: Context, item: RangeComparison, end: RangeEnd, short: float, span: float) -> Severity:
    """Of a range that a description states, a warning where it falls short by no more than `DESCRIBED` of it, beyond
    what the place of the end is known to; else an error."""
    if context.assembly.check.profile != "description":
        return "error"
    return "error" if short - _uncertainty(context, item, end) > DESCRIBED * span else "warning"


def _uncertainty(context: Context, item: RangeComparison, end: RangeEnd) -> float:
    """rad or m: by so much the end moves where the parts that meet there are off by their contact tolerance."""
    parts = [context.assembly.part(name) for name in end.parts]
    sizes = [part.mesh.size for part in parts if part.mesh is not None]
    joint = item.intended
    if len(sizes) < 2 or end.place is None or joint.axis is None:
        return 0.0
    tolerance = context.assembly.tolerances.contact_of(sizes[0], sizes[1])
    if joint.type == "prismatic" or joint.point is None:
        return tolerance
    lever = float(np.linalg.norm(np.cross(end.place - joint.point, joint.axis)))
    return tolerance / lever if lever > tolerance else math.inf


def _finding(
    context: Context, rule: Rule, item: RangeComparison, side: str, stated: float, value: float, end: RangeEnd
) -> Finding:
    joint = item.intended
    end_value, intended = shown(value, joint, context.units), shown(stated, joint, context.units)
    by = f"{quoted(end.parts)} meet" if end.parts else end.reason
    state = f"state the range that is {'free' if end.status == 'found' else 'guided'}{_range(context, item)}"
    what, remedy = f"stops at {end_value}", f"Cut away what is in the way, or {state}."
    if end.status == "unbounded":
        what = f"goes only to {end_value}"
        remedy = f"Lengthen the guide, add an end stop, or {state}."
    text = f"joint '{joint.name}' {what} on the {side} side ({by}), intended is {intended}"
    turned = _turned(context, item, stated - value)
    if turned:
        text += f"; it is free from {turned[0]}: is the sign of {turned[1]} wrong?"
        remedy = turned[2]
    return rule.finding(
        [joint.name, *end.parts],
        text,
        found=end_value if not turned else f"{end_value} (free from {turned[0]})",
        intended=intended,
        place=end.place if end.place is not None else joint.point,
        declared=joint,
        remedy=remedy,
        witness=_witness(context, item, stated, end),
    )


def _turned(context: Context, item: RangeComparison, short: float) -> tuple[str, str, str] | None:
    """The same range with the other sign where that is free, what may have the wrong sign, and what to do; None where
    it is not free, or too little is short."""
    joint = item.intended
    lower, upper = joint.range or (-math.inf, math.inf)
    follows = next((c for c in context.function.couplings if not c.others and c.joints[0] == joint.name), None)
    if not free_reversed(item) or (follows is None and abs(short) <= WRONG_SIGN * (upper - lower)):
        return None
    free = f"{shown(-upper, joint, context.units)} to {shown(-lower, joint, context.units)}"
    suspect = "its axis" if follows is None else "its axis or of its ratio"
    remedy = f"Turn the axis round, or state {range_as_written(context, joint, (-upper, -lower)) or free}"
    if follows is not None:
        remedy += f" and the ratio {number(-follows.ratio)} to '{follows.joints[1]}'"
    return free, suspect, remedy + "; else remove what is in the way, or state the range that is needed."


def _range(context: Context, item: RangeComparison) -> str:
    """ ": `range = [-40, 70]`": what the parts leave of the stated range, as the file has it."""
    lower, upper = item.intended.range or (-math.inf, math.inf)
    ends = [_reach(item.lower, lower), _reach(item.upper, upper)]
    low, high = (stated if end is None else item.sign * end for end, stated in zip(ends, (lower, upper), strict=True))
    kept = max(low, lower), min(high, upper)
    written = range_as_written(context, item.intended, kept) if kept[0] < kept[1] else ""
    return f": {written}" if written else ""


def _witness(context: Context, item: RangeComparison, stated: float, end: RangeEnd) -> Witness | None:
    """Parts in each other beyond the stop, or a slider that has left its guide before it."""
    comparison = next((c for c in context.comparisons if c.intended is item.intended), None)
    match = None if comparison is None else joint_as_intended(comparison)
    if match is None:
        return None
    if end.status == "unbounded":
        return beyond_guide(context, match[0], item.sign * stated)
    return None if end.value is None else beyond_stop(context, match[0], end.parts, end.value, item.sign * stated)


RULE = Rule("KF412", "joint-range-short", "error", __doc__, check, also=("warning",))
