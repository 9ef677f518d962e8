"""The boxes of a mesh's facets, in chunks of facets that lie together: what meets a small box is found without
asking all of them."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.constants import KEPT_FACETS
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.foundation.sorting import ascending
from kinform.model.arrays import Array, Flags, Ints

BOXES_AT_ONCE = 200_000
"""Boxes times boxes up to which all are compared with all in `boxes_within`: blocks of fewer take longer."""

CHUNK = 48
"""Facets of a chunk: a box is compared with all chunks, and with the facets of those that it meets. Chosen, not
measured."""
OFTEN = 128
"""Questions up to which chunks are not made: to make them takes as long as 100 to 200 questions, for 20,000 facets as
for 400,000."""
CHUNKED_LEAST = 16_000
"""Facets up to which comparing all takes no longer than with chunks: 0.02 ms."""
GRID_FINEST = 512
"""Most cells along the side of a grid: 2 MB of counts."""
GRID_LISTED = 12
"""Most cells of a grid that a facet is listed in on average: beyond, the grid is made coarser. Chosen, not measured."""
UNLISTED = 32
"""Comparisons of points with boxes a facet that together cost as much as making a grid."""
COMPARED_MOST = 8000
"""Comparisons of points with boxes that take no longer than finding out which of them are not needed."""
SIZE_OCTAVES = 20
"""Octaves of size that facets are sorted by: down to a millionth of the whole, where files end."""
PLACE_BITS = 10
"""Bits of a coordinate along the Z-curve that facets are sorted along: three coordinates fit into 31 bits, which numpy
sorts in half of the time."""
ROWS_TOGETHER = 64
"""Rows that are viewed as one wide row for the least and the greatest of each column. Chosen, not measured."""
BOXES_MATRIX = 600_000
"""Boxes times boxes, or times points, up to which all of one kind are compared with all of another; of more, so many at
once: 30 MB."""
BOXES_A_BLOCK = 64
"""Neighbouring boxes that are compared together with what comes near them. Chosen, not measured."""


def bounds(points: NDArray[np.floating]) -> tuple[Array, Array]:
    """Least and greatest of each column (d,) of points (n, d), n > 0.

    Rows are taken together to wide ones first: numpy goes through narrow ones a hundred times slower.
    """
    count, width = points.shape
    wide = count // ROWS_TOGETHER * ROWS_TOGETHER
    together = np.ascontiguousarray(points[:wide]).reshape(-1, ROWS_TOGETHER * width)
    rest = points[wide:]
    low = np.concatenate([together.min(axis=0).reshape(-1, width), rest]) if wide else rest
    high = np.concatenate([together.max(axis=0).reshape(-1, width), rest]) if wide else rest
    return low.min(axis=0), high.max(axis=0)


def box_corners(low: Array, high: Array, X: Array) -> Array:
    """(8, 3) corners of a box from `low` to `high` (3,), at the pose X (4, 4)."""
    bits = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
    return np.asarray(np.where(bits, high, low) @ X[:3, :3].T + X[:3, 3])


def facet_boxes(points: Array, faces: Ints) -> tuple[Array, Array]:
    """Lower and upper corners (n, d) of the boxes of faces (n, 3) over points (V, d); of values (V,) least and
    greatest."""
    first, second, third = (points.take(corner, axis=0) for corner in faces.T)
    return np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)


def triangle_boxes(corners: Array) -> tuple[Array, Array]:
    """Lower and upper corners (n, …) of the boxes of triangles (n, 3, …), the least and greatest of three: by columns,
    numpy being slow along short rows."""
    first, second, third = (corners[:, corner] for corner in range(3))
    return np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)


def middles(corners: Array) -> Array:
    """(n, d) means of the corners of triangles (n, 3, d), to the bits of their mean along the second axis."""
    out = corners[:, 0] + corners[:, 1]
    out += corners[:, 2]
    out /= 3.0
    return np.asarray(out)


def meeting_box(lows: Array, highs: Array, low: Array, high: Array) -> Flags:
    """(n,) whether boxes from `lows` to `highs` (n, d) meet that from `low` to `high` (d,)."""
    meets = lows[:, 0] <= high[0]
    meets &= highs[:, 0] >= low[0]
    for axis in range(1, lows.shape[1]):
        meets &= lows[:, axis] <= high[axis]
        meets &= highs[:, axis] >= low[axis]
    return np.asarray(meets)


def boxes_within(first: tuple[Array, Array], second: tuple[Array, Array], margin: float) -> Flags:
    """(n, m) whether boxes come within `margin` of each other along every axis: lowest and highest corners (n, d) of
    the first kind, (m, d) of the second. Many are compared in blocks of neighbours with what their box comes near."""
    (low_a, high_a), (low_b, high_b) = first, second
    if len(low_a) * len(low_b) <= BOXES_AT_ONCE:
        return _within(low_a, high_a, low_b, high_b, margin)
    out = np.zeros((len(low_a), len(low_b)), bool)
    order = together(low_a, high_a)
    for start in range(0, len(order), BOXES_A_BLOCK):
        rows = order[start : start + BOXES_A_BLOCK]
        low, high = low_a[rows], high_a[rows]
        columns = np.flatnonzero(_within(low.min(axis=0)[None], high.max(axis=0)[None], low_b, high_b, margin)[0])
        if len(columns):
            out[rows[:, None], columns] = _within(low, high, low_b[columns], high_b[columns], margin)
    return out


def _within(low_a: Array, high_a: Array, low_b: Array, high_b: Array, margin: float) -> Flags:
    """`boxes_within` of all with all."""
    out = np.ones((len(low_a), len(low_b)), bool)
    for axis in range(low_a.shape[1]):
        out &= low_a[:, None, axis] - high_b[None, :, axis] <= margin
        out &= low_b[None, :, axis] - high_a[:, None, axis] <= margin
    return out


class FacetBoxes:
    """Boxes (F, d) of facets, d 2 or 3, in an order of chunks by size and place once they are asked for often."""

    def __init__(self, low: Array, high: Array):
        self.low, self.high = low, high
        self._asked = 0
        self._order: Ints | None = None
        self._columns: tuple[Array, Array] | None = None

    def meeting(self, low: Array, high: Array) -> Ints:
        """Facets whose boxes meet the box from `low` to `high` (d,), ascending."""
        self._asked += 1
        if self._asked <= OFTEN or len(self.low) <= CHUNKED_LEAST:
            return np.flatnonzero(self._meeting(low, high))
        if self._order is None:
            self._columns = None
            self._order = together(self.low, self.high)
            self._starts = np.arange(0, len(self.low), CHUNK)
            self._chunk_low = np.minimum.reduceat(self.low[self._order], self._starts)
            self._chunk_high = np.maximum.reduceat(self.high[self._order], self._starts)
        chunks = np.flatnonzero(meeting_box(self._chunk_low, self._chunk_high, low, high))
        at = (self._starts[chunks, None] + np.arange(CHUNK)).ravel()
        facets = np.sort(self._order[at[at < len(self._order)]])
        return np.asarray(facets[meeting_box(self.low[facets], self.high[facets], low, high)])

    def _meeting(self, low: Array, high: Array) -> Flags:
        """(n,) of all boxes, asked column by column where these can be kept."""
        if len(self.low) > KEPT_FACETS:
            return meeting_box(self.low, self.high, low, high)
        if self._columns is None:
            self._columns = np.ascontiguousarray(self.low.T), np.ascontiguousarray(self.high.T)
        return meeting_box(self._columns[0].T, self._columns[1].T, low, high)


class FlatBoxes:
    """Boxes (F, 2) of facets in a plane, listed by the cells of a grid once many points are asked: which points are in
    which of them. With `tops` (F,), which a point must not be above, those below it need not be told."""

    def __init__(self, low: Array, high: Array, tops: Array | None = None):
        self.low, self.high, self._tops = low, high, tops
        self._sides = [np.ascontiguousarray(side) for side in (*low.T, *high.T)]
        self._left = UNLISTED * len(low)
        """Comparisons that cost less than the list does."""

    def _list(self) -> None:
        low, high = self.low, self.high
        self._origin = low.min(axis=0, initial=np.inf)
        whole = np.maximum(high.max(axis=0, initial=-np.inf) - self._origin, TINY)
        side = int(np.clip(2.0 * np.sqrt(len(low)), 1, GRID_FINEST))
        while True:
            self._cell, self._side = whole / side, side
            left, lower, right, upper = (self._cells(column, k % 2) for k, column in enumerate(self._sides))
            wide, tall = right - left + 1, upper - lower + 1
            listed = int((wide * tall).sum())
            # a few thousand entries in all cost nothing
            if side == 1 or listed <= GRID_LISTED * len(low) + 4096:
                break
            side = (side + 1) // 2
        # each box by the columns of cells that it covers, and each of these by its cells
        box, across = _counted(wide)
        column, along = _counted(tall[box])
        key = ((left[box] + across) * side + lower[box])[column] + along
        self._facets = box[column][_in_order(key, side * side)]
        self._starts = np.concatenate([[0], np.cumsum(np.bincount(key, minlength=side * side))])

    def listed_at(self, points: Array) -> int:
        """How many facets are listed in the cells of points (n, 2), all together."""
        if self._left > 0:
            self._list()
            self._left = 0
        key = self._keys(points)
        return int((self._starts[key + 1] - self._starts[key]).sum())

    def around(self, points: Array, heights: Array | None = None) -> tuple[Ints, Ints]:
        """Indices of points (n, 2), ascending, and of facets whose box they are in, ascending for each; some facets
        whose tops are below the points' `heights` (n,) are left out."""
        if self._left > 0:
            few = self._among(points, heights)
            if few is not None:
                return few
            self._list()
        key = self._keys(points)
        start = self._starts[key]
        count = self._starts[key + 1] - start
        which = np.repeat(np.arange(len(points)), count)
        facets = self._facets[np.arange(len(which)) + np.repeat(start - np.cumsum(count) + count, count)]
        x, y = points[which, 0], points[which, 1]
        left, lower, right, upper = (side[facets] for side in self._sides)
        held = np.flatnonzero((left <= x) & (right >= x) & (lower <= y) & (upper >= y))
        return which[held], facets[held]

    def _keys(self, points: Array) -> Ints:
        """(n,) the cell of each point (n, 2)."""
        return np.asarray(self._cells(points[:, 0], 0) * self._side + self._cells(points[:, 1], 1))

    def _among(self, points: Array, heights: Array | None) -> tuple[Ints, Ints] | None:
        """As above by comparison with all boxes about the points; None where that has come to cost more than a list."""
        left, lower, right, upper = self._sides
        if len(points) * len(left) <= COMPARED_MOST:
            self._left -= len(points) * len(left)
            return self._compared(points, heights) if self._left > 0 else None
        (least_x, least_y), (most_x, most_y) = points.min(axis=0, initial=np.inf), points.max(axis=0, initial=-np.inf)
        beside = (left <= most_x) & (right >= least_x) & (lower <= most_y) & (upper >= least_y)
        if heights is not None and self._tops is not None:
            beside &= self._tops >= heights.min(initial=np.inf)
        near = beside.nonzero()[0]
        # of points in their order along one of the axes, those beside a box follow each other
        orders = [np.argsort(points[:, axis], kind="stable") for axis in (0, 1)]
        ranges = []
        for axis, order in enumerate(orders):
            places = points[:, axis].take(order)
            begin = places.searchsorted(self._sides[axis].take(near))
            ranges.append((begin, places.searchsorted(self._sides[2 + axis].take(near), side="right") - begin))
        numbers = [int(number.sum()) for _, number in ranges]
        axis = 0 if numbers[0] <= numbers[1] else 1
        # a box that one axis does not exclude is compared along the other: about two comparisons
        self._left -= len(left) + 2 * numbers[axis]
        if self._left <= 0:
            return None
        which, box = self._along(points, axis, orders[axis], near, *ranges[axis])
        in_turn = ascending(which * np.int64(max(len(near), 1)) + box, len(points) * max(len(near), 1))
        return which.take(in_turn), near.take(box.take(in_turn))

    def _compared(self, points: Array, heights: Array | None) -> tuple[Ints, Ints]:
        """As above, of few: each with all."""
        left, lower, right, upper = self._sides
        x, y = points.T[:, :, None]
        held = left <= x
        for beyond in (right >= x, lower <= y, upper >= y):
            held &= beyond
        if heights is not None and self._tops is not None:
            held &= self._tops >= heights[:, None]
        which, facets = held.nonzero()
        return which, facets

    def _along(self, points: Array, axis: int, order: Ints, near: Ints, begin: Ints, number: Ints) -> tuple[Ints, Ints]:
        """Points and, by their places among those `near`, boxes, of which the points are beside a box along an axis
        that are so many `number` (m,) in their `order` (n,) from `begin` (m,) on, and are in it."""
        low, high = (self._sides[k + 1 - axis].take(near) for k in (0, 2))
        ends, out = np.cumsum(number), []
        blocks = range(0, int(ends[-1]) if len(ends) else 0, BOXES_MATRIX)
        cuts = [*ends.searchsorted(list(blocks), side="right").tolist(), len(near)] if len(blocks) else [0, len(near)]
        for i, j in pairwise(cuts):
            box = np.repeat(np.arange(i, j), number[i:j])
            first = begin[i:j] - np.cumsum(number[i:j]) + number[i:j]
            which = order.take(np.arange(len(box)) + np.repeat(first, number[i:j]))
            place = points[:, 1 - axis].take(which)
            held = low.take(box) <= place
            held &= high.take(box) >= place
            kept = held.nonzero()[0]
            out.append((which.take(kept), box.take(kept)))
        return np.concatenate([which for which, _ in out]), np.concatenate([box for _, box in out])

    def _cells(self, places: Array, axis: int) -> Ints:
        """(n,) the column or row of cells that places along an axis are in, or nearest to."""
        cell = np.floor((places - self._origin[axis]) / self._cell[axis])
        return np.asarray(np.clip(cell, 0, self._side - 1, out=cell).astype(np.int64))


