"""What every kind of curved surface can do, over a batch of candidate regions at once.

A candidate's parameters are one row of `Params`: axis (3), point (3), radius, half-angle. Distances are
positive outside the chord side: the vertices of a tessellation lie at 0, points on its chords below.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, TypeAlias, TypeVar, cast

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.constants import DAMPING, NEAR, RUN_OF_PAIRS
from kinform.surfaces.groups import columns_of, in_order, normal_equations, occurrences, parted, solve_normal
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork

Params = Array
"""(R, 8): axis, point, radius, half-angle."""

Seen = TypeVar("Seen")
Look: TypeAlias = Callable[[Params, Array], Any]
"""What points (N, 3) are about surfaces (N, 8)."""


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
        self._edges: tuple[Ints, Ints, Flags] | None = None
        self._corners: tuple[Ints, Ints] | None = None
        self._points: Array | None = None
        self._inner: dict[int, tuple[Ints, Ints]] = {}
        self._mesh: Ints | None = None
        self._parts: list[Batch] | None = None
        self._seen: tuple[Params, Look, Any] | None = None

    def parts(self) -> list[Batch]:
        """The batch cut into runs of pairs, so that what is computed for every corner stays small."""
        if len(self.region) <= RUN_OF_PAIRS:
            return [self]
        if self._parts is None:
            runs = [slice(k, k + RUN_OF_PAIRS) for k in range(0, len(self.region), RUN_OF_PAIRS)]
            self._parts = [Batch(self.patchwork, self.region[run], self.polygon[run], self.count) for run in runs]
        return self._parts

    def seen(self, params: Params, look: Callable[[Params, Array], Seen]) -> tuple[Ints, Seen]:
        """(region of each, what they are there) of the middles of the pairs' polygons, and after them of the corners,
        about the surfaces (R, 8) of their regions. What was asked for last is kept: who asks for the widths of polygons
        asks next whether they conform."""
        if self._seen is None or self._seen[0] is not params or self._seen[1] != look:
            group = np.concatenate([self.region, self.region.take(self.corners[0])])
            points = np.concatenate([self.patchwork.middles(self.polygon).T, self.points.T], axis=1).T
            self._seen = params, look, (group, look(columns_of(params, group), points))
        return cast("tuple[Ints, Seen]", self._seen[2])

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
    def points(self) -> Array:
        """Coordinates of those vertices."""
        if self._points is None:
            self._points = self.patchwork.at(self.corners[1])
        return self._points

    @property
    def edges(self) -> tuple[Ints, Ints, Flags]:
        """(region, edge, whether both polygons are in the region), each edge once for a region."""
        if self._edges is None:
            owner, edge = self.patchwork.sides.expand(self.polygon)
            total = np.int64(max(len(self.patchwork.a), 1))
            key, times = occurrences(self.region[owner] * total + edge)
            self._edges = *parted(key, int(total)), times == 2
        return self._edges

    def inner_vertices(self, least: int = 3) -> tuple[Ints, Ints]:
        """(region, vertex) of vertices that at least so many of the region's polygons share."""
        if least not in self._inner:
            owner, vertex = self.corners
            total = np.int64(max(len(self.patchwork.vertices), 1))
            key, times = occurrences(self.region[owner] * total + vertex)
            self._inner[least] = parted(key.take((times >= least).nonzero()[0]), int(total))
        return self._inner[least]

    def forget(self) -> None:
        """Drops what is found when asked for: what is large, and is needed no longer or rarely."""
        self._edges = self._corners = self._points = self._parts = self._seen = None
        self._inner = {}

    def select(self, keep: Flags) -> Batch:
        """The batch without some of its pairs; itself, with what it has already found, where all are kept."""
        rows = keep.nonzero()[0]
        if len(rows) == len(keep):
            return self
        return Batch(self.patchwork, self.region.take(rows), self.polygon.take(rows), self.count)


