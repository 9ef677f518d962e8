"""Screw: a turn about an axis that slides pitch / 2π along it a radian. Coordinate: the angle (rad)."""

import math

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.joints.revolute import turn
from kinform.behaviour.primitives import OneFreedom

__all__ = ["SCREW"]


def _chain(geometry: JointGeometry) -> tuple[OneFreedom, ...]:
    if geometry.pitch is None or not math.isfinite(geometry.pitch):
        raise ValueError("its pitch is not known")
    lead = geometry.pitch / (2.0 * math.pi)
    return (turn(geometry.needed("axis"), geometry.needed("point"), lead),)


SCREW = JointKind("screw", (("angle", True),), 1, _chain, (0,))
