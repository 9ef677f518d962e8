"""The moment of inertia about an axis lies outside of the required bounds.

About the axis through the point, or through the centre of mass where no point is given, at the pose of the meshes.
Where the error that coarse facets leave could decide, the requirement is inconclusive (KF902).

Why it matters: acceleration and natural frequency follow from it.

What to do: move material, or change the bound. `kinform show F.h5 mass` lists all inertias.

Example: `kind = "inertia"`, `of = "rotor"`, `axis = [0, 0, 1]`, `maximum = 2e-5`.
"""

from __future__ import annotations

from kinform.consistency.comparisons.limits import Quantity, amount, beside_bounds, whose
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer
from kinform.consistency.requirements import MASSES, requirement_rule
from kinform.foundation.words import direction, number
from kinform.function.requirement_kinds import Inertia

INERTIA_SPREAD = 5.0 / 3.0
"""An error of the shape that adds so much to the mass adds so much more to the inertia, at equal proportions."""


REMEDY = "Move material, or change the bound."


def judge(context: Context, requirement: Inertia) -> Answer:
    """The moment of inertia beside its bounds."""
    whole = amount(context, requirement.of)
    if isinstance(whole, Answer):
        return whole
    axis, point = requirement.axis, requirement.point
    value = whole.about(axis, point)
    through = "the centre of mass" if point is None else "the point"
    name = f"the moment of inertia of {whose(requirement.of)} about {direction(axis)} through {through}"
    quantity = Quantity(name, _shown, REMEDY, "kg·m²", whole.centre)
    error = INERTIA_SPREAD * whole.bound * value
    return beside_bounds(quantity, value, error, requirement.minimum, requirement.maximum)


def _shown(value: float, digits: int) -> str:
    return f"{number(value, digits)} kg·m²"


RULE = requirement_rule("KF430", "inertia-out-of-bounds", Inertia, __doc__, judge, MASSES)
