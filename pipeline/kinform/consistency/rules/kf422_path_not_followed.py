"""A point of a body, or its orientation, strays from the required path during the simulation.

The path is straight between its rows. It is compared at the times of its rows and at all output times between;
motion between output times is interpolated, and where that could decide, where the simulation ends before the
path does, or where there is none, the requirement is inconclusive (KF902).

Why it matters: the tool, the camera or the gripper is not where it should be.

What to do: correct the drives or the geometry. `kinform show F.h5 simulation` shows the motion.

Example: `kind = "follow"` of a coupler point whose crank is 0.5 mm too short.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF422", "path-not-followed", "follow", __doc__)
