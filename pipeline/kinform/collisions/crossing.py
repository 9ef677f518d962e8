"""Where facets cross each other: the segments that pairs of triangles have in common (Möller 1997)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.screws import cross

__all__ = ["crossings"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_CORNERS, _NEXT = np.array([0, 1, 2]), np.array([1, 2, 0])


def crossings(first: Array, second: Array, least: float) -> tuple[Flags, Array]:
    """Which triangles (n, 3, 3) cross, by more than `least` (m), and the segment (n, 2, 3) that they share.

    Triangles that touch, or lie in one plane, do not cross.
    """
    n1, n2 = _normal(first), _normal(second)
    d1 = np.einsum("ij,ikj->ik", n2, first - second[:, :1])
    d2 = np.einsum("ij,ikj->ik", n1, second - first[:, :1])
    along = cross(n1, n2)
    length = np.linalg.norm(along, axis=1)
    along /= np.where(length > 0.0, length, 1.0)[:, None]
    found = (length > 1e-9) & (np.abs(d1).max(axis=1) > 0.0)
    for d in (d1, d2):
        found &= (d.max(axis=1) > least) & (d.min(axis=1) < -least)
    low1, high1, p1, q1 = _span(first, d1, along)
    low2, high2, p2, q2 = _span(second, d2, along)
    low, high = np.maximum(low1, low2), np.minimum(high1, high2)
    found &= high - low > least
    start = np.where((low1 >= low2)[:, None], p1, p2)
    end = np.where((high1 <= high2)[:, None], q1, q2)
    return found, np.stack([start, end], axis=1)


def _normal(triangles: Array) -> Array:
    n = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    length = np.linalg.norm(n, axis=1, keepdims=True)
    return np.asarray(n / np.where(length > 0.0, length, 1.0))


def _span(triangles: Array, d: Array, along: Array) -> tuple[Array, Array, Array, Array]:
    """Where a triangle meets the plane from which its corners are `d` (n, 3) away: along a line, and as points."""
    here, there = d[:, _CORNERS], d[:, _NEXT]
    straddles = (here < 0.0) != (there < 0.0)
    step = np.where(straddles, here - there, 1.0)
    share = np.where(straddles, here / step, 0.0)[..., None]
    points = triangles + share * (triangles[:, _NEXT] - triangles)
    places = np.einsum("ij,ikj->ik", along, points)
    lowest = np.argmin(np.where(straddles, places, np.inf), axis=1)
    highest = np.argmax(np.where(straddles, places, -np.inf), axis=1)
    rows = np.arange(len(d))
    return places[rows, lowest], places[rows, highest], points[rows, lowest], points[rows, highest]
