"""The static imbalance about an axis, mass times distance of the centre of mass from the axis, is above its limit.

The axis is that of a joint, or is given by axis and point. At the pose of the meshes.

Why it matters: what turns shakes its bearings, and gravity turns what should stay where it is put.

What to do: move material towards the other side of the axis, or add a counterweight.

Example: `kind = "balance"`, `of = "inner"`, `joint = "pitch"`, `limit = 1e-5` for a camera that sits 2 mm forward.
"""

from __future__ import annotations

from kinform.consistency.comparisons.limits import amount
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, Margin, met, undecided, violated
from kinform.consistency.requirements import JOINTS, MASSES, requirement_rule
from kinform.foundation.words import length, mass, number, quoted, telling
from kinform.function import resolve_joint
from kinform.function.requirement_kinds import Balance
from kinform.model.arrays import Array


def judge(context: Context, requirement: Balance) -> Answer:
    """The imbalance beside its limit."""
    whole = amount(context, requirement.of)
    if isinstance(whole, Answer):
        return whole
    line = _line(context, requirement)
    if isinstance(line, Answer):
        return line
    distance = whole.distance(*line)
    imbalance = whole.mass * distance
    shown = telling(lambda value, digits: f"{number(value, digits)} kg·m", imbalance, requirement.limit)
    limit = f"at most {shown(requirement.limit)}"
    text = (
        f"the imbalance of {quoted([requirement.of])} is {shown(imbalance)}: {mass(whole.mass)}, "
        f"{length(distance, context.units)} off the axis"
    )
    margin = Margin(requirement.limit - imbalance, "kg·m")
    if imbalance <= requirement.limit:
        return met(text, margin=margin)
    return violated(
        f"{text}, required is {limit}", found=shown(imbalance), intended=limit, place=whole.centre,
        remedy="Move material across the axis, or add a counterweight.", margin=margin,
    )  # fmt: skip


def _line(context: Context, requirement: Balance) -> tuple[Array, Array] | Answer:
    """Axis and point: of the derived joint, else as stated."""
    if requirement.joint is None:
        if requirement.axis is None or requirement.point is None:
            return undecided("it names neither a joint nor axis and point", "Name a joint, or give axis and point.")
        return requirement.axis, requirement.point
    lacking = context.lacks("kinematics")
    if lacking is not None:
        return undecided(lacking.reason, JOINTS["kinematics"])
    resolution = resolve_joint(context.assembly, context.kinematics, requirement.joint)
    for line in (resolution.joint, resolution.intended):
        if line is not None and line.axis is not None and line.point is not None:
            return line.axis, line.point
    return undecided(f"joint '{requirement.joint}' has no axis: {resolution.reason}", "Give axis and point.")


RULE = requirement_rule("KF431", "unbalanced", Balance, __doc__, judge, MASSES)
