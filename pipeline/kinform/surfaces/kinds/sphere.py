"""Spheres: balls and sockets."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import among, distinct
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import columns_of, group_mean, group_moments, group_sum, parted, spheres_through
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.constants import LARGEST_DOUBLE, LEAST_POINTS, SAGITTA
from kinform.surfaces.kinds.kind import DoublyCurved, Probe
from kinform.surfaces.kinds.quadrics import distance_from_second
from kinform.surfaces.polygons.noise import Scales


class Sphere(DoublyCurved):
    """Centre and radius are linear in the squares of the distances; then least squares."""

    name = "sphere"
    least = 8
    bends = (0.4, 1.0)
    saddle = False
    handicap = 1.2
    shared = 3
    most_steps = 3
    still = 0.0

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """The sphere through the vertices that polygons share."""
        work, count = batch.patchwork, batch.count
        region, vertex = _shared(batch)
        points = work.at(vertex)
        middle = group_mean(region, points, count)
        centre, square = spheres_through(region, points - columns_of(middle, region), count)
        params = np.zeros((count, 8))
        params[:, 3:6] = middle + centre
        params[:, 6] = np.sqrt(np.maximum(square, 0.0))
        usable = (np.bincount(region, minlength=count) >= LEAST_POINTS) & (square > 0)
        return params, usable & (params[:, 6] < LARGEST_DOUBLE) & np.isfinite(params).all(axis=1)

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """Those that three polygons share, near the surface; where these are one ring, also those on it that two
        share."""
        region, vertex = super().defining(batch, params, tolerance)
        flat = _one_ring(batch)
        if not flat.any():
            return region, vertex
        more, ends = batch.inner_vertices(2)
        rows = flat.take(more).nonzero()[0]
        more, ends = more.take(rows), ends.take(rows)
        on = np.abs(self.probe(columns_of(params, more), batch.patchwork.at(ends)).distance) < tolerance.take(more)
        total = np.int64(max(len(batch.patchwork.vertices), 1))
        keys = np.concatenate([region * total + vertex, (more * total + ends)[on]])
        return parted(distinct(keys), int(total))

    def step(self, params: Params, change: Array) -> Params:
        """By centre and radius, by no more than the radius."""
        stepped = params.copy()
        stepped[:, 3:7] += np.clip(change, -params[:, 6:7], params[:, 6:7])
        return stepped

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance, normal and radius."""
        offset = points - params[:, 3:6]
        rho = np.sqrt(dot(offset, offset))
        return Probe(rho - params[:, 6], offset / np.maximum(rho, TINY)[:, None], params[:, 6])

    def equations(self, params: Params, points: Array) -> tuple[Array, Array]:
        """By centre (3) and radius."""
        distance, normal, _ = self.probe(params, points)
        return np.concatenate([-normal, -np.ones((len(points), 1))], axis=1), distance

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """Several vertices surrounded by the surface, and curvature in both directions above the tolerance."""
        work = batch.patchwork
        region, _ = batch.inner_vertices(3)
        surrounded = np.bincount(region, minlength=batch.count)
        each = work.area.take(batch.polygon)
        total = group_sum(batch.region, work.normals(batch.polygon) * each[:, None], batch.count)
        area = np.maximum(np.bincount(batch.region, each, batch.count), TINY)
        # a cap of half-angle φ has the mean normal (1 + cos φ) / 2
        cos = np.clip(2 * np.linalg.norm(total, axis=1) / area - 1, -1.0, 1.0)
        credible = (surrounded >= 4) & (params[:, 6] * (1 - cos) > SAGITTA * scale.fit)
        rows = credible.nonzero()[0]
        if len(rows):
            some, number = batch.where(credible).compact()
            credible[rows] = _determined(some, params[number], scale.at(number))
        return np.asarray(credible)


def _shared(batch: Batch) -> tuple[Ints, Ints]:
    """(region, vertex) of the vertices that three polygons share, or two, where those are too few or one ring: after a
    boolean, vertices that two share may lie on chords."""
    region, vertex = batch.inner_vertices(2)
    surrounded, middle = batch.inner_vertices(3)
    enough = (np.bincount(surrounded, minlength=batch.count) >= LEAST_POINTS) & ~_one_ring(batch)
    total = np.int64(max(len(batch.patchwork.vertices), 1))
    use = ~enough[region] | among(region * total + vertex, surrounded * total + middle)
    return region[use], vertex[use]


def _one_ring(batch: Batch) -> Flags:
    """(R,) whether the vertices that three polygons share, enough to suggest a circle, are in one plane."""
    region, vertex = batch.inner_vertices(3)
    several = np.bincount(region, minlength=batch.count) >= LEAST_POINTS
    rows = several.take(region).nonzero()[0]
    region, points = region.take(rows), batch.patchwork.at(vertex.take(rows))
    offset = points - columns_of(group_mean(region, points, batch.count), region)
    moments = group_moments(region, offset.T, batch.count)
    first, second = moments[:, 0], moments[:, 1]
    # products of two and of all three of the eigenvalues
    pairs = np.trace(moments, axis1=1, axis2=2) ** 2 - (moments * moments).sum(axis=(1, 2))
    volume = dot(cross(first, second), moments[:, 2])
    # Variance of vertices across their plane, as a share of that along it, below which they are one ring: any sphere
    # about its axis goes through it.
    return np.asarray(several & (2 * volume < 1e-4 * pairs * np.trace(moments, axis1=1, axis2=2)))


def _determined(batch: Batch, params: Params, scale: Scales) -> Flags:
    """(R,) whether the vertices on these spheres lie on no other quadric, as two rings do. Those inside a region are
    enough where they do not; those at its border, which a third ring may be, have to lie on the sphere as exactly as
    vertices do: three rings are only one more than fit anyway."""
    centre, radius = params[:, 3:6], params[:, 6]
    # Fits by which the vertices of a sphere are off every other quadric in the mean, at least: two rings lie on one to
    # the last digits, to a fifth of a fit where vertices scatter; three rings of a cap whose sagitta is just enough are
    # half a fit off.
    least = 0.5 * scale.fit
    known = np.zeros(batch.count, bool)
    for shared, near in ((3, scale.fit), (2, np.minimum(scale.noise, scale.fit))):
        region, vertex = batch.inner_vertices(shared)
        points = batch.patchwork.at(vertex)
        offset = points - columns_of(centre, region)
        off = np.abs(np.sqrt(dot(offset, offset)) - radius.take(region))
        on = (~known.take(region) & (off < near.take(region))).nonzero()[0]
        known |= distance_from_second(region.take(on), points[on], centre, radius) > least
        if known.all():
            break
    return known
