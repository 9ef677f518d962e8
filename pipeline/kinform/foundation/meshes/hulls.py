"""Convex hulls of points, flat ones too: how far outside of them other points lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array

ENTRIES = 1 << 20
"""Distances of points from planes, and from hulls, that are worked out in one pass: 8 MB. It bounds memory and changes
no result."""
SOME = 60
"""Planes of a hull that tell that a point is far from it, about: for a ball within some 10 % of its radius. Chosen."""


@dataclass(frozen=True, eq=False)
class Hull:
    """The convex hull of points."""

    corners: Array
    """(n, 3) m: the points at its corners."""
    planes: Array
    """(m, 4): outward unit normals, and offsets: n·x + d ≤ 0 inside."""
    volume: float
    """m³."""

    def outside(self, points: Array) -> Array:
        """How far (m) each of the points (k, 3) lies outside, at least: beyond the plane that it is farthest beyond;
        negative inside. Exact where the nearest place of the hull is inside of a face."""
        return beyond(self.planes, points)


def beyond(planes: Array, points: Array) -> Array:
    """How far each of the points (k, 3) lies beyond the plane (of m, each normal and offset) that it is farthest
    beyond."""
    out = np.full(len(points), -np.inf)
    rows = max(1, ENTRIES // max(len(planes), 1))
    for start in range(0, len(points), rows):
        block = slice(start, start + rows)
        out[block] = (points[block] @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    return out


def outside_of_all(hulls: Sequence[Hull], points: Array) -> Array:
    """How far each of the points (k, 3) lies outside of the hull that it is least outside of.

    Some planes of a hull give a least value. Only where that is below what another hull gives are all planes asked: of
    many hulls few are near a point, and the time grows with the points alone.
    """
    if len(hulls) == 1:
        return hulls[0].outside(points)
    some = [hull.planes[:: 1 + len(hull.planes) // SOME] for hull in hulls]
    out = np.full(len(points), np.inf)
    rows = max(1, ENTRIES // max(len(hulls), 1))
    for start in range(0, len(points), rows):
        block = points[start : start + rows]
        least = np.array([beyond(planes, block) for planes in some])
        first, best = least.argmin(axis=0), out[start : start + rows]
        for k, hull in enumerate(hulls):
            asked = first == k
            best[asked] = hull.outside(block[asked])
        for k, hull in enumerate(hulls):
            asked = (first != k) & (least[k] < best)
            best[asked] = np.minimum(best[asked], hull.outside(block[asked]))
    return out


def hull_of(points: Array) -> Hull | None:
    """The hull of points (n, 3) m; of points in a plane, that of a slab as thin as nothing. None of fewer than three,
    or of points that are all in one place."""
    from scipy.spatial import ConvexHull, QhullError  # takes a third of a second, which looking at results need not pay

    if len(points) < 3:
        return None
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    size = float(np.ptp(points, axis=0).max())
    if size <= 0.0:
        return None

    scaled = (points - middle) / size
    try:
        hull = ConvexHull(scaled)
    except QhullError:
        # Share of its size by which a flat set of points is thickened on each side, so that it has a hull: far below
        # the resolution of any mesh file.
        steps = 1e-7 * np.array([*np.eye(3), *-np.eye(3)])
        scaled = (scaled[:, None, :] + steps).reshape(-1, 3)
        hull = ConvexHull(scaled)
    normals, offsets = hull.equations[:, :3], hull.equations[:, 3] * size
    planes = np.column_stack([normals, offsets - normals @ middle])
    return Hull(scaled[hull.vertices] * size + middle, planes, float(hull.volume) * size**3)
