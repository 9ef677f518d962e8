"""Tori: fillets around bosses and bores, O-ring grooves, races of ball bearings.

The axis comes from the normals: on a surface of revolution every normal meets the axis, which is linear in
the axis' Plücker coordinates (Pottmann and Randrup 1998; slippage after Gelfand and Guibas 2004). The profile
is a circle in the half-plane of distance from the axis and position along it.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import group_sum, normal_equations, quantile, solve_normal
from kinform.surfaces.kinds import ruled as _revolved
from kinform.surfaces.kinds.kind import Batch, Params, Probe
from kinform.surfaces.polygons.patchwork import Scale

__all__ = ["Torus", "rotation_axes"]

RINGS = 5
"""Rings of vertices that a profile has at least: three lie on a circle anyway, and four that are symmetric."""
STEPS = 3
"""Places around the axis that a torus is known at, at least."""


def rotation_axes(batch: Batch) -> tuple[Array, Array, Flags]:
    """(axis, point, whether there is one) about which each region's polygons turn into themselves, by their
    normals through their centres; pitch allowed for, and refused."""
    work, count = batch.patchwork, batch.count
    normal, weight = work.normal[batch.polygon], work.area[batch.polygon]
    total = np.maximum(np.bincount(batch.region, weight, count), 1e-300)
    middle = group_sum(batch.region, work.centre[batch.polygon] * weight[:, None], count) / total[:, None]
    offset = work.centre[batch.polygon] - middle[batch.region]
    size = np.sqrt(np.bincount(batch.region, weight * np.einsum("ij,ij->i", offset, offset), count) / total)
    size = np.maximum(size, 1e-12)
    rows = np.concatenate([cross(offset / size[batch.region][:, None], normal), normal], axis=1)
    matrix: Array = np.empty((count, 6, 6))
    for i in range(6):
        for j in range(i, 6):
            matrix[:, i, j] = np.bincount(batch.region, weight * rows[:, i] * rows[:, j], count) / total
            matrix[:, j, i] = matrix[:, i, j]
    _, vectors = np.linalg.eigh(np.nan_to_num(matrix))
    twist = vectors[:, :, 0]
    turn = np.linalg.norm(twist[:, :3], axis=1)
    scale = np.maximum(turn, 1e-12)[:, None]
    axis, moment = twist[:, :3] / scale, twist[:, 3:] / scale
    pitch = np.abs(np.einsum("ij,ij->i", axis, moment))
    point = middle + cross(axis, moment) * size[:, None]
    return axis, point, (turn > 0.05) & (pitch < 0.05 + 0.05 * np.linalg.norm(moment, axis=1))


class Torus:
    """Axis from the normals, then a circle through the profile, then least squares."""

    name = "torus"
    least = 12
    bends = (0.01, 1.0)
    saddle = True
    handicap = 1.5

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """Circle through the profile of the vertices that polygons share, about the axis of the normals."""
        work, count = batch.patchwork, batch.count
        axis, point, usable = rotation_axes(batch)
        region, vertex = batch.inner_vertices(2)
        params = np.zeros((count, 8))
        params[:, :3], params[:, 3:6] = axis, point
        t, rho, _ = _revolved.split(params[region], work.vertices[vertex])
        size = np.maximum(np.bincount(region, minlength=count), 1)
        rho0, t0 = np.bincount(region, rho, count) / size, np.bincount(region, t, count) / size
        u, v = rho - rho0[region], t - t0[region]
        matrix, right = normal_equations(region, np.stack([u, v, np.ones_like(u)], axis=1), u * u + v * v, count)
        solution = solve_normal(matrix, right)
        major, along = rho0 + solution[:, 0] / 2, t0 + solution[:, 1] / 2
        square = solution[:, 2] + (solution[:, 0] ** 2 + solution[:, 1] ** 2) / 4
        params[:, 3:6] += along[:, None] * axis
        params[:, 6], params[:, 7] = major, np.sqrt(np.maximum(square, 0.0))
        sane = (size >= 9) & (square > 0) & (major > 0) & (major < 5.0) & (params[:, 7] < 5.0)
        return params, usable & sane & np.isfinite(params).all(axis=1)

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over offset, tilt and both radii."""
        work, count = batch.patchwork, batch.count
        for step in range(steps):
            if step == 0:
                region, vertex = self.defining(batch, params, tolerance)
            if not len(region):
                return params
            points = work.vertices[vertex]
            mine = params[region]
            matrix, right = normal_equations(
                region, self.jacobian(mine, points), self.probe(mine, points).distance, count
            )  # fmt: skip
            change = -solve_normal(matrix, right, 1e-11)
            x, y = _revolved.basis(params[:, :3])
            bound = params[:, 7:8]
            shift = np.clip(change[:, [0, 1, 4]], -bound, bound)
            tilt = np.clip(change[:, 2:4], -0.3, 0.3)
            moved = params.copy()
            moved[:, 3:6] += shift[:, :1] * x + shift[:, 1:2] * y + shift[:, 2:] * params[:, :3]
            leaning = params[:, :3] + tilt[:, :1] * x + tilt[:, 1:] * y
            moved[:, :3] = leaning / np.maximum(np.linalg.norm(leaning, axis=1), 1e-300)[:, None]
            moved[:, 6:] = np.maximum(params[:, 6:] + np.clip(change[:, 5:], -bound / 2, bound), 1e-9)
            params = np.where(np.isfinite(moved).all(axis=1, keepdims=True), moved, params)
            if np.abs(change).max(initial=0.0) < _revolved.CONVERGED:
                break
        return params

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance from the tube, its normal, and the larger radius: that about the axis."""
        t, rho, radial = _revolved.split(params, points)
        across = rho - params[:, 6]
        q = np.sqrt(across * across + t * t)
        scale = 1.0 / np.maximum(q, 1e-300)
        normal = (across * scale)[:, None] * radial + (t * scale)[:, None] * params[:, :3]
        return Probe(q - params[:, 7], normal, params[:, 6] + params[:, 7])

    def widths(self, batch: Batch, params: Params) -> Array:
        """Twice the greatest angle between the normals at a polygon's middle and at a vertex of it."""
        owner, _ = batch.corners
        mine = params[batch.region]
        middle = self.probe(mine, batch.patchwork.centre[batch.polygon]).normal
        apart = self.probe(mine[owner], batch.points).normal - middle[owner]
        square = np.zeros(len(batch.polygon))
        np.maximum.at(square, owner, np.einsum("ij,ij->i", apart, apart))
        return np.asarray(4 * np.arcsin(np.minimum(np.sqrt(square) / 2, 1.0)))

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """Vertices that two of the region's polygons share, where they lie on the surface."""
        region, vertex = batch.inner_vertices(2)
        distance = np.abs(self.probe(params[region], batch.patchwork.vertices[vertex]).distance)
        keep = distance < 4 * tolerance[region]
        return region[keep], vertex[keep]

    def jacobian(self, params: Params, points: Array) -> Array:
        """By offset across the axis (2), tilt (2), offset along the axis, major and minor radius."""
        t, rho, radial = _revolved.split(params, points)
        across = rho - params[:, 6]
        scale = 1.0 / np.maximum(np.sqrt(across * across + t * t), 1e-300)
        x, y = _revolved.basis(params[:, :3])
        rx, ry = np.einsum("ij,ij->i", radial, x), np.einsum("ij,ij->i", radial, y)
        out, up = across * scale, t * scale
        lever = params[:, 6] * up
        return np.stack([-out * rx, -out * ry, lever * rx, lever * ry, -up, -out, -np.ones_like(t)], axis=1)

    def credible(self, batch: Batch, params: Params, scale: Scale) -> Flags:
        """Rings enough in the profile, places enough around the axis, and curved both ways: with neither a
        sphere nor a cylinder within the tolerance."""
        count = batch.count
        region, vertex = self.defining(batch, params, np.full(count, scale.fit))
        if not len(region):
            return np.zeros(count, bool)
        mine = params[region]
        t, rho, radial = _revolved.split(mine, batch.patchwork.vertices[vertex])
        x, y = _revolved.basis(mine[:, :3])
        around = np.arctan2(np.einsum("ij,ij->i", radial, y), np.einsum("ij,ij->i", radial, x))
        tube = np.arctan2(t, rho - mine[:, 6])
        step = 0.2 * quantile(batch.region, self.widths(batch, params), count, 0.75)
        rings = _distinct(region, tube, step, count)
        places = _distinct(region, around, 0.3 * step, count)
        low, high = np.full(count, np.inf), np.full(count, -np.inf)
        middle = _middle(region, tube, count)
        turned = np.angle(np.exp(1j * (tube - middle[region])))
        np.minimum.at(low, region, turned)
        np.maximum.at(high, region, turned)
        sweep = np.where(high > low, np.minimum(high - low, np.pi), 0.0)
        bow = params[:, 7] * (1 - np.cos(sweep / 2))
        bent = (rings >= RINGS) & (places >= STEPS) & (bow > 4 * scale.fit)
        return np.asarray(bent & (params[:, 6] > 10 * scale.fit) & (params[:, 6] > 0.02 * params[:, 7]))


def _middle(region: Ints, angle: Array, count: int) -> Array:
    """Mean direction of the angles of each region."""
    return np.asarray(np.arctan2(np.bincount(region, np.sin(angle), count), np.bincount(region, np.cos(angle), count)))


def _distinct(region: Ints, angle: Array, step: Array, count: int) -> Ints:
    """Number of angles of each region that differ by more than its step."""
    order = np.lexsort((angle, region))
    region, angle = region[order], angle[order]
    fresh = np.r_[True, (region[1:] != region[:-1]) | (np.diff(angle) > step[region[1:]])]
    return np.bincount(region[fresh], minlength=count).astype(np.int64)
