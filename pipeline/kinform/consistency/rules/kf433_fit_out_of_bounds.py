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

from collections.abc import Mapping
from dataclasses import replace

from kinform.consistency.comparisons.limits import Quantity, beside_bounds
from kinform.consistency.context import Context, Need
from kinform.consistency.outcome import Answer, least, met, undecided
from kinform.consistency.requirements import requirement_rule, shared_parts, worst_of
from kinform.foundation.words import counted, length, quoted
from kinform.function.fits import clearances
from kinform.function.requirement_kinds import Fit

KINDS = {"radial": "radial clearance", "both sides": "clearance between planes", "gap": "gap between planes"}
REMEDY = "Change one of the two sizes."
SUPPLIED_BY: Mapping[Need, str] = {"contacts": "Give both parts meshes."}


def judge(context: Context, requirement: Fit) -> Answer:
    """Every fit of the two beside the bounds."""
    between = requirement.between
    if shared := shared_parts(context, between):
        return undecided(f"{quoted(shared)} would be on both sides", "Name two that share no part.")
    first, second = (context.assembly.parts_of(name) for name in between)
    fits = clearances(context.contacts, first, second)
    if not fits:
        return undecided(
            f"no surfaces of {quoted(between)} mate within the contact tolerance",
            "Raise [tolerances] contact, or see KF203.",
        )

    def shown(value: float, digits: int) -> str:
        return length(value, context.units, digits)

    answers = []
    for fit in fits:
        name = f"the {KINDS[fit.kind]} of {quoted(between)}"
        quantity = Quantity(name, shown, REMEDY, "m", fit.place, cause="by the fit of the surfaces")
        answers.append(beside_bounds(quantity, fit.value, fit.error, requirement.minimum, requirement.maximum))
    whole = worst_of(answers) or met(f"{counted(len(fits), 'fit')} within bounds; {answers[0].message}")
    return whole if whole.state == "undecided" else replace(whole, margin=least(answer.margin for answer in answers))


RULE = requirement_rule("KF433", "fit-out-of-bounds", Fit, __doc__, judge, SUPPLIED_BY)
