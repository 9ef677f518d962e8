"""The manifest asks kinform to infer fasteners, and a suggestion was applied, or contradicts what is stated.

Parts that suggestions hold together count as one body, and a contact of planes alone with one round rim on both
sides turns about it. What contact decides by itself is not reported here. What the manifest keeps apart outweighs
suggestions: parts of two `[[group]]`s, and parts between which an assumption or the function states a joint that moves.
Where suggestions would join them by way of other parts, one of these suggestions must be wrong, and none is applied.

Why it matters: a suggestion is no proof. Holes line up across true joints too, and rims lie beside the axis of
a joint as often as on it.

What to do: write what is true as `[[group]]` or `[[assume]]`, and take `infer` away.

Example: `[fasteners] infer = true`, and two brackets with four aligned holes.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import quoted
from kinform.kinematics.joints.bodies.kept_apart import contradicted, kept_apart
from kinform.model.contacts import Suggestion
from kinform.model.kinematics import Kinematics


def check(context: Context) -> Findings:
    """Suggestions that were applied, and those that were not because something else is stated."""
    hints, kinematics = context.contacts.suggestions, context.kinematics
    fastening = [hint for hint in hints if hint.fastens]
    refused = contradicted(fastening, kept_apart(context.assembly), lambda part: kinematics.body_of(part).name)
    why = {id(fastening[index]): apart.words for index, apart in refused.items()}
    said = ((hint, _became(hint, why.get(id(hint), ""), kinematics)) for hint in hints)
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


def _became(hint: Suggestion, contradiction: str, kinematics: Kinematics) -> str:
    """What followed from a suggestion, or nothing; `contradiction` is what the manifest says against it."""
    first, second = (kinematics.body_of(part) for part in hint.parts)
    if first is second:
        applied = any(f"{'~'.join(hint.parts)}: {hint.evidence}" in reason for reason in first.merged)
        return "are taken for one body" if hint.fastens and applied else ""
    if hint.fastens:
        reason = contradiction or "contact would then hold together what the manifest keeps apart"
        return f"are not made one body, because {reason}"
    pair = {first.name, second.name}
    turned = any(set(joint.bodies) == pair and hint.kind in joint.evidence for joint in kinematics.joints)
    return "are taken to turn about an axis" if turned else ""


RULE = Rule(
    "KF906", "fasteners-inferred", "note", __doc__, check, needs=("inferred fasteners", "contacts", "kinematics")
)
