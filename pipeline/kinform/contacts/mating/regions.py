"""What triangles in a chart cover, as cross-sections of manifold3d: of many sets at once.

A union of triangles takes Clipper ten times as long as one of the loops around them, which numpy finds; and numpy takes
as long to begin as it takes to go through a few hundred numbers. What comes of one set does not depend on the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from manifold3d import CrossSection, FillRule

from kinform.contacts.mating.cells import signed_areas
from kinform.foundation.algebra.vectors import NEXT
from kinform.foundation.concatenation import concatenated
from kinform.foundation.equal_rows import number_equal_rows
from kinform.foundation.rounding import ARITHMETIC, SINGLE
from kinform.foundation.sorting import numbered
from kinform.model.arrays import Array, Ints


def regions(flats: Sequence[Array], units: Sequence[float]) -> list[CrossSection]:
    """The union of each of some sets of triangles (n, 3, 2) m, in units of its unit (m)."""
    if not flats:
        return []
    flat, owner, unit = concatenated(flats), np.repeat(np.arange(len(flats)), [len(f) for f in flats]), np.array(units)
    signed, own = signed_areas(flat), unit.take(owner)
    turned = signed < 0.0
    flat = (np.where(turned[:, None, None], flat[:, ::-1], flat) if turned.any() else flat) / own[:, None, None]
    large = np.abs(signed) > ARITHMETIC * own * own
    if not large.all():
        flat, owner = flat[large], owner[large]
    ends = np.searchsorted(owner, np.arange(len(flats) + 1)).tolist()
    loops = _simple_outlines(flat, owner, len(flats))
    for k, (i, j) in enumerate(zip(ends[:-1], ends[1:], strict=True)):
        if loops[k] is None:
            own = flat[i:j]
            # of more triangles the outline is quicker to unite than all of them
            loops[k] = _outline(own) if j - i > 64 else list(np.ascontiguousarray(own))
    return [CrossSection(outline, FillRule.Positive) for outline in loops]


def _simple_outlines(flat: Array, owner: Ints, count: int) -> list[list[Array] | None]:
    """Closed loops around triangles (n, 3, 2) of positive area of `count` sets, by the set of each (n,), ascending:
    edges that no other triangle of the set runs the other way. They wind about every point as often as the triangles
    do, and there are far fewer of them. Each from its lowest corner on, and by that; None of sets in which several
    edges leave one corner."""
    points, of_point = flat.reshape(-1, 2), np.repeat(owner, 3)
    cells = np.round(points / SINGLE)
    cells += 0.0  # one zero
    first, corner = number_equal_rows([*np.ascontiguousarray(cells.T).view(np.uint64), of_point.view(np.uint64)])
    leaving, reaching, times = _one_way(corner)
    of_corner = of_point.take(first)
    out: list[list[Array] | None] = [[] for _ in range(count)]
    for k in of_corner[np.bincount(leaving, times, len(first)) > 1.0].tolist():
        out[k] = None
    x, y = cells.take(first.take(leaving), axis=0).T
    begins = leaving.take(np.lexsort((y, x, of_corner.take(leaving))))
    onward = np.full(len(first), -1)
    onward[leaving] = reaching
    after, seen = onward.tolist(), bytearray(len(first))
    places, sizes, sets = [], [], []
    for begin, k in zip(begins.tolist(), of_corner.take(begins).tolist(), strict=True):
        if seen[begin] or out[k] is None:
            continue
        loop, at = [begin], after[begin]
        while at != begin:
            loop.append(at)
            seen[at] = True
            at = after[at]
        if len(loop) > 2:
            places += loop
            sizes.append(len(loop))
            sets.append(k)
    corners, ends = points.take(first.take(np.array(places, np.int64)), axis=0), [0, *accumulate(sizes)]
    for k, start, end in zip(sets, ends, ends[1:], strict=False):
        loops = out[k]
        assert loops is not None
        loops.append(corners[start:end])
    return out


def _one_way(corner: Ints) -> tuple[Ints, Ints, Ints]:
    """Edges of triangles, by their numbered corners (3n,), that more triangles run one way than the other: the corners
    that they leave and reach, and how many more."""
    total, end = int(corner.max(initial=0)) + 1, corner.reshape(-1, 3).take(NEXT, axis=1).ravel()
    low, high = np.minimum(corner, end), np.maximum(corner, end)
    leads, edge = number_equal_rows([(low * total + high).view(np.uint64)])
    net = np.bincount(edge, np.where(corner < end, 1.0, -1.0), len(leads)).astype(np.int64)
    left = net.nonzero()[0]
    forward, one, two = net.take(left) > 0, low.take(leads.take(left)), high.take(leads.take(left))
    return np.where(forward, one, two), np.where(forward, two, one), np.abs(net.take(left))


def _outline(flat: Array) -> list[Array]:
    """The same of one set (n, 3, 2), whatever leaves its corners."""
    cells = np.round(flat.reshape(-1, 2) / SINGLE)
    order = np.lexsort((cells[:, 1], cells[:, 0]))
    fresh = np.r_[True, (cells[order[1:]] != cells[order[:-1]]).any(axis=1)]
    renamed = np.empty(len(order), np.int64)
    renamed[order] = np.cumsum(fresh) - 1
    points, count = flat.reshape(-1, 2)[order[fresh]], np.int64(fresh.sum())
    corner = renamed.reshape(-1, 3)
    start, end = renamed, np.roll(corner, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    edge, number = numbered(low * count + high, int(count) ** 2)
    net = np.bincount(number, np.where(start < end, 1.0, -1.0)).astype(np.int64)
    times = np.abs(net)
    one: Ints = np.repeat(edge // count, times)
    two: Ints = np.repeat(edge % count, times)
    forward = np.repeat(net > 0, times)
    leaving, reaching = np.where(forward, one, two), np.where(forward, two, one)
    onward: dict[int, list[int]] = {}
    for a, b in zip(leaving.tolist(), reaching.tolist(), strict=True):
        onward.setdefault(a, []).append(b)
    loops = []
    for begin in sorted(onward):
        while onward[begin]:
            # every corner is left as often as it is reached, so that a walk ends where it began
            loop, at = [begin], onward[begin].pop()
            while at != begin:
                loop.append(at)
                at = onward[at].pop()
            if len(loop) > 2:
                loops.append(points[loop])
    return loops
