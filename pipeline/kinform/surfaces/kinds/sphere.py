"""Spheres: balls and sockets."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.sorting import among
from kinform.model.arrays import Array, Flags
from kinform.surfaces.constants import LARGEST_SPHERE, LEAST_POINTS, SAGITTA
from kinform.surfaces.groups import group_mean, group_sum, spheres_through
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.kind import DoublyCurved, Probe
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
        """The sphere through the vertices that three polygons share, or two, where those are too few: after a boolean,
        vertices that two share may lie on chords."""
        work, count = batch.patchwork, batch.count
        region, vertex = batch.inner_vertices(2)
        surrounded, middle_vertex = batch.inner_vertices(3)
        enough = np.bincount(surrounded, minlength=count) >= LEAST_POINTS
        total = np.int64(max(len(work.vertices), 1))
        use = ~enough[region] | among(region * total + vertex, surrounded * total + middle_vertex)
        region, vertex = region[use], vertex[use]
        points = work.vertices[vertex]
        middle = group_mean(region, points, count)
        centre, square = spheres_through(region, points - middle[region], count)
        params = np.zeros((count, 8))
        params[:, 3:6] = middle + centre
        params[:, 6] = np.sqrt(np.maximum(square, 0.0))
        usable = (np.bincount(region, minlength=count) >= LEAST_POINTS) & (square > 0)
        return params, usable & (params[:, 6] < LARGEST_SPHERE) & np.isfinite(params).all(axis=1)

    def step(self, params: Params, change: Array) -> Params:
        """By centre and radius, by no more than the radius."""
        stepped = params.copy()
        stepped[:, 3:7] += np.clip(change, -params[:, 6:7], params[:, 6:7])
        return stepped

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance, normal and radius."""
        offset = points - params[:, 3:6]
        rho = np.sqrt(dot(offset, offset))
        return Probe(rho - params[:, 6], offset / np.maximum(rho, 1e-300)[:, None], params[:, 6])

    def equations(self, params: Params, points: Array) -> tuple[Array, Array]:
        """By centre (3) and radius."""
        distance, normal, _ = self.probe(params, points)
        return np.concatenate([-normal, -np.ones((len(points), 1))], axis=1), distance

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """Several vertices surrounded by the surface, and curvature in both directions above the tolerance."""
        work = batch.patchwork
        region, _ = batch.inner_vertices(3)
        surrounded = np.bincount(region, minlength=batch.count)
        total = group_sum(batch.region, (work.normal * work.area[:, None])[batch.polygon], batch.count)
        area = np.maximum(np.bincount(batch.region, work.area[batch.polygon], batch.count), 1e-300)
        # a cap of half-angle φ has the mean normal (1 + cos φ) / 2
        cos = np.clip(2 * np.linalg.norm(total, axis=1) / area - 1, -1.0, 1.0)
        return np.asarray((surrounded >= 4) & (params[:, 6] * (1 - cos) > SAGITTA * scale.fit))
