"""A mesh by few facets, and how far these are off it at most: enough to tell how far parts are certainly apart.

Vertices in one cell of a grid become one (vertex clustering, Rossignac and Borrel 1993). A point of a facet is the same
weighted mean of its corners before and after, so that it moves no further than the corner that moves furthest. Most
facets of fine details become lines or points; these are left out where a facet that is kept has them among its edges or
corners, else the facet stays as it is.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import distinct, numbered
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh

COARSE_CELL = 0.02
"""Side of the cells whose vertices become one, of the part itself: facets of fine details vanish. A choice; ..."""
COARSE_WORTH = 0.5
"""... and where more than this share of all are left, all are: the coarse ones would gain less than half."""


def coarse_mesh(mesh: Mesh) -> tuple[Array, Ints, float] | None:
    """Vertices (v, 3) m and faces (f, 3) such that every point of the mesh is within the distance (m) of these; None
    where they would not be far fewer."""
    places, owner = _clustered(mesh)
    corners = np.sort(owner[mesh.faces], axis=1)
    first, second, third = corners.T
    proper = np.flatnonzero((first != second) & (second != third))
    kept = _distinct_rows(corners[proper], len(places))
    bare = _uncovered(corners, kept, len(places))
    if len(kept) + len(bare) > COARSE_WORTH * len(mesh.faces):
        return None
    away = mesh.vertices - places[owner]
    off = float(np.sqrt((away * away).sum(axis=1).max()))
    vertices, faces = places, kept
    if len(bare):
        own = mesh.faces[bare]
        vertices = np.concatenate([places, mesh.vertices[own.ravel()]])
        faces = np.concatenate([kept, len(places) + np.arange(own.size).reshape(-1, 3)])
    return vertices, faces, off


def _clustered(mesh: Mesh) -> tuple[Array, Ints]:
    """(v, 3) m middles of the vertices in each cell, and of each vertex (V,) which of these is its own."""
    vertices, low = mesh.vertices, mesh.vertices.min(axis=0)
    size = max(COARSE_CELL * mesh.diagonal, TINY)
    counts = np.floor(np.ptp(vertices, axis=0) / size).astype(np.int64) + 1
    x, y, z = np.floor((vertices - low) / size).astype(np.int64).T
    cells, owner = numbered((x * counts[1] + y) * counts[2] + z, int(counts.prod()))
    order = np.argsort(owner, kind="stable")
    starts = np.searchsorted(owner[order], np.arange(len(cells)))
    lower, upper = (f.reduceat(vertices[order], starts) for f in (np.minimum, np.maximum))
    return 0.5 * (lower + upper), owner


def _distinct_rows(rows: Ints, below: int) -> Ints:
    """(k, 3) the distinct rows of (n, 3) numbers below a number."""
    if not len(rows):
        return rows
    key = distinct((rows[:, 0] * below + rows[:, 1]) * below + rows[:, 2])
    rest, third = np.divmod(key, below)
    return np.stack([*np.divmod(rest, below), third], axis=1)


def _uncovered(corners: Ints, kept: Ints, count: int) -> Ints:
    """Facets of sorted corners (F, 3) that became lines or points which no facet that is kept has."""
    low, high = corners[:, 0], corners[:, 2]
    flat = np.flatnonzero((low == corners[:, 1]) | (corners[:, 1] == high))
    low, high = low[flat], high[flat]
    used = np.zeros(count, dtype=bool)
    used[kept] = True
    lines = np.flatnonzero(low < high)
    edges = distinct(np.concatenate([kept[:, i] * count + kept[:, j] for i, j in ((0, 1), (1, 2), (0, 2))]))
    bare = np.flatnonzero((low == high) & ~used[low])
    return np.sort(flat[np.append(bare, lines[~np.isin(low[lines] * count + high[lines], edges)])])
