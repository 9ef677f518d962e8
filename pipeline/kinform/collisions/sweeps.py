"""Which facets a turn or slide can bring together: those that sweep over the same profile.

A facet that turns about an axis keeps its distances from the axis and its heights along it, one that slides keeps its
shadow: facets whose boxes in these coordinates are apart never meet, over the whole motion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.contacts.proximity import near_boxes
from kinform.kinematics.screws import perpendicular

__all__ = ["largest_radius", "meeting"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


def meeting(first: Array, second: Array, twist: Array, margin: float) -> tuple[Flags, Flags]:
    """Which triangles (n, 3, 3) and (m, 3, 3) of the world can meet when the second move along the unit twist (6,)."""
    own, other = _profile(first, twist), _profile(second, twist)
    return near_boxes(*own, *other, margin)


def largest_radius(triangles: Array, twist: Array) -> float:
    """m: greatest distance of the triangles' corners from the axis of a turning twist."""
    across = _across(triangles.reshape(-1, 3), twist)
    return float(np.linalg.norm(across, axis=1).max(initial=0.0))


def _across(points: Array, twist: Array) -> Array:
    axis = twist[:3]
    foot = np.cross(axis, twist[3:])
    away = points - foot
    return np.asarray(away - (away @ axis)[:, None] * axis)


def _profile(triangles: Array, twist: Array) -> tuple[Array, Array]:
    """Boxes (n, 3) of what a triangle keeps: radius and height of a turn, radius of a screw, shadow of a slide."""
    n = len(triangles)
    low, high = np.zeros((n, 3)), np.zeros((n, 3))
    turning = bool(twist[:3] @ twist[:3] > 0.25)
    axis = twist[:3] if turning else twist[3:]
    if not turning:
        for k, direction in enumerate(perpendicular(axis)):
            shadow = triangles @ direction
            low[:, k], high[:, k] = shadow.min(axis=1), shadow.max(axis=1)
        return low, high
    u, v = perpendicular(axis)
    away = triangles - np.cross(axis, twist[3:])
    flat = np.stack([away @ u, away @ v], axis=-1)
    high[:, 0] = np.linalg.norm(flat, axis=2).max(axis=1)
    low[:, 0] = _nearest(flat)
    if abs(float(twist[:3] @ twist[3:])) < 1e-12:
        heights = away @ axis
        low[:, 1], high[:, 1] = heights.min(axis=1), heights.max(axis=1)
    return low, high


def _nearest(flat: Array) -> Array:
    """(n,) distance of flat triangles (n, 3, 2) from the origin; 0 where it is inside."""
    following = np.roll(flat, -1, axis=1)
    side = following - flat
    square = np.maximum(np.einsum("ijk,ijk->ij", side, side), 1e-300)
    share = np.clip(-np.einsum("ijk,ijk->ij", flat, side) / square, 0.0, 1.0)
    away = np.linalg.norm(flat + share[..., None] * side, axis=2).min(axis=1)
    turn = flat[..., 0] * following[..., 1] - flat[..., 1] * following[..., 0]
    inside = (turn > 0.0).all(axis=1) | (turn < 0.0).all(axis=1)
    return np.where(inside, 0.0, away)
