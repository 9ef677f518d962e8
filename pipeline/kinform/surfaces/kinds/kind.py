"""What every kind of curved surface can do, over a batch of candidate regions at once.

A candidate's parameters are one row of `Params`: axis (3), point (3), radius, half-angle. Distances are
positive outside the chord side: the vertices of a tessellation lie at 0, points on its chords below.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.surfaces import SurfaceKind
from kinform.surfaces.groups import columns_of, in_order, normal_equations, solve_normal, sums_of
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.polygons.noise import Scales

DAMPING = 1e-11
"""Share of the scaled diagonal that is added to normal equations: it changes nothing in a regular fit, and bounds the
step of a vague one."""
NEAR = 4
"""Tolerances within which shared vertices of spheres and tori define them: beyond, they lie on chords. Chosen, not
measured."""


class Probe(NamedTuple):
    """Points held against their surfaces."""

    distance: Array
    """(N,) signed: above 0 no chord of the tessellation can lie."""
    normal: Array
    """(N, 3) away from the axis or the centre."""
    curvature_radius: Array
    """(N,) radius of curvature along the tessellated direction."""


class Moving:
    """Which sets of regions have least squares that go on: those of one kind and mesh end together, when none of them
    moves any more, so that they have the same fits whatever others are beside them."""

    def __init__(self, of_region: Ints, count: int):
        """Of regions that are in these sets (R,), from 0 to `count`."""
        self._set = of_region
        self._on = np.ones(count, bool)

    def only(self, region: Ints, vertex: Ints) -> tuple[Ints, Ints]:
        """The vertices of sets that go on; those without any do not."""
        mine = self._set.take(region)
        self._on &= np.bincount(mine, minlength=len(self._on)) > 0
        if self._on.all():
            return region, vertex
        rows = self._on.take(mine).nonzero()[0]
        return region.take(rows), vertex.take(rows)

    def taken(self, stepped: Params, params: Params) -> Params:
        """The parameters after a step: as they were where a set has ended."""
        if self._on.all():
            return stepped
        return np.where(self._on.take(self._set)[:, None], stepped, params)

    def after(self, change: Array, still: float, region: Ints, vertex: Ints) -> tuple[Ints, Ints]:
        """The vertices of sets that go on after a step by `change` (R, k)."""
        largest = np.zeros(len(self._on))
        np.maximum.at(largest, self._set, np.abs(change).max(axis=1, initial=0.0))
        ended = self._on & (largest < still)
        if not ended.any():
            return region, vertex
        self._on &= ~ended
        return self.only(region, vertex)


class Kind(Protocol):
    """One kind of curved surface."""

    name: SurfaceKind
    least: int
    """Polygons that a region of this kind has at least."""
    bends: tuple[float, float]
    """Range of the ratio of the two curvatures in the middle of a piece for which the kind is tried."""
    saddle: bool
    """Whether edges within one surface may bend both ways."""
    handicap: float
    """A more complex kind must explain this many times more polygons than a simpler one."""

    def of(self, numbers: Ints) -> Kind:
        """The kind of some of the regions, in this order."""
        return self

    def each(self, count: int) -> list[tuple[Kind, slice]]:
        """The kinds of `count` regions, each with the run of those that are of it."""
        return [(self, slice(0, count))]

    def enough(self, size: Ints) -> Flags:
        """Which regions of so many polygons (R,) have as many as their kind needs."""
        return size >= self.least

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
        """(region of each, probe) of the middles of the pairs' polygons, and after them of the corners; normals of the
        middles at least."""
        ...

    def cuts(self, batch: Batch, params: Params, pairs: Ints, tolerance: Array) -> Flags:
        """Which of these pairs' polygons may be facets of their surface that were cut off: each has corners below it by
        more than the tolerance (n,)."""
        return np.ones(len(pairs), bool)

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
    """Change of the parameters (rad, spans) at which a fit stands still before that."""

    def step(self, params: Params, change: Array) -> Params:
        """The surfaces with their free parameters changed by (R, k), within bounds."""
        ...

    def equations(self, params: Params, points: Array) -> tuple[Array, Array]:
        """Derivative (N, k) of the distance by the free parameters, and the distance (N,)."""
        ...

    def jacobian(self, params: Params, points: Array) -> Array:
        """The derivative alone."""
        return self.equations(params, points)[0]

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over the free parameters."""
        moving = Moving(batch.mesh, len(batch.patchwork.total))
        region, vertex = moving.only(*self.defining(batch, params, tolerance))
        for _ in range(min(steps, self.most_steps)):
            if not len(region):
                break
            mine, points = columns_of(params, region), batch.patchwork.at(vertex)
            columns, distance = self.equations(mine, points)
            matrix, right = normal_equations(sums_of(region, batch.count), columns.T, distance)
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
        """Twice the greatest angle of normals within each polygon."""
        return batch.widths(params, self._spans)

    def _spans(self, batch: Batch, params: Params) -> Array:
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
        rows = (distance < (NEAR * tolerance).take(region)).nonzero()[0]
        return region.take(rows), vertex.take(rows)


def distinct_angles(region: Ints, angle: Array, step: Array, count: int) -> Ints:
    """Number of angles of each region that differ by more than its step (count,)."""
    order = in_order(region, angle, count)
    region, angle = region.take(order), angle.take(order)
    fresh = heads(region)
    fresh[1:] |= angle[1:] - angle[:-1] > step.take(region[1:])
    return np.bincount(region[fresh], minlength=count).astype(np.int64)
