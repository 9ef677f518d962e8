"""The function intends a joint between two bodies that do not touch.

Contact through loose parts between them (a pin, a bearing) counts, if the function does not name them. Where such a
part has play between the two, less than the contact tolerance to either side, it is not known whether it carries the
joint, and the rule is inconclusive. So it is where the bodies touch in a way that is no contact that is known (KF209).

Why it matters: nothing carries the joint; the bodies move independently.

What to do: check the poses and the clearance (surfaces mate up to `tolerances.contact`); add the missing
pin or bearing; or correct `between`.

Example: the pin of a hinge was left out, and the two leaves are 2 mm apart.
"""

from __future__ import annotations

from kinform.consistency.comparisons.comparison import Comparison
from kinform.consistency.comparisons.missing_pin import missing_pin
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.questions.gaps import gap_between
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, length, quoted


def check(context: Context) -> Outcome:
    """Intended joints without any contact."""
    doubts = [f"'{c.intended.name}': {c.afloat}" for c in context.comparisons if c.afloat and not c.touch]
    return settled(
        (
            RULE.finding(
                [c.intended.name],
                f"the intended {c.intended.type} joint '{c.intended.name}' is missing: {_reason(context, c)}"
                + (f"; {pin[0]}" if pin else ""),
                found="no contact" + (f", {pin[0]}" if pin else ""),
                intended=f"{c.intended.type} joint of {quoted(c.intended.between)}",
                place=c.intended.point,
                declared=c.intended,
                remedy=pin[1]
                if pin
                else "Check poses and clearances, add the part that carries the joint, or correct `between`.",
                witness=gap_between(context.assembly, *(body.parts for body in c.bodies)),
            )
            for c in context.comparisons
            if c.state == "absent" or _taken(c)
            for pin in [missing_pin(context, c)]
        ),
        "; ".join(doubts),
        reason=f"{counted(len(context.comparisons), 'joint')} compared",
    )


def _taken(comparison: Comparison) -> bool:
    """Whether a complete function states the joint, and it is sure that there is no contact."""
    joint = comparison.joint
    return comparison.state == "taken" and joint is not None and not joint.patches and not comparison.afloat


def _reason(context: Context, comparison: Comparison) -> str:
    kinematics = context.design.kinematics
    touched = {name for joint in kinematics.joints for name in joint.bodies} if kinematics else set()
    lonely = [body for body in comparison.bodies if body.name not in touched]
    limit = context.assembly.tolerances.contact
    within = f" within {length(limit, context.units)}" if limit is not None else ""
    if len(lonely) == 1:
        return f"{quoted([lonely[0].name])} touches no other body{within}"
    first, second = (quoted([body.name]) for body in comparison.bodies)
    return f"{first} and {second} do not touch{within}"


RULE = Rule("KF401", "joint-missing", "error", __doc__, check, needs=("comparisons",))
