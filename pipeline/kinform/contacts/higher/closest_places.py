"""Where two outlines come closest, by samples along them whose tangents are opposed: only those are compared whose
neighbourhoods come near each other."""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.higher.outlines import CURVE_SAMPLES, Curve
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Ints

CURVE_CHUNK = 16
"""Consecutive samples of a curve that share a box: the distance of boxes tells which samples are compared at all.
Chosen, not measured."""
CURVES_OPPOSED = -0.9
"""Largest cosine between the tangents of two curves that touch: 26° from opposite, as samples are coarse. Chosen, not
measured."""


def closest_places(first: Curve, second: Curve, tolerance: float) -> list[tuple[float, float]]:
    """Parameters of both curves where samples of the first come closer to the second than their neighbours, and as
    close as curves that touch, of which samples may be a step off, within the tolerance (m)."""
    (s, p, tangent), (t, q, other) = first.samples, second.samples
    step = max(float(np.diff(first.knots).max()), float(np.diff(second.knots).max())) / CURVE_SAMPLES
    far = MATING_REACH * tolerance + 2.0 * step
    spread = far + float(np.sqrt(((p[1:] - p[:-1]) ** 2).sum(axis=1).max(initial=0.0)))
    nearest, away, gap = _opposed((p, tangent), (q, other), *_beside(p, q, spread))
    # of those beside which something is near, also what is not
    near = np.flatnonzero(away <= far)
    rows = np.unique(np.clip(np.concatenate([near - 1, near + 1]), 0, len(p) - 1))
    rows = rows[away[rows] > spread]
    if len(rows):
        every = np.repeat(rows, len(q)), np.tile(np.arange(len(q)), len(rows))
        for known, found in zip((nearest, away, gap), _opposed((p, tangent), (q, other), *every), strict=True):
            known[rows] = found[rows]
    padded = np.concatenate([[np.inf], gap, [np.inf]])
    lowest = np.flatnonzero((padded[1:-1] <= padded[:-2]) & (padded[1:-1] < padded[2:]) & np.isfinite(gap))
    return [(float(s[k]), float(t[nearest[k]])) for k in lowest if away[k] <= far]


def _beside(points: Array, others: Array, far: float) -> tuple[Ints, Ints]:
    """Pairs (k,) of points (n, 2) and of others (m, 2) along a curve, all that come within `far` (m) of each other
    among them, by the first, then by the second: by the boxes of few others that follow each other."""
    starts = np.arange(0, len(others), CURVE_CHUNK)
    low = np.minimum.reduceat(others, starts) - far
    high = np.maximum.reduceat(others, starts) + far
    inside = (points[:, :1] >= low[:, 0]) & (points[:, :1] <= high[:, 0])
    inside &= (points[:, 1:] >= low[:, 1]) & (points[:, 1:] <= high[:, 1])
    point, chunk = np.nonzero(inside)
    other = (starts[chunk, None] + np.arange(CURVE_CHUNK)).ravel()
    there = other < len(others)
    return np.repeat(point, CURVE_CHUNK)[there], other[there]


def _opposed(
    first: tuple[Array, Array], second: tuple[Array, Array], one: Ints, two: Ints
) -> tuple[Ints, Array, Array]:
    """For each of points (n, 2) with tangents (n, 2) the nearest of others with an opposed one, of pairs `one` (k,)
    ascending and `two` (k,): its index, how far off it is (m), and the gap along its normal; ∞ where none is."""
    (p, tangent), (q, other) = first, second
    nearest, away, gap = np.zeros(len(p), np.int64), np.full(len(p), np.inf), np.full(len(p), np.inf)
    tx, ty = tangent.T
    ox, oy = other.T
    facing = np.flatnonzero(tx[one] * ox[two] + ty[one] * oy[two] < CURVES_OPPOSED)
    if not len(facing):
        return nearest, away, gap
    one, two = one[facing], two[facing]
    x, y = p[one, 0] - q[two, 0], p[one, 1] - q[two, 1]
    square = x * x + y * y
    starts = np.flatnonzero(heads(one))
    least = np.repeat(np.minimum.reduceat(square, starts), np.diff(np.append(starts, len(one))))
    least_at = np.flatnonzero(square == least)
    at = least_at[heads(one[least_at])]
    rows = one[at]
    nearest[rows], away[rows] = two[at], np.sqrt(square[at])
    gap[rows] = x[at] * oy[two[at]] - y[at] * ox[two[at]]
    return nearest, away, gap
