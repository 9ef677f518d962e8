"""The speed of a joint exceeds its limit during the simulation.

The greatest of the output times counts; where a smooth peak between them would be above the limit, the requirement is
inconclusive (KF902), and so do output times that are too few to follow the motion: a shorter `step` decides, and finds
shorter peaks. Without a simulation that ran to its
end the requirement is inconclusive (KF902).

Why it matters: motors, encoders and bearings have a greatest speed.

What to do: slow the drive, or change the transmission.

Example: `kind = "speed"`, `joint = "yaw"`, `limit = 180` (degrees a second).
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.limits import Quantity, peak_beside_limit, run_of_joint
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer
from kinform.consistency.requirements import SINGLE, requirement_rule, shown_value, unit_of
from kinform.function.requirement_kinds import Speed


def judge(context: Context, requirement: Speed) -> Answer:
    """The peak speed beside its limit."""
    run = run_of_joint(context, requirement)
    if isinstance(run, Answer):
        return run
    joint, simulation, column = run

    def shown(value: float, digits: int) -> str:
        return f"{shown_value(value, joint, context.units, digits)}/s"

    quantity = Quantity(
        f"the speed of joint '{requirement.joint}'", shown, "Slow the drive.", f"{unit_of(joint)}/s", joint.point
    )
    return peak_beside_limit(quantity, simulation, np.abs(simulation.joint_velocity[:, column]), requirement.limit)


RULE = requirement_rule("KF426", "speed-exceeded", Speed, __doc__, judge, SINGLE)
