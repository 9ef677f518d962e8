"""Which thin triangles meet which facets, of few of either: by their boxes, then by separating axes.

Two triangles are apart where one of seventeen directions parts them: their normals, the products of their edges, and,
where they lie in one plane, what is across an edge in it (Gottschalk, Lin & Manocha, OBBTree, SIGGRAPH 1996). FCL asks
the same of what its trees leave; to make a tree of a few hundred facets, and objects of its answers, takes longer than
to ask about all whose boxes meet. Within, triangles are (3, 3, n): corner, coordinate, triangle. numpy goes through
long rows several times faster than through rows of three.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.constants import (
    CLEARLY_APART,
    CLEARLY_ROUNDED,
    CROSSED_FEW,
    CROSSED_SOME,
    CULLED_LEAST,
    MET_FEW,
    MET_MOST,
)
from kinform.foundation.meshes.box_pairs import meeting_boxes
from kinform.foundation.meshes.boxes import facet_boxes, meeting_box, triangle_boxes
from kinform.model.arrays import Array, Flags, Ints


def beside(slivers: Array, vertices: Array, faces: Ints) -> Ints:
    """Those of faces (m, 3) over vertices (V, 3), ascending, whose boxes meet the box of all slivers (n, 3, 3)."""
    corners = slivers.reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    low_f, high_f = facet_boxes(vertices, faces)
    return np.flatnonzero(meeting_box(low_f, high_f, low, high))


def meeting(slivers: Array, corners: Array) -> tuple[Ints, Ints] | None:
    """(k,) each: slivers (n, 3, 3) and facets (m, 3, 3) that meet, by sliver, then by facet; one unit of length. None
    where too many are near each other to ask about all."""
    candidates = meeting_boxes(triangle_boxes(slivers), triangle_boxes(corners))
    if candidates is None or len(candidates[0]) > MET_MOST * (len(slivers) + len(corners)):
        return None
    sliver, facet = candidates
    both = [np.ascontiguousarray(triangles.transpose(1, 2, 0)) for triangles in (slivers, corners)]
    if len(sliver) > CULLED_LEAST:
        sliver, facet = _not_clearly_apart(both[0], both[1], sliver, facet)
    first, second = (triangles.take(chosen, axis=2) for triangles, chosen in zip(both, (sliver, facet), strict=True))
    origin = first[0].copy()
    first -= origin
    second -= origin
    edges = _edges(first), _edges(second)
    normals = [_cross(sides[0], sides[1]) for sides in edges]
    triangles, met = [first, second, *edges, *normals], np.arange(len(sliver))
    for directions in _MANY if len(sliver) > MET_FEW else _FEW:
        kept = np.flatnonzero(~_apart(directions(*triangles[2:]), *triangles[:2]))
        met, triangles = met[kept], [array.take(kept, axis=-1) for array in triangles]
    return sliver[met], facet[met]


def _not_clearly_apart(first: Array, second: Array, one: Ints, two: Ints) -> tuple[Ints, Ints]:
    """Those of pairs of triangles `one` (c,) of (3, 3, n) and `two` (c,) of (3, 3, m) that neither lie on one side of
    the plane of the other nor beyond one of its edges, by more than rounding: all that meet among them.

    What is asked of a triangle is computed once for all of its pairs, which leaves few to be asked exactly.
    """
    origin = first[0, :, :1]
    first, second = first - origin, second - origin
    size = max(float(np.abs(first).max()), float(np.abs(second).max()))
    for some in (_planes, _borders):
        for mine, other, turned in ((second, first, False), (first, second, True)):
            owner, asked = (one, two) if turned else (two, one)
            kept = ~_beyond(some(mine, size), owner, [corner.take(asked, axis=1) for corner in other])
            one, two = one[kept], two[kept]
    return one, two


_Sides = list[tuple[Array, Array]]
"""Directions (3, n), and how far along them (n,) triangles reach at most, rounding included."""


def _beyond(sides: _Sides, owner: Ints, corners: list[Array]) -> Flags:
    """(c,) whether all corners, (3, c) each, lie beyond a side of the triangle that is their `owner` (c,)."""
    out = np.zeros(len(owner), dtype=bool)
    for axis, reach in sides:
        x, y, z = axis.take(owner, axis=1)
        one, two, three = (_along(x, y, z, corner) for corner in corners)
        out |= np.minimum(np.minimum(one, two), three) > reach.take(owner)
    return out


def _planes(triangles: Array, size: float) -> _Sides:
    """Both sides of the planes of triangles (3, 3, n); `size` bounds all coordinates."""
    edges = _edges(triangles)
    normal, long = _cross(edges[0], edges[1]), np.abs(edges).max(axis=(0, 1))
    spare = size * (CLEARLY_APART * np.abs(normal).max(axis=0) + CLEARLY_ROUNDED * long**2)
    x, y, z = normal
    offset = _along(x, y, z, triangles[0])
    return [(normal, offset + spare), (-normal, spare - offset)]


def _borders(triangles: Array, size: float) -> _Sides:
    """What lies across each edge in the plane of its triangle."""
    edges = _edges(triangles)
    normal, long = _cross(edges[0], edges[1]), np.abs(edges).max(axis=(0, 1))
    out = []
    for edge, corner in zip(edges, triangles, strict=True):
        x, y, z = across = _cross(edge, normal)
        spare = size * (CLEARLY_APART * np.abs(across).max(axis=0) + CLEARLY_ROUNDED * long**3)
        out.append((across, _along(x, y, z, corner) + spare))
    return out


def crossing(first: Array, second: Array) -> bool | None:
    """Whether any triangles (n, 3, 3) and (m, 3, 3) meet: of many, some of the first are asked before all are, which
    settles it where much crosses. None as above."""
    first, second = _mutual(first, second)
    if len(first) * len(second) > CROSSED_FEW:
        some = first[:: max(CROSSED_SOME, -(-len(first) * len(second) // CROSSED_FEW))]
        met = meeting(*_mutual(some, second))
        if met is not None and len(met[0]):
            return True
    met = meeting(first, second)
    return None if met is None else bool(len(met[0]))


def _mutual(first: Array, second: Array) -> tuple[Array, Array]:
    """Those of triangles (n, 3, 3) and (m, 3, 3), in their order, that may meet some of the others by the box of all of
    these; neither of none."""
    low, high = triangle_boxes(second)
    first = _within(first, low.min(axis=0), high.max(axis=0))
    if not len(first):
        return first, second[:0]
    low, high = triangle_boxes(first)
    return first, _within(second, low.min(axis=0), high.max(axis=0))


def _within(triangles: Array, low: Array, high: Array) -> Array:
    """Those of triangles (n, 3, 3) whose boxes meet that from `low` to `high` (3,)."""
    return np.asarray(triangles[meeting_box(*triangle_boxes(triangles), low, high)])


def _edges(triangles: Array) -> Array:
    """(3, 3, c) edges of triangles (3, 3, c), one after the other."""
    return np.asarray(triangles[[1, 2, 0]] - triangles)


def _cross(a: Array, b: Array) -> Array:
    """(3, …) products of vectors by their coordinates (3, …), broadcast."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[j], b[k], out=out[i])
        out[i] -= a[k] * b[j]
    return out


