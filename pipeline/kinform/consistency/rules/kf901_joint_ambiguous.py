"""The contact of two bodies neither clearly holds nor clearly frees a motion.

Inconclusive when an intended joint is between the two bodies. Without an intended joint it is a warning.

Why it matters: a guess could be wrong either way. Very short journals, slight tapers, noisy meshes and
coarse facets are the usual causes.

A face may also be read in two ways, as a guide or as an end stop: the bottom of a bore that a piston has reached, or
the step bearing of a shaft. Both readings are named then, and an intended joint chooses among them. A pin in a
slot holds or has play; that it holds may be chosen so, and not that it has play.

What to do: export a finer mesh, make the locating surface longer, separate parts that overlap, state the intended
joint where there are two readings, or state the joint by `[[assume]]`.

Example: a disc 0.2 mm thick in a bore of 40 mm: it hardly keeps the axis.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted
from kinform.model.findings import Finding
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint


def check(context: Context) -> Outcome:
    """Joints whose status is ambiguous."""
    ambiguous = [joint for joint in context.kinematics.joints if joint.status == "ambiguous" or _doubted(joint)]
    wanted = {joint.name: _wanted(context, joint) for joint in ambiguous}
    findings = [_finding(context, joint, wanted[joint.name]) for joint in ambiguous]
    intended = [want.name for want in wanted.values() if want is not None]
    return settled(findings, f"ambiguous: {quoted(intended)}" if intended else "")


def _doubted(joint: Joint) -> bool:
    """Whether it is taken as stated where contact is in doubt."""
    return any(reading.cause == "doubt" for reading in joint.readings)


def _wanted(context: Context, joint: Joint) -> IntendedJoint | None:
    for intended in context.function.joints:
        if {context.body(name) for name in intended.between} == set(joint.bodies):
            return intended
    return None


def _finding(context: Context, joint: Joint, intended: IntendedJoint | None) -> Finding:
    others = " or ".join(reading.type for reading in joint.readings) or "another"
    remedy = (
        "Export a finer mesh, lengthen the locating surface, separate overlapping parts, or state it by [[assume]]."
    )
    if joint.readings:
        remedy = "State the joint that is meant as [[function.joint]]: it chooses among these. Else by [[assume]]."
    if any(reading.cause == "bend" for reading in joint.readings):
        others = f"{others} with {counted(joint.readings[0].freedoms, 'freedom')}"
        remedy = "Joints that go through the roller are known all the same; else state this one by [[assume]]."
    return RULE.at("warning" if intended is None else RULE.severity).finding(
        [joint.name if intended is None else intended.name],
        f"the joint of {quoted(joint.bodies)} is ambiguous: {joint.reason}",
        found=f"{joint.type}, or {others}",
        intended=intended.type if intended is not None else None,
        place=context.place_of(joint),
        declared=intended,
        remedy=remedy,
    )


RULE = Rule("KF901", "joint-ambiguous", "note", __doc__, check, needs=("kinematics",), also=("warning",))
