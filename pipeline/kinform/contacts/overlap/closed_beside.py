"""What of a closed mesh lies beside another part, closed again: it overlaps the other part as the whole does, in a
small share of the time where a large part touches at one end.

Two parts overlap in the common box of theirs only. The facets outside of it are left out, and each hole that they
leave, of which all corners lie beyond one side of the common box, is closed by a fan about the middle of its corners,
which lies there too. So neither what is left out nor what closes it comes into the common box. Nor can the inside have
changed there: the winding numbers of what is left out, closed by the fans, are one number all over the common box,
and nought where that reaches the part's own box, beyond which they are.
"""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import BESIDE_MARGIN, BESIDE_SHARE
from kinform.contacts.search.pair_view import PartView, near_facets
from kinform.foundation.graphs.components import components
from kinform.foundation.sorting import numbered
from kinform.model.arrays import Array, Ints


def closed_beside(part: PartView, other: PartView) -> tuple[Array, Ints, Ints] | None:
    """Vertices (V, 3) m in the part frame, faces (n, 3), and which facet of the mesh each is, those that close it being
    counted on; None where it would be little less than the whole, or holes reach round the common box, or that lies
    within the part's own."""
    low, high = np.maximum(part.low, other.low), np.minimum(part.high, other.high)
    if not ((low == part.low) | (high == part.high)).any():
        return None
    mesh, margin = part.index.mesh, BESIDE_MARGIN * part.index.mesh.diagonal
    low, high = low - margin, high + margin
    facets, _, _ = near_facets(part, low, high)
    if not 0 < len(facets) < BESIDE_SHARE * len(mesh.faces):
        return None
    faces, count = mesh.faces[facets], np.int64(len(mesh.vertices))
    start, end = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    forth, back = start * count + end, end * count + start
    open_ = ~np.isin(back, forth)
    start, end = end[open_], start[open_]
    rim, ends = numbered(np.concatenate([start, end]), int(count))
    hole = components(ends[: len(start)], ends[len(start) :], len(rim))
    holes = int(hole.max(initial=-1)) + 1
    if not _each_beyond_a_side(part.vertices[rim], hole, holes, low, high):
        return None
    weight = np.bincount(hole, minlength=holes)
    tips = np.stack([np.bincount(hole, column, holes) / weight for column in mesh.vertices[rim].T], axis=1)
    fans = np.stack([start, end, count + hole[ends[: len(start)]]], axis=1)
    used, corners = numbered(np.concatenate([faces, fans]).ravel(), int(count) + holes)
    vertices = np.concatenate([mesh.vertices, tips]).take(used, axis=0)
    numbers = np.concatenate([facets, len(mesh.faces) + np.arange(len(fans))])
    return vertices, corners.reshape(-1, 3), numbers


def _each_beyond_a_side(places: Array, group: Ints, groups: int, low: Array, high: Array) -> bool:
    """Whether places (n, 3) of each group (n,) all lie beyond one side of the box from `low` to `high` (3,)."""
    beyond = np.concatenate([places < low, places > high], axis=1)
    within = np.zeros((groups, 6), dtype=np.int64)
    np.add.at(within, group, ~beyond)
    return bool((within == 0).any(axis=1).all())
