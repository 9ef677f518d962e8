"""Vectors of three: products, frames across an axis, canonical signs.

numpy's own cross product spends most of its time on moving axes about, ten times the product of single vectors.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.constants import MANY
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array

NEXT, _AFTER = np.array([1, 2, 0]), np.array([2, 0, 1])
"""Index that follows each of three, of a coordinate or a corner of a triangle, and the one after it."""
# the signs of the permutations of three indices
_CROSS = np.zeros((3, 3, 3))
for _i in range(3):
    _CROSS[_i, (_i + 2) % 3, (_i + 1) % 3] = 1.0
    _CROSS[_i, (_i + 1) % 3, (_i + 2) % 3] = -1.0
CROSS = _CROSS.reshape(3, 9)
"""(3, 9): a @ CROSS is the matrix of a × …, row by row. A product is much faster than components."""

_UNITS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""x, y, z as plain tuples: arithmetic with single numbers is quicker than with arrays of three."""


def cross(a: Array, b: Array) -> Array:
    """a × b along the last axis (…, 3), broadcast."""
    if a.ndim == 1 and b.ndim == 1:
        x, y, z = a.tolist()
        u, v, w = b.tolist()
        return np.array([y * w - z * v, z * u - x * w, x * v - y * u])
    if max(a.size, b.size) < MANY:
        return np.asarray(a.take(NEXT, -1) * b.take(_AFTER, -1) - a.take(_AFTER, -1) * b.take(NEXT, -1))
    out = np.empty(a.shape if a.shape == b.shape else np.broadcast(a, b).shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return out


def cross_columns(a: Array, b: Array) -> Array:
    """a × b of the rows of a and b, (n, 3) each, in memory column by column, as they are best too."""
    out = np.empty((3, len(a)))
    less = np.empty(len(a))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[:, j], b[:, k], out=out[i])
        np.multiply(a[:, k], b[:, j], out=less)
        out[i] -= less
    return out.T


def dot(a: Array, b: Array) -> Array:
    """(n,) inner products of the rows of a and b, (n, 3) each; of many, or of rows that are not stored as such, column
    by column, to the bits of einsum over rows."""
    if a.shape == b.shape and a.shape[1] == 3 and (a.size >= MANY or a.strides[1] != 8 or b.strides[1] != 8):
        out = a[:, 0] * b[:, 0]
        out += a[:, 2] * b[:, 2]
        out += a[:, 1] * b[:, 1]
        return np.asarray(out)
    return np.asarray(np.einsum("ij,ij->i", a, b))


def cross_matrix(a: Array) -> Array:
    """(…, 3, 3) matrices of a × …, for a (…, 3)."""
    return np.asarray((a @ CROSS).reshape(*a.shape, 3))


def times(vectors: Array, matrix: Array) -> Array:
    """Vectors (…, 3) times a matrix (3, k) or a vector (3,), as one long product: of more dimensions than two numpy
    makes many short ones, which take five times as long."""
    if vectors.ndim <= 2:
        return np.asarray(vectors @ matrix)
    return np.asarray((vectors.reshape(-1, 3) @ matrix).reshape(*vectors.shape[:-1], *matrix.shape[1:]))


def weighted_mean(points: Array, weights: Array) -> Array:
    """(3,) mean of points (n, 3) by weights (n,), to the bits of np.average, which takes three times as long."""
    column = weights[:, None]
    return np.asarray((points * column).sum(axis=0) / column.sum(axis=0))


def box(points: Array) -> tuple[Array, Array]:
    """(3,) least and greatest coordinates of points (n, 3): along columns that are stored as such, many times as fast
    as across rows of three."""
    columns = np.ascontiguousarray(points.T)
    return columns.min(axis=1), columns.max(axis=1)


def normalised(vectors: Array) -> Array:
    """Vectors (…, 3) of length one; zero vectors stay."""
    length = np.sqrt(np.einsum("...i,...i", vectors, vectors))
    return np.asarray(vectors / np.maximum(length, TINY)[..., None])


def norm(vector: Array) -> float:
    """The length of a vector, or the root of the sum of squares of any array, to the bits of np.linalg.norm: that asks
    for an order, an axis and a type first, which takes ten times as long as a product of three."""
    flat = vector if vector.ndim == 1 else vector.ravel(order="K")
    return math.sqrt(flat.dot(flat))


