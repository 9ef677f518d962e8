"""Circular cones: countersinks, chamfers, tapers, points."""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import group_sum, normal_equations, solve_normal
from kinform.surfaces.kinds import ruled as _revolved
from kinform.surfaces.kinds.kind import Batch, Params, Probe
from kinform.surfaces.polygons.patchwork import Scale

__all__ = ["Cone"]


class Cone:
    """Axis from the small circle of the normals, then radius linear along the axis, then least squares."""

    name = "cone"
    least = 4
    bends = (0.0, 0.6)
    saddle = False
    handicap = 1.2

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """ρ² as a polynomial in the position along the axis is linear in centre and taper."""
        work, count = batch.patchwork, batch.count
        normal, weight = work.normal[batch.polygon], work.area[batch.polygon]
        total = np.maximum(np.bincount(batch.region, weight, count), 1e-300)
        mean = group_sum(batch.region, normal * weight[:, None], count) / total[:, None]
        offset = normal - mean[batch.region]
        matrix = group_sum(batch.region, weight[:, None, None] * offset[:, :, None] * offset[:, None, :], count)
        values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
        axis = np.ascontiguousarray(vectors[:, :, 0])
        region, edge, inner = batch.edges
        region, edge = region[inner & work.smooth[edge]], edge[inner & work.smooth[edge]]
        params, usable = self._taper(batch, axis, region, edge)
        return params, usable & (values[:, 0] < 1e-2 * values[:, 1])

    def _taper(self, batch: Batch, axis: Array, region: Ints, edge: Ints) -> tuple[Params, Flags]:
        work, count = batch.patchwork, batch.count
        x, y = _revolved.basis(axis)
        group = np.repeat(region, 2)
        points = work.vertices[work.ends[edge].ravel()]
        size = np.maximum(np.bincount(group, minlength=count), 1)
        middle = group_sum(group, points, count) / size[:, None]
        offset = points - middle[group]
        u, v, t = (np.einsum("ij,ij->i", offset, e[group]) for e in (x, y, axis))
        columns = np.stack([u, v, np.ones_like(u), t, t * t], axis=1)
        matrix, right = normal_equations(group, columns, u * u + v * v, count)
        solution = solve_normal(matrix, right)
        centre = solution[:, :2] / 2
        # two rings leave the size of the ring open above, but not its middle; the rest is a line
        rho = np.hypot(u - centre[group, 0], v - centre[group, 1])
        matrix, right = normal_equations(group, np.stack([np.ones_like(t), t], axis=1), rho, count)
        line = solve_normal(matrix, right)
        params = np.zeros((count, 8))
        params[:, :3] = axis
        params[:, 3:6] = middle + centre[:, :1] * x + centre[:, 1:] * y
        params[:, 6] = np.maximum(line[:, 0], 1e-9)
        params[:, 7] = np.arctan(line[:, 1])
        return params, (size >= 6) & (line[:, 0] > 0) & (line[:, 0] < 10.0) & np.isfinite(params).all(axis=1)

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over offset, tilt, radius and half-angle."""
        return _revolved.gauss_newton(batch, params, tolerance, steps, cone=True)

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
        """By offset (2), tilt (2), radius, half-angle."""
        return _revolved.jacobian(params, points, cone=True)

    def credible(self, batch: Batch, params: Params, scale: Scale) -> Flags:
        """At least five generators, a sagitta above the tolerance, and a taper that no cylinder has."""
        lines = _revolved.lines(batch, params, np.full(batch.count, scale.fit))
        widths = _revolved.widths(batch, params)
        sweep = np.minimum(np.bincount(batch.region, widths, batch.count), np.pi)
        region = batch.region[batch.corners[0]]
        t = np.einsum("ij,ij->i", batch.points - params[region, 3:6], params[region, :3])
        high, low = np.full(batch.count, -np.inf), np.full(batch.count, np.inf)
        np.maximum.at(high, region, t)
        np.minimum.at(low, region, t)
        filled = batch.size > 0
        high, low = np.where(filled, high, 0.0), np.where(filled, low, 0.0)
        height = high - low
        cos = np.cos(params[:, 7])
        largest = np.maximum(params[:, 6] + high * np.tan(params[:, 7]), params[:, 6] + low * np.tan(params[:, 7]))
        sagitta = largest * (1 - np.cos(sweep / 2)) * cos
        taper = height * np.abs(np.sin(params[:, 7]))
        even = _revolved.even(batch, widths)
        return np.asarray((lines >= 5) & even & (sagitta > 4 * scale.fit) & (taper > 2 * scale.fit))
