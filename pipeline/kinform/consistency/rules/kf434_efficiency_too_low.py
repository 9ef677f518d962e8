"""Too little of the work that the drive of a joint puts in comes out, because of friction.

At each of the poses the joint is moved slowly against gravity, loads and springs: the efficiency is the effort without
friction over that with it, by the coefficients in motion. Other drives stand still, and joints that close no loop are
held. Friction is that of the drives of kind friction, and what couplings and motors lose by their `efficiency`; joints
without one count as free of it. Without load there is no efficiency; loads that redundancy shares leave it open:
inconclusive then (KF902).

Why it matters: the motor that was chosen for the load does not move it, and what is lost heats the thread.

What to do: take a steeper lead, a smaller radius, better materials or lubrication, or rolling bodies.

Example: `kind = "efficiency"`, `joint = "screw"`, `minimum = 0.3`.
"""

from __future__ import annotations

from kinform.consistency.comparisons.driving import driven_in, worst
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, Margin, met, undecided, violated
from kinform.consistency.requirements import SINGLE, requirement_rule
from kinform.foundation.words import counted
from kinform.function.requirement_kinds import Efficiency

REMEDY = "Take a steeper lead, a smaller radius, other materials or lubrication, or rolling bodies."
LOAD = "State the load: a [[function.load]], or gravity with the masses."


def judge(context: Context, requirement: Efficiency) -> Answer:
    """The least efficiency of all poses beside the minimum."""
    name = requirement.joint
    found = driven_in(context, name, requirement.poses)
    if isinstance(found, Answer):
        return found
    for shown, driving, _ in found:
        if driving.efficiency is None:
            return undecided(f"at {shown}: nothing loads joint '{name}', so that it has no efficiency", LOAD)
    shown, driving, joint = worst(found, lambda one: -(one.efficiency or 0.0))
    least = driving.efficiency or 0.0
    limit = f"at least {100.0 * requirement.minimum:.4g} %"
    value = f"{100.0 * least:.4g} %"
    text = f"moving joint '{name}' slowly against its load has an efficiency of {value} at {shown}"
    if least == 0.0:
        text = f"no effort moves joint '{name}' against its load at {shown}: friction grows with it"
    margin = Margin(least - requirement.minimum, "")
    if least < requirement.minimum:
        return violated(
            f"{text}, required is {limit}", found=value, intended=limit, place=joint.point, remedy=REMEDY,
            margin=margin,
        )  # fmt: skip
    text = f"{text}, the least of {counted(len(found), 'pose')}"
    return met(text, found=value, intended=limit, margin=margin)


RULE = requirement_rule("KF434", "efficiency-too-low", Efficiency, __doc__, judge, SINGLE)
