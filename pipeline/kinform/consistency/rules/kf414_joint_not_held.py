"""Contact leaves an intended joint free, and more: the joint is taken as stated, because the function is complete.

An error for a design, a note for a robot description (`[check] profile`), whose pins and bearings are rarely modelled.
The joint has the status `stated`; ranges, collisions and simulations rest on it. Without `complete = true` such a joint
is of another type than intended: that is KF402. An intended joint without any contact is KF401.

Why it matters: what holds the joint is in no mesh, so nothing shows that it is held.

What to do: model what holds the joint: the pin, the bearing, the shoulder of the shaft. Or nothing, where that is
known to be left out.

Example: a link that ends at the flat face of a servo's horn; the axle is not modelled.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, direction


def check(context: Context) -> Outcome:
    """Stated joints that contact leaves free and does not hold."""
    if not context.function.complete:
        return skipped("the function does not say that it is complete")
    findings = [
        RULE.finding(
            [c.intended.name],
            f"joint '{c.intended.name}' is not held by contact, which leaves more free: {c.joint.motion}",
            found=c.joint.motion,
            intended=c.intended.type + (f" about {direction(c.intended.axis)}" if c.intended.axis is not None else ""),
            place=c.intended.point,
            declared=c.intended,
            remedy="Model what holds the joint, or accept that it is taken as stated.",
        )
        for c in context.comparisons
        if c.joint is not None and c.state == "stated" and c.joint.status == "stated" and c.joint.motion
    ]
    return decided(findings, f"{counted(len(context.comparisons), 'joint')} compared")


RULE = Rule("KF414", "joint-not-held", "error", __doc__, check, needs=("comparisons",))
