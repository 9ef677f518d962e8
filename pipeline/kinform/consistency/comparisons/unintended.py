"""Joints that the function does not ask for."""

from __future__ import annotations

from kinform.consistency.comparisons.coupled import coupled_through
from kinform.consistency.context import Context
from kinform.consistency.rule import Outcome, skipped
from kinform.model.kinematics import Joint

__all__ = ["unintended"]


def unintended(context: Context) -> tuple[Joint, ...] | Outcome:
    """Joints between two bodies that intended joints name, where no intended joint joins these two, and no stated
    coupling goes through them."""
    if not context.function.joints:
        return skipped("the function states no joint")
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return kinematics
    wanted, named = context.intended_pairs, context.intended_bodies
    meshing = {name for stated in context.function.couplings for name in coupled_through(context, kinematics, stated)}
    return tuple(
        j
        for j in kinematics.joints
        if tuple(sorted(j.bodies)) not in wanted and named.issuperset(j.bodies) and str(j.name) not in meshing
    )
