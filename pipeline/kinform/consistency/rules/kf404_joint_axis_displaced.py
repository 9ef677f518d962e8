"""The axis, or the centre, of a joint lies beside the intended one.

A finding when the distance exceeds `tolerances.axis_offset` (default 0.5 % of the smaller body's diagonal)
by more than two standard uncertainties of the found axis; inconclusive when the uncertainty decides. Axes are lines:
their least distance over the stretch between the intended point and the joint counts, so that a tilt alone is reported
by KF403 only.

Why it matters: levers, strokes and clearances are computed from wrong places.

What to do: correct the position of the bore or the pose of the part, or the place of the intended joint: the remedy has
the nearest one, in the frame and unit of the file. Raise `tolerances.axis_offset` if the difference is acceptable.

Example: a hinge that was moved 2 mm in the CAD model, and not in the manifest.
"""

from __future__ import annotations

from kinform.consistency.comparisons.as_written import point_as_written
from kinform.consistency.comparisons.comparison import WITH_LINE, Comparison
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, length, place
from kinform.model.findings import Finding


def check(context: Context) -> Outcome:
    """Distances between intended and found axes or centres."""
    units = context.units
    findings, unknown, count = [], [], 0
    for c in context.comparisons:
        off = c.offset
        if off is None:
            continue
        count += 1
        if c.displaced:
            findings.append(_finding(context, c, off))
        elif c.displaced is None:
            unknown.append(
                f"'{c.intended.name}' is {length(off, units)} off, known to {length(c.position_slack, units)}"
            )
    if unknown:
        return inconclusive("; ".join(unknown), findings)
    return decided(findings, f"{counted(count, 'place')} compared") if count else skipped("no axis to compare")


def _finding(context: Context, c: Comparison, off: float) -> Finding:
    assert c.point is not None and c.intended.point is not None
    units, nearest = context.units, c.point
    if c.axis is not None and c.type in WITH_LINE:
        nearest = c.point + c.axis * float(c.axis @ (c.intended.point - c.point))
    written = point_as_written(context, c.intended, nearest) or "`point` of the intended joint"
    what = "centre" if c.type in ("spherical", "universal") else "axis"
    return RULE.finding(
        [c.intended.name],
        f"the {what} of joint '{c.intended.name}' is {length(off, units)} beside the intended one "
        f"(allowed {length(c.position_limit, units)})",
        found=f"through {place(c.point, units)}",
        intended=f"through {place(c.intended.point, units)}",
        place=c.point,
        declared=c.intended,
        remedy=f"Correct the pose or the mating surfaces, or state where the {what} is: {written}.",
    )


RULE = Rule("KF404", "joint-axis-displaced", "error", __doc__, check, needs=("comparisons",))
