"""Balls that hold all facets of a mesh: how far points keep from it at least, told quickly."""

from __future__ import annotations

import numpy as np

from kinform.foundation.meshes.near_points import Nearest
from kinform.foundation.meshes.subdivision import inner_weights, longest_sides
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array
from kinform.model.assembly import Mesh

BALL_SHARE = 0.012
"""Largest radius of the balls about facets, as a share of the diagonal of the mesh: a few thousand balls cover a mesh.
Chosen, not measured."""


class Balls:
    """Those of one mesh."""

    def __init__(self, mesh: Mesh):
        self._near = _balls(mesh)

    def away(self, points: Array) -> Array:
        """(n,) m that points (n, 3) of the part frame keep from all facets at least."""
        out = np.full(len(points), np.inf)
        for centres, radius in self._near:
            out = np.minimum(out, centres.away(points) - radius)
        return np.asarray(np.maximum(out, 0.0))


def _balls(mesh: Mesh) -> list[tuple[Nearest, float]]:
    """Middles of balls that hold all facets, with their radius (m), by octaves of it."""
    corners = mesh.vertices.take(mesh.faces, axis=0)
    longest = longest_sides(corners)
    # at most 6² smaller triangles a facet: long thin ones get larger balls
    parts = np.clip(np.ceil(longest / max(BALL_SHARE * mesh.diagonal, TINY)), 1, 6).astype(np.int64)
    middles, radii = [], []
    for number in np.flatnonzero(np.bincount(parts)).tolist():
        alike = parts == number
        middles.append((inner_weights(number) @ corners[alike]).reshape(-1, 3))
        radii.append(np.repeat(2.0 / 3.0 * longest[alike] / number, number * number))
    points, radius = np.concatenate(middles), np.concatenate(radii)
    size, low = max(mesh.diagonal, TINY), mesh.vertices.min(axis=0)
    level = np.ceil(np.log2(np.maximum(radius / size, BALL_SHARE))).astype(np.int64)
    out = []
    for k in range(int(level.min()), int(level.max()) + 1):
        alike = level == k
        if not alike.any():
            continue
        # one for all that are in one cell of a grid
        largest, cell = float(radius[alike].max()), 0.5 * 2.0**k * size
        places = [
            np.round((column[alike] - least) / cell).astype(np.int64)
            for column, least in zip(points.T, low, strict=True)
        ]
        x, y, z = places
        counts = [int(place.max()) + 1 for place in places]
        occupied = np.zeros(counts, dtype=bool)
        occupied[x, y, z] = True
        centres = low + cell * np.argwhere(occupied)
        out.append((Nearest(centres), largest + 0.5 * float(np.sqrt(3.0)) * cell))
    return out
