"""The boxes of a mesh's facets, in chunks of facets that lie together: what meets a small box is found without
asking all of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["FacetBoxes", "FlatBoxes", "facet_boxes", "together"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_CHUNK = 48
"""Facets of a chunk."""
_OFTEN = 6
"""Questions that are cheaper to answer without chunks than the chunks are to make."""
_OCTAVES = 20
"""Octaves of size that are told apart."""
_BEFORE = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])


def facet_boxes(corners: tuple[Array, Array, Array]) -> tuple[Array, Array]:
    """Lower and upper corners (n, d) of the boxes of triangles, given by their three corners (n, d) each."""
    first, second, third = corners
    return np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)


class FacetBoxes:
    """Boxes (F, d) of facets, d 2 or 3, in an order of chunks by size and place once they are asked for often."""

    def __init__(self, low: Array, high: Array):
        self.low, self.high = low, high
        self._asked = 0
        self._order: Ints | None = None

    def meeting(self, low: Array, high: Array) -> Ints:
        """Facets whose boxes meet the box from `low` to `high` (d,), ascending."""
        self._asked += 1
        if self._asked <= _OFTEN or len(self.low) <= _CHUNK:
            meets = np.ones(len(self.low), dtype=bool)
            for axis in range(self.low.shape[1]):
                meets &= (self.low[:, axis] <= high[axis]) & (self.high[:, axis] >= low[axis])
            return np.flatnonzero(meets)
        if self._order is None:
            self._order = together(self.low, self.high)
            self._starts = np.arange(0, len(self.low), _CHUNK)
            self._chunk_low = np.minimum.reduceat(self.low[self._order], self._starts)
            self._chunk_high = np.maximum.reduceat(self.high[self._order], self._starts)
        chunks = np.flatnonzero(((self._chunk_low <= high) & (self._chunk_high >= low)).all(axis=1))
        at = (self._starts[chunks, None] + np.arange(_CHUNK)).ravel()
        some = np.sort(self._order[at[at < len(self._order)]])
        meets = ((self.low[some] <= high) & (self.high[some] >= low)).all(axis=1)
        return np.asarray(some[meets])


class FlatBoxes:
    """Boxes (F, 2) of facets in a plane, on grids by octave of their size: which of many points are in which of them."""

    def __init__(self, low: Array, high: Array):
        self.low, self.high = low, high
        size = (high - low).max(axis=1, initial=0.0)
        self._origin = low.min(axis=0, initial=np.inf)
        whole = max(float((high - self._origin).max(initial=0.0)), 1e-300)
        level = np.clip(np.ceil(np.log2(np.maximum(size, 1e-300) / whole)), -_OCTAVES, 0).astype(np.int64)
        self._levels = np.unique(level)
        self._cells = whole * 2.0**self._levels
        rank = np.searchsorted(self._levels, level)
        key = self._key(rank, np.floor((low - self._origin) / self._cells[rank, None]).astype(np.int64))
        self._facets = np.argsort(key, kind="stable")
        self._keys = key[self._facets]

    def around(self, points: Array) -> tuple[Ints, Ints]:
        """Indices of points (n, 2), ascending, and of facets whose box they are in."""
        cell = np.floor((points[:, None] - self._origin) / self._cells[:, None]).astype(np.int64)
        # a box is no larger than its cell: it began in the cell of the point or in one before
        cell = (cell[:, :, None] - _BEFORE).reshape(len(points), -1, 2)
        key = self._key(np.repeat(np.arange(len(self._levels)), len(_BEFORE)), np.clip(cell, -1, 2**_OCTAVES))
        first, last = np.searchsorted(self._keys, key, "left"), np.searchsorted(self._keys, key, "right")
        count = (last - first).sum(axis=1)
        lengths = (last - first).ravel()
        ends = np.cumsum(lengths)
        at = np.arange(int(lengths.sum())) + np.repeat(first.ravel() - ends + lengths, lengths)
        which, facets = np.repeat(np.arange(len(points)), count), self._facets[at]
        held = ((self.low[facets] <= points[which]) & (self.high[facets] >= points[which])).all(axis=1)
        return which[held], facets[held]

    def _key(self, rank: Ints, cell: Ints) -> Ints:
        """One number for a level and a cell (…, 2)."""
        side = np.int64(2 ** (_OCTAVES + 1))
        return np.asarray((rank * side + cell[..., 0] + 1) * side + cell[..., 1] + 1)


def together(low: Array, high: Array) -> Ints:
    """An order in which neighbours are of like size and lie together: by octave of size, then along a Z-curve."""
    count, dimensions = low.shape
    if count == 0:
        return np.zeros(0, np.int64)
    size = (high - low).max(axis=1)
    whole = max(float((high.max(axis=0) - low.min(axis=0)).max()), 1e-300)
    octave = np.clip(np.floor(np.log2(np.maximum(size, 1e-12 * whole) / whole)), -20, 0).astype(np.int64)
    cell = np.clip((0.5 * (low + high) - low.min(axis=0)) / whole * 1024.0, 0, 1023).astype(np.int64)
    code = np.zeros(count, dtype=np.int64)
    for bit in range(10):
        for axis in range(dimensions):
            code |= ((cell[:, axis] >> bit) & 1) << (dimensions * bit + axis)
    return np.lexsort((code, -octave)).astype(np.int64)
