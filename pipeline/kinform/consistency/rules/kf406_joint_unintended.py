"""Two bodies of the function are joined by a joint that the function does not intend.

Applies when `[[function.joint]]` is stated at all, to bodies that an intended joint names. Joints to
other bodies (pins, bearings, screws) are means and are not compared; those bodies are listed by KF408.
Flat or irregular contact is KF407. Of a joint that is ambiguous the rule finds nothing, and is inconclusive.
Where the function states all joints (`complete = true`), contact that goes against the motion that these let two bodies
have is found here, or by KF407; the joints and the mobility are those of the function without it. Contact that closes a
loop of a robot description is KF419.

Why it matters: a guide, journal or socket that nobody wanted takes freedoms away.

What to do: separate the bodies, or add the joint to the function if it is wanted.

Example: a cable duct on the arm fits around the base like a bearing.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.questions.gaps import gap_between
from kinform.consistency.rule import Rule
from kinform.foundation.words import area, direction, quoted
from kinform.model.findings import Finding, Witness, stated
from kinform.model.kinematics import IgnoredContact, Joint
from kinform.model.names import BodyName


def check(context: Context) -> Outcome:
    """Lower pairs, other than planar, between bodies of the function that no intended joint joins."""
    joints = context.unintended_joints
    unknown = [joint.name for joint in joints if joint.status == "ambiguous"]
    found = [joint for joint in joints if joint.name not in unknown and joint.type not in ("planar", "general")]
    findings = [_finding(context, joint) for joint in found]
    loops = {loop.aside.name for loop in context.open_loops}
    findings += [_beside(context, a) for a in context.kinematics.asides if not a.loose and a.name not in loops]
    return settled(findings, f"not intended and ambiguous: {quoted(unknown)}" if unknown else "")


def _finding(context: Context, joint: Joint) -> Finding:
    return RULE.finding(
        [joint.name],
        f"{quoted(joint.bodies)} are joined by a {joint.type} joint that the function does not intend",
        found=joint.type + (f" about {direction(joint.axis)}" if joint.axis is not None else ""),
        intended="no joint",
        declared=context.assembly.source,
        remedy="Separate the two bodies, or add the joint to [function].",
        witness=_witness(context, joint.bodies),
    )


def _witness(context: Context, bodies: tuple[BodyName, BodyName]) -> Witness | None:
    """How near the two bodies are; of bodies without meshes, that the manifest assumes the joint."""
    sides = [context.kinematics.named_bodies[name].parts for name in bodies]
    near = gap_between(context.assembly, *sides)
    if near is not None:
        return near
    for assumption in context.assembly.assumptions:
        ends = [set(context.assembly.parts_of(name)) for name in assumption.between]
        if all(any(end & set(side) for end in ends) for side in sides):
            return stated(assumption.source, *assumption.between)
    return None


def _beside(context: Context, aside: IgnoredContact) -> Finding:
    return RULE.finding(
        [aside.name],
        f"{quoted(aside.bodies)} touch like a {aside.type} joint over {area(aside.area, context.units)}, and "
        f"{aside.words}: the contact is taken to hold nothing",
        found=aside.type + (f" about {direction(aside.axis)}" if aside.axis is not None else ""),
        intended="no joint",
        declared=context.assembly.source,
        remedy="Separate the two bodies, or add the joint to [function].",
        witness=_witness(context, aside.bodies),
    )


RULE = Rule("KF406", "joint-unintended", "error", __doc__, check, needs=("stated joints", "kinematics"))
