"""Where facets cross each other: the segments that pairs of triangles have in common (Möller 1997)."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import NEXT, cross
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array, Flags


def crossings(first: Array, second: Array, normals: tuple[Array, Array], least: float) -> tuple[Flags, Array]:
    """Which triangles (n, 3, 3) cross, by more than `least` (m), and the segment (n, 2, 3) that they share; `normals`:
    unit (n, 3) of both.

    Triangles that touch, or lie in one plane, do not cross.
    """
    crossing = np.zeros(len(first), dtype=bool)
    segments = np.zeros((len(first), 2, 3))
    # most that touch are flush: they are told by one plane, and the rest left out
    n1, n2 = normals
    d1 = _heights(first, second, n2)
    rows = np.flatnonzero((d1.max(axis=1) > least) & (d1.min(axis=1) < -least))
    first, second, n1, n2, d1 = first[rows], second[rows], n1[rows], n2[rows], d1[rows]
    d2 = _heights(second, first, n1)
    keep = (d2.max(axis=1) > least) & (d2.min(axis=1) < -least)
    rows, first, second, d1, d2 = rows[keep], first[keep], second[keep], d1[keep], d2[keep]
    if not len(rows):
        return crossing, segments
    along = cross(n1[keep], n2[keep])
    length = np.linalg.norm(along, axis=1)
    along /= np.where(length > 0.0, length, 1.0)[:, None]
    spans = _span(np.concatenate([first, second]), np.concatenate([d1, d2]), np.concatenate([along, along]))
    (low1, low2), (high1, high2), (p1, p2), (q1, q2) = ((side[: len(rows)], side[len(rows) :]) for side in spans)
    crossing[rows] = (length > SOLVED) & (np.minimum(high1, high2) - np.maximum(low1, low2) > least)
    segments[rows, 0] = np.where((low1 >= low2)[:, None], p1, p2)
    segments[rows, 1] = np.where((high1 <= high2)[:, None], q1, q2)
    return crossing, segments


def _heights(triangles: Array, others: Array, normals: Array) -> Array:
    """(n, 3) m of the corners of triangles above the planes of others."""
    return np.asarray(((triangles - others[:, :1]) @ normals[:, :, None])[:, :, 0])


def _span(triangles: Array, d: Array, along: Array) -> tuple[Array, Array, Array, Array]:
    """Where a triangle meets the plane from which its corners are `d` (n, 3) away: along a line, and as points."""
    here, there = d, d[:, NEXT]
    straddles = (here < 0.0) != (there < 0.0)
    step = np.where(straddles, here - there, 1.0)
    share = np.where(straddles, here / step, 0.0)[..., None]
    points = triangles + share * (triangles[:, NEXT] - triangles)
    places = np.einsum("ij,ikj->ik", along, points)
    lowest = np.argmin(np.where(straddles, places, np.inf), axis=1)
    highest = np.argmax(np.where(straddles, places, -np.inf), axis=1)
    rows = np.arange(len(d))
    return places[rows, lowest], places[rows, highest], points[rows, lowest], points[rows, highest]
