"""Poses, twists and accelerations of all links at many times at once, from coordinates and their rates.

World axes about the mechanism's centre; the same kinematics as `Mechanism` and the kernel, in batches.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.spatial import along_motion, cross_motion, rotation_vector
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.mechanism.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class States:
    """T times, L links, n rates."""

    poses: Array
    """(T, L, 4, 4)."""
    screws: Array
    """(T, n, 6) twist of each rate."""
    twists: Array
    """(T, L, 6)."""
    accelerations: Array
    """(T, L, 6) rates of change of the twists."""


def poses_at(mechanism: Mechanism, q: Array) -> Array:
    """(T, L, 4, 4) poses at positions (T, nq)."""
    count = len(q)
    values = q[:, mechanism.screw_q]
    factors = np.stack([values, np.sin(values), 1.0 - np.cos(values)], axis=-1)
    motions = np.eye(4) + np.einsum("tpk,pkij->tpij", factors, mechanism.screw_terms)
    own = np.broadcast_to(np.eye(4), (len(mechanism.parent), count, 4, 4)).copy()
    own[mechanism.screw_link] = motions.transpose(1, 0, 2, 3)
    for ball in mechanism.balls:
        R = _rotations(q[:, ball.q : ball.q + 4])
        R = R if ball.forward else R.transpose(0, 2, 1)
        own[ball.link, :, :3, :3] = R
        own[ball.link, :, :3, 3] = ball.point - R @ ball.point
    X = np.empty((count, len(mechanism.parent), 4, 4))
    X[:, 0] = np.eye(4)
    for link in range(1, len(mechanism.parent)):
        X[:, link] = X[:, mechanism.parent[link]] @ own[link]
    return X


def gaps_at(mechanism: Mechanism, poses: Array, q: Array) -> Array:
    """(T, 6C + G) what keeps the loops from closing at poses (T, L, 4, 4) and positions (T, nq), as `Mechanism.gap`."""
    geared = q @ mechanism.gear_q.T
    if len(mechanism.closures) == 0:
        return np.asarray(geared)
    ends, targets = (poses[:, side].reshape(-1, 4, 4) for side in mechanism.closures.T)
    R = targets[:, :3, :3] @ ends[:, :3, :3].transpose(0, 2, 1)
    p = targets[:, :3, 3] - (R @ ends[:, :3, 3, None])[..., 0]
    loops = np.concatenate([rotation_vector(R), p / mechanism.length], axis=1)
    return np.concatenate([loops.reshape(len(q), -1), geared], axis=1)


def states_at(mechanism: Mechanism, q: Array, v: Array, a: Array) -> States:
    """All of it at positions (T, nq), rates (T, n) and their rates of change (T, n)."""
    X = poses_at(mechanism, q)
    count, n = v.shape
    frames = X[:, mechanism.column_frame].reshape(-1, 4, 4)
    twist = np.broadcast_to(mechanism.column, (count, n, 6)).reshape(-1, 6)
    screws = along_motion(frames, twist).reshape(count, n, 6)
    twists = np.einsum("ln,tn,tnk->tlk", mechanism.moves, v, screws, optimize=True)
    carried = cross_motion(
        twists[:, mechanism.column_link].reshape(-1, 6), (screws * v[:, :, None]).reshape(-1, 6)
    ).reshape(count, n, 6)
    gained = np.einsum("ln,tnk->tlk", mechanism.moves, screws * a[:, :, None] + carried, optimize=True)
    return States(X, screws, twists, gained)


def _rotations(q: Array) -> Array:
    """(T, 3, 3) rotations of quaternions (T, 4)."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)
