"""Which thin triangles meet which facets, of few of either: by their boxes, then by separating axes.

Two triangles are apart where one of seventeen directions parts them: their normals, the products of their edges, and,
where they lie in one plane, what is across an edge in it (Gottschalk, Lin & Manocha, OBBTree, SIGGRAPH 1996). FCL asks
the same of what its trees leave; to make a tree of a few hundred facets, and objects of its answers, takes longer than
to ask about all whose boxes meet.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.boxes import facet_boxes
from kinform.model.arrays import Array, Flags, Ints


def beside(slivers: Array, vertices: Array, faces: Ints) -> Ints:
    """Those of faces (m, 3) over vertices (V, 3), ascending, whose boxes meet the box of all slivers (n, 3, 3)."""
    corners = slivers.reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    low_f, high_f = facet_boxes(vertices, faces)
    return np.flatnonzero(((low_f <= high) & (high_f >= low)).all(axis=1))


def mutual(first: Array, second: Array) -> tuple[Array, Array]:
    """Those of triangles (n, 3, 3) and (m, 3, 3), in their order, that may meet some of the others by the box of all of
    these; neither of none."""
    low, high = _boxes(second)
    first = _within(first, low.min(axis=0), high.max(axis=0))
    if not len(first):
        return first, second[:0]
    low, high = _boxes(first)
    return first, _within(second, low.min(axis=0), high.max(axis=0))


def _within(triangles: Array, low: Array, high: Array) -> Array:
    """Those of triangles (n, 3, 3) whose boxes meet that from `low` to `high` (3,)."""
    low_t, high_t = _boxes(triangles)
    return np.asarray(triangles[((low_t <= high) & (high_t >= low)).all(axis=1)])


def _boxes(triangles: Array) -> tuple[Array, Array]:
    """Lower and upper corners (n, 3) of the boxes of triangles (n, 3, 3)."""
    one, two, three = (triangles[:, k] for k in range(3))
    return np.minimum(np.minimum(one, two), three), np.maximum(np.maximum(one, two), three)


def meeting(slivers: Array, corners: Array) -> tuple[Ints, Ints]:
    """(k,) each: slivers (n, 3, 3) and facets (m, 3, 3) that meet, by sliver, then by facet; one unit of length."""
    sliver, facet = _boxes_meeting(slivers, corners)
    for part in (_apart_by_normal, _apart_by_edges):
        met = ~part(slivers[sliver], corners[facet])
        sliver, facet = sliver[met], facet[met]
    return sliver, facet


def _boxes_meeting(first: Array, second: Array) -> tuple[Ints, Ints]:
    """Pairs of triangles (n, 3, 3) and (m, 3, 3) whose boxes meet."""
    meets = np.ones((len(first), len(second)), dtype=bool)
    low, high = np.ascontiguousarray(first.min(axis=1).T), np.ascontiguousarray(first.max(axis=1).T)
    low_other, high_other = np.ascontiguousarray(second.min(axis=1).T), np.ascontiguousarray(second.max(axis=1).T)
    for axis in range(3):
        meets &= low[axis][:, None] <= high_other[axis]
        meets &= low_other[axis] <= high[axis][:, None]
    rows, columns = np.nonzero(meets)
    return rows, columns


def _edges(triangles: Array) -> Array:
    """(c, 3, 3) edges of triangles (c, 3, 3), one after the other."""
    return triangles[:, [1, 2, 0]] - triangles


def _apart_by_normal(first: Array, second: Array) -> Flags:
    """(c,) whether a normal of either triangle (c, 3, 3) parts the two."""
    origin = first[:, :1]
    first, second = first - origin, second - origin
    normals = [cross(edges[:, 0], edges[:, 1]) for edges in (_edges(first), _edges(second))]
    return _apart(np.stack(normals, axis=1), first, second)


def _apart_by_edges(first: Array, second: Array) -> Flags:
    """(c,) whether a direction across edges of the two, or across an edge in the plane of its triangle, parts them."""
    origin = first[:, :1]
    first, second = first - origin, second - origin
    one, two = _edges(first), _edges(second)
    across = cross(one[:, :, None], two[:, None]).reshape(-1, 9, 3)
    inside = [cross(edges, cross(edges[:, 0], edges[:, 1])[:, None]) for edges in (one, two)]
    return _apart(np.concatenate([across, *inside], axis=1), first, second)


def _apart(axes: Array, first: Array, second: Array) -> Flags:
    """(c,) whether any of the axes (c, k, 3) parts the triangles (c, 3, 3): those that touch are not apart."""
    (low, high), (low_other, high_other) = _reach(axes, first), _reach(axes, second)
    return np.asarray(((low > high_other) | (low_other > high)).any(axis=1))


def _reach(axes: Array, triangles: Array) -> tuple[Array, Array]:
    """(c, k) least and greatest of the corners of triangles (c, 3, 3) along axes (c, k, 3)."""
    x, y, z = (axes[:, :, k] for k in range(3))
    one, two, three = (
        x * corner[:, :1] + y * corner[:, 1:2] + z * corner[:, 2:] for corner in (triangles[:, k] for k in range(3))
    )
    return np.minimum(np.minimum(one, two), three), np.maximum(np.maximum(one, two), three)
