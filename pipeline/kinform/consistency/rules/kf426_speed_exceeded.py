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

from kinform.consistency.comparisons.peaks import of_joint, peak
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, requirement_rule, shown_value
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]


def judge(context: Context, requirement: Requirement) -> Answer:
    """The peak speed beside its limit."""
    found = of_joint(context, requirement)
    if isinstance(found, Answer):
        return found
    joint, simulation, column = found
    name = requirement.values["joint"]
    values = np.abs(simulation.joint_velocity[:, column])
    return peak(
        simulation, values, requirement.values["limit"], f"the speed of joint '{name}'",
        lambda v, digits: f"{shown_value(v, joint, context.units, digits)}/s", "Slow the drive.", joint.point,
    )  # fmt: skip


RULE = requirement_rule("KF426", "speed-exceeded", "speed", __doc__, judge)
