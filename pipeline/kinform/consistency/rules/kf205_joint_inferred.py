"""A joint follows from indirect evidence, such as coaxial rims or a bolt circle, not from its contact alone.

Why it matters: the contact alone allows more. The evidence is usually right, and cannot be proved.

What to do: look at the evidence. If it is right, nothing, or say it by `[[assume]]`. Otherwise model the
journal, or correct the joint by `[[assume]]`.

Example: a servo horn that lies flat on a bracket: the common centre of their rims suggests the axis.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import listed, quoted

STATED = (("assumption",), ("function",))
"""All the evidence of joints that somebody stated: reported by KF207, or the function itself."""


def check(context: Context) -> Findings:
    """Joints whose status is inferred, except from statements."""
    for joint in context.kinematics.joints:
        if joint.status == "inferred" and joint.evidence not in STATED:
            yield RULE.finding(
                [joint.name],
                f"the {joint.type} joint of {quoted(joint.bodies)} is inferred from {listed(joint.evidence)}: "
                f"{joint.reason}",
                found=f"{joint.type}, inferred",
                intended="a joint that contact alone decides",
                remedy="Check the evidence; model the mating surfaces, or state the joint by [[assume]].",
            )


RULE = Rule("KF205", "joint-inferred", "note", __doc__, check, needs=("kinematics", "meshes"))
