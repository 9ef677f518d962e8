"""Tori: fillets around bosses and bores, O-ring grooves, races of ball bearings.

The axis is that of the turn under which the region slides on itself (see `slippage`). The profile is a circle in the
half-plane of distance from the axis and position along it.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.rounding import ARITHMETIC, SOLVED, TINY
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import columns_of, group_range, quantile, spheres_through
from kinform.surfaces.kinds.axial import azimuths, cylindrical, frames
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.constants import CONVERGED, LARGEST_DOUBLE, RING_APART, SAGITTA, TILT_LIMIT
from kinform.surfaces.kinds.kind import DoublyCurved, Probe, distinct_angles
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.slippage import slippage

TORUS_PITCH = 0.05
"""Advance of the motion of a torus, per arm and one, below which it is a rotation. Chosen, not measured."""


class Torus(DoublyCurved):
    """Axis from the normals, then a circle through the profile, then least squares."""

    name = "torus"
    least = 12
    bends = (0.01, 1.0)
    saddle = True
    handicap = 1.5
    shared = 2
    most_steps = 6
    still = CONVERGED

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """Circle through the profile of the vertices that polygons share, about the axis of the normals."""
        count = batch.count
        axis, point, usable = _rotation_axes(batch)
        region, vertex = batch.inner_vertices(2)
        params = np.zeros((count, 8))
        params[:, :3], params[:, 3:6] = axis, point
        t, rho, _ = cylindrical(columns_of(params, region), batch.patchwork.at(vertex))
        size = np.maximum(np.bincount(region, minlength=count), 1)
        rho0, t0 = np.bincount(region, rho, count) / size, np.bincount(region, t, count) / size
        centre, square = spheres_through(region, np.stack([rho - rho0[region], t - t0[region]], axis=1), count)
        params[:, 3:6] += (t0 + centre[:, 1])[:, None] * axis
        params[:, 6], params[:, 7] = rho0 + centre[:, 0], np.sqrt(np.maximum(square, 0.0))
        small = (params[:, 6] > 0) & (params[:, 6:] < LARGEST_DOUBLE).all(axis=1)
        # fewer vertices suggest no circle of the profile: three determine it
        return params, usable & small & (size >= 9) & (square > 0) & np.isfinite(params).all(axis=1)

    def step(self, params: Params, change: Array) -> Params:
        """By offset across the axis (2), tilt (2), offset along the axis and both radii, by no more than the tube's."""
        x, y = frames(params[:, :3])
        bound = params[:, 7:8]
        shift = np.clip(change[:, [0, 1, 4]], -bound, bound)
        tilt = np.clip(change[:, 2:4], -TILT_LIMIT, TILT_LIMIT)
        stepped = params.copy()
        stepped[:, 3:6] += shift[:, :1] * x + shift[:, 1:2] * y + shift[:, 2:] * params[:, :3]
        leaning = params[:, :3] + tilt[:, :1] * x + tilt[:, 1:] * y
        stepped[:, :3] = leaning / np.maximum(np.linalg.norm(leaning, axis=1), TINY)[:, None]
        stepped[:, 6:] = np.maximum(params[:, 6:] + np.clip(change[:, 5:], -bound / 2, bound), SOLVED)
        return stepped

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance from the tube, its normal, and the larger radius: that about the axis."""
        t, rho, radial = cylindrical(params, points)
        across = rho - params[:, 6]
        q = np.sqrt(across * across + t * t)
        scale = 1.0 / np.maximum(q, TINY)
        normal = (across * scale)[:, None] * radial + (t * scale)[:, None] * params[:, :3]
        return Probe(q - params[:, 7], normal, params[:, 6] + params[:, 7])

    def equations(self, params: Params, points: Array) -> tuple[Array, Array]:
        """By offset across the axis (2), tilt (2), offset along the axis, major and minor radius."""
        t, rho, radial = cylindrical(params, points)
        across = rho - params[:, 6]
        q = np.sqrt(across * across + t * t)
        scale = 1.0 / np.maximum(q, TINY)
        x, y = frames(params[:, :3])
        rx, ry = dot(radial, x), dot(radial, y)
        out, up = across * scale, t * scale
        lever = params[:, 6] * up
        columns = [-out * rx, -out * ry, lever * rx, lever * ry, -up, -out, -np.ones_like(t)]
        return np.array(columns).T, q - params[:, 7]

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """Rings enough in the profile, places enough around the axis, and curved both ways: with neither a
        sphere nor a cylinder within the tolerance."""
        count = batch.count
        region, vertex = self.defining(batch, params, scale.fit)
        if not len(region):
            return np.zeros(count, bool)
        mine = columns_of(params, region)
        t, rho, radial = cylindrical(mine, batch.patchwork.at(vertex))
        tube = np.arctan2(t, rho - mine[:, 6])
        step = RING_APART * quantile(batch.region, self.widths(batch, params), count, 0.75)
        rings = distinct_angles(region, tube, step, count)
        # facets are narrower around the axis than along the profile
        places = distinct_angles(region, azimuths(mine, radial), 0.3 * step, count)
        low, high = group_range(
            region, np.angle(np.exp(1j * (tube - _mean_angles(region, tube, count)[region]))), count
        )
        sweep = np.where(high > low, np.minimum(high - low, np.pi), 0.0)
        bow = params[:, 7] * (1 - np.cos(sweep / 2))
        # three rings of vertices lie on a circle anyway, and four that are symmetric; three places around the axis
        bent = (rings >= 5) & (places >= 3) & (bow > SAGITTA * scale.fit)
        # a middle circle of less than ten fits is that of a sphere
        # Least radius of the middle circle, in radii of the tube: less is a sphere. Chosen, not measured.
        return np.asarray(bent & (params[:, 6] > 10 * scale.fit) & (params[:, 6] > 0.02 * params[:, 7]))


def _rotation_axes(batch: Batch) -> tuple[Array, Array, Flags]:
    """(axis, point, whether there is one) about which each region's polygons turn into themselves."""
    motion = slippage(batch.patchwork, batch.region, batch.polygon, batch.count)
    turn = np.linalg.norm(motion.angular, axis=1)
    scale = np.maximum(turn, ARITHMETIC)[:, None]
    axis, moment = motion.angular / scale, motion.linear / scale
    pitch = np.abs(dot(axis, moment))
    point = motion.middle + cross(axis, moment) * motion.size[:, None]
    # the motion of a torus (patch of radius 1) rotates
    return (
        axis,
        point,
        (turn > 0.05) & (pitch < TORUS_PITCH + TORUS_PITCH * np.linalg.norm(moment, axis=1)),
    )


def _mean_angles(region: Ints, angle: Array, count: int) -> Array:
    """Mean direction of the angles of each region."""
    return np.asarray(np.arctan2(np.bincount(region, np.sin(angle), count), np.bincount(region, np.cos(angle), count)))
