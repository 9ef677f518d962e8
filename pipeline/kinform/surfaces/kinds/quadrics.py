"""Whether vertices say that a surface is a sphere, or leave other quadrics open.

Two rings about one axis lie on a sphere whatever their radii: a disc with a chamfer at both ends has two. They lie on a
pair of planes as well, and on every quadric of the pencil that the two span; a ring and the pole over it lie on more.
Vertices that determine a sphere lie on no second quadric. Quadrics stay quadrics in whitened coordinates, where a flat
cap is as well conditioned as a ball.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array, Ints
from kinform.surfaces.groups import Sums, columns_of, group_mean, group_moments, sums_of

PAIRS = ((0, 1), (0, 2), (1, 2))
"""Coordinates in the mixed terms of a quadric."""


def distance_from_second(group: Ints, points: Array, centre: Array, radius: Array) -> Array:
    """(G,) root mean square distance of each group's points (N, 3) from that quadric, other than the sphere on which
    they lie, which is nearest to all of them: 0 where they lie on both. Lengths are those of the points; `centre`
    (G, 3) and `radius` (G,) are those of the spheres. To first order: value over gradient (Taubin 1991)."""
    count = len(radius)
    middle = group_mean(group, points, count)
    offset = points - columns_of(middle, group)
    sums = sums_of(group, count)
    size = np.maximum(np.bincount(group, minlength=count), 1)
    values, vectors = np.linalg.eigh(group_moments(group, offset.T, count) / size[:, None, None])
    spread = np.sqrt(np.maximum(values, 1e-30))
    w = np.array([dot(offset, columns_of(vectors[:, :, k], group)) / spread[:, k].take(group) for k in range(3)])
    columns = np.array([*(w * w), *(w[i] * w[j] for i, j in PAIRS), *w, np.ones(len(group))])
    moments = _moments(columns, sums) / size[:, None, None]
    sphere = np.zeros((count, 10))
    away = middle - centre
    sphere[:, :3] = spread * spread
    sphere[:, 6:9] = 2 * spread * np.einsum("gij,gi->gj", vectors, away)
    sphere[:, 9] = dot(away, away) - radius * radius
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    beside = np.eye(10) - sphere[:, :, None] * sphere[:, None, :]
    matrix = beside @ moments @ beside
    matrix += (1 + np.trace(matrix, axis1=1, axis2=2))[:, None, None] * sphere[:, :, None] * sphere[:, None, :]
    found, quadric = np.linalg.eigh(matrix)
    steepness = _steepness(quadric[:, :, 0], w, spread, group, sums) / size
    return np.asarray(np.sqrt(np.maximum(found[:, 0], 0.0) / np.maximum(steepness, TINY)))


def _moments(columns: Array, sums: Sums) -> Array:
    """(G, k, k) sums of products of the columns (k, N)."""
    k = len(columns)
    rows = [sums(columns[i] * columns[i:]) for i in range(k)]
    out: Array = np.empty((rows[0].shape[-1], k, k))
    for i, row in enumerate(rows):
        out[:, i, i:] = out[:, i:, i] = row.T
    return out


def _steepness(quadric: Array, w: Array, spread: Array, group: Ints, sums: Sums) -> Array:
    """(G,) sum of the squares of the gradients of quadrics (G, 10) at points (3, N) in whitened coordinates."""
    out: Array = np.zeros(len(quadric))
    for k in range(3):
        slope = 2 * quadric[:, k].take(group) * w[k] + quadric[:, 6 + k].take(group)
        for number, (i, j) in enumerate(PAIRS):
            if k in (i, j):
                slope += quadric[:, 3 + number].take(group) * w[i + j - k]
        out += sums(slope * slope) / spread[:, k] ** 2
    return out
