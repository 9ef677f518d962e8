"""A drive gives more at some speed than the torque–speed curve of its motor allows, or turns faster than it can.

At each output time the point of effort and speed is held against the curve; its share is by how much the point would
have to shrink towards the origin to lie on the curve. The greatest share counts, as with KF425: a smooth peak between
output times, too few of them, no dynamic simulation that ran to its end, or no drive on the joint make it inconclusive
(KF902). A `motion` drive gives whatever its law asks for, so this is where it shows that no such motor can.

Why it matters: the motor is strong enough at rest and fast enough idle, and still does not follow the motion.

What to do: slow the motion, change the gear ratio, or take another motor.

Example: `kind = "torque_speed"`, `joint = "shoulder"`, `speeds = [0, 300, 360]`, `efforts = [2.5, 2.5, 0]`.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.limits import Quantity, peak_beside_limit, run_of_joint
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, undecided
from kinform.consistency.requirements import SINGLE, effort, requirement_rule, shown_value
from kinform.foundation.words import number
from kinform.function import resolve_joint
from kinform.function.requirement_kinds import TorqueSpeed


def judge(context: Context, requirement: TorqueSpeed) -> Answer:
    """The worst point of the motion beside the curve."""
    run = run_of_joint(context, requirement, dynamic=True)
    if isinstance(run, Answer):
        return run
    joint, simulation, column = run
    drives = context.function.drives
    driven = {resolve_joint(context.assembly, context.kinematics, drive.joint).joint for drive in drives}
    if joint not in driven:
        return undecided(f"nothing drives the joint '{requirement.joint}'", "Add a [[function.drive]] for it.")
    given, speed = simulation.joint_effort[:, column], simulation.joint_velocity[:, column]
    used = requirement.used(speed, given)
    known = np.where(np.isfinite(used), used, -np.inf)
    worst = int(known.argmax())
    remedy = "Slow the motion, change the gear ratio, or take another motor."
    if np.isfinite(known[worst]):
        fast = shown_value(abs(float(speed[worst])), joint, context.units, 4)
        remedy = f"There it gives {effort(abs(float(given[worst])), joint, 4)} at {fast}/s. {remedy}"
    name = f"what the drive of joint '{requirement.joint}' gives, beside the curve of its motor,"
    quantity = Quantity(name, lambda value, digits: f"{number(100.0 * value, digits)} %", remedy, "1", joint.point)
    return peak_beside_limit(quantity, simulation, used, 1.0)


RULE = requirement_rule("KF436", "drive-beyond-its-curve", TorqueSpeed, __doc__, judge, SINGLE)
