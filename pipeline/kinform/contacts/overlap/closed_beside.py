"""What of a closed mesh lies beside another part, closed again: it overlaps the other part as the whole does, in a
small share of the time where a large part touches at one end.

Two parts overlap in the common box of theirs only. Of all its sides, that one is taken beyond which most facets lie
whole, and these are left out; each hole that they leave has all of its corners beyond that side, and is closed by a fan
about the middle of its corners, which lies there too. So nothing changes on this side of it: what is left out and the
fans are closed surfaces beyond it, in which no point on this side lies. Beyond it the fans lie in the part's own box,
but out of the common one, and so out of the box of the other part.
"""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import BESIDE_MARGIN, BESIDE_SHARE
from kinform.contacts.search.pair_view import PartView
from kinform.foundation.graphs.components import components
from kinform.foundation.sorting import numbered
from kinform.model.arrays import Array, Ints


def closed_beside(part: PartView, other: PartView) -> tuple[Array, Ints, Ints] | None:
    """Vertices (V, 3) m in the part frame, faces (n, 3), and which facet of the mesh each is, those that close it being
    counted on; None where it would be little less than the whole."""
    mesh, margin = part.index.mesh, BESIDE_MARGIN * part.index.mesh.diagonal
    low = np.maximum(part.low, other.low) - margin
    high = np.minimum(part.high, other.high) + margin
    beyond = ((part.vertices < low) @ _BITS[:3]) | ((part.vertices > high) @ _BITS[3:])
    first, second, third = (beyond.take(corner) for corner in mesh.faces.T)
    whole = first & second & third
    side = _BITS[np.argmax([np.count_nonzero(whole & bit) for bit in _BITS])]
    facets = np.flatnonzero((whole & side) == 0)
    if not 0 < len(facets) <= BESIDE_SHARE * len(mesh.faces):
        return None
    faces, count = mesh.faces[facets], np.int64(len(mesh.vertices))
    start, end = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    single = np.isin(end * count + start, start * count + end, invert=True)
    start, end = end[single], start[single]
    rim, ends = numbered(np.concatenate([start, end]), int(count))
    hole = components(ends[: len(start)], ends[len(start) :], len(rim))
    holes = int(hole.max(initial=-1)) + 1
    corners = np.bincount(hole, minlength=holes)
    tips = [np.bincount(hole, column, holes) / corners for column in mesh.vertices[rim].T]
    fans = np.stack([start, end, count + hole[ends[: len(start)]]], axis=1)
    used, placed = numbered(np.concatenate([faces, fans]).ravel(), int(count) + holes)
    vertices = np.concatenate([mesh.vertices, np.stack(tips, axis=1)]).take(used, axis=0)
    return vertices, placed.reshape(-1, 3), np.concatenate([facets, len(mesh.faces) + np.arange(len(fans))])


_BITS = 1 << np.arange(6)
"""One for each side of a box."""
