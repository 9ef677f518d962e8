"""The centre of mass of a part, a group or the whole is too far from where it is required, at the pose of the meshes.

Why it matters: what is to stand, hang or turn in balance does not.

What to do: move material, or the point. `kinform show F.h5 mass` lists all centres.

Example: `kind = "centre_of_mass"`, `point = [0, 0, 0]`, `tolerance = 0.5` for a gimbal that is 2 mm off.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.limits import amount, whose
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, Margin, met, violated
from kinform.consistency.requirements import MASSES, requirement_rule
from kinform.foundation.words import length, place, telling
from kinform.function.requirement_kinds import CentreOfMass


def judge(context: Context, requirement: CentreOfMass) -> Answer:
    """The distance of the centre of mass from its point."""
    units = context.units
    whole = amount(context, requirement.of)
    if isinstance(whole, Answer):
        return whole
    distance = float(np.linalg.norm(whole.centre - requirement.point))
    shown = telling(lambda value, digits: length(value, units, digits), distance, requirement.tolerance)
    centre, wanted, within = place(whole.centre, units), place(requirement.point, units), shown(requirement.tolerance)
    text = f"the centre of mass of {whose(requirement.of)} is at {centre}, {shown(distance)} from {wanted}"
    margin = Margin(requirement.tolerance - distance, "m")
    if distance <= requirement.tolerance:
        return met(text, margin=margin)
    return violated(
        f"{text}, required is within {within}", found=centre, intended=f"within {within} of {wanted}",
        place=whole.centre, remedy="Move material, or correct the point.", margin=margin,
    )  # fmt: skip


RULE = requirement_rule("KF429", "centre-of-mass-off", CentreOfMass, __doc__, judge, MASSES)
