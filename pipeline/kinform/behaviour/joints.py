"""Kinds of joints: the coordinates of each, and its motion as a chain of primitives.

A new kind is a function that gives its chain and an entry of `KINDS`. `general` joints have neither coordinates nor a
chain and are not here.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from kinform.behaviour.primitives import Ball, OneFreedom, Primitive
from kinform.foundation.algebra.vectors import perpendicular
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.quantities import Direction, Metres, Place


@dataclass(frozen=True, eq=False)
class JointGeometry:
    """Where a joint is, in the world at the pose of the meshes; None where its kind needs nothing."""

    axis: Direction | None = None
    """(3,) unit."""
    point: Place | None = None
    """(3,) m."""
    axis2: Direction | None = None
    """(3,) unit."""
    pitch: Metres | None = None
    """Metres a turn."""

    def needed(self, name: str) -> Array:
        """The vector `axis`, `axis2` or `point`; ValueError when it is not known."""
        value: Array | None = getattr(self, name)
        if value is None or not np.all(np.isfinite(value)):
            raise ValueError(f"its {name} is not known")
        return value


@dataclass(frozen=True)
class JointKind:
    """A kind of joint: its coordinates in their fixed order, and its motion as a chain of primitives.

    `coordinates` are (name, rotational) pairs, one a column of the results; the primitives of `chain`
    take them in the order of `uses`, listed from the first body to the second.
    """

    name: str
    coordinates: tuple[tuple[str, bool], ...]
    rates: int
    chain: Callable[[JointGeometry], tuple[Primitive, ...]]
    """Raises ValueError when the geometry lacks something."""
    uses: tuple[int, ...]
    """First coordinate of each primitive."""


def _turn(axis: Array, point: Array, lead: float = 0.0) -> OneFreedom:
    """Turn about the unit axis through `point` that also slides `lead` metres a radian."""
    return OneFreedom(axis, point, lead * axis)


def _slide(direction: Array) -> OneFreedom:
    """Slide along the unit direction."""
    return OneFreedom(np.zeros(3), np.zeros(3), direction)


def _fixed(_: JointGeometry) -> tuple[Primitive, ...]:
    """No freedom; the two bodies move as one."""
    return ()


def _revolute(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """A turn about an axis. Coordinate: the angle (rad)."""
    return (_turn(geometry.needed("axis"), geometry.needed("point")),)


def _prismatic(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """A slide along an axis. Coordinate: the distance (m)."""
    return (_slide(geometry.needed("axis")),)


def _cylindrical(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """A turn about an axis and a slide along it. Coordinates: angle (rad), distance (m)."""
    axis = geometry.needed("axis")
    return (_turn(axis, geometry.needed("point")), _slide(axis))


def _spherical(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """All turns about a point. Coordinates: the quaternion wxyz of the second body relative to the first; rates: ω of
    the second relative to the first (rad/s), in the axes of the first, which are the world's at the pose of the meshes.
    """
    return (Ball(geometry.needed("point")),)


def _planar(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """Slides along two directions u, v of the first body across the axis, and a turn about the axis through `point` of
    the second. Coordinates: angle (rad), then the distances along u and v (m), where (u, v, axis) is the right-handed
    frame of `kinform.foundation.algebra.vectors.perpendicular`.
    """
    axis = geometry.needed("axis")
    u, v = perpendicular(axis)
    return (_slide(u), _slide(v), _turn(axis, geometry.needed("point")))


def _screw(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """A turn about an axis that slides pitch / 2π along it a radian. Coordinate: the angle (rad)."""
    if geometry.pitch is None or not math.isfinite(geometry.pitch):
        raise ValueError("its pitch is not known")
    return (_turn(geometry.needed("axis"), geometry.needed("point"), geometry.pitch / (2.0 * math.pi)),)


def _universal(geometry: JointGeometry) -> tuple[Primitive, ...]:
    """A turn about `axis`, which is fixed in the first body, then one about `axis2`, which is fixed in the second.
    Coordinates: both angles (rad) in that order.
    """
    point = geometry.needed("point")
    axis, axis2 = geometry.needed("axis"), geometry.needed("axis2")
    if float(np.linalg.norm(np.cross(axis, axis2))) < SINGLE:
        raise ValueError("its two axes are parallel")
    return (_turn(axis, point), _turn(axis2, point))


_ANGLE, _DISTANCE = ("angle", True), ("distance", False)

KINDS: dict[str, JointKind] = {
    kind.name: kind
    for kind in (
        JointKind("fixed", (), 0, _fixed, ()),
        JointKind("revolute", (_ANGLE,), 1, _revolute, (0,)),
        JointKind("prismatic", (_DISTANCE,), 1, _prismatic, (0,)),
        JointKind("cylindrical", (_ANGLE, _DISTANCE), 2, _cylindrical, (0, 1)),
        JointKind("spherical", (("qw", True), ("qx", True), ("qy", True), ("qz", True)), 3, _spherical, (0,)),
        JointKind("planar", (_ANGLE, ("u", False), ("v", False)), 3, _planar, (1, 2, 0)),
        JointKind("screw", (_ANGLE,), 1, _screw, (0,)),
        JointKind("universal", (_ANGLE, ("angle2", True)), 2, _universal, (0, 1)),
    )
}
"""By name, in the order in which they are listed to users."""
