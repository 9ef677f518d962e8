"""Circular cylinders: shafts and bores."""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import group_sum, normal_equations, solve_normal
from kinform.surfaces.kinds import ruled as _revolved
from kinform.surfaces.kinds.kind import Batch, Params, Probe
from kinform.surfaces.polygons.patchwork import Scale

__all__ = ["Cylinder"]

LARGEST = 10.0
"""Radius, in diagonals of the mesh, beyond which a face is no cylinder that a joint could use."""


class Cylinder:
    """Axis from the ridges (or the normals, where ridges are short), then a circle, then least squares."""

    name = "cylinder"
    least = 3
    bends = (0.0, 0.45)
    saddle = False
    handicap = 1.0

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """Circle through the ends of the ridges, seen along the axis."""
        work = batch.patchwork
        ridge, agreement = _revolved.axis_of_edges(batch)
        normal = work.normal[batch.polygon]
        weight = work.area[batch.polygon][:, None, None]
        matrix = group_sum(batch.region, weight * normal[:, :, None] * normal[:, None, :], batch.count)
        _, vectors = np.linalg.eigh(np.nan_to_num(matrix))
        axis = np.where((agreement > 0.98)[:, None], ridge, vectors[:, :, 0])
        params = np.zeros((batch.count, 8))
        params[:, :3], params[:, 6] = axis, np.inf
        region, edge, inner, smooth = _revolved.generators(batch, params)
        inner_count = np.bincount(region[inner], minlength=batch.count)
        use = inner | smooth | (inner_count[region] < 3)
        surrounded, vertex = batch.inner_vertices(3)
        ends = work.ends[edge[use]].ravel()
        return self._circle(batch, axis, np.r_[np.repeat(region[use], 2), surrounded], np.r_[ends, vertex])

    def _circle(self, batch: Batch, axis: Array, group: Ints, vertex: Ints) -> tuple[Params, Flags]:
        work, count = batch.patchwork, batch.count
        x, y = _revolved.basis(axis)
        points = work.vertices[vertex]
        size = np.maximum(np.bincount(group, minlength=count), 1)
        middle = group_sum(group, points, count) / size[:, None]
        offset = points - middle[group]
        u, v = np.einsum("ij,ij->i", offset, x[group]), np.einsum("ij,ij->i", offset, y[group])
        matrix, right = normal_equations(group, np.stack([u, v, np.ones_like(u)], axis=1), u * u + v * v, count)
        solution = solve_normal(matrix, right)
        centre = solution[:, :2] / 2
        square = solution[:, 2] + (centre**2).sum(axis=1)
        params = np.zeros((count, 8))
        params[:, :3] = axis
        params[:, 3:6] = middle + centre[:, :1] * x + centre[:, 1:] * y
        params[:, 6] = np.sqrt(np.maximum(square, 0.0))
        usable = (size >= 6) & (square > 0) & (params[:, 6] < LARGEST) & np.isfinite(params).all(axis=1)
        return params, usable

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over offset, tilt and radius."""
        return _revolved.gauss_newton(batch, params, tolerance, steps, cone=False)

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance, normal and radius of curvature."""
        return _revolved.probe(params, points)

    def widths(self, batch: Batch, params: Params) -> Array:
        """Angle about the axis of each polygon."""
        return _revolved.widths(batch, params)

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """Ends of ridges."""
        return _revolved.defining(batch, params, tolerance)

    def jacobian(self, params: Params, points: Array) -> Array:
        """By offset (2), tilt (2), radius."""
        return _revolved.jacobian(params, points, cone=False)

    def credible(self, batch: Batch, params: Params, scale: Scale) -> Flags:
        """At least four generators, or three at equal steps; two strips of like width; and a sagitta well above the
        tolerance."""
        lines = _revolved.lines(batch, params, np.full(batch.count, scale.fit))
        widths = _revolved.widths(batch, params)
        sweep = np.minimum(np.bincount(batch.region, widths, batch.count), np.pi)
        sagitta = params[:, 6] * (1 - np.cos(sweep / 2))
        even = _revolved.even(batch, widths)
        known = (lines >= 4) | ((lines == 3) & _revolved.regular(batch, params))
        return np.asarray(known & even & (sagitta > 4 * scale.fit) & (params[:, 6] < LARGEST))
