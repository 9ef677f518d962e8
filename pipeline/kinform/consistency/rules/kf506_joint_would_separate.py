"""In the simulated motion, a joint made of contacts that can only push would have to pull.

Joints hold both ways in the simulation; contacts do not. Of joints that contact does not enclose (`kinform show F.h5
joints` says so) the wrench of each output time is compared with what pushes at the borders of their patches can make:
no tension, and no moment that would tip the part over an edge of its patch. Friction is not counted, nor are fasteners
that are not modelled; what a drive gives acts through the joint's point. The finding names the first such time.

Where redundant constraints leave wrenches open, all that balance are admitted: a finding means that none of them can be
pushed by all contacts at once. Notes name the joints of which it cannot be known: those that are stated rather than
found in contact, those that are within 1 % of what their contacts carry, and open ones of very large mechanisms and of
those with gears. Parts that
contact alone fuses into one body are not looked at: no reaction is computed between them.

Why it matters: from there on the real device moves in another way; the lid lifts, the block tips over.

What to do: hold the part down (a retaining ring, a screw, a spring, a second flange), or drive it more gently. Where
a fastener holds it that geometry does not show, state the group or the joint.

Example: a cam throws its follower, which only its weight keeps on the cam, off at 120 turns a minute.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import number, quoted
from kinform.model.findings import Finding
from kinform.statics.separating import Lift, Sharing, lifts


def check(context: Context) -> Outcome:
    """The first separation of each joint."""
    run = context.simulation
    if run.level != "dynamic" or not len(run.time):
        return skipped("without a dynamic run there are no reactions")
    if len(run.F_B) != len(run.time):
        return inconclusive("the run has no reactions: run `kinform simulate`")
    separations, shared, aside = lifts(context.design)
    findings = [_finding(lift) if lift.certain else _doubt(lift) for lift in separations]
    if shared is not None and (shared.time is not None or not shared.certain):
        findings.append(_shared(shared))
    reason = "" if not aside else f"not found in contact, and not looked at: {quoted(aside)}"
    return decided(findings, reason)


def _finding(lift: Lift) -> Finding:
    joint = lift.joint
    return RULE.finding(
        (joint.name,),
        f"'{joint.name}' would separate at t = {number(lift.time, 6)} s: its contacts can only push, and holding it "
        f"there takes {number(lift.force)} N and {number(lift.torque)} N·m that they cannot give",
        found=f"t = {number(lift.time, 6)} s",
        intended="contact that pushes",
        place=joint.point,
        remedy="Hold the part by something that pulls, or drive it more gently; state fasteners that are not modelled.",
    )


def _doubt(lift: Lift) -> Finding:
    return RULE.at("note").finding(
        (lift.joint.name,),
        f"whether '{lift.joint.name}' would separate at t = {number(lift.time, 6)} s is not certain: it is within 1 % "
        "of what its contacts can carry",
        place=lift.joint.point,
    )


def _shared(shared: Sharing) -> Finding:
    """Of joints whose reactions redundant constraints leave open."""
    names = shared.joints
    if shared.time is None:
        return RULE.at("note").finding(
            names,
            f"whether {quoted(names)} would separate is not known: redundant constraints leave the reaction open",
            remedy="Remove the redundant constraints: see KF303.",
        )
    when = f"t = {number(shared.time, 6)} s"
    if not shared.certain:
        return RULE.at("note").finding(
            names,
            f"whether {quoted(names)} would separate at {when} is not certain: however redundant constraints share the "
            "load, it is within 1 % of what their contacts can carry",
        )
    return RULE.finding(
        names,
        f"of {quoted(names)} at least one would separate at {when}: however redundant constraints share the load, "
        "their contacts cannot carry it by pushing alone",
        found=when,
        intended="contact that pushes",
        remedy="Hold the parts by something that pulls, or drive them more gently; state fasteners that are not "
        "modelled.",
    )


RULE = Rule(
    "KF506",
    "joint-would-separate",
    "warning",
    __doc__,
    check,
    needs=("contacts", "kinematics", "forces"),
    also=("note",),
)
