"""Revolute: a turn about an axis. Coordinate: the angle (rad)."""

import numpy as np

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.primitives import OneFreedom
from kinform.model.arrays import Array

__all__ = ["REVOLUTE", "turn"]


def turn(axis: Array, point: Array, lead: float = 0.0) -> OneFreedom:
    """Turn about the unit axis through `point` that also slides `lead` metres a radian."""
    return OneFreedom(axis, point, lead * axis)


def _chain(geometry: JointGeometry) -> tuple[OneFreedom, ...]:
    return (turn(np.asarray(geometry.needed("axis")), geometry.needed("point")),)


REVOLUTE = JointKind("revolute", (("angle", True),), 1, _chain, (0,))
