"""The mass of a part, a group or the whole lies outside of the required bounds.

The mass comes from the geometry and the densities, or is stated. Where the error that coarse facets leave could
decide, the requirement is inconclusive (KF902).

Why it matters: drives and structures are sized for a mass.

What to do: change the shape or the material, or the bound. `kinform show F.h5 mass` lists all masses.

Example: `kind = "mass"`, `of = "camera"`, `maximum = 0.2` for a camera of 230 g.
"""

from __future__ import annotations

from kinform.consistency.comparisons.limits import Quantity, amount, beside_bounds, whose
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer
from kinform.consistency.requirements import MASSES, requirement_rule
from kinform.foundation.words import mass
from kinform.function.requirement_kinds import Mass

REMEDY = "Change the shape, the material or the bound."


def judge(context: Context, requirement: Mass) -> Answer:
    """The mass beside its bounds."""
    whole = amount(context, requirement.of)
    if isinstance(whole, Answer):
        return whole
    quantity = Quantity(f"the mass of {whose(requirement.of)}", mass, REMEDY, "kg", whole.centre)
    return beside_bounds(quantity, whole.mass, whole.bound * whole.mass, requirement.minimum, requirement.maximum)


RULE = requirement_rule("KF428", "mass-out-of-bounds", Mass, __doc__, judge, MASSES)
