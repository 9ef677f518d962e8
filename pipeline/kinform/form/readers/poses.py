"""Poses of the manifest: position, and quaternion or roll-pitch-yaw, as 4×4 matrices in SI."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.spatial import to_matrix
from kinform.model.arrays import Array


def rpy_rotation(degrees: Sequence[float]) -> Array:
    """Rotation (3, 3) Rz(yaw)·Ry(pitch)·Rx(roll) of [roll, pitch, yaw] in degrees.

    Multiples of 90° give exact zeros and ones, so that a quarter turn does not tilt a part.
    """
    (sr, cr), (sp, cp), (sy, cy) = (_sine_cosine(angle) for angle in degrees)
    turn_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    turn_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    turn_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    rotation: Array = turn_z @ turn_y @ turn_x
    return rotation


def _sine_cosine(degrees: float) -> tuple[float, float]:
    quarter, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[int(quarter) % 4]
    return math.sin(math.radians(degrees)), math.cos(math.radians(degrees))


def unit_error(wxyz: Sequence[float]) -> float:
    """How far the length of a quaternion is from one."""
    return abs(float(np.linalg.norm(wxyz)) - 1.0)


def pose(
    position: Sequence[float] | None, quaternion: Sequence[float] | None, rpy: Sequence[float] | None, metres: float
) -> Array:
    """Pose (4, 4) of a placed thing in its manifest's frame; `metres` per unit of the position."""
    out = np.eye(4)
    if quaternion is not None:
        out[:3, :3] = to_matrix(np.asarray(quaternion, dtype=float))
    elif rpy is not None:
        out[:3, :3] = rpy_rotation(rpy)
    if position is not None:
        out[:3, 3] = np.asarray(position, dtype=float) * metres
    return out


def shift(X_WF: Array, place: Array) -> Array:
    """The pose (4, 4) moved along to a place (3,) of its own frame."""
    if not place.any():
        return X_WF
    out = X_WF.copy()
    out[:3, 3] += X_WF[:3, :3] @ place
    return out
