"""Edges of welded meshes: the one table of which facets meet where.

Half-edge 3·f + k runs from corner k of facet f to its next corner. An edge is the half-edges between the same two
vertices: one where the mesh is open, two where it is closed, more where bodies touch. Edges are sorted by their lower
vertex, then by their higher one; the half-edges of one edge by facet, or, `by_corner`, by the corner that they begin
at and then by facet.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import NEXT, cross, dot
from kinform.foundation.equal_rows import number_equal_rows
from kinform.foundation.sorting import ascending, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class SharedEdges:
    """Half-edges that follow each other in an edge of a table: one row an edge of two facets, two an edge of three."""

    first: Ints
    second: Ints
    """(k,) half-edges."""
    ends: Ints
    """(k, 2) vertices, the lower first."""
    forward: Flags
    """(k,) `first` runs from the lower to the higher vertex."""
    opposed: Flags
    """(k,) the two run against each other, as those of facets that agree on the outside do."""

    @cached_property
    def sides(self) -> Ints:
        """(2, k) facets of `first` and `second`."""
        out = np.empty((2, len(self.first)), np.int64)
        np.floor_divide(self.first, 3, out=out[0])
        np.floor_divide(self.second, 3, out=out[1])
        return out

    @property
    def facets(self) -> Ints:
        """(k, 2) the same."""
        return self.sides.T

    def where(self, rows: Flags | Ints) -> SharedEdges:
        """Some of the rows, by their numbers or by flags (k,)."""
        rows = rows.nonzero()[0] if rows.dtype == bool else rows
        return SharedEdges(
            self.first.take(rows),
            self.second.take(rows),
            self.ends.take(rows, axis=0),
            self.forward.take(rows),
            self.opposed.take(rows),
        )

    def along(self, vertices: Array) -> Array:
        """(k, 3) from the lower to the higher vertex."""
        return np.asarray(vertices[self.ends[:, 1]] - vertices[self.ends[:, 0]])

    def convexity(self, vertices: Array, first: Array, second: Array) -> Array:
        """(k,) positive at convex edges, negative at concave ones, 0 at flat ones; of the outward normals of the facets
        of `first` and `second` (k, 3) each."""
        along = dot(cross(first, second), self.along(vertices))
        return np.asarray(np.where(self.forward, 1.0, -1.0) * along)


@dataclass(frozen=True, eq=False)
class EdgeTable:
    """Half-edges by undirected edge."""

    faces: Ints
    """(F, 3) vertices."""
    half_edges: Ints
    """(3F,) half-edge numbers, grouped by edge."""
    starts: Ints
    """(E,) where each edge begins in `half_edges`."""
    counts: Ints
    """(E,) facets at each edge."""

    @cached_property
    def ends(self) -> Ints:
        """(3F, 2) vertices of each half-edge, the lower first, by half-edge number."""
        return edge_ends(self.faces)

    @cached_property
    def forward(self) -> Flags:
        """(3F,) by half-edge number: runs from the lower to the higher vertex."""
        start, end = _starts_and_ends(self.faces)
        return start < end

    @property
    def open(self) -> int:
        """Edges of one facet only."""
        return int((self.counts == 1).sum())

    @property
    def overused(self) -> int:
        """Edges of more than two facets."""
        return int((self.counts > 2).sum())

    @cached_property
    def balance(self) -> Ints:
        """(E,) runs forward less runs backward; 0 on a shared edge whose facets agree."""
        before = np.zeros(len(self.half_edges) + 1, np.int64)
        np.cumsum(self.forward.take(self.half_edges), out=before[1:])
        forward = before.take(self.starts + self.counts) - before.take(self.starts)
        return np.asarray(2 * forward - self.counts)

    @cached_property
    def pairs(self) -> Ints:
        """(2, k) the two half-edges of each edge that has two."""
        first = self.starts[self.counts == 2]
        return np.stack([self.half_edges.take(first), self.half_edges.take(first + 1)])

    @property
    def shared(self) -> SharedEdges:
        """Neighbours in the edges of two facets and more."""
        follows = np.ones(len(self.half_edges), dtype=bool)
        follows[self.starts] = False
        at = np.flatnonzero(follows)
        first, second = self.half_edges.take(at - 1), self.half_edges.take(at)
        starts, following = _starts_and_ends(self.faces)
        start, end = starts.take(first), following.take(first)
        ends = np.empty((len(at), 2), start.dtype)
        np.minimum(start, end, out=ends[:, 0])
        np.maximum(start, end, out=ends[:, 1])
        # facets of one edge run along it from the one end or the other
        return SharedEdges(first, second, ends, start < end, start != starts.take(second))


def edge_ends(faces: Ints) -> Ints:
    """(3F, 2) vertices of the half-edges of faces (F, 3), the lower first."""
    start, end = _starts_and_ends(faces)
    return np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1)


def edge_table(faces: Ints, vertices: int, by_corner: bool = False) -> EdgeTable:
    """Edges of faces (F, 3), none of which uses a vertex twice, over that many vertices."""
    key = _keys(faces, vertices)
    if by_corner:
        corners = np.arange(len(key)).reshape(-1, 3).T.ravel()
        order = corners.take(ascending(key.take(corners), vertices * vertices))
    else:
        order = ascending(key, vertices * vertices)
    starts = np.flatnonzero(heads(key.take(order)))
    counts = np.empty_like(starts)
    np.subtract(starts[1:], starts[:-1], out=counts[:-1])
    counts[-1:] = len(key) - starts[-1:]
    return EdgeTable(faces, order, starts, counts)


def unsorted_edge_table(faces: Ints, vertices: int) -> EdgeTable:
    """As `edge_table`, but edges as they first occur, which takes no sort where none has more than two facets."""
    first, edge = number_equal_rows([_keys(faces, vertices).view(np.uint64)])
    counts = np.bincount(edge, minlength=len(first))
    starts = np.cumsum(counts) - counts
    if counts.max(initial=0) > 2:
        return EdgeTable(faces, ascending(edge, len(first)), starts, counts)
    place = starts.take(edge) + 1
    place[first] -= 1
    half_edges = np.empty(len(edge), np.int64)
    half_edges[place] = np.arange(len(edge))
    return EdgeTable(faces, half_edges, starts, counts)


def _keys(faces: Ints, vertices: int) -> Ints:
    """(3F,) number of the edge of each half-edge: that of its lower vertex, then that of its higher one."""
    start, end = _starts_and_ends(faces)
    key = np.minimum(start, end).astype(np.int64, copy=False)
    key *= vertices
    key += np.maximum(start, end)
    return key


def _starts_and_ends(faces: Ints) -> tuple[Ints, Ints]:
    """(3F,) vertices that the half-edges run from and to."""
    return faces.ravel(), faces.take(NEXT, axis=1).ravel()


def shared_edges(faces: Ints, vertices: int, by_corner: bool = False) -> SharedEdges:
    """`shared` of the table of edges."""
    return edge_table(faces, vertices, by_corner).shared
