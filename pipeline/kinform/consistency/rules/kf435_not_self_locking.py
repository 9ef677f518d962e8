"""A joint that is meant to stay under its load without a drive is moved by it.

At each of the poses gravity, loads and springs act and the joint's drive gives nothing; other drives stand still, and
joints that close no loop are held. Friction at rest (of the drives of kind friction, by the coefficients at rest)
holds the joint, or does not. Where nothing loads it, nothing is shown, and loads that redundancy shares leave it open:
inconclusive then (KF902). Vibration loosens what friction holds; a coefficient is rarely known better than to a third.

Why it matters: the lift comes down when the motor is switched off.

What to do: take a smaller lead, a larger radius, a greater coefficient at rest, or add a brake.

Example: `kind = "self_locking"`, `joint = "screw"`.
"""

from __future__ import annotations

from kinform.consistency.comparisons.driving import driven_in, worst
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, met, undecided, violated
from kinform.consistency.requirements import SINGLE, effort, requirement_rule
from kinform.foundation.words import counted, telling
from kinform.function.requirement_kinds import SelfLocking

REMEDY = "Take a smaller lead, a larger radius or a greater coefficient at rest, or add a brake."
LOAD = "State the load: a [[function.load]], or gravity with the masses."


def judge(context: Context, requirement: SelfLocking) -> Answer:
    """Whether friction holds the joint in all poses."""
    name = requirement.joint
    found = driven_in(context, name, requirement.poses)
    if isinstance(found, Answer):
        return found
    for shown, driving, _ in found:
        if driving.without == 0.0:
            return undecided(f"at {shown}: nothing loads joint '{name}', so that nothing is shown", LOAD)
    shown, driving, joint = worst(found, lambda one: one.least)
    if driving.locked:
        where = counted(len(found), "pose")
        return met(f"joint '{name}' stays under its load without a drive, in {where}", found="stays", intended="stays")
    words = telling(lambda value, digits: effort(value, joint, digits), driving.least, abs(driving.without))
    return violated(
        f"joint '{name}' does not stay under its load at {shown}: it takes {words(driving.least)} to hold it "
        f"({words(abs(driving.without))} without friction)",
        found=words(driving.least), intended="stays without a drive", place=joint.point, remedy=REMEDY,
    )  # fmt: skip


RULE = requirement_rule("KF435", "not-self-locking", SelfLocking, __doc__, judge, SINGLE)
