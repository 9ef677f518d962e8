"""Small algebra in batches: cross products, twists, quaternions, rotations.

Twists (ω; v) and wrenches (τ; f) about a common origin; quaternions wxyz, unit, Hamilton.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "along_motion",
    "cross",
    "cross_force",
    "cross_motion",
    "multiply",
    "quaternions",
    "rotation_vector",
    "to_matrix",
]

Array = NDArray[np.float64]

NEXT = np.array([1, 2, 0])
LAST = np.array([2, 0, 1])


def cross(a: Array, b: Array) -> Array:
    """a × b over the last axis; numpy's own takes four times as long on small arrays."""
    product: Array = a[..., NEXT] * b[..., LAST] - a[..., LAST] * b[..., NEXT]
    return product


def cross_motion(a: Array, b: Array) -> Array:
    """(…, 6) rate of change of twist b when it is carried along by twist a."""
    w = a[..., :3]
    return np.concatenate(
        [cross(w, b[..., :3]), cross(w, b[..., 3:]) + cross(a[..., 3:], b[..., :3])], axis=-1
    )


def cross_force(a: Array, f: Array) -> Array:
    """(…, 6) rate of change of wrench f when it is carried along by twist a."""
    w = a[..., :3]
    return np.concatenate(
        [cross(w, f[..., :3]) + cross(a[..., 3:], f[..., 3:]), cross(w, f[..., 3:])], axis=-1
    )


def along_motion(X: Array, twist: Array) -> Array:
    """Twists (n, 6) carried from the zero pose by poses X (n, 4, 4)."""
    R, p = X[:, :3, :3], X[:, :3, 3]
    omega = (R @ twist[:, :3, None])[..., 0]
    return np.concatenate([omega, (R @ twist[:, 3:, None])[..., 0] + cross(p, omega)], axis=-1)


def multiply(a: Array, b: Array) -> Array:
    """Quaternion product a ∘ b (4,)."""
    w, v, x, u = a[0], a[1:], b[0], b[1:]
    return np.concatenate([[w * x - v @ u], w * u + x * v + cross(v, u)])


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
