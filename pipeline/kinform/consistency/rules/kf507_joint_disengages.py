"""In the simulated motion, a slider leaves the last of the surfaces that guide it.

Of joints that slide along an axis (prismatic, cylindrical, screw), the extents along it of both sides of each patch are
compared at every output time: the finding names the first at which no patch is left. A joint that is left while others
still guide its bodies the same way is not reported: a bar in two bushes may leave one. Joints that are stated rather
than found in contact have no patches to leave, and planar joints are not looked at.

Why it matters: beyond there the joint does not exist; the simulated motion means nothing.

What to do: lengthen the guide, shorten the stroke, or add an end stop.

Example: a carriage of 40 mm leaves its rail of 200 mm at a stroke of 125 mm.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.questions.proofs import beyond_guide
from kinform.consistency.rule import Rule
from kinform.foundation.words import angle, length, number
from kinform.model.findings import Finding
from kinform.statics.disengaging import SLIDES, Slip, slips


def check(context: Context) -> Outcome:
    """The first time at which each slider has left its guide."""
    run = context.simulation
    if not any(kind in SLIDES for kind in run.joint_types):
        return skipped("no joint slides along an axis")
    return decided(_finding(context, slip) for slip in slips(context.design))


def _finding(context: Context, slip: Slip) -> Finding:
    def said(value: float) -> str:
        return angle(value) if slip.joint.type == "screw" else length(value, context.units)

    return RULE.finding(
        (slip.joint.name,),
        f"'{slip.joint.name}' disengages at t = {number(slip.time, 6)} s: at {said(slip.value)} the slider has left "
        f"its guide, which ends at {said(slip.limit)}",
        found=said(slip.value),
        intended=f"up to {said(slip.limit)}",
        place=slip.joint.point,
        remedy="Lengthen the guide, shorten the stroke, or add an end stop.",
        witness=beyond_guide(context, slip.joint, slip.value),
    )


RULE = Rule("KF507", "joint-disengages", "error", __doc__, check, needs=("contacts", "kinematics", "motion"))
