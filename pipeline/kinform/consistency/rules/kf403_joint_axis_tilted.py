"""The axis of a joint points in another direction than intended.

A finding when the angle exceeds `tolerances.axis_angle` (default `tolerances.alignment`, 0.2°) by more than two
standard uncertainties of the found axis; inconclusive when the uncertainty decides. The sense of the axis does not
count. Only joints of the right type are compared.

Why it matters: over 100 mm, 0.5° is 0.9 mm; optical and bearing axes are rarely allowed as much.

What to do: correct the bore or the shaft, or the axis of the intended joint: the remedy has the one that was found, in
the frame of the file. Raise `tolerances.axis_angle` if the difference is acceptable.

Example: the pitch axis of a gimbal was drilled 0.5° off square.
"""

from __future__ import annotations

from kinform.consistency.comparisons.as_written import axis_as_written
from kinform.consistency.comparisons.comparison import Comparison
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import angle, counted, direction
from kinform.model.findings import Finding


def check(context: Context) -> Outcome:
    """Angles between intended and found axes."""
    limit = context.assembly.tolerances.angle_limit()
    findings, unknown, count = [], [], 0
    for c in context.comparisons:
        off = c.angle
        if off is None:
            continue
        count += 1
        if c.tilted:
            findings.append(_finding(context, c, off, limit))
        elif c.tilted is None:
            unknown.append(f"'{c.intended.name}' is {angle(off)} off, known to {angle(c.angle_slack)}")
    if unknown:
        return inconclusive("; ".join(unknown), findings)
    return decided(findings, f"{counted(count, 'axis', 'axes')} compared") if count else skipped("no axis to compare")


def _finding(context: Context, c: Comparison, off: float, limit: float) -> Finding:
    assert c.axis is not None and c.intended.axis is not None
    sense = 1.0 if float(c.axis @ c.intended.axis) >= 0.0 else -1.0
    written = axis_as_written(context, c.intended, sense * c.axis) or "`axis` of the intended joint"
    return RULE.finding(
        [c.intended.name],
        f"the axis of joint '{c.intended.name}' is {angle(off)} off the intended direction (allowed {angle(limit)})",
        found=f"axis {direction(sense * c.axis)}",
        intended=f"axis {direction(c.intended.axis)}",
        place=c.point if c.point is not None else c.intended.point,
        declared=c.intended,
        remedy=f"Correct the mating surfaces, or state the axis that they have: {written}.",
    )


RULE = Rule("KF403", "joint-axis-tilted", "error", __doc__, check, needs=("comparisons",))
