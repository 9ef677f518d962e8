"""The static imbalance about an axis, mass times distance of the centre of mass from the axis, is above its limit.

The axis is that of a joint, or is given by axis and point. At the pose of the meshes.

Why it matters: what turns shakes its bearings, and gravity turns what should stay where it is put.

What to do: move material towards the other side of the axis, or add a counterweight.

Example: `kind = "balance"`, `of = "inner"`, `joint = "pitch"`, `limit = 1e-5` for a camera that sits 2 mm forward.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.consistency.comparisons.weighed import amount
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, met, requirement_rule, undecided, violated
from kinform.consistency.rule import Outcome
from kinform.foundation.words import length, mass, number, quoted, telling
from kinform.function import resolve
from kinform.model.function import Requirement

__all__ = ["RULE", "judge"]


def judge(context: Context, requirement: Requirement) -> Answer:
    """The imbalance beside its limit."""
    values = requirement.values
    found = amount(context, values["of"])
    if isinstance(found, Answer):
        return found
    line = _line(context, requirement)
    if isinstance(line, Answer):
        return line
    distance = found.distance(*line)
    imbalance = found.mass * distance
    shown = telling(lambda value, digits: f"{number(value, digits)} kg·m", imbalance, values["limit"])
    limit = f"at most {shown(values['limit'])}"
    text = (
        f"the imbalance of {quoted([values['of']])} is {shown(imbalance)}: {mass(found.mass)}, "
        f"{length(distance, context.units)} off the axis"
    )
    if imbalance <= values["limit"]:
        return met(text)
    return violated(
        f"{text}, required is {limit}", found=shown(imbalance), intended=limit, place=found.centre,
        remedy="Move material across the axis, or add a counterweight.",
    )  # fmt: skip


def _line(context: Context, requirement: Requirement) -> tuple[NDArray[np.float64], NDArray[np.float64]] | Answer:
    """Axis and point: of the derived joint, else as stated."""
    values = requirement.values
    if "joint" not in values:
        if "axis" not in values or "point" not in values:
            return undecided("it names neither a joint nor axis and point", "Name a joint, or give axis and point.")
        return np.array(values["axis"]), np.array(values["point"])
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return undecided(kinematics.reason, "Run `kinform joints`.")
    found = resolve(context.assembly, kinematics, values["joint"])
    for line in (found.joint, found.intended):
        if line is not None and line.axis is not None and line.point is not None:
            return line.axis, line.point
    return undecided(f"joint '{values['joint']}' has no axis: {found.reason}", "Give axis and point.")


RULE = requirement_rule("KF431", "unbalanced", "balance", __doc__, judge)
