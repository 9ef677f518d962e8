"""Triangles of overlaps in a chart, gathered into the bins of a grid: of many overlaps at once.

Large triangles are halved until none is larger than a bin. A triangle counts with 3/4 of its area at its centroid and
1/12 at each corner, which is exact for quadratic functions; each bin then stands at its mean, so that areas and first
moments carry no sampling noise. numpy takes as long to begin as it takes to go through a few hundred triangles, and a
part may have many contacts that are small: so overlaps are cut, gathered and weighed together, and what comes of one
of them does not depend on the others, to the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.vectors import NEXT, lengths
from kinform.foundation.concatenation import concatenated
from kinform.foundation.meshes.boxes import middles
from kinform.foundation.rounding import SINGLE
from kinform.foundation.sorting import heads, numbered
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class Cut:
    """An overlap as triangles in a chart, not yet gathered."""

    corners: Array
    """(n, 3, 2), in units."""
    size: Array
    """(2,) units, of a bin."""
    rim: Array
    """(r, 2) units: corners that bound the overlap."""
    unit: float
    """m."""
    narrow: bool


def signed_areas(corners: Array) -> Array:
    """(n,) of triangles (n, 3, 2), positive where they run left about."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]))


@dataclass(frozen=True, eq=False)
class Cells:
    """Triangles of an overlap in the chart, gathered into bins."""

    corners: Array
    """(k, 3, 2) m."""
    areas: Array
    """(k,) m²."""
    centroids: Array
    """(k, 2) m."""
    bins: Ints
    """(k,) bin of each triangle; every number from 0 occurs."""
    count: int
    """Bins."""
    rim: Array
    """(r, 2) m: corners that bound the overlap."""
    unit: float
    """m: the contact tolerance."""
    narrow: bool = False
    """Whether all of the overlap is narrower than what is thin in any case."""

    def kept(self, triangles: Flags) -> Cells:
        """Only the flagged triangles (k,), their bins renumbered, and the rim that they touch."""
        rows = np.flatnonzero(triangles)
        corners, bins = self.corners.take(rows, axis=0), self.bins.take(rows)
        seen = np.zeros(self.count, bool)
        seen[bins] = True
        places = np.cumsum(seen) - 1
        # numpy sorts numbers of two parts several times slower than Python looks them up
        touched = set(_keys(corners.reshape(-1, 2), self.unit).tolist())
        rim = [key in touched for key in _keys(self.rim, self.unit).tolist()]
        return Cells(
            corners, self.areas.take(rows), self.centroids.take(rows, axis=0), places[bins], int(seen.sum()),
            self.rim[np.array(rim, dtype=bool)], self.unit, self.narrow,
        )  # fmt: skip


def gathered(cuts: Sequence[Cut]) -> list[Cells]:
    """The cells of overlaps, each of which has an area."""
    if not cuts:
        return []
    owner = np.repeat(np.arange(len(cuts)), [len(cut.corners) for cut in cuts])
    size = np.array([cut.size for cut in cuts]).T
    corners, owner = _split(np.ascontiguousarray(concatenated([cut.corners for cut in cuts]).T), size, owner)
    held = signed_areas(corners.T) != 0.0
    if not held.all():
        corners, owner = corners[:, :, held], owner[held]
    starts = np.flatnonzero(heads(owner))
    # bins are counted from the region's own corner, so that they move with it
    place = corners[:, 0] + corners[:, 1]
    place += corners[:, 2]
    place /= 3.0
    place -= np.minimum.reduceat(corners.min(axis=1), starts, axis=1).take(owner, axis=1)
    place /= size.take(owner, axis=1)
    cells = np.floor(place, out=place).astype(np.int64)
    across, along = np.maximum.reduceat(cells, starts, axis=1) + 1
    before = np.cumsum(across * along)
    offset = before - across * along
    _, bins = numbered(offset.take(owner) + cells[0] * along.take(owner) + cells[1], int(before[-1]))
    first = np.minimum.reduceat(bins, starts)
    counts = np.diff(first, append=bins.max() + 1).tolist()
    bins -= first.take(owner)
    corners *= np.array([cut.unit for cut in cuts]).take(owner)
    flat = np.ascontiguousarray(corners.T)
    areas, centroids = np.abs(signed_areas(flat)), middles(flat)
    ends = [*starts.tolist(), len(owner)]
    return [
        Cells(
            flat[i:j], areas[i:j], centroids[i:j], bins[i:j], counts[k], cut.rim * cut.unit, cut.unit, cut.narrow
        )
        for k, (cut, i, j) in enumerate(zip(cuts, ends[:-1], ends[1:], strict=True))
    ]  # fmt: skip


