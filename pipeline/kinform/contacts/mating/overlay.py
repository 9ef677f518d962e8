"""Where two sets of facets lie over each other on one analytic surface, as points with areas.

Both sets are drawn in the surface's chart, intersected as polygons (manifold3d's cross-sections), and
the result is cut into triangles, which are gathered into bins of a grid. A triangle counts with 3/4 of
its area at its centroid and 1/12 at each corner, which is exact for quadratic functions; each bin then
stands at its mean, so that areas and first moments carry no sampling noise. The rim of the patch, which
bounds the cone of separating motions, stays as points of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from manifold3d import CrossSection, FillRule, triangulate
from numpy.typing import NDArray

from kinform.contacts import constants
from kinform.contacts.mating.charts import Chart
from kinform.foundation.algebra.vectors import lengths
from kinform.foundation.meshes.boxes import meeting_box, middles, triangle_boxes
from kinform.foundation.sorting import heads, numbered
from kinform.model.arrays import Array, Flags, Ints


def _signed(corners: Array) -> Array:
    """(n,) m² areas of triangles (n, 3, 2), positive where they run left about."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]))


def _means(points: Array, weights: Array, group: Ints, count: int) -> tuple[Array, Array]:
    """Weighted mean (count, 2) and total weight (count,) of the points of each group."""
    total = np.bincount(group, weights=weights, minlength=count)
    sums = np.empty((count, 2))
    for k in range(2):
        sums[:, k] = np.bincount(group, weights=weights * points[:, k], minlength=count)
    sums /= np.where(total > 0.0, total, 1.0)[:, None]
    return sums, np.asarray(total, np.float64)


