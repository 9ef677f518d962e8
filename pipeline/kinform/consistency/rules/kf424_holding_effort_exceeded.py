"""The static effort that holds a joint in a pose exceeds its limit.

Gravity, loads and springs by virtual work, at each of the poses (joints that a pose does not name stay at the pose
of the meshes, or go where loops put them); other drives stand still; joints that close no loop are held. Where
friction is stated (drives of kind friction) it is the least effort that holds the joint with all that friction at
rest can hold, and what it would take without is told beside it. An unknown mass, a loop in which it is not stated
which joint holds, or a joint that shares the load with other drives make the requirement inconclusive (KF902).

Why it matters: the arm sinks, or the motor overheats while it does nothing.

What to do: balance the joint, lighten what it carries, or take a stronger or self-locking drive.

Example: `kind = "hold"`, `joint = "shoulder"`, `limit = 1.5`, `poses = [{shoulder = 90, elbow = 0}]`.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF424", "holding-effort-exceeded", "hold", __doc__)
