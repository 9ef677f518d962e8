"""Which of some facets points are nearest to, and how far off that is: measured, of all facets whose boxes come as
near to a point as the nearest of some of their corners.

FCL tells the same from a tree, which takes longer to make of a few thousand facets than a few hundred points take to
be measured so, and names any one of facets that are as near as each other; here it is the first.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kinform.foundation.meshes.box_pairs import meeting_boxes
from kinform.foundation.meshes.boxes import meeting_box, triangle_boxes
from kinform.foundation.meshes.near_points import Nearest
from kinform.foundation.rounding import SOLVED
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Flags, Ints

# meshes/closest
CLOSEST_SOME = 60_000
"""Corners of facets, times points, whose distance bounds that of the nearest facet: more corners give closer bounds but
cost more than they save."""
CLOSEST_MOST = 1_000_000
"""Points times facets near each up to which all are measured: 0.1 s and 0.2 GB. Beyond, FCL is asked."""
CLOSEST_SIFTED = 8
"""Facets near a point from which on their boxes are compared first: that takes a tenth of measuring them and leaves a
few."""


class Triangles:
    """Triangles (m, 3, 3), one unit of length, and what is known of them once they are asked."""

    def __init__(self, corners: Array):
        self.corners = corners

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Lower and upper corners (m, 3) of their boxes."""
        return triangle_boxes(self.corners)

    @cached_property
    def largest(self) -> float:
        """Of all coordinates."""
        return float(np.abs(self.corners).max())

    def nearest(self, points: Array) -> tuple[Array, Ints] | None:
        """As `closest_facets`."""
        return _nearest(points, self)


def closest_facets(points: Array, corners: Array) -> tuple[Array, Ints] | None:
    """Distance (n,) of points (n, 3) from triangles (m, 3, 3), m > 0, and the first of those that are nearest (n,), one
    unit of length; None where too many would have to be measured."""
    return Triangles(corners).nearest(points)


def _nearest(points: Array, triangles: Triangles) -> tuple[Array, Ints] | None:
    if len(points) == 0:
        return np.zeros(0), np.zeros(0, np.int64)
    corners, (low, high) = triangles.corners, triangles.boxes
    some = corners[:: len(points) * len(corners) // CLOSEST_SOME + 1, 0]
    reach = (1.0 + SOLVED) * Nearest(some).away(points)[:, None]
    # Rounding of distances, as a share of the largest coordinate: facets within it are as near. Four spacings of
    # doubles: more would name another of two near facets.
    rounding = 1e-15 * triangles.largest
    least, most = points - reach, points + reach
    beside = meeting_box(low, high, least.min(axis=0), most.max(axis=0)).nonzero()[0]
    corners = corners.take(beside, axis=0)
    candidates = meeting_boxes((least, most), (low.take(beside, axis=0), high.take(beside, axis=0)))
    if candidates is None or len(candidates[0]) > CLOSEST_MOST:
        return None
    point, facet = candidates
    columns, places = np.ascontiguousarray(corners.transpose(1, 2, 0)), np.ascontiguousarray(points.T)
    if len(point) > CLOSEST_SIFTED * len(points):
        point, facet = _sifted(columns, places, point, facet, rounding)
    away = _from_origin(columns.take(facet, axis=2) - places.take(point, axis=1))
    # the box of a corner touches that of its facet, so that every point has candidates, in their order
    starts = np.searchsorted(point, np.arange(len(points)))
    distance = np.minimum.reduceat(away, starts)
    as_near = (away <= ((1.0 + SOLVED) * distance + rounding).take(point)).nonzero()[0]
    first = as_near[np.searchsorted(point[as_near], np.arange(len(points)))]
    return distance, beside[facet[first]]


def _sifted(corners: Array, places: Array, point: Ints, facet: Ints, rounding: float) -> tuple[Ints, Ints]:
    """Those of pairs of points `point` (k,) of (3, n), ascending, each of which there is, and triangles `facet` (k,) of
    (3, 3, m), whose boxes are no farther off than the triangle whose box is nearest: all that may be nearest."""
    lows, highs = (least(least(corners[0], corners[1]), corners[2]) for least in (np.minimum, np.maximum))
    square = np.zeros(len(point))
    for low, high, place in zip(lows, highs, places, strict=True):
        here = place.take(point)
        off = np.maximum(low.take(facet) - here, here - high.take(facet))
        np.maximum(off, 0.0, out=off)
        off *= off
        square += off
    starts = heads(point).nonzero()[0]
    least_of = np.minimum.reduceat(square, starts)
    nearest = (square == least_of.take(point)).nonzero()[0]
    nearest = nearest.take(heads(point.take(nearest)).nonzero()[0])
    most = _from_origin(corners.take(facet.take(nearest), axis=2) - places)
    most *= (1.0 + SOLVED) ** 2
    most += 2.0 * rounding
    most *= most
    kept = (square <= most.take(point)).nonzero()[0]
    return point.take(kept), facet.take(kept)


def distances_from(point: Array, corners: Array) -> Array:
    """(m,) distances of a point (3,) from triangles (m, 3, 3), one unit of length."""
    return _from_origin(np.ascontiguousarray((corners - point).transpose(1, 2, 0)))


def distances_between(points: Array, corners: Array) -> Array:
    """(k,) distances of points (k, 3) from triangles (k, 3, 3), one unit of length."""
    return _from_origin(np.ascontiguousarray((corners - points[:, None]).transpose(1, 2, 0)))


def _from_origin(triangles: Array) -> Array:
    """(k,) distances of the origin from triangles (3, 3, k): corner, coordinate, triangle."""
    sides = triangles[[1, 2, 0]] - triangles
    normal = _cross(sides[0], sides[1])
    length = np.sqrt(_dot(normal, normal))
    over: Flags = length > 0.0
    square = np.full(triangles.shape[2], np.inf)
    for corner, side in zip(triangles, sides, strict=True):
        # outside of an edge, seen along the normal, the foot of the perpendicular is not on the triangle
        over &= _dot(_cross(corner, side), normal) >= 0.0
        long = _dot(side, side)
        share = -_dot(corner, side)
        share /= np.where(long > 0.0, long, 1.0)
        np.minimum(np.maximum(share, 0.0, out=share), 1.0, out=share)
        foot = share * side
        foot += corner
        np.minimum(square, _dot(foot, foot), out=square)
    height = np.abs(_dot(normal, triangles[0])) / np.where(over, length, 1.0)
    return np.where(over, height, np.sqrt(square))


def _dot(a: Array, b: Array) -> Array:
    """(k,) products of vectors by their coordinates (3, k)."""
    out = a[0] * b[0]
    out += a[1] * b[1]
    out += a[2] * b[2]
    return np.asarray(out)


def _cross(a: Array, b: Array) -> Array:
    """(3, k) the same, vectors."""
    out = np.empty(a.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[j], b[k], out=out[i])
        out[i] -= a[k] * b[j]
    return out