@dataclass(frozen=True, eq=False)
class Cells:
    """Triangles of an overlap in the chart, gathered into bins."""

    corners: Array
    """(k, 3, 2) m."""
    bins: Ints
    """(k,) bin of each triangle; every number from 0 occurs."""
    rim: Array
    """(r, 2) m: corners that bound the overlap."""
    unit: float
    """m: the contact tolerance."""
    narrow: bool = False
    """Whether all of the overlap is narrower than what is thin in any case."""

    @cached_property
    def areas(self) -> Array:
        """(k,) m²."""
        return np.abs(_signed(self.corners))

    @cached_property
    def centroids(self) -> Array:
        """(k, 2) m."""
        return middles(self.corners)

    def probes(self) -> Array:
        """(bins, 2) m: for each bin the centroid, of its triangles, that is nearest to its mean."""
        centroids = self.centroids
        mean, _ = _means(centroids, self.areas, self.bins, int(self.bins.max()) + 1)
        off = lengths(centroids - mean[self.bins])
        order = np.lexsort((off, self.bins))
        return np.asarray(centroids[order[heads(self.bins[order])]])

    def kept(self, triangles: Flags) -> Cells:
        """Only the flagged triangles (k,), their bins renumbered, and the rim that they touch."""
        corners = self.corners[triangles]
        seen = np.zeros(int(self.bins.max(initial=-1)) + 1, bool)
        seen[self.bins[triangles]] = True
        bins = (np.cumsum(seen) - 1)[self.bins[triangles]]
        # numpy sorts numbers of two parts several times slower than Python looks them up
        touched = set(self._keys(corners.reshape(-1, 2)).tolist())
        rim = [key in touched for key in self._keys(self.rim).tolist()]
        return Cells(corners, bins, self.rim[np.array(rim, dtype=bool)], self.unit, self.narrow)

    def _keys(self, points: Array) -> NDArray[np.complex128]:
        """One number a point (n, 2), the same for points that are one."""
        grid = np.ascontiguousarray(points / (constants.POINT_SAME * self.unit))
        return np.rint(grid, out=grid).view(np.complex128)[:, 0]

    def quadrature(self) -> tuple[Array, Array]:
        """Points (n, 2) m and the area (n,) m² each stands for: bins in order, then the rim."""
        count = int(self.bins.max()) + 1
        corners = self.corners.reshape(-1, 2)
        shares = np.repeat(self.areas / 12.0, 3)
        keys, every = self._keys(corners), self._keys(self.rim)
        order = every.argsort(kind="stable")
        rim_first = order[heads(every[order])]
        rim_keys = every[rim_first]
        at = np.minimum(rim_keys.searchsorted(keys), max(len(rim_keys) - 1, 0))
        on_rim = rim_keys[at] == keys if len(rim_keys) else np.zeros(len(keys), dtype=bool)
        rim_shares = np.bincount(at[on_rim], weights=shares[on_rim], minlength=len(rim_keys))
        inner = np.flatnonzero(~on_rim)
        points = np.concatenate([self.centroids, corners.take(inner, axis=0)])
        weights = np.concatenate([0.75 * self.areas, shares[inner]])
        mean, total = _means(points, weights, np.concatenate([self.bins, self.bins[inner // 3]]), count)
        return np.concatenate([mean, self.rim[rim_first]]), np.concatenate([total, rim_shares])


def _region(flat: Array, unit: float) -> CrossSection:
    """The union of triangles (n, 3, 2), in units of `unit` (m)."""
    signed = _signed(flat)
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


def _split(corners: Array, size: Array) -> Array:
    """Halve triangles (2, 3, n), coordinate by corner, at their longest edge, in units of `size` (2,), until no edge is
    longer than it."""
    small: list[Array] = []
    while True:
        edges = corners - corners[:, _NEXT]
        edges /= size[:, None, None]
        edges *= edges
        length = np.sqrt(edges[0] + edges[1])
        large = np.logical_or.reduce(length > 1.0)
        rows = np.flatnonzero(large)
        if not len(rows):
            return np.concatenate([*small, corners], axis=2) if small else corners
        if len(rows) < len(large):
            small.append(corners[:, :, ~large])
            corners, length = corners[:, :, rows], length[:, rows]
        corner, every = length.argmax(axis=0), np.arange(len(rows))
        begin, end, third = corners[:, corner, every], corners[:, _NEXT[corner], every], corners[:, corner - 1, every]
        corners = np.empty((2, 3, 2 * len(rows)))
        corners[:, 0, : len(rows)] = begin
        corners[:, 1, : len(rows)] = corners[:, 0, len(rows) :] = 0.5 * (begin + end)
        corners[:, 1, len(rows) :] = end
        corners[:, 2, : len(rows)] = corners[:, 2, len(rows) :] = third


_NEXT = np.array([1, 2, 0])
"""The corner of a triangle that follows on each."""


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


def overlay(chart: Chart, first: Array, second: Array, tolerance: float, thin: float = 0.0) -> Cells | None:
    """Overlap of the facets `first` (n, 3, 3) and `second` (m, 3, 3) in the chart; None where there is none.

    `tolerance` (m) sets what is too thin or too small to be a patch, `thin` (m) what is thin in any case: pieces that
    are narrower than this are left out beside others, and are `narrow` where there are no others.
    """
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
    area = float(np.abs(_signed(corners)).sum())
    size = np.minimum(step, math.sqrt(area / constants.PATCH_BINS))
    corners = _split(np.ascontiguousarray(corners.T), size)
    held = _signed(corners.T) != 0.0
    if not held.all():
        corners = corners[:, :, held]
    # Bins are counted from the region's own corner, so that they move with it.
    place = corners[:, 0] + corners[:, 1]
    place += corners[:, 2]
    place /= 3.0
    place -= corners.reshape(2, -1).min(axis=1)[:, None]
    place /= size[:, None]
    cells = np.floor(place, out=place).astype(np.int64)
    across, along = (cells.max(axis=1) + 1).tolist()
    _, bins = numbered(cells[0] * along + cells[1], across * along)
    rim = _rim([polygon for polygons in pieces for polygon in polygons], flat)
    corners = np.ascontiguousarray((corners * tolerance).T)
    return Cells(corners, bins, rim * tolerance, tolerance, narrow)
