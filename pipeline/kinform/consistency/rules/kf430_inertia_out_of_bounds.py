"""The moment of inertia about an axis lies outside of the required bounds.

About the axis through the point, or through the centre of mass where no point is given, at the pose of the meshes.
Where the error that coarse facets leave could decide, the requirement is inconclusive (KF902).

Why it matters: acceleration and natural frequency follow from it.

What to do: move material, or change the bound. `kinform show F.h5 mass` lists all inertias.

Example: `kind = "inertia"`, `of = "rotor"`, `axis = [0, 0, 1]`, `maximum = 2e-5`.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.weighed import amount, compared, whose
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, requirement_rule
from kinform.foundation.words import direction, number
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]

SPREAD = 5.0 / 3.0
"""An error of the shape that adds so much to the mass adds so much more to the inertia, at equal proportions."""


def judge(context: Context, requirement: Requirement) -> Answer:
    """The moment of inertia beside its bounds."""
    values = requirement.values
    found = amount(context, values.get("of"))
    if isinstance(found, Answer):
        return found
    axis, point = np.array(values["axis"]), values.get("point")
    value = found.about(axis, None if point is None else np.array(point))
    through = "the centre of mass" if point is None else "the point"
    text = f"the moment of inertia of {whose(values.get('of'))} about {direction(axis)} through {through} is"
    remedy = "Move material, or change the bound."
    low, high = values.get("minimum"), values.get("maximum")
    return compared(value, SPREAD * found.bound * value, low, high, text, _shown, remedy, found.centre)


def _shown(value: float, digits: int) -> str:
    return f"{number(value, digits)} kg·m²"


RULE = requirement_rule("KF430", "inertia-out-of-bounds", "inertia", __doc__, judge)
