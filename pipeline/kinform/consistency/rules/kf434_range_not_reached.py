"""A joint is stopped before the end of its intended range.

The range that the geometry leaves is compared with the intended one, in the designer's sign, with 0.05° or a
thousandth of the range to spare. A wider range is no finding. Ranges that were not found are KF904.

Why it matters: the mechanism does not reach what it is for.

What to do: remove what stops it, or narrow the intended range. `kinform show F.h5 joints` tells what stops it.

Example: a shoulder intended to turn by 110° that hits its housing at 96°.
"""

from __future__ import annotations

import math

from kinform.consistency._context import Context
from kinform.consistency._ranges import Range, compared_ranges, shown_range
from kinform.consistency._rule import Outcome, Rule, decided, skipped
from kinform.consistency._words import counted
from kinform.model.findings import Finding

__all__ = ["RULE"]

SPARE = math.radians(0.05)
SHARE = 1e-3


def check(context: Context) -> Outcome:
    """Intended ranges that are not reached."""
    if not any(joint.range is not None for joint in context.function.joints):
        return skipped("no intended joint states a range")
    ranges = compared_ranges(context)
    if isinstance(ranges, Outcome):
        return ranges
    known = [r for r in ranges if r.found is not None]
    if not known:
        return skipped("no intended range could be compared: see KF904")
    findings = [_finding(context, r) for r in known if _short(r)]
    return decided(findings, f"{counted(len(known), 'range')} compared")


def _short(item: Range) -> bool:
    """Whether one side ends before it should."""
    assert item.intended.range is not None
    assert item.found is not None
    (low, high), (found_low, found_high) = item.intended.range, item.found
    width = high - low
    spare = SHARE * width if math.isfinite(width) else 0.0
    if item.intended.type != "prismatic":
        spare = max(spare, SPARE)
    return found_low > low + spare or found_high < high - spare


def _finding(context: Context, item: Range) -> Finding:
    joint, units = item.intended, context.units
    assert joint.range is not None
    assert item.found is not None
    found, intended = (shown_range(r, joint, units) for r in (item.found, joint.range))
    return RULE.finding(
        [joint.name],
        f"joint '{joint.name}' reaches {found}, intended is {intended}",
        found=found,
        intended=intended,
        place=joint.point,
        declared=joint,
        remedy="Remove what stops it, or narrow the intended range.",
    )


RULE = Rule("KF434", "range-not-reached", "error", __doc__, check)
