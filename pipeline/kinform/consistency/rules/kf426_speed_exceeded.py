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

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF426", "speed-exceeded", "speed", __doc__)
