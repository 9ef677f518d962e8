"""A small part of a contact blocks a motion that most of it allows, in both senses.

The joint has the type of the motion that the rest of the contact allows; what blocks is listed with its
area and place. Only contacts that interfere, that oppose in one direction (an end stop), or that lie on
no recognised surface can be blockers. Locators such as keys, flats and dowels are part of the joint. The finding is
made only where a finite step of the motion in either sense makes the parts interpenetrate beyond tolerance: a stop
that ends the motion at this pose in one sense is no fault. What holds a link of a robot description to the hub of its
own joint is not counted.

Why it matters: as modelled the joint does not move. Often a screw head, a label or a fillet rubs.

What to do: relieve the part at the place given. If the blocker is meant, no joint of this type exists.

Example: an elbow with a tab in a notch beside the journal, which forbids the rotation in both senses.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.questions.finite_step import StepWitness
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import area, counted, length, number, quoted
from kinform.model.findings import Finding
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint


def check(context: Context) -> Findings:
    """Joints whose status is blocked, of which steps prove that they are so in both senses."""
    blocked = [joint for joint in context.kinematics.joints if joint.status == "blocked"]
    found = [(joint, proof) for joint in blocked if (proof := _proof(context, joint)) is not None]
    return [_finding(context, joint, proof) for joint, proof in found]


def _proof(context: Context, joint: Joint) -> StepWitness | None:
    """The motion of the joint that is blocked in both senses, if any."""
    if context.blocked_joints is None:
        return None
    first, second = (context.kinematics.named_bodies[name].parts for name in joint.bodies)
    return context.blocked_joints.of(first, second, joint.twists, intended=_wanted(context, joint)).witness


def _finding(context: Context, joint: Joint, proof: StepWitness) -> Finding:
    """The finding of one blocked joint, with the largest of the contacts that block it."""
    units = context.units
    largest = max(joint.blockers, key=lambda b: (b.area, b.parts, b.patch), default=None)
    wanted = _wanted(context, joint)
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
    message += f"; {proof.words(units)}"
    return RULE.finding(
        [wanted.name if wanted is not None else joint.name],
        message,
        found=joint.reason or "blocked",
        intended=f"free {joint.type} motion" if wanted is not None else None,
        place=largest.place if largest is not None else context.place_of(joint),
        declared=wanted,
        remedy="Relieve the parts at this place, or change the joint if the contact is meant.",
        witness=proof.record,
    )


def _wanted(context: Context, joint: Joint) -> IntendedJoint | None:
    """The intended joint of the same bodies."""
    return next((one for one in context.function.joints if _joins(context, joint, one.between)), None)


def _joins(context: Context, joint: Joint, between: tuple[str, str]) -> bool:
    return {context.body(name) for name in between} == set(joint.bodies)


RULE = Rule("KF204", "joint-blocked", "warning", __doc__, check, needs=("kinematics", "meshes"))
