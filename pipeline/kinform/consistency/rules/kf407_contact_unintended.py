"""Two bodies of the function touch, and the function intends no joint between them.

Like KF406, for contact that is no joint by itself: flat faces, or irregular contact. Where the function states all
joints, contact of which it is not sure what it would hold is told here too.

Why it matters: the bodies may rub or stop each other. Sometimes it is an end stop that is meant.

What to do: give the bodies a gap; if the contact is meant, add it to the function or state
`[[assume]] ignore = true` with the reason.

Example: the side of a link slides along the base.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import area, counted, quoted
from kinform.model.findings import Finding
from kinform.model.kinematics import IgnoredContact, Joint


def check(context: Context) -> Findings:
    """Planar and general contact between bodies of the function that no intended joint joins."""
    touching = [j for j in context.unintended_joints if j.type in ("planar", "general") and j.status != "ambiguous"]
    beside = [aside for aside in context.kinematics.asides if aside.loose]
    return [_finding(context, joint) for joint in touching] + [_beside(context, aside) for aside in beside]


def _finding(context: Context, joint: Joint) -> Finding:
    contacts = context.design.contacts
    size = sum(contacts.patches[k].area for k in joint.patches) if contacts is not None else 0.0
    over = f" over {area(size, context.units)}" if size > 0.0 else ""
    return RULE.finding(
        [joint.name],
        f"{quoted(joint.bodies)} touch{over}, which the function does not intend",
        found=f"{joint.type} contact, {counted(joint.freedoms, 'freedom')} left",
        intended="no contact",
        declared=context.assembly.source,
        remedy="Give the bodies a gap, or state the contact in [function] or by [[assume]].",
    )


def _beside(context: Context, aside: IgnoredContact) -> Finding:
    over = f" over {area(aside.area, context.units)}" if aside.area > 0.0 else ""
    return RULE.finding(
        [aside.name],
        f"{quoted(aside.bodies)} touch{over}, and {aside.words}: the contact is taken to hold nothing",
        found=f"{'' if aside.status != 'ambiguous' else 'ambiguous '}{aside.type} contact, "
        f"{counted(aside.freedoms, 'freedom')} left",
        intended="no contact",
        declared=context.assembly.source,
        remedy="Give the bodies a gap, or state the contact in [function] or by [[assume]].",
    )


RULE = Rule("KF407", "contact-unintended", "warning", __doc__, check, needs=("stated joints", "kinematics"))
