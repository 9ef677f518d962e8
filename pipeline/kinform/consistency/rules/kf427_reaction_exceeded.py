"""The reaction in a joint exceeds its limit of force or torque during the simulation.

The force that the two bodies exert on each other through the joint, and the torque about the joint's point, the
greatest of the output times; a smooth peak between them that would be above the limit makes the requirement
inconclusive (KF902), as do output times that are too few to follow the motion, and a shorter `step` decides.
Components that redundant constraints leave undetermined, a simulation without reactions, and one that did not run to
its end make the requirement inconclusive (KF902).

Why it matters: the bearing, the pin or the screw is overloaded.

What to do: lighten or slow what moves, support it better, or take a larger bearing.

Example: `kind = "reaction"`, `joint = "elbow"`, `force = 250`.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF427", "reaction-exceeded", "reaction", __doc__)
