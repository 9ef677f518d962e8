"""The function states the range of a joint, and what the geometry allows is not known.

The rule is inconclusive as long as there is one, also when a side is free (`inf`). Ranges that were found are
compared by KF434.

Why it matters: whether the parts collide inside the range is not known.

What to do: see the reason. A requirement of kind `clear` over the ranges checks two parts along it; else check it
by other means.

Example: `range = [-110, 110]` for a shoulder whose parts were never moved.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._ranges import compared_ranges, shown_range
from kinform.consistency._rule import Outcome, Rule, decided, inconclusive, skipped
from kinform.consistency._words import counted

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Every intended range that has nothing to be compared with."""
    ranged = [joint for joint in context.function.joints if joint.range is not None]
    if not ranged:
        return skipped("no intended joint states a range")
    ranges = compared_ranges(context)
    if isinstance(ranges, Outcome):
        return ranges
    unknown = [item for item in ranges if item.found is None]
    findings = [
        RULE.finding(
            [item.intended.name],
            f"the range of joint '{item.intended.name}' is not checked: {item.reason}",
            found="not checked",
            intended=shown_range(item.intended.range or (0.0, 0.0), item.intended, context.units),
            place=item.intended.point,
            declared=item.intended,
            remedy='Require `kind = "clear"` of the parts with `over = "ranges"`, or check it by other means.',
        )
        for item in unknown
    ]
    if not unknown:
        return decided(reason=f"{counted(len(ranges), 'range')} found")
    return inconclusive(f"{counted(len(unknown), 'range')} not checked", findings)


RULE = Rule("KF904", "range-not-checked", "note", __doc__, check)
