"""Joints that the function does not ask for."""

from __future__ import annotations

from kinform.consistency.comparisons.coupled import coupled_through
from kinform.consistency.context import Context
from kinform.model.kinematics import Joint

__all__ = ["unintended_joints"]


def unintended_joints(context: Context) -> tuple[Joint, ...]:
    """Joints between two bodies that intended joints name, where no intended joint joins these two, and no stated
    coupling goes through them. Needs kinematics."""
    wanted, named = context.intended_pairs, context.intended_bodies
    meshing = {name for stated in context.function.couplings for name in coupled_through(context, stated)}
    return tuple(
        j
        for j in context.kinematics.joints
        if tuple(sorted(j.bodies)) not in wanted and named.issuperset(j.bodies) and str(j.name) not in meshing
    )
