"""What every kind of curved surface can do, over a batch of candidate regions at once.

A candidate's parameters are one row of `Params`: axis (3), point (3), radius, half-angle. Distances are
positive outside the chord side: the vertices of a tessellation lie at 0, points on its chords below.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import occurrences, starts_of
from kinform.surfaces.polygons.patchwork import Patchwork, Scale

__all__ = ["Batch", "Kind", "Params", "Probe", "widths"]

Params = Array
"""(R, 8): axis, point, radius, half-angle."""

RUN = 1 << 15
"""Pairs of one run."""

ALONG = float(np.cos(np.radians(10.0)))
"""Edges within this of a generator are generators."""


@dataclass(frozen=True, eq=False)
class Probe:
    """Points held against their surfaces."""

    distance: Array
    """(N,) signed: above 0 no chord of the tessellation can lie."""
    normal: Array
    """(N, 3) away from the axis or the centre."""
    curvature_radius: Array
    """(N,) radius of curvature along the tessellated direction."""


class Batch:
    """R candidate regions: (region, polygon) pairs sorted by region, and what belongs to them."""

    def __init__(self, patchwork: Patchwork, region: Ints, polygon: Ints, count: int):
        self.patchwork = patchwork
        self.region = region
        self.polygon = polygon
        self.count = count
        self.size = np.diff(starts_of(region, count))
        self._edges: tuple[Ints, Ints, Flags] | None = None
        self._corners: tuple[Ints, Ints] | None = None
        self._points: Array | None = None
        self._inner: dict[int, tuple[Ints, Ints]] = {}

    def parts(self) -> list[Batch]:
        """The batch cut into runs of pairs, so that what is computed for every corner stays small."""
        if len(self.region) <= RUN:
            return [self]
        cuts = range(0, len(self.region), RUN)
        return [Batch(self.patchwork, self.region[k : k + RUN], self.polygon[k : k + RUN], self.count) for k in cuts]

    @property
    def corners(self) -> tuple[Ints, Ints]:
        """(pair, vertex) of every polygon's vertices; a vertex once for each of its polygons."""
        if self._corners is None:
            self._corners = self.patchwork.corners.expand(self.polygon)
        return self._corners

    @property
    def points(self) -> Array:
        """Coordinates of those vertices."""
        if self._points is None:
            self._points = self.patchwork.vertices[self.corners[1]]
        return self._points

    @property
    def edges(self) -> tuple[Ints, Ints, Flags]:
        """(region, edge, whether both polygons are in the region), each edge once for a region."""
        if self._edges is None:
            owner, edge = self.patchwork.sides.expand(self.polygon)
            total = np.int64(max(len(self.patchwork.a), 1))
            key, times = occurrences(self.region[owner] * total + edge)
            self._edges = key // total, key % total, times == 2
        return self._edges

    def inner_vertices(self, least: int = 3) -> tuple[Ints, Ints]:
        """(region, vertex) of vertices that at least so many of the region's polygons share."""
        if least not in self._inner:
            owner, vertex = self.corners
            total = np.int64(max(len(self.patchwork.vertices), 1))
            key, times = occurrences(self.region[owner] * total + vertex)
            key = key[times >= least]
            self._inner[least] = key // total, key % total
        return self._inner[least]

    def select(self, keep: Flags) -> Batch:
        """The batch without some of its pairs."""
        return Batch(self.patchwork, self.region[keep], self.polygon[keep], self.count)


class Kind(Protocol):
    """One kind of curved surface."""

    name: str
    least: int
    """Polygons that a region of this kind has at least."""
    bends: tuple[float, float]
    """Range of the ratio of the two curvatures in the middle of a piece for which the kind is tried."""
    saddle: bool
    """Whether edges within one surface may bend both ways."""
    handicap: float
    """A more complex kind must explain this many times more polygons than a simpler one."""

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """Closed-form parameters of each region from its polygons, and whether there are any."""
        ...

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Least squares over the defining vertices within the tolerance (R,)."""
        ...

    def probe(self, params: Params, points: Array) -> Probe:
        """Holds points (N, 3) against surfaces (N, 8)."""
        ...

    def widths(self, batch: Batch, params: Params) -> Array:
        """(pairs,) angle that each polygon subtends along the tessellated direction."""
        ...

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """(region, vertex) of the vertices that lie on the true surface, not on chords."""
        ...

    def jacobian(self, params: Params, points: Array) -> Array:
        """(N, k) derivative of the distance by the free parameters."""
        ...

    def credible(self, batch: Batch, params: Params, scale: Scale) -> Flags:
        """Whether there is evidence enough for this kind, not only agreement with it."""
        ...


def widths(kind: Kind, batch: Batch, params: Params) -> Array:
    """(pairs,) `kind.widths`, run by run."""
    return np.concatenate([kind.widths(part, params) for part in batch.parts()])
