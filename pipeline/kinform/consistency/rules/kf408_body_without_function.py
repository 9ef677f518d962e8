"""The function states joints, and this body is in none of them.

Why it matters: what the body may do is not compared with anything. For pins, bearings and screws that is
as it should be.

What to do: nothing for such parts. Otherwise add the intended joint, or put the part in a `[[group]]`
with the body that it is fastened to.

Example: a cover that was added to the assembly, and not to the function.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import counted, quoted


def check(context: Context) -> Findings:
    """Bodies that no intended joint names."""
    kinematics = context.kinematics
    for body in kinematics.bodies:
        if body.name not in context.intended_bodies:
            yield RULE.finding(
                [body.name],
                f"{quoted([body.name])} is in no intended joint: its "
                f"{counted(sum(body.name in joint.bodies for joint in kinematics.joints), 'joint')} "
                "cannot be compared with the function",
                found="no intended joint",
                intended="an intended joint of every body, or a [[group]]",
                declared=context.assembly.part(body.parts[0]).source,
                remedy="Nothing for pins and screws; otherwise add the intended joint, or a [[group]].",
            )


RULE = Rule("KF408", "body-without-function", "note", __doc__, check, needs=("stated joints", "kinematics"))