class Moving:
    """Which meshes have regions whose least squares go on: those of one mesh end together, when none of them moves any
    more, so that a mesh has the same fits whatever other meshes are beside it."""

    def __init__(self, batch: Batch):
        self._batch = batch
        self._mesh = np.ones(len(batch.patchwork.total), bool)

    def only(self, region: Ints, vertex: Ints) -> tuple[Ints, Ints]:
        """The vertices of meshes that go on; those without any do not."""
        mesh = self._batch.mesh[region]
        self._mesh &= np.bincount(mesh, minlength=len(self._mesh)) > 0
        if self._mesh.all():
            return region, vertex
        rows = np.flatnonzero(self._mesh[mesh])
        return region.take(rows), vertex.take(rows)

    def taken(self, stepped: Params, params: Params) -> Params:
        """The parameters after a step: as they were where a mesh has ended."""
        if self._mesh.all():
            return stepped
        return np.where(self._mesh[self._batch.mesh][:, None], stepped, params)

    def after(self, change: Array, still: float, region: Ints, vertex: Ints) -> tuple[Ints, Ints]:
        """The vertices of meshes that go on after a step by `change` (R, k)."""
        largest = np.zeros(len(self._mesh))
        np.maximum.at(largest, self._batch.mesh, np.abs(change).max(axis=1, initial=0.0))
        ended = self._mesh & (largest < still)
        if not ended.any():
            return region, vertex
        self._mesh &= ~ended
        return self.only(region, vertex)


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

    def held(self, batch: Batch, params: Params) -> tuple[Ints, Probe]:
        """(region of each, probe) of the middles of the pairs' polygons, and after them of the corners."""
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

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """Whether there is evidence enough for this kind, not only agreement with it."""
        ...


class DoublyCurved(Kind, Protocol):
    """What spheres and tori have in common: every polygon bends both ways, so that the normal tells its place."""

    shared: int
    """Polygons of a region that share a vertex of the true surface, at least."""
    most_steps: int
    """Steps of least squares after which nothing is gained."""
    still: float
    """Change of the parameters (rad, diagonals) at which a fit stands still before that."""

    def step(self, params: Params, change: Array) -> Params:
        """The surfaces with their free parameters changed by (R, k), within bounds."""
        ...

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over the free parameters."""
        moving = Moving(batch)
        region, vertex = moving.only(*self.defining(batch, params, tolerance))
        for _ in range(min(steps, self.most_steps)):
            if not len(region):
                break
            mine, points = columns_of(params, region), batch.patchwork.at(vertex)
            matrix, right = normal_equations(
                region, self.jacobian(mine, points), self.probe(mine, points).distance, batch.count
            )
            change = -solve_normal(matrix, right, DAMPING)
            stepped = self.step(params, change)
            finite = np.isfinite(stepped).all(axis=1, keepdims=True)
            params = moving.taken(np.where(finite, stepped, params), params)
            region, vertex = moving.after(change, self.still, region, vertex)
        return params

    def held(self, batch: Batch, params: Params) -> tuple[Ints, Probe]:
        """By the kind's probe."""
        return batch.seen(params, self.probe)

    def widths(self, batch: Batch, params: Params) -> Array:
        """Twice the greatest angle between the normals at a polygon's middle and at a vertex of it."""
        owner, _ = batch.corners
        normal, count = self.held(batch, params)[1].normal, len(batch.polygon)
        apart = normal[count:] - columns_of(normal[:count], owner)
        square = np.zeros(len(batch.polygon))
        np.maximum.at(square, owner, dot(apart, apart))
        return np.asarray(4 * np.arcsin(np.minimum(np.sqrt(square) / 2, 1.0)))

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """Vertices that enough of the region's polygons share, where they lie on the surface."""
        region, vertex = batch.inner_vertices(self.shared)
        distance = np.abs(self.probe(columns_of(params, region), batch.patchwork.at(vertex)).distance)
        rows = np.flatnonzero(distance < NEAR * tolerance[region])
        return region.take(rows), vertex.take(rows)


def distinct_angles(region: Ints, angle: Array, step: Array, count: int) -> Ints:
    """Number of angles of each region that differ by more than its step (count,)."""
    order = in_order(region, angle, count)
    region, angle = region.take(order), angle.take(order)
    fresh = np.r_[True, (region[1:] != region[:-1]) | (np.diff(angle) > step[region[1:]])]
    return np.bincount(region[fresh], minlength=count).astype(np.int64)


def widths(kind: Kind, batch: Batch, params: Params) -> Array:
    """(pairs,) `kind.widths`, run by run."""
    return np.concatenate([kind.widths(part, params) for part in batch.parts()])
