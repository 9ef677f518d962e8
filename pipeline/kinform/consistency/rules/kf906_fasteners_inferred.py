"""The manifest asks kinform to infer fasteners, and suggestions were applied.

Parts that suggestions hold together count as one body, and a contact of planes alone with one round rim on both
sides turns about it.

Why it matters: a suggestion is no proof. Holes line up across true joints too, and rims lie beside the axis of
a joint as often as on it.

What to do: write what is true as `[[group]]` or `[[assume]]`, and take `infer` away.

Example: `[fasteners] infer = true`, and two brackets with four aligned holes.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, decided, skipped
from kinform.consistency._words import quoted

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Suggestions that were applied."""
    if not context.assembly.infer_fasteners:
        return skipped("the manifest does not ask to infer fasteners")
    contacts = context.contacts
    if isinstance(contacts, Outcome):
        return contacts
    return decided(
        RULE.finding(
            hint.parts,
            f"{quoted(hint.parts)} are taken for one body: {hint.evidence}"
            if hint.fastens
            else f"{quoted(hint.parts)} may turn about an axis: {hint.evidence}",
            declared=context.assembly.source,
            remedy="Write it as [[group]] or [[assume]] if it is true.",
        )
        for hint in contacts.suggestions
    )


RULE = Rule("KF906", "fasteners-inferred", "note", __doc__, check)
