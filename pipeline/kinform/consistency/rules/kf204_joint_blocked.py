"""Most of a contact allows a motion that a small part of it forbids.

The joint has the type of the motion that the rest of the contact allows; what blocks is listed with its
area and place. Only contacts that interfere, that oppose in one direction (an end stop), or that lie on
no recognised surface can be blockers. Locators such as keys, flats and dowels are part of the joint.

Why it matters: as drawn the joint does not move. Often a screw head, a label or a fillet rubs; sometimes
the blocker is a stop that is meant and only touches in this pose.

What to do: relieve the part at the place given. If the blocker is meant, no joint of this type exists.

Example: an elbow of which 6 % of the contact area, beside the journal, forbids the rotation.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import area, counted, length, number, quoted
from kinform.model.findings import Finding
from kinform.model.kinematics import Joint


def check(context: Context) -> Findings:
    """Joints whose status is blocked."""
    return [_finding(context, joint) for joint in context.kinematics.joints if joint.status == "blocked"]


def _finding(context: Context, joint: Joint) -> Finding:
    """The finding of one blocked joint, with the largest of the contacts that block it."""
    units = context.units
    largest = max(joint.blockers, key=lambda b: (b.area, b.parts, b.patch), default=None)
    wanted = next((i for i in context.function.joints if _joins(context, joint, i.between)), None)
    message = f"the {joint.type} joint of {quoted(joint.bodies)} is blocked"
    if largest is not None:
        count = len(joint.blockers)
        share = sum(blocker.share for blocker in joint.blockers)
        gap = f"{'overlap' if largest.gap < 0 else 'gap'} {length(abs(largest.gap), units, 2)}"
        message += (
            f": {counted(count, 'contact')} with {number(100 * share, 2)} % of the area "
            f"{'forbids' if count == 1 else 'forbid'} {largest.forbids}; "
            f"the largest is {area(largest.area, units)} between {quoted(largest.parts)} ({gap})"
        )
    return RULE.finding(
        [wanted.name if wanted is not None else joint.name],
        message,
        found=joint.reason or "blocked",
        intended=f"free {joint.type} motion" if wanted is not None else None,
        place=largest.place if largest is not None else context.place_of(joint),
        declared=wanted,
        remedy="Relieve the parts at this place, or change the joint if the contact is meant.",
    )


def _joins(context: Context, joint: Joint, between: tuple[str, str]) -> bool:
    return {context.body(name) for name in between} == set(joint.bodies)


RULE = Rule("KF204", "joint-blocked", "warning", __doc__, check, needs=("kinematics", "meshes"))
