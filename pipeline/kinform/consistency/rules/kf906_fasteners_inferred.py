"""The manifest asks kinform to infer fasteners, and a suggestion was applied, or contradicts what is stated.

Parts that suggestions hold together count as one body, and a contact of planes alone with one round rim on both
sides turns about it. What contact decides by itself is not reported here. Where an assumption or the function
states a joint that moves between two bodies, that outweighs the suggestion.

Why it matters: a suggestion is no proof. Holes line up across true joints too, and rims lie beside the axis of
a joint as often as on it.

What to do: write what is true as `[[group]]` or `[[assume]]`, and take `infer` away.

Example: `[fasteners] infer = true`, and two brackets with four aligned holes.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import quoted
from kinform.model.contacts import Suggestion
from kinform.model.kinematics import Kinematics


def check(context: Context) -> Findings:
    """Suggestions that were applied, and those that were not because something else is stated."""
    contacts, kinematics = context.contacts, context.kinematics
    said = ((hint, _became(hint, kinematics)) for hint in contacts.suggestions)
    for hint, became in said:
        if became:
            yield RULE.finding(
                hint.parts,
                f"{quoted(hint.parts)} {became}: {hint.evidence} ({hint.confidence} confidence)",
                found=hint.evidence,
                intended="what the manifest states",
                declared=context.assembly.source,
                remedy="Write it as [[group]] or [[assume]] if it is true.",
            )


def _became(hint: Suggestion, kinematics: Kinematics) -> str:
    """What followed from a suggestion, or nothing."""
    first, second = (kinematics.body_of(part) for part in hint.parts)
    if first is second:
        applied = any(f"{'~'.join(hint.parts)}: {hint.evidence}" in reason for reason in first.merged)
        return "are taken for one body" if hint.fastens and applied else ""
    if hint.fastens:
        return "are not made one body, because a joint is stated between them"
    pair = {first.name, second.name}
    turned = any(set(joint.bodies) == pair and hint.kind in joint.evidence for joint in kinematics.joints)
    return "are taken to turn about an axis" if turned else ""


RULE = Rule(
    "KF906", "fasteners-inferred", "note", __doc__, check, needs=("inferred fasteners", "contacts", "kinematics")
)
