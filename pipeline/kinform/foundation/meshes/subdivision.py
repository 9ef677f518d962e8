"""Triangles divided into smaller ones of the same shape."""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array


def longest_sides(corners: Array) -> Array:
    """(n,) lengths of the longest sides of triangles (n, 3, 3)."""
    x, y, z = np.ascontiguousarray(np.moveaxis(corners, 2, 0))
    squares = [
        (x[:, k] - x[:, k - 1]) ** 2 + (y[:, k] - y[:, k - 1]) ** 2 + (z[:, k] - z[:, k - 1]) ** 2 for k in range(3)
    ]
    return np.asarray(np.sqrt(np.maximum(np.maximum(squares[0], squares[1]), squares[2])))


def inner_weights(number: int) -> Array:
    """(number², 3) weights of a triangle's corners for the middles of those that it is divided into, `number` a
    side."""
    up = [(3 * a + 1, 3 * b + 1) for a in range(number) for b in range(number - a)]
    down = [(3 * a + 2, 3 * b + 2) for a in range(number - 1) for b in range(number - 1 - a)]
    two = np.array(up + down, dtype=float) / (3.0 * number)
    return np.column_stack([two, 1.0 - two.sum(axis=1)])