def _normals(one: Array, two: Array, normal: Array, other: Array) -> Array:
    """(3, 2, c) the normals (3, c) of two triangles, of which also the edges (3, 3, c) are given, as below."""
    return np.stack([normal, other], axis=1)


def _in_planes(one: Array, two: Array, normal: Array, other: Array) -> Array:
    """(3, 6, c) directions across an edge in the plane of its triangle."""
    out = np.empty((3, 6, one.shape[2]))
    out[:, :3] = _cross(one.transpose(1, 0, 2), normal[:, None])
    out[:, 3:] = _cross(two.transpose(1, 0, 2), other[:, None])
    return out


def _products(one: Array, two: Array, normal: Array, other: Array) -> Array:
    """(3, 9, c) directions across an edge of either."""
    return _cross(one.transpose(1, 0, 2)[:, :, None], two.transpose(1, 0, 2)[:, None]).reshape(3, 9, -1)


def _across(one: Array, two: Array, normal: Array, other: Array) -> Array:
    """(3, 15, c) both."""
    return np.concatenate([_products(one, two, normal, other), _in_planes(one, two, normal, other)], axis=1)


_FEW, _MANY = (_normals, _across), (_normals, _in_planes, _products)
"""Directions that are asked together. Of many triangles, most are parted by the first of them."""


def _apart(axes: Array, first: Array, second: Array) -> Flags:
    """(c,) whether any of the axes (3, k, c) parts the triangles (3, 3, c): those that touch are not apart."""
    (low, high), (low_other, high_other) = _reach(axes, first), _reach(axes, second)
    return np.asarray(((low > high_other) | (low_other > high)).any(axis=0))


def _reach(axes: Array, triangles: Array) -> tuple[Array, Array]:
    """(k, c) least and greatest of the corners of triangles (3, 3, c) along axes (3, k, c)."""
    x, y, z = axes
    one, two, three = (_along(x, y, z, corner) for corner in triangles)
    return np.minimum(np.minimum(one, two), three), np.maximum(np.maximum(one, two), three)


def _along(x: Array, y: Array, z: Array, corner: Array) -> Array:
    """(k, c) places of corners (3, c) along directions by their coordinates (k, c)."""
    out = x * corner[0]
    out += y * corner[1]
    out += z * corner[2]
    return np.asarray(out)