def _counted(numbers: Ints) -> tuple[Ints, Ints]:
    """0, 1, 2 … each so many times as `numbers` (n,) says, and counted from 0 again for each."""
    of = np.repeat(np.arange(len(numbers)), numbers)
    return of, np.arange(len(of)) - np.repeat(np.cumsum(numbers) - numbers, numbers)


def _in_order(keys: Ints, most: int) -> Ints:
    """The stable order of keys (n,) below `most`: by 16 bits at a time, which numpy sorts by counting."""
    order = np.argsort((keys & 0xFFFF).astype(np.uint16), kind="stable")
    if most > 1 << 16:
        order = order[np.argsort((keys[order] >> 16).astype(np.uint16), kind="stable")]
    return np.asarray(order)


def together(low: Array, high: Array) -> Ints:
    """An order in which neighbours are of like size and lie together: by octave of size, then along a Z-curve."""
    if not len(low):
        return np.zeros(0, np.int64)
    size = (high - low).max(axis=1)
    whole = max(float((bounds(high)[1] - bounds(low)[0]).max()), TINY)
    octave = np.clip(np.floor(np.log2(np.maximum(size, ARITHMETIC * whole) / whole)), -SIZE_OCTAVES, 0).astype(np.int64)
    return np.lexsort((_places(low, high), -octave)).astype(np.int64)


def along_curve(low: Array, high: Array) -> Ints:
    """An order of boxes (n, d) in which neighbours lie together, whatever their size: along a Z-curve."""
    return ascending(_places(low, high), 1 << (low.shape[1] * PLACE_BITS)) if len(low) else np.zeros(0, np.int64)


def _places(low: Array, high: Array) -> Ints:
    """(n,) where the middles of boxes (n, d) are along a Z-curve."""
    dimensions, least = low.shape[1], bounds(low)[0]
    whole = max(float((bounds(high)[1] - least).max()), TINY)
    spread, code = _spread(dimensions), np.zeros(len(low), np.int64)
    for axis in range(dimensions):
        place = (0.5 * (low[:, axis] + high[:, axis]) - least[axis]) / whole * 2.0**PLACE_BITS
        code |= spread[np.clip(place, 0, 2**PLACE_BITS - 1).astype(np.int64)] << axis
    return code


@cache
def _spread(apart: int) -> Ints:
    """(2^PLACE_BITS,) numbers with their bits that far apart."""
    numbers = np.arange(1 << PLACE_BITS)
    return np.asarray(sum(((numbers >> bit) & 1) << (apart * bit) for bit in range(PLACE_BITS)))
