"""Poses as descriptions state them: angles in radians, fixed axes or a sequence, exact at quarter turns."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.spatial import to_matrix
from kinform.model.arrays import Array


def sine_cosine(angle: float) -> tuple[float, float]:
    """Of an angle in radians. Quarter turns, as far as printed digits say them, give exact zeros and ones."""
    quarters = angle / (0.5 * math.pi)
    nearest = round(quarters)
    # Quarter turns by which an angle may miss a whole one and be taken for it: what eleven printed digits lose. The
    # pose that "1.5708" states is kept as it is: it differs by more than forward kinematics is compared to.
    if abs(quarters - nearest) < 1e-11:
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[nearest % 4]
    return math.sin(angle), math.cos(angle)


def turn(axis: str, angle: float) -> Array:
    """Rotation (3, 3) about x, y or z."""
    s, c = sine_cosine(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    out = np.eye(3)
    out[i, i] = out[j, j] = c
    out[i, j], out[j, i] = -s, s
    return out


def rpy(angles: Sequence[float]) -> Array:
    """Rz(yaw)·Ry(pitch)·Rx(roll) of [roll, pitch, yaw], radians."""
    out: Array = turn("z", angles[2]) @ turn("y", angles[1]) @ turn("x", angles[0])
    return out


def about(axis: Sequence[float], angle: float) -> Array:
    """Rotation (3, 3) about an axis, which need not be a unit vector; the identity where it is zero."""
    size = math.hypot(*axis)
    if size == 0.0:
        return np.eye(3)
    s, c = sine_cosine(angle)
    x, y, z = (value / size for value in axis)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + s * k + (1.0 - c) * (k @ k))


def quaternion(wxyz: Sequence[float]) -> Array:
    """Rotation (3, 3) of a quaternion of any length but zero; the identity for that."""
    size = math.hypot(*wxyz)
    return np.eye(3) if size == 0.0 else np.asarray(to_matrix(np.array(wxyz) / size))


def pose(rotation: Array, position: Sequence[float] | Array) -> Array:
    """(4, 4)."""
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation, position
    return out


def place(X: Array, point: Sequence[float] | Array) -> Array:
    """A point (3,) of a frame, seen from where the frame has the pose X (4, 4)."""
    return np.asarray(X[:3, :3] @ np.asarray(point) + X[:3, 3])
