"""Which points are near each other: by their places along a line, or, where many share a place, by a k-d tree.

Of a few thousand points nearly all are alone on a line that no designer lays an edge along, which takes a sort to see:
less than to import a tree.
"""

from __future__ import annotations

import sys
from functools import cached_property
from typing import Any

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array, Ints

LINE = np.array([0.57735, 0.51763, 0.63144, 0.44317])
"""(4,) direction that no designer lays an edge along: few points share a place on it."""
FEW_PAIRS = 1 << 16
"""Pairs of points that share a place up to which all are measured, in all. Chosen, not measured."""
MEASURED = 1 << 21
"""Distances to points of one set that are measured before a tree is made: 0.02 s, a tenth of what importing trees
takes."""
MEASURED_BESIDE = 1 << 17
"""The same where trees are imported already: a few times what making one takes."""


class Near:
    """Points (m, k), k up to 4, that lie within a distance of each other."""

    def __init__(self, points: Array, distance: float):
        self._points, self._distance = points, distance

    @cached_property
    def pairs(self) -> Ints:
        """(n, 2) indices i < j of all that are near each other, in their order."""
        pairs = self._in_line
        if pairs is None:
            pairs = self._tree.query_pairs(self._distance, output_type="ndarray")
        return np.asarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])

    def about(self, chosen: Ints) -> Array:
        """How many points lie near each of some of them, itself among them; had before all pairs are, which are many
        where these are."""
        if self._in_line is None:
            return np.asarray(self._tree.query_ball_point(self._points[chosen], self._distance, return_length=True))
        return np.asarray(1.0 + np.bincount(self._in_line.ravel(), minlength=len(self._points))[chosen])

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self._points, compact_nodes=False, balanced_tree=False)

    @cached_property
    def _in_line(self) -> Ints | None:
        """The pairs, by their places along a line; None where too many share a place."""
        points, distance = self._points, self._distance
        line = LINE[: points.shape[1]]
        place = points @ (line / np.linalg.norm(line))
        order = np.argsort(place)
        ordered = place[order]
        beyond = np.searchsorted(ordered, ordered + distance * (1 + SOLVED), side="right")
        counts = beyond - np.arange(1, len(points) + 1)
        # Pairs a point up to which all are measured, where that is more. Chosen, not measured.
        if counts.sum() > max(FEW_PAIRS, 2 * len(points)):
            return None
        first = np.repeat(np.arange(len(points)), counts)
        second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
        pairs = np.stack([order[first], order[second]], axis=1)
        apart = points.take(pairs[:, 0], axis=0) - points.take(pairs[:, 1], axis=0)
        return np.sort(pairs[dot(apart, apart) <= distance * distance], axis=1)


class Nearest:
    """How far points are from the nearest of some (m, 3): measured, until a tree, to the same bits, would have been
    worth its making, and its import where nothing else has imported it."""

    def __init__(self, points: Array):
        self._points, self._asked = points, 0
        self._tree: Any = None

    def away(self, places: Array) -> Array:
        """(n,) of places (n, 3)."""
        self._asked += len(places) * len(self._points)
        if self._tree is None and self._asked <= (MEASURED_BESIDE if "scipy.spatial" in sys.modules else MEASURED):
            return self._measured(places)
        if self._tree is None:
            from scipy.spatial import cKDTree

            self._tree = cKDTree(self._points)
        return np.asarray(self._tree.query(places)[0])

    def _measured(self, places: Array) -> Array:
        columns = [np.ascontiguousarray(column) for column in self._points.T]
        rows = max(FEW_PAIRS // len(self._points), 1)
        squares = np.empty(len(places))
        total, apart = np.empty((2, min(rows, len(places)), len(self._points)))
        for first in range(0, len(places), rows):
            some = places[first : first + rows]
            for k, column in enumerate(columns):
                square = np.subtract(some[:, k, None], column, out=(apart if k else total)[: len(some)])
                square *= square
                if k:
                    total[: len(some)] += square
            squares[first : first + rows] = total[: len(some)].min(axis=1)
        return np.sqrt(squares)
