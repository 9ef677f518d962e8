"""The effort that the drive of a joint gives exceeds its limit during the simulation.

The greatest of the output times counts; where a smooth peak between them would be above the limit, the requirement is
inconclusive (KF902), and so do output times that are too few to follow the motion: a shorter `step` decides, and finds
shorter peaks. Without a dynamic simulation that ran
to its end, or without a drive on the joint, the requirement is inconclusive (KF902).

Why it matters: the motor stalls, or the gear breaks.

What to do: slow the motion, lighten or balance what moves, or take a stronger drive.

Example: `kind = "torque"`, `joint = "shoulder"`, `limit = 2.5`.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.limits import Quantity, peak_beside_limit, run_of_joint
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, undecided
from kinform.consistency.requirements import SINGLE, effort, requirement_rule, unit_of_effort
from kinform.function import resolve_joint
from kinform.function.requirement_kinds import Torque

REMEDY = "Slow the motion, balance what moves, or take a stronger drive."


def judge(context: Context, requirement: Torque) -> Answer:
    """The peak effort beside its limit."""
    run = run_of_joint(context, requirement, dynamic=True)
    if isinstance(run, Answer):
        return run
    joint, simulation, column = run
    drives = context.function.drives
    driven = {resolve_joint(context.assembly, context.kinematics, drive.joint).joint for drive in drives}
    if joint not in driven:
        return undecided(f"nothing drives the joint '{requirement.joint}'", "Add a [[function.drive]] for it.")
    name = f"the effort of joint '{requirement.joint}'"
    quantity = Quantity(
        name, lambda value, digits: effort(value, joint, digits), REMEDY, unit_of_effort(joint), joint.point
    )
    return peak_beside_limit(quantity, simulation, np.abs(simulation.joint_effort[:, column]), requirement.limit)


RULE = requirement_rule("KF425", "torque-exceeded", Torque, __doc__, judge, SINGLE)
