"""Circular cones: countersinks, chamfers, tapers, points. Proposed here, fitted by least squares in `ruled`."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.constants import ROWS
from kinform.surfaces.groups import (
    columns_of,
    group_mean,
    group_mean_of,
    group_moments,
    group_range,
    normal_equations,
    slices,
    solve_normal,
    spheres_of,
    sums_of,
)
from kinform.surfaces.kinds.axial import frames
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.constants import LARGEST, LEAST_POINTS, SAGITTA
from kinform.surfaces.kinds.ruled import Ruled
from kinform.surfaces.polygons.noise import Scales


class Cone(Ruled):
    """Axis from the small circle of the normals, then radius linear along the axis, then least squares."""

    name = "cone"
    least = 4
    bends = (0.0, 0.6)
    saddle = False
    handicap = 1.2
    tapers = True

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """ρ² as a polynomial in the position along the axis is linear in centre and taper."""
        work, count = batch.patchwork, batch.count
        normal, weight = work.normals(batch.polygon), work.area.take(batch.polygon)
        offset = normal - columns_of(group_mean(batch.region, normal, count, weight), batch.region)
        matrix = group_moments(batch.region, offset.T, count, weight)
        values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
        axis = np.ascontiguousarray(vectors[:, :, 0])
        # Variance of the normals along the axis, as a share of the next, below which they lie on the circle of a cone.
        # Chosen, not measured.
        circle = values[:, 0] < 1e-2 * values[:, 1]
        region, edge, inner = batch.edges
        rows = (inner & work.smooth.take(edge) & circle.take(region)).nonzero()[0]
        region, edge = region.take(rows), edge.take(rows)
        params, usable = _taper(batch, axis, region, edge)
        return params, usable & circle

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """At least five generators, a sagitta above the tolerance, and a taper that no cylinder has."""
        lines, sweep, even = self.evident(batch, params, scale)
        region = batch.region[batch.corners[0]]
        t = dot(batch.points - columns_of(params[:, 3:6], region), columns_of(params[:, :3], region))
        low, high = (np.where(batch.size > 0, end, 0.0) for end in group_range(region, t, batch.count))
        slope = np.tan(params[:, 7])
        largest = np.maximum(params[:, 6] + high * slope, params[:, 6] + low * slope)
        sagitta = largest * (1 - np.cos(sweep / 2)) * np.cos(params[:, 7])
        taper = (high - low) * np.abs(np.sin(params[:, 7]))
        # ends that differ in radius by less are those of a cylinder
        return np.asarray((lines >= 5) & even & (sagitta > SAGITTA * scale.fit) & (taper > 2 * scale.fit))


def _taper(batch: Batch, axis: Array, region: Ints, edge: Ints) -> tuple[Params, Flags]:
    """The cone about each axis through the ends of its region's edges, and whether there is one."""
    work, count = batch.patchwork, batch.count
    x, y = frames(axis)
    group = np.repeat(region, 2)
    vertex = work.ends[edge].ravel()
    middle = group_mean_of(group, list(work.columns), vertex, count)
    u, v, t = np.empty((3, len(vertex)))
    for rows in slices(len(vertex), ROWS):
        mine = group[rows]
        offset = work.at(vertex[rows]) - columns_of(middle, mine)
        for out, direction in ((u, x), (v, y), (t, axis)):
            out[rows] = dot(offset, columns_of(direction, mine))
    del vertex
    centre, _ = spheres_of(group, (u, v), count, t, t * t)
    # two rings leave the size of the ring open above, but not its middle; the rest is a line
    u -= centre[:, 0].take(group)
    v -= centre[:, 1].take(group)
    rho = np.hypot(u, v, out=u)
    del v
    line = solve_normal(*normal_equations(sums_of(group, count), np.array([np.ones_like(t), t]), rho))
    params = np.zeros((count, 8))
    params[:, :3] = axis
    params[:, 3:6] = middle + centre[:, :1] * x + centre[:, 1:] * y
    params[:, 6] = np.maximum(line[:, 0], SOLVED)
    params[:, 7] = np.arctan(line[:, 1])
    enough = np.bincount(group, minlength=count) >= LEAST_POINTS
    return params, enough & (line[:, 0] > 0) & (line[:, 0] < LARGEST) & np.isfinite(params).all(axis=1)
