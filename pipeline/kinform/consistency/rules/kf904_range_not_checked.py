"""The function states the range of a joint, and how far the parts let it go is not known.

A note for each stated range of which a side is not known: no such joint was found, it is one of several freedoms, its
loops have a singular pose, or parts overlap from the start: what these do is not known. KF412 compares what is known.
Between bodies without meshes a range is given by the function, and there is nothing to compare it with: the rule does
not apply to it, unless meshes elsewhere could meet.

Why it matters: whether the parts collide inside the range is not known.

What to do: follow the reason that is given; resolve overlaps of parts first.

Example: `range = [-110, 110]` for a shoulder whose motor overlaps its bracket in the pose of the meshes.
"""

from __future__ import annotations

from kinform.consistency.comparisons.ranges import range_comparisons, shown
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted


def check(context: Context) -> Outcome:
    """Every intended range."""
    items = range_comparisons(context)
    if not items:
        return skipped("no intended joint states a range")
    open_ = [item for item in items if not item.given]
    if not open_:
        return skipped(
            f"bodies without meshes: {counted(len(items), 'range')} given by the function, nothing to compare"
        )
    findings = [
        RULE.finding(
            [item.intended.name],
            f"the range of joint '{item.intended.name}' is not known: {why}",
            found="not known",
            intended=" to ".join(shown(end, item.intended, context.units) for end in item.intended.range or (0.0, 0.0)),
            place=item.intended.point,
            declared=item.intended,
            remedy="Follow the reason, or check it by other means.",
        )
        for item in open_
        if (why := item.unknown)
    ]
    return settled(findings, f"{counted(len(findings), 'range')} not checked" if findings else "")


RULE = Rule("KF904", "range-not-checked", "note", __doc__, check, speaks_for=("KF412",))
