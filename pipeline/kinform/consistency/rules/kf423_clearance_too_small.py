"""Two parts collide, or come nearer than the required distance, along the simulated motion or over the ranges.

Distances are those of the surfaces, by FCL. Surfaces by which a pair mates do not count against each other, nor against
what borders on their mates or touches beside them; they count against all the rest. Messages name such pairs. Along the
motion steps are as long as the distance allows, so that nothing is passed over; between output times poses are
interpolated. Over the ranges every combination of joint values between the two is covered, cell by cell.
Distances are certain up to 1e-4 of the size of the smaller part, 1e-3 where several joints move at once. A simulation
that did not run, a range that is not known, a loop between the two (over ranges), too many cells, or parts of which it
is not known whether they overlap as drawn (KF210) make the requirement inconclusive (KF902).

Why it matters: what collides does not move there, and breaks.

What to do: see the place and the time. Cut material away, or narrow the motion or the range.

Example: `kind = "clear"`, `between = ["camera", "housing"]`, `distance = 1` for a camera that passes a rib by 0.4 mm.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF423", "clearance-too-small", "clear", __doc__)
