"""Rotation matrices, unit quaternions and rotation vectors, in stacks.

scipy has the same; importing its rotations takes longer than everything else that a small design asks for.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross_matrix
from kinform.model.arrays import Array


def matrices(quaternions: Array) -> Array:
    """(…, 3, 3) rotations of quaternions (…, 4) wxyz of any length but 0."""
    q = quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True)
    spin = cross_matrix(q[..., 1:])
    return np.asarray(np.eye(3) + 2.0 * (q[..., :1, None] * spin + spin @ spin))


def quaternions(R: Array) -> Array:
    """(…, 4) unit quaternions wxyz of rotations (…, 3, 3), of either sign."""
    diagonal = np.diagonal(R, axis1=-2, axis2=-1)
    trace = diagonal.sum(axis=-1)
    # 4 q qᵀ: its column of the greatest diagonal is q but for its length, without cancellation (Shepperd 1978)
    squares = np.empty((*R.shape[:-2], 4, 4))
    squares[..., 0, 0] = 1.0 + trace
    squares[..., 1:, 1:] = R + np.swapaxes(R, -1, -2)
    for k in range(3):
        squares[..., k + 1, k + 1] = 1.0 + 2.0 * diagonal[..., k] - trace
    axial = np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], axis=-1)
    squares[..., 0, 1:] = squares[..., 1:, 0] = axial
    most = np.argmax(np.diagonal(squares, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(squares, most[..., None, None], axis=-2)[..., 0, :]
    return np.asarray(q / np.linalg.norm(q, axis=-1, keepdims=True))


def rotation_vectors(R: Array) -> Array:
    """(…, 3) rad: axis times angle, of at most half a turn, of rotations (…, 3, 3)."""
    q = quaternions(R)
    q = np.where(q[..., :1] < 0.0, -q, q)
    half = np.linalg.norm(q[..., 1:], axis=-1)
    angle = 2.0 * np.arctan2(half, q[..., 0])
    # angle / sin(angle / 2), which is 2 (1 + angle²/24) near zero
    share = np.where(half > 1e-4, angle / np.where(half > 1e-4, half, 1.0), 2.0 + angle * angle / 12.0)
    return np.asarray(share[..., None] * q[..., 1:])


def turned(vectors: Array) -> Array:
    """(…, 3, 3) rotations of rotation vectors (…, 3) rad."""
    square = (vectors * vectors).sum(axis=-1)
    angle = np.sqrt(square)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    sine = np.where(small, 1.0 - square / 6.0, np.sin(safe) / safe)[..., None, None]
    versine = np.where(small, 0.5 - square / 24.0, 2.0 * (np.sin(0.5 * safe) / safe) ** 2)[..., None, None]
    spin = cross_matrix(vectors)
    return np.asarray(np.eye(3) + sine * spin + versine * (spin @ spin))
