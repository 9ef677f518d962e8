"""A part can leave the assembly in a direction that is not listed.

It leaves where contact stops it one way only (`kinform show F.h5 joints` tells these ways), or where it slides in
a joint without an end. Ground is held; parts of a `[[group]]` stay together. Directions agree within 1°. Whether a
slide has an end is known from the range of its joint; where that is not known, or where contact does not say
whether parts are held, the requirement is inconclusive (KF902).

Why it matters: what can fall out does.

What to do: add a shoulder, a clip, a lid or a screw; or list the direction, if assembly needs it.

Example: `kind = "retained"`, `part = "shaft"` for a shaft with a shoulder on one side only.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF432", "not-retained", "retained", __doc__)
