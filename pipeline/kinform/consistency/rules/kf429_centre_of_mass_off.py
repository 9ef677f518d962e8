"""The centre of mass of a part, a group or the whole is too far from where it is required, at the pose of the meshes.

Why it matters: what is to stand, hang or turn in balance does not.

What to do: move material, or the point. `kinform show F.h5 mass` lists all centres.

Example: `kind = "centre_of_mass"`, `point = [0, 0, 0]`, `tolerance = 0.5` for a gimbal that is 2 mm off.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.weighed import amount, whose
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, met, requirement_rule, violated
from kinform.foundation.words import length, place, telling
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]


def judge(context: Context, requirement: Requirement) -> Answer:
    """The distance of the centre of mass from its point."""
    values, units = requirement.values, context.units
    found = amount(context, values.get("of"))
    if isinstance(found, Answer):
        return found
    wanted = np.array(values["point"])
    distance = float(np.linalg.norm(found.centre - wanted))
    shown = telling(lambda value, digits: length(value, units, digits), distance, values["tolerance"])
    text = (
        f"the centre of mass of {whose(values.get('of'))} is at {place(found.centre, units)}, "
        f"{shown(distance)} from {place(wanted, units)}"
    )
    intended = f"within {shown(values['tolerance'])} of {place(wanted, units)}"
    if distance <= values["tolerance"]:
        return met(text)
    return violated(
        f"{text}, required is within {shown(values['tolerance'])}", found=place(found.centre, units), intended=intended, place=found.centre,
        remedy="Move material, or correct the point.",
    )  # fmt: skip


RULE = requirement_rule("KF429", "centre-of-mass-off", "centre_of_mass", __doc__, judge)
