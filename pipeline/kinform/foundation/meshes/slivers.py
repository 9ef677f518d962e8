"""Which thin triangles meet which facets, of few of either: by their boxes, then by separating axes.

Two triangles are apart where one of seventeen directions parts them: their normals, the products of their edges, and,
where they lie in one plane, what is across an edge in it (Gottschalk, Lin & Manocha, OBBTree, SIGGRAPH 1996). FCL asks
the same of what its trees leave; to make a tree of a few hundred facets, and objects of its answers, takes longer than
to ask about all whose boxes meet. Within, triangles are (3, 3, n): corner, coordinate, triangle. numpy goes through
long rows several times faster than through rows of three.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from kinform.foundation.constants import MANY, ROWS
from kinform.foundation.meshes.box_pairs import Boxes, meeting_boxes
from kinform.foundation.meshes.boxes import meeting_box, triangle_boxes
from kinform.foundation.rounding import ARITHMETIC, SOLVED
from kinform.model.arrays import Array, Flags, Ints

CROSSED_FEW = 400_000
"""Triangles times triangles up to which all are asked whether they cross, of several pairs at once; beyond, one in so
many first that it is this. Of 277 bolts in bores that share nothing, with 150,000 to 200,000 each, 40 % of the time."""
CULLED_LEAST = 4000
"""Pairs of triangles from which on those that are clearly apart are removed first: nearly all are."""
MET_MOST = 10
"""Pairs of triangles, per triangle, from which on trees of FCL take less time than asking about each."""
CROSSED_MOST = 60
"""The same where only one crossing is asked for: two trees for it take longer than one of few slivers does."""


def beside(slivers: Array, low: Array, high: Array) -> Ints:
    """Those of facets, ascending, whose boxes from `low` to `high` (m, 3) meet the box of all slivers (n, 3, 3)."""
    corners = slivers.reshape(-1, 3)
    return np.flatnonzero(meeting_box(low, high, corners.min(axis=0), corners.max(axis=0)))


Met = tuple[Ints, Ints]
"""(k,) each: slivers and facets that meet, by sliver, then by facet."""


def meeting(slivers: Array, corners: Array) -> Met | None:
    """Those of slivers (n, 3, 3) and facets (m, 3, 3) that meet; one unit of length. None where too many are near each
    other to ask about all."""
    return meetings([(slivers, corners)])[0]


def meetings(asked: Sequence[tuple[Array, Array]], most: float | None = None) -> list[Met | None]:
    """The same of several sets of slivers with their facets, each in a frame of its own: all at once where they are
    few, for numpy takes as long to begin as it takes to go through a few hundred of them. `most`: pairs near each
    other, in all triangles, that are too many."""
    return met_among(asked, [_beside_boxes(*one, MET_MOST if most is None else most) for one in asked])


def met_among(asked: Sequence[tuple[Array, Array]], near: Sequence[Met | None]) -> list[Met | None]:
    """The same of those pairs of each set that are `near` each other by their boxes, None where these are too many."""
    told = zip(asked, near, strict=True)
    out: list[Met | None] = [None if pairs is None else _culled(*one, pairs) for one, pairs in told]
    left = [k for k, pairs in enumerate(out) if pairs is not None and len(pairs[0])]
    if not left:
        return out
    firsts, seconds, ones, twos = [], [], [], []
    begin = [0, 0]
    for k in left:
        (slivers, corners), (one, two) = asked[k], out[k]  # type: ignore[misc]
        if len(slivers) > len(one):
            slivers, one = slivers.take(one, axis=0), np.arange(len(one))
        if len(corners) > len(two):
            corners, two = corners.take(two, axis=0), np.arange(len(two))
        firsts.append(slivers)
        seconds.append(corners)
        ones.append(one + begin[0])
        twos.append(two + begin[1])
        begin = [begin[0] + len(slivers), begin[1] + len(corners)]
    one, two = np.concatenate(ones), np.concatenate(twos)
    met = _decided(firsts, seconds, one, two)
    for k, start, end in zip(left, *_spans([len(one) for one in ones]), strict=True):
        mine, kept = out[k], met[start:end].nonzero()[0]
        assert mine is not None
        out[k] = mine[0].take(kept), mine[1].take(kept)
    return out


def _spans(counts: list[int]) -> tuple[list[int], list[int]]:
    """Where each of so many begins and ends."""
    ends = list(accumulate(counts))
    return [0, *ends[:-1]], ends


def _decided(firsts: list[Array], seconds: list[Array], one: Ints, two: Ints) -> Flags:
    """Which of pairs of triangles `one` (c,) of all the first (n, 3, 3) and `two` (c,) of all the second meet."""
    first, second = (np.ascontiguousarray(np.concatenate(every).transpose(1, 2, 0)) for every in (firsts, seconds))
    # near an origin of their own, and with a bound of their own, no set is judged by the coordinates of another
    origin = np.array([triangles[0, 0] for triangles in firsts]).T
    starts = [_spans([len(triangles) for triangles in every])[0] for every in (firsts, seconds)]
    owners = [np.repeat(np.arange(len(every)), [len(t) for t in every]) for every in (firsts, seconds)]
    moved = [every - origin.take(owner, axis=1) for every, owner in zip((first, second), owners, strict=True)]
    size, other = (
        np.maximum.reduceat(np.abs(every).max(axis=(0, 1)), begin) for every, begin in zip(moved, starts, strict=True)
    )
    apart, met = _told(moved[0], moved[1], one, two, np.maximum(size, other).take(owners[1]))
    unsure = (~(apart | met)).nonzero()[0]
    if len(unsure):
        met[unsure[_not_parted(first.take(one[unsure], axis=2), second.take(two[unsure], axis=2))]] = True
    return met


def _beside_boxes(slivers: Array, corners: Array, most: float) -> Met | None:
    """Those that may meet, by their boxes; None as above."""
    return meeting_boxes(triangle_boxes(slivers), triangle_boxes(corners), most * (len(slivers) + len(corners)))


def _culled(slivers: Array, corners: Array, near: Met) -> Met:
    """Those of pairs that may meet, of many by their planes and edges."""
    if len(near[0]) <= CULLED_LEAST:
        return near
    first, second = (np.ascontiguousarray(triangles.transpose(1, 2, 0)) for triangles in (slivers, corners))
    return _not_clearly_apart(first, second, *near)


def _not_parted(first: Array, second: Array) -> Ints:
    """Which of pairs of triangles (3, 3, c) none of the directions parts, ascending."""
    origin = first[0].copy()
    first -= origin
    second -= origin
    edges = _edges(first), _edges(second)
    normals = [_cross(sides[0], sides[1]) for sides in edges]
    triangles, met = [first, second, *edges, *normals], np.arange(first.shape[2])
    for directions in _MANY if len(met) > MANY else _FEW:
        kept = (~_apart(directions(*triangles[2:]), *triangles[:2])).nonzero()[0]
        met = met[kept]
        if not len(met):
            break
        triangles = [array.take(kept, axis=-1) for array in triangles]
    return met


def _told(first: Array, second: Array, one: Ints, two: Ints, size: Array) -> tuple[Flags, Flags]:
    """Which of pairs of triangles `one` (c,) of (3, 3, n) and `two` (c,) of (3, 3, m) are clearly apart, by the plane
    of the second or across one of its edges, and which clearly meet, as the first edge of the one steeply passes into
    the other: by more than rounding, so that all directions together say the same. That is most of them. `size` (m,)
    bounds all coordinates of what each of the second is asked with."""
    # what is asked of a triangle is computed once for all of its pairs
    axes, reach, spare, square = sides_of(second, size)
    plane = np.ascontiguousarray(axes[:, 0]), reach[0], spare[0]
    edges = np.ascontiguousarray(axes[:, 1:]), reach[1:], spare[1:]
    apart, met = np.empty(len(one), bool), np.zeros(len(one), bool)
    for start in range(0, len(one), ROWS):
        mine, other = one[start : start + ROWS], two[start : start + ROWS]
        corners = first.take(mine, axis=2)
        apart[start : start + ROWS], place, rounding = _told_by_plane(corners, *_of(plane, other))
        # the plane parts half of them, of which nothing more is asked
        left = (~apart[start : start + ROWS]).nonzero()[0]
        if len(left):
            other = other.take(left)
            heights = [place[0].take(left), place[1].take(left), rounding.take(left), square.take(other)]
            beyond, through = _told_by_edges(corners.take(left, axis=2), *heights, *_of(edges, other))
            apart[start + left], met[start + left] = beyond, through
    return apart, met


def _of(sides: tuple[Array, Array, Array], owner: Ints) -> list[Array]:
    """Some of what there is of each triangle, for its pairs (c,)."""
    return [of.take(owner, axis=-1) for of in sides]


def _told_by_plane(first: Array, normal: Array, reach: Array, spare: Array) -> tuple[Flags, Array, Array]:
    """Which of triangles (3, 3, c) are clearly on one side of the plane of the other, with its normals (3, c); where
    their corners are along these (3, c), and what is more than rounding there (c,)."""
    place = normal[0] * first[:, 0]
    place += normal[1] * first[:, 1]
    place += normal[2] * first[:, 2]
    place -= reach
    begin, end, third = place
    apart = np.minimum(np.minimum(begin, end), third) > spare
    apart |= np.maximum(np.maximum(begin, end), third) < -spare
    return apart, place, spare


def _told_by_edges(
    first: Array, begin: Array, end: Array, rounding: Array, square: Array, axes: Array, reach: Array, spare: Array
) -> tuple[Flags, Flags]:
    """Which of triangles (3, 3, c) are clearly beyond one edge of the other, with what lies across each (3, 3, c), and
    which clearly meet it, as their first edge, from `begin` to `end` (c,) along its normal, passes through it."""
    place = axes[0] * first[:, 0, None]
    place += axes[1] * first[:, 1, None]
    place += axes[2] * first[:, 2, None]
    place -= reach
    one, two, three = place
    apart = np.logical_or.reduce(np.minimum(np.minimum(one, two), three) > spare)
    edge, rise = first[1] - first[0], end - begin
    edge *= edge
    met = begin * end < 0.0
    met &= np.minimum(np.abs(begin), np.abs(end)) > rounding
    met &= rise * rise > (edge[0] + edge[1] + edge[2]) * square
    through = one - (begin / np.where(met, rise, 1.0)) * (two - one)
    met &= np.logical_and.reduce(through < -spare)
    return apart, met


def sides_of(triangles: Array, size: Array) -> tuple[Array, Array, Array, Array]:
    """Of triangles (3, 3, n) the normal and what lies across each edge (3, 4, n), how far along these they reach
    (4, n), what is more than rounding there (4, n), `size` (n,) being the bound of all coordinates, and the square (n,)
    of what is steep along the normal."""
    edges = _edges(triangles)
    axes = np.empty((3, 4, triangles.shape[2]))
    normal = axes[:, 0]
    normal[:] = _cross(edges[0], edges[1])
    axes[:, 1:] = _cross(edges.transpose(1, 0, 2), normal[:, None])
    corners = triangles.take(_BORDERED, axis=0)
    reach = axes[0] * corners[:, 0]
    reach += axes[1] * corners[:, 1]
    reach += axes[2] * corners[:, 2]
    long = np.abs(edges).max(axis=(0, 1))
    rounded = size * ARITHMETIC * long * long
    spare = size * SOLVED * np.abs(axes).max(axis=0)
    spare[0] += rounded
    spare[1:] += rounded * long
    # Sine between an edge and a triangle from which on the edge clearly passes through: rounding moves the intersection
    # by no more than ten times its size, and no separating direction in which both are short is left.
    square = 0.1**2 * (normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2])
    return axes, reach, spare, square


_BORDERED = np.array([0, 0, 1, 2])
"""A corner on the plane of a triangle, and on each of its edges."""


def _not_clearly_apart(first: Array, second: Array, one: Ints, two: Ints) -> tuple[Ints, Ints]:
    """Those of pairs of triangles `one` (c,) of (3, 3, n) and `two` (c,) of (3, 3, m) that neither lie on one side of
    the plane of the other nor beyond one of its edges, by more than rounding: all that meet among them.

    What is asked of a triangle is computed once for all of its pairs, which leaves few to be asked exactly.
    """
    origin = first[0, :, :1]
    first, second = first - origin, second - origin
    size = max(float(np.abs(first).max()), float(np.abs(second).max()))
    for beyond in (_beyond_plane, _beyond_border):
        for mine, other, turned in ((second, first, False), (first, second, True)):
            owner, asked = (one, two) if turned else (two, one)
            kept = ~beyond(mine, size, owner, [corner.take(asked, axis=1) for corner in other])
            one, two = one[kept], two[kept]
    return one, two


def _beyond_plane(triangles: Array, size: float, owner: Ints, corners: list[Array]) -> Flags:
    """(c,) whether all corners, (3, c) each, lie on one side of the plane of their `owner` (c,) of triangles (3, 3, n);
    `size` bounds all coordinates."""
    edges = _edges(triangles)
    normal, long = _cross(edges[0], edges[1]), np.abs(edges).max(axis=(0, 1))
    spare = size * (SOLVED * np.abs(normal).max(axis=0) + ARITHMETIC * long**2)
    x, y, z = normal
    offset = _along(x, y, z, triangles[0])
    x, y, z = normal.take(owner, axis=1)
    one, two, three = (_along(x, y, z, corner) for corner in corners)
    out = np.minimum(np.minimum(one, two), three) > (offset + spare).take(owner)
    out |= np.maximum(np.maximum(one, two), three) < (offset - spare).take(owner)
    return np.asarray(out)


def _beyond_border(triangles: Array, size: float, owner: Ints, corners: list[Array]) -> Flags:
    """(c,) whether they all lie beyond one of its edges, in the plane of the triangle."""
    edges, out = _edges(triangles), np.zeros(len(owner), dtype=bool)
    normal, long = _cross(edges[0], edges[1]), np.abs(edges).max(axis=(0, 1))
    for edge, corner in zip(edges, triangles, strict=True):
        x, y, z = across = _cross(edge, normal)
        spare = size * (SOLVED * np.abs(across).max(axis=0) + ARITHMETIC * long**3)
        reach = _along(x, y, z, corner) + spare
        x, y, z = across.take(owner, axis=1)
        one, two, three = (_along(x, y, z, place) for place in corners)
        out |= np.minimum(np.minimum(one, two), three) > reach.take(owner)
    return out


def crossings(asked: Sequence[tuple[Array, Array]]) -> list[bool | None]:
    """`crossing` of several sets of triangles, at once where they are few."""
    mutual = [_mutual(first, second) for first, second in asked]
    few = [k for k, (first, second) in enumerate(mutual) if len(first) * len(second) <= CROSSED_FEW]
    met = dict(zip(few, meetings([mutual[k] for k in few], CROSSED_MOST), strict=True))
    return [_any(met[k]) if k in met else _crossing(*pair) for k, pair in enumerate(mutual)]


def _any(met: Met | None) -> bool | None:
    return None if met is None else bool(len(met[0]))


def crossing(first: Array, second: Array) -> bool | None:
    """Whether any triangles (n, 3, 3) and (m, 3, 3) meet. None as above."""
    return crossings([(first, second)])[0]


def _crossing(first: Array, second: Array) -> bool | None:
    """The same of many that are within each other's boxes: some of the first are asked before all are, which settles
    it where much crosses."""
    # One triangle in 64 is asked first, or fewer: where nothing crosses, all are asked after them.
    some = first[:: max(64, -(-len(first) * len(second) // CROSSED_FEW))]
    (met,) = meetings([_mutual(some, second)], CROSSED_MOST)
    if met is not None and len(met[0]):
        return True
    return _any(meetings([(first, second)], CROSSED_MOST)[0])


def _mutual(first: Array, second: Array) -> tuple[Array, Array]:
    """Those of triangles (n, 3, 3) and (m, 3, 3) that are `mutual`."""
    one, two = mutual(first, second)
    return first.take(one, axis=0), second.take(two, axis=0)


def mutual(first: Array, second: Array) -> tuple[Ints, Ints]:
    """Places, ascending, of those of triangles (n, 3, 3) and (m, 3, 3) that may meet some of the others by the box of
    all of these; neither of none."""
    return _mutual_boxes(triangle_boxes(first), triangle_boxes(second))


def near_swept(first: Array, begin: Array, end: Array, most: float) -> Met | None:
    """Those of triangles (n, 3, 3) that may, by their boxes, meet triangles whose corners go straight from `begin`
    (m, 3, 3) to `end`, anywhere on their way; None of more than `most` times as many as there are triangles."""
    (low, high), (low_end, high_end), own = triangle_boxes(begin), triangle_boxes(end), triangle_boxes(first)
    swept = np.minimum(low, low_end), np.maximum(high, high_end)
    one, two = _mutual_boxes(own, swept)
    boxes = [(low.take(rows, axis=0), high.take(rows, axis=0)) for (low, high), rows in ((own, one), (swept, two))]
    met = meeting_boxes(boxes[0], boxes[1], most * (len(one) + len(two)))
    return None if met is None else (one.take(met[0]), two.take(met[1]))


def _mutual_boxes(first: Boxes, second: Boxes) -> tuple[Ints, Ints]:
    """`mutual` of triangles with these boxes."""
    (low, high), (low_other, high_other) = first, second
    near = meeting_box(low, high, low_other.min(axis=0), high_other.max(axis=0)).nonzero()[0]
    if not len(near):
        return near, near
    least, most = low.take(near, axis=0).min(axis=0), high.take(near, axis=0).max(axis=0)
    return near, meeting_box(low_other, high_other, least, most).nonzero()[0]


def _edges(triangles: Array) -> Array:
    """(3, 3, c) edges of triangles (3, 3, c), one after the other."""
    return np.asarray(triangles[[1, 2, 0]] - triangles)


def _cross(a: Array, b: Array) -> Array:
    """(3, …) products of vectors by their coordinates (3, …), broadcast."""
    out = np.empty(a.shape if a.shape == b.shape else np.broadcast(a, b).shape)
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
