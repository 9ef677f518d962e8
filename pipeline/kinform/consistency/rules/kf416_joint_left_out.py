"""Contact inside one body is that of a joint, and the function, which states all joints, has none there.

With `complete = true` contact that no stated joint moves holds. So a joint that was forgotten is no freedom: its two
sides are one body. The rule lists axes of journals, inside of a body, about which contact alone would part it
into two substantial sides; screws, pins and rings are none, nor is what a `[[group]]` or `[[assume]]` joins, or what
lies on the axis of a stated joint (KF208). A joint that is stated as fixed and turns by contact is KF414.
Slides are not looked for.

Why it matters: the mechanism has a freedom more than is counted, simulated and checked.

What to do: state the joint; or, where the two are fastened by something that is in no mesh, join them by `[[group]]`.

Example: of an arm with six joints five are stated, and the forearm is one body with the upper arm.
"""

from __future__ import annotations

from kinform.consistency.comparisons.intended_joints import loose_joint
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import direction, quoted
from kinform.model.findings import Finding
from kinform.model.kinematics import UndeclaredJoint


def check(context: Context) -> Outcome:
    """Joints that contact alone would make inside bodies, and that no joint states as fixed."""
    assembly, kinematics = context.assembly, context.kinematics
    if not kinematics.membership:
        return skipped("the function does not state all joints")
    if kinematics.left_out is None:
        why = "the results are of an older version, which did not look for them"
        return skipped(f"{why}: derive them again (kinform run)")
    fixed = [loose_joint(assembly, kinematics, joint) for joint in context.function.joints]
    return decided(_finding(context, one) for one in kinematics.left_out if not any(one is other for other in fixed))


def _finding(context: Context, one: UndeclaredJoint) -> Finding:
    about = "" if one.axis is None else f" about {direction(one.axis)}"
    return RULE.finding(
        [one.body],
        f"by contact {quoted(one.second)} would be on a {one.type} joint{about} in body '{one.body}', and [function] "
        "states none there: it is taken to hold",
        found=f"{one.type}{about}: {one.words}",
        intended="no joint, with `complete = true`",
        place=one.point,
        declared=context.assembly.source,
        remedy="State the joint, or join the two sides by [[group]].",
    )


RULE = Rule("KF416", "joint-left-out", "warning", __doc__, check, needs=("kinematics",))
