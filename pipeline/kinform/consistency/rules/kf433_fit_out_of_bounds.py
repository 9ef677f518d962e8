"""The clearance between two parts lies outside of the required bounds.

Of coaxial and concentric surfaces the clearance is the difference of radii (half of that of diameters), negative for
a press fit; of planes that face each other, as a key in its slot, the gaps of both sides together. Every fit between
the two counts. Where the uncertainty of the fitted surfaces could decide, or where no surfaces mate, the requirement
is inconclusive (KF902).

Why it matters: too tight does not assemble or seizes, too loose rattles.

What to do: change one of the two sizes. `kinform show F.h5 contacts` lists all fits.

Example: `kind = "fit"`, `between = ["shaft", "bush"]`, `minimum = 0.01`, `maximum = 0.05` for a gap of 0.15 mm.
"""

from __future__ import annotations

from kinform.consistency.comparisons.weighed import compared
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, common, met, requirement_rule, undecided
from kinform.consistency.rule import Outcome
from kinform.foundation.words import counted, length, quoted
from kinform.function.fits import clearances
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]

KINDS = {"radial": "radial clearance", "both sides": "clearance between planes", "gap": "gap between planes"}


def judge(context: Context, requirement: Requirement) -> Answer:
    """Every fit of the two beside the bounds."""
    contacts, values = context.contacts, requirement.values
    if isinstance(contacts, Outcome):
        return undecided(contacts.reason, "Give both parts meshes.")
    if shared := common(context, values["between"]):
        return undecided(f"{quoted(shared)} would be on both sides", "Name two that share no part.")
    first, second = (context.assembly.parts_of(name) for name in values["between"])
    found = clearances(contacts, first, second)
    if not found:
        return undecided(
            f"no surfaces of {quoted(values['between'])} mate within the contact tolerance",
            "Raise [tolerances] contact, or see KF203.",
        )
    answers = [
        compared(
            fit.value, fit.error, values.get("minimum"), values.get("maximum"),
            f"the {KINDS[fit.kind]} of {quoted(values['between'])} is",
            lambda v, digits: length(v, context.units, digits), "Change one of the two sizes.", fit.place,
            "by the fit of the surfaces",
        )
        for fit in found
    ]  # fmt: skip
    for state in ("violated", "undecided"):
        for one in answers:
            if one.state == state:
                return one
    return met(f"{counted(len(found), 'fit')} within bounds; {answers[0].message}")


RULE = requirement_rule("KF433", "fit-out-of-bounds", "fit", __doc__, judge)
