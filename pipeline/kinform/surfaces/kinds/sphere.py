"""Spheres: balls and sockets."""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import group_sum, normal_equations, solve_normal
from kinform.surfaces.kinds.kind import Batch, Params, Probe
from kinform.surfaces.polygons.patchwork import Scale

__all__ = ["Sphere"]


class Sphere:
    """Centre and radius are linear in the squares of the distances; then least squares."""

    name = "sphere"
    least = 8
    bends = (0.4, 1.0)
    saddle = False
    handicap = 1.2

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """|q|² = 2 q·c + k over the vertices that three polygons share, or two, where those are too few: after
        a boolean, vertices that two share may lie on chords."""
        work, count = batch.patchwork, batch.count
        region, vertex = batch.inner_vertices(2)
        surrounded, _ = inner = batch.inner_vertices(3)
        enough = np.bincount(surrounded, minlength=count) >= 6
        total = np.int64(max(len(work.vertices), 1))
        use = ~enough[region] | np.isin(region * total + vertex, inner[0] * total + inner[1])
        region, vertex = region[use], vertex[use]
        points = work.vertices[vertex]
        size = np.bincount(region, minlength=count)
        middle = group_sum(region, points, count) / np.maximum(size, 1)[:, None]
        offset = points - middle[region]
        columns = np.concatenate([offset, np.ones((len(offset), 1))], axis=1)
        matrix, right = normal_equations(region, columns, (offset**2).sum(axis=1), count)
        solution = solve_normal(matrix, right)
        centre = solution[:, :3] / 2
        square = solution[:, 3] + (centre**2).sum(axis=1)
        params = np.zeros((count, 8))
        params[:, 3:6] = middle + centre
        params[:, 6] = np.sqrt(np.maximum(square, 0.0))
        return params, (size >= 6) & (square > 0) & (params[:, 6] < 5.0) & np.isfinite(params).all(axis=1)

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over centre and radius."""
        for step in range(min(steps, 3)):
            if step == 0:
                region, vertex = self.defining(batch, params, tolerance)
            if not len(region):
                return params
            points = batch.patchwork.vertices[vertex]
            matrix, right = normal_equations(
                region, self.jacobian(params[region], points), self.probe(params[region], points).distance,
                batch.count,
            )  # fmt: skip
            change = -solve_normal(matrix, right, 1e-11)
            moved = params.copy()
            moved[:, 3:7] += np.clip(change, -params[:, 6:7], params[:, 6:7])
            params = np.where(np.all(np.isfinite(moved), axis=1, keepdims=True), moved, params)
        return params

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance, normal and radius."""
        offset = points - params[:, 3:6]
        rho = np.sqrt(np.einsum("ij,ij->i", offset, offset))
        return Probe(rho - params[:, 6], offset / np.maximum(rho, 1e-300)[:, None], params[:, 6])

    def widths(self, batch: Batch, params: Params) -> Array:
        """Twice the greatest angle between a polygon's middle and a vertex of it."""
        work = batch.patchwork
        owner, _ = batch.corners
        mine = params[batch.region]
        middle = self.probe(mine, work.centre[batch.polygon]).normal
        apart = self.probe(mine[owner], batch.points).normal - middle[owner]
        square = np.zeros(len(batch.polygon))
        np.maximum.at(square, owner, np.einsum("ij,ij->i", apart, apart))
        return np.asarray(4 * np.arcsin(np.minimum(np.sqrt(square) / 2, 1.0)))

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """Vertices that three of the region's polygons share, or two where they lie on the surface."""
        region, vertex = batch.inner_vertices(3)
        distance = np.abs(self.probe(params[region], batch.patchwork.vertices[vertex]).distance)
        keep = distance < 4 * tolerance[region]
        return region[keep], vertex[keep]

    def jacobian(self, params: Params, points: Array) -> Array:
        """By centre (3) and radius."""
        normal = self.probe(params, points).normal
        return np.concatenate([-normal, -np.ones((len(points), 1))], axis=1)

    def credible(self, batch: Batch, params: Params, scale: Scale) -> Flags:
        """Several vertices surrounded by the surface, and curvature in both directions above the tolerance."""
        work = batch.patchwork
        region, _ = batch.inner_vertices(3)
        inner = np.bincount(region, minlength=batch.count)
        total = group_sum(batch.region, (work.normal * work.area[:, None])[batch.polygon], batch.count)
        area = np.maximum(np.bincount(batch.region, work.area[batch.polygon], batch.count), 1e-300)
        cos = np.clip(2 * np.linalg.norm(total, axis=1) / area - 1, -1.0, 1.0)
        return np.asarray((inner >= 4) & (params[:, 6] * (1 - cos) > 4 * scale.fit))
