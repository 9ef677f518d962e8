"""Spherical: all turns about a point. Coordinates: the quaternion wxyz of the second body relative to the
first; rates: ω of the second relative to the first (rad/s), in the axes of the first body, which are the
world's at the pose of the meshes."""

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.primitives import Ball

__all__ = ["SPHERICAL"]


def _chain(geometry: JointGeometry) -> tuple[Ball, ...]:
    return (Ball(geometry.needed("point")),)


SPHERICAL = JointKind("spherical", (("qw", True), ("qx", True), ("qy", True), ("qz", True)), 3, _chain, (0,))
