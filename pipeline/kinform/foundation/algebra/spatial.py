"""Algebra in batches: rates of twists and wrenches that are carried along, quaternions, rotations.

Twists (ω; v) and wrenches (τ; f) about a common origin; quaternions wxyz, unit, Hamilton.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import CROSS, cross_matrix
from kinform.model.arrays import Array

# a × … of each of six coordinates, as blocks of 6 × 6
_BLOCKS = np.zeros((6, 6, 6))
_BLOCKS[:3, :3, :3] = _BLOCKS[:3, 3:, 3:] = _BLOCKS[3:, 3:, :3] = CROSS.reshape(3, 3, 3)
TWIST = _BLOCKS.reshape(6, 36)
"""(6, 36): a @ TWIST is the matrix that takes twists to their rates when a carries them along, row by row."""


def cross_motion(a: Array, b: Array) -> Array:
    """(n, 6) rate of change of twists b that are carried along by twists a."""
    return np.asarray(((a @ TWIST).reshape(-1, 6, 6) @ b[:, :, None])[..., 0])


def cross_force(a: Array, f: Array) -> Array:
    """(n, 6) rate of change of wrenches f that are carried along by twists a."""
    return np.asarray(-(f[:, None, :] @ (a @ TWIST).reshape(-1, 6, 6))[:, 0])


def along_motion(X: Array, twist: Array) -> Array:
    """Twists (n, 6) carried from the zero pose by poses X (n, 4, 4)."""
    R, p = X[:, :3, :3], X[:, :3, 3]
    # Both halves of a twist as the columns of one matrix, turned at once.
    halves = R @ twist.reshape(-1, 2, 3).transpose(0, 2, 1)
    out = np.empty_like(twist)
    out[:, :3] = halves[:, :, 0]
    out[:, 3:] = halves[:, :, 1] + (cross_matrix(p) @ halves[:, :, :1])[..., 0]
    return out


def multiply(a: Array, b: Array) -> Array:
    """Quaternion product a ∘ b (4,)."""
    w, v, x, u = a[0], a[1:], b[0], b[1:]
    return np.concatenate([[w * x - v @ u], w * u + x * v + np.cross(v, u)])


def to_matrix(q: Array) -> Array:
    """(3, 3) rotation of a quaternion (4,), which is normalised first."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternions(R: Array) -> Array:
    """Quaternions (n, 4) of rotations (n, 3, 3), w ≥ 0 (Shepperd 1978: the largest divides)."""
    trace = np.trace(R, axis1=1, axis2=2)
    squares = np.column_stack([trace, R[:, 0, 0], R[:, 1, 1], R[:, 2, 2]])
    largest = np.argmax(squares, axis=1)
    out = np.empty((len(R), 4))
    for n, k in enumerate(largest):
        r = R[n]
        if k == 0:
            out[n] = 1.0 + trace[n], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
            continue
        i, j, m = k - 1, k % 3, (k + 1) % 3
        out[n, 0] = r[m, j] - r[j, m]
        out[n, 1 + i] = 1.0 + r[i, i] - r[j, j] - r[m, m]
        out[n, 1 + j] = r[j, i] + r[i, j]
        out[n, 1 + m] = r[m, i] + r[i, m]
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    return np.where(out[:, :1] < 0.0, -out, out)


def rotation_vector(R: Array) -> Array:
    """Rotation vectors (n, 3) of rotations (n, 3, 3): axis times the angle in [0, π]."""
    q = quaternions(R)
    sine = np.linalg.norm(q[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, q[:, 0])
    return q[:, 1:] * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 2.0)[:, None]
