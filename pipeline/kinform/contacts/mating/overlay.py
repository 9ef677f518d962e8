"""Where two sets of facets lie over each other on one analytic surface, as points with areas.

Both sets are drawn in the surface's chart, intersected as polygons (manifold3d's cross-sections), and
the result is cut into triangles, which `cells` gathers into bins of a grid. The rim of the patch, which
bounds the cone of separating motions, stays as points of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from manifold3d import CrossSection, FillRule, triangulate

from kinform.contacts import constants
from kinform.contacts.mating.cells import Cells, Cut, gathered, signed_areas
from kinform.contacts.mating.charts import Chart
from kinform.foundation.algebra.vectors import lengths
from kinform.foundation.meshes.boxes import meeting_box, triangle_boxes
from kinform.foundation.sorting import numbered
from kinform.model.arrays import Array, Ints


def _region(flat: Array, unit: float) -> CrossSection:
    """The union of triangles (n, 3, 2), in units of `unit` (m)."""
    signed = signed_areas(flat)
    turned = signed < 0.0
    flat = (np.where(turned[:, None, None], flat[:, ::-1], flat) if turned.any() else flat) / unit
    large = np.abs(signed) > 1e-12 * unit * unit
    flat = np.ascontiguousarray(flat if large.all() else flat[large])
    return CrossSection(_outline(flat) if len(flat) > constants.MANY_TRIANGLES else list(flat), FillRule.Positive)


def _outline(flat: Array) -> list[Array]:
    """Closed loops around triangles (n, 3, 2) of positive area: edges that no other triangle runs the other way.

    They wind about every point as often as the triangles do, and there are far fewer of them.
    """
    cells = np.round(flat.reshape(-1, 2) / constants.POINT_SAME)
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
    if int(np.bincount(leaving).max(initial=0)) == 1:
        return _simple_loops(points, leaving, reaching)
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


def _simple_loops(points: Array, leaving: Ints, reaching: Ints) -> list[Array]:
    """The loops of edges (k,), no two of which leave one corner, each from its lowest corner on."""
    onward = np.full(len(points), -1)
    onward[leaving] = reaching
    after, seen = onward.tolist(), bytearray(len(points))
    loops = []
    for begin in np.sort(leaving).tolist():
        if seen[begin]:
            continue
        loop, at = [begin], after[begin]
        while at != begin:
            loop.append(at)
            seen[at] = True
            at = after[at]
        if len(loop) > 2:
            loops.append(points[loop])
    return loops


def _perimeter(polygons: list[Array]) -> float:
    """m of all outlines."""
    edges = [np.concatenate([p[:1] - p[-1:], p[1:] - p[:-1]]) for p in polygons]
    return float(sum(lengths(along).sum() for along in edges))


def _resampled(polygon: Array, step: Array) -> Array:
    """The polygon (n, 2) with points added so that no edge is longer than `step` (2,) in any coordinate."""
    ends = np.concatenate([polygon[1:], polygon[:1]])
    if step[0] == step[1] == math.inf:
        return np.asarray(polygon + 0.0 * (ends - polygon))
    counts = np.maximum(np.ceil((np.abs(ends - polygon) / step).max(axis=1) - 1e-9), 1).astype(np.int64)
    rows = np.repeat(np.arange(len(polygon)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(len(rows)) - first) / counts[rows]
    return np.asarray(polygon[rows] + share[:, None] * (ends[rows] - polygon[rows]))


def _overlap(chart: Chart, first: Array, second: Array, unit: float) -> CrossSection | None:
    """The region, in units of `unit`, that both sets of facets cover."""
    flat_a, flat_b = chart.flatten(first), chart.flatten(second)
    if not len(flat_a) or not len(flat_b):
        return None
    boxes = [triangle_boxes(flat) for flat in (flat_a, flat_b)]
    low = np.maximum(*(lower.min(axis=0) for lower, _ in boxes))
    high = np.minimum(*(upper.max(axis=0) for _, upper in boxes))
    if (low >= high).any():
        return None
    sides = []
    for flat, box in zip((flat_a, flat_b), boxes, strict=True):
        within = meeting_box(*box, low, high)
        sides.append(_region(flat if within.all() else flat[within], unit))
    region = sides[0] ^ sides[1]
    window = chart.window()
    return region if window is None else region ^ CrossSection([window / unit], FillRule.Positive)


def _pieces(region: CrossSection, thin: float) -> list[list[Array]]:
    """The connected pieces of a region that are neither points nor narrower than `thin`, as polygons."""
    pieces = []
    for piece in region.decompose():
        polygons = [np.asarray(p) for p in piece.simplify(constants.REGION_SIMPLE).to_polygons()]
        area = piece.area()
        if polygons and area >= constants.REGION_SMALL and 2.0 * area >= thin * _perimeter(polygons):
            pieces.append(polygons)
    return pieces


def _rim(polygons: list[Array], flat: bool) -> Array:
    """Points that bound the region: of a plane the corners of its hull, else all corners; thinned evenly."""
    corners = np.concatenate(polygons)
    if flat:
        corners = np.concatenate([np.asarray(p) for p in CrossSection.hull_points(corners).to_polygons()])
    every = math.ceil(len(corners) / constants.PATCH_RIM_POINTS)
    return np.asarray(corners[::every])


def overlays(asked: Sequence[tuple[Chart, Array, Array, float, float]]) -> list[Cells | None]:
    """Overlaps of facets (n, 3, 3) and (m, 3, 3) in charts, each of (chart, first, second, tolerance, thin); None of
    those where there is none.

    The tolerance (m) sets what is too thin or too small to be a patch, `thin` (m) what is thin in any case: pieces that
    are narrower than this are left out beside others, and are `narrow` where there are no others.
    """
    cuts = [_cut(*one) for one in asked]
    cells = iter(gathered([cut for cut in cuts if cut is not None]))
    return [None if cut is None else next(cells) for cut in cuts]


def _cut(chart: Chart, first: Array, second: Array, tolerance: float, thin: float) -> Cut | None:
    """One of them, not yet gathered."""
    region = _overlap(chart, first, second, tolerance)
    if region is None:
        return None
    wide = max(constants.REGION_THIN, thin / tolerance)
    pieces = _pieces(region, wide)
    narrow = not pieces and wide > constants.REGION_THIN
    if narrow:
        pieces = _pieces(region, constants.REGION_THIN)
    if not pieces:
        return None
    step = np.array(chart.step) / tolerance
    flat = bool(np.isinf(step).all())
    triangles = []
    for number, polygons in enumerate(pieces):
        pieces[number] = [_resampled(polygon, step) for polygon in polygons]
        triangles.append(np.concatenate(pieces[number])[triangulate(pieces[number])])
    corners = np.concatenate(triangles)
    area = float(np.abs(signed_areas(corners)).sum())
    size = np.minimum(step, math.sqrt(area / constants.PATCH_BINS))
    rim = _rim([polygon for polygons in pieces for polygon in polygons], flat)
    return Cut(corners, size, rim, tolerance, narrow)
