"""Cylindrical: a turn about an axis and a slide along it. Coordinates: angle (rad), distance (m)."""

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.joints.prismatic import slide
from kinform.behaviour.joints.revolute import turn
from kinform.behaviour.primitives import OneFreedom

__all__ = ["CYLINDRICAL"]


def _chain(geometry: JointGeometry) -> tuple[OneFreedom, ...]:
    axis = geometry.needed("axis")
    return (turn(axis, geometry.needed("point")), slide(axis))


CYLINDRICAL = JointKind("cylindrical", (("angle", True), ("distance", False)), 2, _chain, (0, 1))
