"""Which facets of two parts come near each other, by their boxes on a grid: everything else need not be asked.

Boxes of facets are counted into cells by their eight corners and summed along the axes, and looked up in
the same way, so that the work grows with the number of facets, whatever their size.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.constants import CELLS_LEAST, CELLS_MOST
from kinform.foundation.meshes.boxes import bounds, meeting_box
from kinform.model.arrays import Array, Flags, Ints


def near_boxes(low_a: Array, high_a: Array, low_b: Array, high_b: Array, margin: float) -> tuple[Flags, Flags]:
    """Which boxes (n, 3) of the first kind may come within `margin` of any (m, 3) of the second, and the reverse.

    None that does is missed; some that do not are kept.
    """
    if not len(low_a) or not len(low_b):
        return np.zeros(len(low_a), bool), np.zeros(len(low_b), bool)
    low = np.maximum(bounds(low_a)[0], bounds(low_b)[0]) - margin
    high = np.minimum(bounds(high_a)[1], bounds(high_b)[1]) + margin
    size = np.maximum(high - low, 1e-300)
    finest = min(CELLS_MOST, CELLS_LEAST + int(np.sqrt(len(low_a) + len(low_b)) / 4))
    counts = np.maximum(np.ceil(finest * size / size.max()), 1).astype(np.int64)
    first, last = _cells(low_b - margin, high_b + margin, low, size, counts)
    keep_a = _occupied(_grid(first, last, counts), *_cells(low_a, high_a, low, size, counts))
    keep_a &= meeting_box(low_a, high_a, low, high)
    first, last = _cells(low_a[keep_a] - margin, high_a[keep_a] + margin, low, size, counts)
    keep_b = _occupied(_grid(first, last, counts), *_cells(low_b, high_b, low, size, counts))
    keep_b &= meeting_box(low_b, high_b, low, high)
    return keep_a, keep_b


def _cells(low: Array, high: Array, origin: Array, size: Array, counts: Ints) -> tuple[Ints, Ints]:
    """First and last cell (n, 3) of each box, inside the grid."""
    cells = np.concatenate([low, high], dtype=np.float64)
    cells -= origin
    cells /= size
    cells *= counts
    np.floor(cells, out=cells)
    np.maximum(cells, 0, out=cells)
    np.minimum(cells, counts - 1, out=cells)
    both = cells.astype(np.int64)
    return both[: len(low)], both[len(low) :]


def _grid(first: Ints, last: Ints, counts: Ints) -> Array:
    """Sums of occupied cells from the origin, one larger than the grid along each axis."""
    shape = counts + 1
    flat, sign = _corners(first, last, shape)
    cells = np.bincount(flat.ravel(), np.repeat(sign, len(first)), int(shape.prod())).reshape(tuple(shape))
    for axis in range(3):
        np.cumsum(cells, axis=axis, out=cells)
    summed = np.zeros(tuple(shape))
    summed[1:, 1:, 1:] = cells[:-1, :-1, :-1] > 0.5
    for axis in range(3):
        np.cumsum(summed, axis=axis, out=summed)
    return summed


def _corners(first: Ints, last: Ints, shape: Ints) -> tuple[Ints, Array]:
    """(8, n) place in a flat grid of that shape of the corners of boxes of cells, upper ones one beyond, and their
    signs (8,) in sums."""
    x, y, z = (np.stack([low, high + 1]) * step for low, high, step in zip(
        first.T, last.T, (shape[1] * shape[2], shape[2], 1), strict=True
    ))  # fmt: skip
    flat = (x[:, None, None] + y[None, :, None] + z[None, None]).reshape(8, -1)
    return flat, _SIGNS


_SIGNS = np.array([(-1.0) ** (i + j + k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def _occupied(summed: Array, first: Ints, last: Ints) -> Flags:
    """Whether any cell of each box is occupied."""
    flat, sign = _corners(first, last, np.array(summed.shape))
    return np.asarray(-sign @ summed.ravel()[flat] > 0.5)
