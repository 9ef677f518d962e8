"""The mass of a part, a group or the whole lies outside of the required bounds.

The mass comes from the geometry and the densities, or is stated. Where the error that coarse facets leave could
decide, the requirement is inconclusive (KF902).

Why it matters: drives and structures are sized for a mass.

What to do: change the shape or the material, or the bound. `kinform show F.h5 mass` lists all masses.

Example: `kind = "mass"`, `of = "camera"`, `maximum = 0.2` for a camera of 230 g.
"""

from __future__ import annotations

from kinform.consistency.comparisons.weighed import amount, compared, whose
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, requirement_rule
from kinform.foundation.words import mass
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]


def judge(context: Context, requirement: Requirement) -> Answer:
    """The mass beside its bounds."""
    found = amount(context, requirement.values.get("of"))
    if isinstance(found, Answer):
        return found
    low, high = requirement.values.get("minimum"), requirement.values.get("maximum")
    text = f"the mass of {whose(requirement.values.get('of'))} is"
    remedy = "Change the shape, the material or the bound."
    return compared(found.mass, found.bound * found.mass, low, high, text, mass, remedy, found.centre)


RULE = requirement_rule("KF428", "mass-out-of-bounds", "mass", __doc__, judge)
