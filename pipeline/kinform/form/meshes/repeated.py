"""Facets that a mesh has more than once: shells that were exported twice, facets written for both their sides.

A facet that is there twice the same way round bounds nothing by its second copy, and is taken once. Where a facet is
there both ways round one of the two may be the skin of the solid and the other its back, as programs that draw write
them: the first of the two is taken where that leaves a closed mesh whose facets agree, and nothing is taken away else.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.meshes.edges import EdgeTable, unsorted_edge_table
from kinform.model.arrays import Flags, Ints


def taken_once(faces: Ints, edges: EdgeTable, count: int) -> tuple[Ints, EdgeTable, int]:
    """Faces (F, 3) over `count` vertices without copies, their edges, and how many facets were copies of another,
    whichever way round, whether they were taken away or not."""
    candidates = np.flatnonzero(_doubled(edges))
    if not len(candidates):
        return faces, edges, 0
    same, turned = _copies(faces[candidates])
    copies = len(candidates[same | turned])
    if not copies:
        return faces, edges, 0
    if same.any():
        faces, edges = _without(faces, candidates[same], count)
    if turned.any():
        left = np.flatnonzero(_doubled(edges))
        _, back = _copies(faces[left])
        skin, skin_edges = _without(faces, left[back], count)
        if skin_edges.open == 0 and skin_edges.overused == 0 and not (skin_edges.balance != 0).any():
            return skin, skin_edges, copies
    return faces, edges, copies


def _without(faces: Ints, facets: Ints, count: int) -> tuple[Ints, EdgeTable]:
    """The faces without these facets, and their edges."""
    kept = np.ascontiguousarray(np.delete(faces, facets, axis=0))
    return kept, unsorted_edge_table(kept, count)


def _copies(faces: Ints) -> tuple[Flags, Flags]:
    """(F,) facets with the vertices of an earlier one: wound as one of these, and not wound as any of them."""
    lowest = faces.argmin(axis=1)
    wound = np.stack([np.take_along_axis(faces, ((lowest + k) % 3)[:, None], axis=1)[:, 0] for k in range(3)], axis=1)
    same, alike = (~_first(rows) for rows in (wound, np.sort(faces, axis=1)))
    return same, alike & ~same


def _first(rows: Ints) -> Flags:
    """(n,) which rows are the first of their kind."""
    out = np.zeros(len(rows), bool)
    out[np.unique(rows, axis=0, return_index=True)[1]] = True
    return out


def _doubled(edges: EdgeTable) -> Flags:
    """(F,) facets that may have the vertices of another: it meets them, and perhaps more, at all three edges."""
    beside = np.full(len(edges.half_edges), -1)
    first, second = edges.pairs
    beside[first], beside[second] = second // 3, first // 3
    if edges.overused:
        beside[edges.half_edges[np.repeat(edges.counts > 2, edges.counts)]] = -2
    a, b, c = np.ascontiguousarray(beside.reshape(-1, 3).T)
    alike: Flags = (a == b) & (b == c) & (a != -1)
    return alike | (a == -2) | (b == -2) | (c == -2) if edges.overused else alike