def _split(corners: Array, size: Array, owner: Ints) -> tuple[Array, Ints]:
    """Halve triangles (2, 3, n), coordinate by corner, at their longest edge, in units of the `size` (2, cuts) of their
    `owner` (n,), until no edge is longer than it; by owner."""
    small, owners = [], []
    while True:
        edges = corners - corners[:, NEXT]
        edges /= size.take(owner, axis=1)[:, None]
        edges *= edges
        length = np.sqrt(edges[0] + edges[1])
        large = np.logical_or.reduce(length > 1.0)
        rows = large.nonzero()[0]
        count = len(rows)
        if not count:
            break
        if count < len(large):
            left = (~large).nonzero()[0]
            small.append(corners.take(left, axis=2))
            owners.append(owner.take(left))
            corners, length, owner = corners.take(rows, axis=2), length.take(rows, axis=1), owner.take(rows)
        corner, every = length.argmax(axis=0), np.arange(count)
        begin, end, third = corners[:, corner, every], corners[:, NEXT[corner], every], corners[:, corner - 1, every]
        corners = np.empty((2, 3, 2 * count))
        corners[:, 0, :count] = begin
        corners[:, 1, :count] = corners[:, 0, count:] = 0.5 * (begin + end)
        corners[:, 1, count:] = end
        corners[:, 2, :count] = corners[:, 2, count:] = third
        owner = np.concatenate([owner, owner])
    if small:
        corners, owner = np.concatenate([*small, corners], axis=2), np.concatenate([*owners, owner])
    if size.shape[1] > 1:
        order = owner.argsort(kind="stable")
        corners, owner = corners.take(order, axis=2), owner.take(order)
    return corners, owner


def probed(every: Sequence[Cells]) -> list[Array]:
    """(bins, 2) m, of each of some cells: for each bin the centroid, of its triangles, that is nearest to its mean."""
    centroids, (bins, ends) = concatenated([cells.centroids for cells in every]), _together(every)
    mean, _ = _means(centroids, concatenated([cells.areas for cells in every]), bins, ends[-1])
    off = lengths(centroids - mean.take(bins, axis=0))
    order = np.lexsort((off, bins))
    chosen = centroids.take(order[heads(bins.take(order))], axis=0)
    return [chosen[i:j] for i, j in zip(ends[:-1], ends[1:], strict=True)]


def quadratures(every: Sequence[Cells]) -> list[tuple[Array, Array]]:
    """Points (n, 2) m and the area (n,) m² each stands for, of each of some cells: bins in order, then the rim."""
    centroids, (bins, ends) = concatenated([cells.centroids for cells in every]), _together(every)
    areas = concatenated([cells.areas for cells in every])
    corners = concatenated([cells.corners for cells in every]).reshape(-1, 2)
    shares = np.repeat(areas / 12.0, 3)
    inside, rims, start = np.ones(len(corners), bool), [], 0
    for cells in every:
        end = start + 3 * len(cells.areas)
        keys, about = _keys(corners[start:end], cells.unit), _keys(cells.rim, cells.unit)
        order = about.argsort(kind="stable")
        first = order[heads(about.take(order))]
        found = about.take(first)
        at = np.minimum(found.searchsorted(keys), max(len(found) - 1, 0))
        on_rim = (found.take(at) == keys).nonzero()[0] if len(found) else np.zeros(0, np.int64)
        inside[start + on_rim] = False
        rims.append((cells.rim.take(first, axis=0), np.bincount(at[on_rim], shares[start + on_rim], len(found))))
        start = end
    inner = inside.nonzero()[0]
    points = np.concatenate([centroids, corners.take(inner, axis=0)])
    weights = np.concatenate([0.75 * areas, shares.take(inner)])
    mean, total = _means(points, weights, np.concatenate([bins, bins.take(inner // 3)]), ends[-1])
    return [
        (np.concatenate([mean[i:j], rim]), np.concatenate([total[i:j], shares]))
        for i, j, (rim, shares) in zip(ends[:-1], ends[1:], rims, strict=True)
    ]


def _together(every: Sequence[Cells]) -> tuple[Ints, list[int]]:
    """(k,) the bins of all triangles of some cells, those of each following on those before, and where they end."""
    ends = [0]
    for cells in every:
        ends.append(ends[-1] + cells.count)
    if len(every) == 1:
        return every[0].bins, ends
    return np.concatenate([cells.bins + start for cells, start in zip(every, ends, strict=False)]), ends


def _keys(points: Array, unit: float) -> NDArray[np.complex128]:
    """One number a point (n, 2) m, the same for points that are one."""
    grid = np.ascontiguousarray(points / (SINGLE * unit))
    return np.rint(grid, out=grid).view(np.complex128)[:, 0]


def _means(points: Array, weights: Array, group: Ints, count: int) -> tuple[Array, Array]:
    """Weighted mean (count, 2) and total weight (count,) of the points of each group."""
    total = np.bincount(group, weights=weights, minlength=count)
    sums = np.empty((count, 2))
    for k in range(2):
        sums[:, k] = np.bincount(group, weights=weights * points[:, k], minlength=count)
    sums /= np.where(total > 0.0, total, 1.0)[:, None]
    return sums, np.asarray(total, np.float64)
