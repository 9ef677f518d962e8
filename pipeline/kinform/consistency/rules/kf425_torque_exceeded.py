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

from kinform.consistency.comparisons.peaks import of_joint, peak
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, effort, requirement_rule, undecided
from kinform.function import resolve
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]


def judge(context: Context, requirement: Requirement) -> Answer:
    """The peak effort beside its limit."""
    name = requirement.values["joint"]
    found = of_joint(context, requirement, dynamic=True)
    if isinstance(found, Answer):
        return found
    joint, simulation, column = found
    kinematics = context.design.kinematics
    assert kinematics is not None
    driven = {resolve(context.assembly, kinematics, drive.joint).joint for drive in context.function.drives}
    if joint not in driven:
        return undecided(f"nothing drives the joint '{name}'", "Add a [[function.drive]] for it.")
    values = np.abs(simulation.joint_effort[:, column])
    return peak(
        simulation, values, requirement.values["limit"], f"the effort of joint '{name}'",
        lambda v, digits: effort(v, joint, digits), "Slow the motion, balance what moves, or take a stronger drive.", joint.point,
    )  # fmt: skip


RULE = requirement_rule("KF425", "torque-exceeded", "torque", __doc__, judge)
