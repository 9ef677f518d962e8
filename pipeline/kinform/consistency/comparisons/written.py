"""Values of a joint as its file writes them, ready to paste."""

from __future__ import annotations

import math

from kinform.consistency.context import Context
from kinform.foundation.units import METRES_PER_UNIT
from kinform.foundation.words import number
from kinform.model.descriptions import DescribedJoint
from kinform.model.function import IntendedJoint


def described_joint(context: Context, name: str) -> tuple[DescribedJoint, str] | None:
    """The joint of that name as its description has it, and the format of the description; None of a manifest."""
    found = ((j, str(d.format)) for d in context.assembly.descriptions for j in d.joints if j.name == name)
    return next(found, None)


def written_range(context: Context, joint: IntendedJoint, bounds: tuple[float, float]) -> str:
    """A range (rad or m) in the syntax and the unit of the file that states the joint."""
    found = described_joint(context, joint.name)
    form = found[1] if found is not None else "manifest"
    slides = joint.type == "prismatic"
    if found is None:
        factor = 1.0 / METRES_PER_UNIT[context.units] if slides else math.degrees(1.0)
    else:
        factor = math.degrees(1.0) if found[0].degrees else 1.0
    lower, upper = (number(factor * value, 6) for value in bounds)
    if form == "mjcf":
        return f'range="{lower} {upper}"'
    if form == "sdf":
        return f"<lower>{lower}</lower><upper>{upper}</upper>"
    return f'lower="{lower}" upper="{upper}"' if form == "urdf" else f"range = [{lower}, {upper}]"
