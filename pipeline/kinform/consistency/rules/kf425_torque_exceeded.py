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

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF425", "torque-exceeded", "torque", __doc__)
