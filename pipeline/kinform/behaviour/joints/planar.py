"""Planar: slides along two directions u, v of the first body across the axis, and a turn about the axis
through `point` of the second. Coordinates: angle (rad), then the distances along u and v (m), where
(u, v, axis) is the right-handed frame of `kinform.foundation.algebra.screws.perpendicular`."""

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.joints.prismatic import slide
from kinform.behaviour.joints.revolute import turn
from kinform.behaviour.primitives import OneFreedom
from kinform.foundation.algebra.vectors import perpendicular

__all__ = ["PLANAR"]


def _chain(geometry: JointGeometry) -> tuple[OneFreedom, ...]:
    axis = geometry.needed("axis")
    u, v = perpendicular(axis)
    return (slide(u), slide(v), turn(axis, geometry.needed("point")))


PLANAR = JointKind("planar", (("angle", True), ("u", False), ("v", False)), 3, _chain, (1, 2, 0))
