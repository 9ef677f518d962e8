"""A point of a body, or a direction in which it points, does not cover the region that it is required to reach.

Places spread over the region (a cone: 240 directions inside and 48 on its rim; a box: 7 along each edge; poses: all of
them) are approached from sampled configurations within the ranges of the joints, those of the function and those that
were found. A place that is reached is proved by its configuration; a hole between two places can be missed, and the
report says how large. One that is not reached was not found from any start, and its distance is given. Near enough is
the tolerance, by default a thousandth of the assembly's size, or 0.1°. Collisions are another requirement: `clear`.
Joints whose range is not known may turn freely for a "no"; for a "yes" they make the requirement inconclusive (KF902),
as closed loops with more than two freedoms do for a "no"; and so do joints that a stated coupling ties, for a "yes".

Why it matters: the tool, the beam or the camera does not get where the task is.

What to do: widen a range, lengthen a link, or move the base.

Example: a camera that must point within 40° of +x, on a yaw of ±45° and a pitch of ±30°.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF421", "region-not-reached", "reach", __doc__)
