"""Candidate regions, many at once: pairs of region and polygon, and what belongs to them.

A candidate's parameters are one row of `Params`: axis (3), point (3), radius, half-angle.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np

from kinform.foundation.sorting import occurrences
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.constants import ROWS
from kinform.surfaces.groups import parted, repeated
from kinform.surfaces.polygons.patchwork import Patchwork

Params = Array
"""(R, 8): axis, point, radius, half-angle."""

Seen = TypeVar("Seen")
Look: TypeAlias = Callable[[Params, Array], Any]
"""What points (N, 3) are about surfaces (N, 8)."""


Widths: TypeAlias = Callable[["Batch", Params], Array]
"""Angles (pairs,) that polygons subtend on surfaces (R, 8)."""


class Batch:
    """R candidate regions: (region, polygon) pairs sorted by region, and what belongs to them."""

    def __init__(self, patchwork: Patchwork, region: Ints, polygon: Ints, count: int):
        self.patchwork = patchwork
        self.region = region
        self.polygon = polygon
        self.count = count
        self._edges: tuple[Ints, Ints, Flags] | None = None
        self._corners: tuple[Ints, Ints] | None = None
        self._points: Array | None = None
        self._shared: tuple[Ints, Ints, Ints] | None = None
        self._mesh: Ints | None = None
        self._parts: list[Batch] | None = None
        self._seen: tuple[Params, Look, Any] | None = None
        # the batch that this is a selection of, and the pairs of it, until `seen` is asked for
        self._source: tuple[Batch, Ints] | None = None
        self._widths: tuple[Params, Widths, Array] | None = None
        self._runs: Ints | None = None
        self._many: Ints | None = None

    def parts(self) -> list[Batch]:
        """The batch cut into runs of pairs, so that what is computed for every corner stays small."""
        if len(self.region) <= ROWS:
            return [self]
        if self._parts is None:
            runs = [slice(k, k + ROWS) for k in range(0, len(self.region), ROWS)]
            self._parts = [Batch(self.patchwork, self.region[run], self.polygon[run], self.count) for run in runs]
        return self._parts

    def seen(self, params: Params, look: Callable[[Params, Array], Seen], used: int = 8) -> tuple[Ints, Seen]:
        """(region of each, what they are there) of the middles of the pairs' polygons, and after them of the corners,
        about the surfaces (R, 8) of their regions, of which so many columns are used. What was asked for last is kept,
        also for the pairs that are selected: who asks for the widths of polygons asks next whether they conform, and
        then for those that do."""
        if self._source is not None:
            source, rows = self._source
            self._source = None
            if source.has_seen(params, look):
                self._corners, self._seen = source._seen_of(rows)
        if not self.has_seen(params, look):
            _, vertex = self.corners
            points = self.patchwork.places(self.polygon, vertex)
            group = self.for_seen(np.arange(self.count)[:, None])[:, 0]
            self._seen = params, look, (group, look(self.for_seen(params[:, :used]), points))
        assert self._seen is not None
        return cast("tuple[Ints, Seen]", self._seen[2])

    def for_seen(self, table: Any) -> Any:
        """(N, k) what the regions have in a table (R, k), for each of what `seen` gives; in memory column by column."""
        if self._runs is None:
            corners = np.bincount(self.region, self.many, self.count).astype(np.int64)
            self._runs = np.concatenate([self.size, corners])
        return repeated(np.concatenate([table, table]), self._runs)

    def has_seen(self, params: Params, look: Look) -> bool:
        """Whether that is what `seen` was asked for last."""
        return self._seen is not None and self._seen[0] is params and self._seen[1] == look

    def _seen_of(self, rows: Ints) -> tuple[tuple[Ints, Ints], tuple[Params, Look, Any]]:
        """The corners of some of the pairs, and what was seen last of them."""
        assert self._seen is not None
        params, look, (group, found) = self._seen
        owner, vertex = self.corners
        count = len(self.region)
        number = np.full(count, -1)
        number[rows] = np.arange(len(rows))
        mine = number.take(owner)
        corners = (mine >= 0).nonzero()[0]
        at = np.concatenate([rows, corners + count])
        kept = type(found)(*(values.T.take(at, axis=-1).T for values in found))
        return (mine.take(corners), vertex.take(corners)), (params, look, (group.take(at), kept))

    def widths(self, params: Params, find: Widths) -> Array:
        """(pairs,) angles that `find` says polygons subtend on the surfaces (R, 8) of their regions. They are each for
        itself, so those found last are kept, also for the pairs that are selected."""
        if self._widths is None or self._widths[0] is not params or self._widths[1] != find:
            self._widths = params, find, np.concatenate([find(part, params) for part in self.parts()])
        return self._widths[2]

    @classmethod
    def of_keys(cls, patchwork: Patchwork, keys: Ints, count: int) -> Batch:
        """The batch of sorted `keys`."""
        return cls(patchwork, *parted(keys, patchwork.count), count)

    @cached_property
    def size(self) -> Ints:
        """(R,) number of polygons of each region."""
        return np.bincount(self.region, minlength=self.count)

    @property
    def keys(self) -> Ints:
        """(pairs,) one number for each region and polygon."""
        return self.region * np.int64(self.patchwork.count) + self.polygon

    @property
    def mesh(self) -> Ints:
        """(R,) number of the mesh of each region; 0 of those without polygons."""
        if self._mesh is None:
            filled = np.flatnonzero(self.size)
            self._mesh = np.zeros(self.count, np.int64)
            first = (np.cumsum(self.size) - self.size)[filled]
            self._mesh[filled] = self.patchwork.mesh[self.polygon[first]]
        return self._mesh

    @property
    def corners(self) -> tuple[Ints, Ints]:
        """(pair, vertex) of every polygon's vertices; a vertex once for each of its polygons."""
        if self._corners is None:
            self._corners = self.patchwork.corners.expand(self.polygon)
        return self._corners

    @property
    def many(self) -> Ints:
        """(pairs,) how many vertices each polygon has."""
        if self._many is None:
            self._many = self.patchwork.corners.lengths(self.polygon)
        return self._many

    @property
    def points(self) -> Array:
        """Coordinates of those vertices."""
        if self._points is None:
            self._points = self.patchwork.at(self.corners[1])
        return self._points

    @property
    def edges(self) -> tuple[Ints, Ints, Flags]:
        """(region, edge, whether both polygons are in the region), each edge once for a region."""
        if self._edges is None:
            total = np.int64(max(len(self.patchwork.a), 1))
            base, edge = self.patchwork.sides.expand(self.polygon, self.region * total)
            base += edge
            key, times = occurrences(base)
            self._edges = *parted(key, int(total)), times == 2
        return self._edges

    def inner_vertices(self, least: int = 3) -> tuple[Ints, Ints]:
        """(region, vertex) of vertices that at least so many of the region's polygons share, two or more."""
        if self._shared is None:
            owner, vertex = self.corners
            total = np.int64(max(len(self.patchwork.vertices), 1))
            key, times = occurrences((self.region * total).take(owner) + vertex)
            rows = (times >= 2).nonzero()[0]
            self._shared = *parted(key.take(rows), int(total)), times.take(rows)
        region, shared, times = self._shared
        if least == 2:
            return region, shared
        rows = (times >= least).nonzero()[0]
        return region.take(rows), shared.take(rows)

    def find_shared(self) -> None:
        """Sorts edges and vertices at once, of which batches of some of the regions then have theirs without a sort."""
        _ = self.edges, self.inner_vertices()
        self._corners = self._points = None

    def select(self, keep: Flags) -> Batch:
        """The batch without some of its pairs; itself, with what it has already found, where all are kept."""
        rows = keep.nonzero()[0]
        if len(rows) == len(keep):
            return self
        out = Batch(self.patchwork, self.region.take(rows), self.polygon.take(rows), self.count)
        if self._seen is not None:
            out._source = self, rows
        elif self._source is not None:
            out._source = self._source[0], self._source[1].take(rows)
        if self._widths is not None:
            params, find, widths = self._widths
            out._widths = params, find, widths.take(rows)
        return out

    def where(self, regions: Flags) -> Batch:
        """The batch without the polygons of some of its regions (R,), with what sorting has found of the others."""
        out = self.select(regions.take(self.region))
        if out is not self and self._edges is not None:
            rows = regions.take(self._edges[0]).nonzero()[0]
            region, edge, inner = self._edges
            out._edges = region.take(rows), edge.take(rows), inner.take(rows)
        if out is not self and self._shared is not None:
            rows = regions.take(self._shared[0]).nonzero()[0]
            region, shared, times = self._shared
            out._shared = region.take(rows), shared.take(rows), times.take(rows)
        return out

    def run(self, regions: slice) -> Batch:
        """The batch of a run of its regions alone, with what sorting has found of them."""

        def cut(of: Ints) -> slice:
            return slice(*of.searchsorted((regions.start, regions.stop)).tolist())

        rows = cut(self.region)
        out = Batch(self.patchwork, self.region[rows] - regions.start, self.polygon[rows], regions.stop - regions.start)
        if self._edges is not None:
            region, edge, inner = self._edges
            rows = cut(region)
            out._edges = region[rows] - regions.start, edge[rows], inner[rows]
        if self._shared is not None:
            region, shared, times = self._shared
            rows = cut(region)
            out._shared = region[rows] - regions.start, shared[rows], times[rows]
        return out

    def compact(self) -> tuple[Batch, Ints]:
        """The batch without regions that are empty, with what sorting has found of the others, and the number that each
        had."""
        number = self.size.nonzero()[0]
        if len(number) == self.count:
            return self, number
        new = np.full(self.count, -1)
        new[number] = np.arange(len(number))
        out = Batch(self.patchwork, new.take(self.region), self.polygon, len(number))
        out._corners, out._points = self._corners, self._points
        if self._edges is not None:
            out._edges = new.take(self._edges[0]), *self._edges[1:]
        if self._shared is not None:
            out._shared = new.take(self._shared[0]), *self._shared[1:]
        return out, number
