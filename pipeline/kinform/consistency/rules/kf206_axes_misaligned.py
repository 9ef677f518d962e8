"""The two sides of a joint have axes that differ by more than their clearance allows.

Axes within `tolerances.alignment` are mated all the same, so that the joint is recognised; what is left
over beyond clearance and the uncertainty of the fits is reported here.

Why it matters: the parts bind, or bend when they are assembled.

What to do: make both sides coaxial, or give the joint more clearance.

Example: a shaft tilted by 0.15° in a bearing of 40 mm length with 0.02 mm of clearance, which allows 0.06°.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import angle, length, listed, quoted


def check(context: Context) -> Findings:
    """Joints whose axes were mated beyond what the clearance allows."""
    for name, tilt, offset in context.kinematics.misaligned:
        parts = []
        if tilt > 0.0:
            parts.append(f"{angle(tilt)} in direction")
        if offset > 0.0:
            parts.append(f"{length(offset, context.units, 3)} in position")
        excess = listed(parts) or "a small amount"
        yield RULE.finding(
            [name],
            f"the axes of the two sides of {quoted([name])} differ by {excess} more than the clearance allows",
            found=excess,
            intended="axes that agree within the clearance",
            remedy="Make both sides coaxial, or give the joint more clearance.",
        )


RULE = Rule("KF206", "axes-misaligned", "warning", __doc__, check, needs=("kinematics", "meshes"))
