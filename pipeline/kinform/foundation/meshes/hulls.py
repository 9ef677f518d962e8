"""Convex hulls of points, flat ones too: how far outside of them other points lie."""

from __future__ import annotations

import numpy as np

from kinform.foundation.constants import ROWS
from kinform.frozen import dataclass
from kinform.model.arrays import Array


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
        out = np.full(len(points), -np.inf)
        for start in range(0, len(points), ROWS):
            block = slice(start, start + ROWS)
            out[block] = (points[block] @ self.planes[:, :3].T + self.planes[:, 3]).max(axis=1)
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
