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
from kinform.foundation.meshes.boxes import meeting_box, middles, triangle_boxes
from kinform.foundation.sorting import numbered
from kinform.model.arrays import Array, Flags, Ints


def _signed(corners: Array) -> Array:
    """(n,) m² areas of triangles (n, 3, 2), positive where they run left about."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]))


def _means(points: Array, weights: Array, group: Ints, count: int) -> tuple[Array, Array]:
    """Weighted mean (count, 2) and total weight (count,) of the points of each group."""
    total = np.bincount(group, weights=weights, minlength=count)
    sums = [np.bincount(group, weights=weights * points[:, k], minlength=count) for k in range(2)]
    return np.stack(sums, axis=1) / np.where(total > 0.0, total, 1.0)[:, None], np.asarray(total, np.float64)


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
        off = np.linalg.norm(centroids - mean[self.bins], axis=1)
        order = np.lexsort((off, self.bins))
        _, first = np.unique(self.bins[order], return_index=True)
        return np.asarray(centroids[order[first]])

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
        grid = np.round(points / (constants.POINT_SAME * self.unit))
        return np.asarray(grid[:, 0] + 1j * grid[:, 1])

    def quadrature(self) -> tuple[Array, Array]:
        """Points (n, 2) m and the area (n,) m² each stands for: bins in order, then the rim."""
        count = int(self.bins.max()) + 1
        corners = self.corners.reshape(-1, 2)
        shares = np.repeat(self.areas / 12.0, 3)
        rim_keys, rim_first = np.unique(self._keys(self.rim), return_index=True)
        keys = self._keys(corners)
        at = np.minimum(np.searchsorted(rim_keys, keys), max(len(rim_keys) - 1, 0))
        on_rim = rim_keys[at] == keys if len(rim_keys) else np.zeros(len(keys), dtype=bool)
        rim_shares = np.bincount(at[on_rim], weights=shares[on_rim], minlength=len(rim_keys))
        inner, inner_shares = corners[~on_rim], shares[~on_rim]
        points = np.concatenate([self.centroids, inner])
        weights = np.concatenate([0.75 * self.areas, inner_shares])
        mean, total = _means(points, weights, np.concatenate([self.bins, np.repeat(self.bins, 3)[~on_rim]]), count)
        return np.concatenate([mean, self.rim[rim_first]]), np.concatenate([total, rim_shares])


def _region(flat: Array, unit: float) -> CrossSection:
    """The union of triangles (n, 3, 2), in units of `unit` (m)."""
    signed = _signed(flat)
    flat = np.where((signed < 0.0)[:, None, None], flat[:, ::-1], flat) / unit
    flat = np.ascontiguousarray(flat[np.abs(signed) > 1e-12 * unit * unit])
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
    return float(sum(np.linalg.norm(along, axis=1).sum() for along in edges))


def _resampled(polygon: Array, step: Array) -> Array:
    """The polygon (n, 2) with points added so that no edge is longer than `step` (2,) in any coordinate."""
    ends = np.concatenate([polygon[1:], polygon[:1]])
    counts = np.maximum(np.ceil((np.abs(ends - polygon) / step).max(axis=1) - 1e-9), 1).astype(np.int64)
    rows = np.repeat(np.arange(len(polygon)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(len(rows)) - first) / counts[rows]
    return np.asarray(polygon[rows] + share[:, None] * (ends[rows] - polygon[rows]))


def _split(corners: Array, size: Array) -> Array:
    """Halve triangles at their longest edge, in units of `size` (2,), until no edge is longer than it."""
    small: list[Array] = []
    while True:
        edges = (corners - corners[:, _TURNS[1]]) / size
        edges *= edges
        length = np.sqrt(edges[..., 0] + edges[..., 1])
        large = (length > 1.0).any(axis=1)
        rows = np.flatnonzero(large)
        if not len(rows):
            return np.concatenate([*small, corners]) if small else corners
        small.append(corners[~large])
        turned = corners[rows[:, None], _TURNS[length[rows].argmax(axis=1)]]
        corners = np.concatenate([turned, turned])
        corners[: len(rows), 1] = corners[len(rows) :, 0] = 0.5 * (turned[:, 0] + turned[:, 1])


_TURNS = np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])
"""Corners of a triangle in their order, from each of them on."""


def _overlap(chart: Chart, first: Array, second: Array, unit: float) -> CrossSection | None:
    """The region, in units of `unit`, that both sets of facets cover."""
    flat_a, flat_b = chart.flatten(first), chart.flatten(second)
    if not len(flat_a) or not len(flat_b):
        return None
    low = np.maximum(flat_a.min(axis=(0, 1)), flat_b.min(axis=(0, 1)))
    high = np.minimum(flat_a.max(axis=(0, 1)), flat_b.max(axis=(0, 1)))
    if (low >= high).any():
        return None
    sides = []
    for flat in (flat_a, flat_b):
        within = meeting_box(*triangle_boxes(flat), low, high)
        sides.append(_region(flat[within], unit))
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
    corners = _split(corners, size)
    corners = corners[np.abs(_signed(corners)) > 0.0]
    # Bins are counted from the region's own corner, so that they move with it.
    place = np.floor((middles(corners) - corners.min(axis=(0, 1))) / size).astype(np.int64)
    across, along = (place.max(axis=0) + 1).tolist()
    _, bins = numbered(place[:, 0] * along + place[:, 1], across * along)
    rim = _rim([polygon for polygons in pieces for polygon in polygons], flat)
    return Cells(corners * tolerance, bins, rim * tolerance, tolerance, narrow)