def lengths(rows: Array) -> Array:
    """(…,) lengths of vectors (…, 3), to the bits of np.linalg.norm along the last axis."""
    if rows.size < MANY or rows.shape[-1] != 3:
        return np.asarray(np.sqrt(np.add.reduce(rows * rows, axis=-1)))
    x, y, z = rows[..., 0], rows[..., 1], rows[..., 2]
    square = x * x
    square += y * y
    square += z * z
    return np.asarray(np.sqrt(square, out=square))


LEAST_BY = 1e-3
"""Components of a unit vector that differ by less are alike: rounding does not decide which of them is the least."""


def perpendicular(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors that make a right-handed frame (u, v, axis) with the unit axis (3,): the first across x, y or z,
    the first of those to which the axis is most nearly perpendicular."""
    x, y, z = axis.tolist()
    size = [abs(x), abs(y), abs(z)]
    most = min(size) + LEAST_BY
    a, b, c = _UNITS[0 if size[0] <= most else 1 if size[1] <= most else 2]
    u = np.array([b * z - c * y, c * x - a * z, a * y - b * x])
    u /= norm(u)
    a, b, c = u.tolist()
    return u, np.array([y * c - z * b, z * a - x * c, x * b - y * a])


def turning_frame(vectors: Array) -> Array:
    """(3, 3) right-handed unit axes, row by row, that turn with unit vectors (n, 3), n ≥ 1: the first of these, and
    across it the first that is well apart."""
    first = vectors[0]
    across = vectors - np.outer(vectors @ first, first)
    size = lengths(across)
    # 30° from the first, so that rounding does not decide where the second points
    apart = (size > 0.5).nonzero()[0]
    if not len(apart):
        u, v = perpendicular(first)
        return np.array([first, u, v])
    second = across[apart[0]] / size[apart[0]]
    return np.array([first, second, cross(first, second)])


def perpendiculars(axes: Array) -> tuple[Array, Array]:
    """The same of many unit axes (n, 3): (n, 3) each."""
    size = np.abs(axes)
    unit = np.eye(3)[(size <= size.min(axis=1, keepdims=True) + LEAST_BY).argmax(axis=1)]
    u = cross(unit, axes)
    u /= np.sqrt(dot(u, u))[:, None]
    return u, cross(axes, u)


def sine(a: Array, b: Array) -> float:
    """Of the angle between two unit vectors (3,)."""
    x, y, z = a.tolist()
    u, v, w = b.tolist()
    i, j, k = y * w - z * v, z * u - x * w, x * v - y * u
    return math.sqrt(i * i + j * j + k * k)


def foot(point: Array, axis: Array, place: Array) -> Array:
    """The point of the line through `point` along the unit `axis` that is nearest to `place`, (3,) each."""
    return np.asarray(point + axis * float(axis @ (place - point)))


def canonical(axis: Array) -> Array:
    """Unit vector along `axis` (3,) with the sign of `canonical_sign`."""
    x, y, z = (axis / norm(axis)).tolist()
    sign = _sign(x, y, z)
    # adding zero turns −0 into 0
    return np.array([sign * x + 0.0, sign * y + 0.0, sign * z + 0.0])


def canonical_sign(unit: Array) -> float:
    """The sign that makes the largest component of a unit vector (3,) positive; among components within 1e-3 of the
    largest the first of x, y, z decides."""
    return _sign(*unit.tolist())


def _sign(x: float, y: float, z: float) -> float:
    least = max(abs(x), abs(y), abs(z)) - 1e-3
    first = x if abs(x) >= least else y if abs(y) >= least else z
    return 1.0 if first >= 0.0 else -1.0


def widest_gap(vectors: Array, axis: Array) -> float:
    """rad: the widest angle about a unit axis (3,) that none of the vectors (n, 3) points into."""
    u, v = perpendicular(axis)
    return widest_turn(np.arctan2(vectors @ v, vectors @ u))


def widest_turn(azimuths: Array) -> float:
    """rad: the widest angle between neighbours among directions in a plane, (n,) rad from −π to π."""
    azimuth = np.sort(azimuths)
    between = azimuth[1:] - azimuth[:-1]
    return float(max(between.max(initial=0.0), azimuth[0] + 2.0 * np.pi - azimuth[-1]))
