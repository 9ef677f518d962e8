"""Which facets of two parts come near each other, by their boxes on a grid: everything else need not be asked.

Boxes of facets are counted into cells by their eight corners and summed along the axes, and looked up in
the same way, so that the work grows with the number of facets, whatever their size.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.meshes.boxes import meeting_box
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array, Flags, Ints


def near_boxes(low_a: Array, high_a: Array, low_b: Array, high_b: Array, margin: float) -> tuple[Flags, Flags]:
    """Which boxes (n, 3) of the first kind may come within `margin` of any (m, 3) of the second, and the reverse.

    None that does is missed; some that do not are kept.
    """
    if not len(low_a) or not len(low_b):
        return np.zeros(len(low_a), bool), np.zeros(len(low_b), bool)
    sides = [np.ascontiguousarray(side.T) for side in (low_a, high_a, low_b, high_b)]
    low = np.maximum(sides[0].min(axis=1), sides[2].min(axis=1)) - margin
    high = np.minimum(sides[1].max(axis=1), sides[3].max(axis=1)) + margin
    size = np.maximum(high - low, TINY)
    # 8 to 48 cells along the longest side, more for more boxes. Chosen, not measured
    finest = min(48, 8 + int(np.sqrt(len(low_a) + len(low_b)) / 4))
    counts = np.maximum(np.ceil(finest * size / size.max()), 1).astype(np.int64)
    placed_a, placed_b = (_cells(sides[k], sides[k + 1], 0.0, low, size, counts) for k in (0, 2))
    keep_a = _occupied(_grid(_cells(sides[2], sides[3], margin, low, size, counts), counts), placed_a)
    keep_a &= meeting_box(low_a, high_a, low, high)
    grown = _cells(sides[0][:, keep_a], sides[1][:, keep_a], margin, low, size, counts)
    keep_b = _occupied(_grid(grown, counts), placed_b)
    keep_b &= meeting_box(low_b, high_b, low, high)
    return keep_a, keep_b


def _cells(low: Array, high: Array, margin: float, origin: Array, size: Array, counts: Ints) -> Ints:
    """(2, 3, n) first and last cell of each box (3, n), grown by `margin`, inside the grid."""
    cells = np.empty((2, *low.shape))
    np.subtract(low, margin, out=cells[0])
    np.add(high, margin, out=cells[1])
    cells -= origin[:, None]
    cells /= size[:, None]
    cells *= counts[:, None]
    # without a sign, and up to a whole number, what is cut off is what rounding down leaves out
    np.maximum(cells, 0.0, out=cells)
    np.minimum(cells, (counts - 1)[:, None], out=cells)
    return cells.astype(np.int64)


def _grid(cells: Ints, counts: Ints) -> Ints:
    """Sums of occupied cells from the origin, one larger than the grid along each axis, of boxes of cells (2, 3, n)."""
    shape = counts + 1
    added, taken, size = *_corners(cells, shape), int(shape.prod())
    found = np.bincount(added.ravel(), minlength=size) - np.bincount(taken.ravel(), minlength=size)
    found = found.reshape(tuple(shape))
    for axis in range(3):
        np.cumsum(found, axis=axis, out=found)
    summed = np.zeros(tuple(shape), np.int64)
    summed[1:, 1:, 1:] = found[:-1, :-1, :-1] > 0
    for axis in range(3):
        np.cumsum(summed, axis=axis, out=summed)
    return summed


def _corners(cells: Ints, shape: Ints) -> tuple[Ints, Ints]:
    """(4, n) each: places in a flat grid of that shape of the corners of boxes of cells (2, 3, n), upper ones one
    beyond; those that count in sums, and those that are taken off."""
    places = cells.copy()
    places[1] += 1
    places[:, 0] *= shape[1] * shape[2]
    places[:, 1] *= shape[2]
    x, y, z = places[:, 0], places[:, 1], places[:, 2]
    out = np.empty((2, 4, cells.shape[2]), np.int64)
    sums = (y[0] + z[0], y[1] + z[1]), (y[0] + z[1], y[1] + z[0])
    for k, one in enumerate(sums):
        for j, other in enumerate(one):
            np.add(x[0], other, out=out[k, j])
            np.add(x[1], other, out=out[1 - k, 2 + j])
    return out[0], out[1]


def _occupied(summed: Ints, cells: Ints) -> Flags:
    """Whether any cell of each box of cells (2, 3, n) is occupied."""
    added, taken = (summed.ravel().take(corners) for corners in _corners(cells, np.array(summed.shape)))
    return np.asarray(np.add.reduce(taken, axis=0) > np.add.reduce(added, axis=0))
