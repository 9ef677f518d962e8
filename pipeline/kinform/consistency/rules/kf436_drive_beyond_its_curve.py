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

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF436", "drive-beyond-its-curve", "torque_speed", __doc__)
