"""Circular cylinders: shafts and bores."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import among, ascending, occurrences
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import group_mean, group_moments, group_range, repeated, spheres_of
from kinform.surfaces.kinds.axial import frames
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.constants import LARGEST, LEAST_POINTS, SAGITTA
from kinform.surfaces.kinds.ruled import Ruled, generators
from kinform.surfaces.polygons.noise import Scales


class Cylinder(Ruled):
    """Axis from the ridges (or the normals, where ridges are short), then a circle, then least squares."""

    name = "cylinder"
    least = 3
    bends = (0.0, 0.45)
    saddle = False
    handicap = 1.0
    tapers = False

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """Circle through the ends of the ridges, seen along the axis."""
        work = batch.patchwork
        axis, agreement = _axis_of_edges(batch)
        # Share of the squared lengths of the inner edges that lies along one direction, above which these edges are the
        # ridges of a cylinder. Chosen, not measured.
        vague, number = batch.select(~(agreement > 0.98).take(batch.region)).compact()
        axis[number] = _axis_of_normals(vague)
        params = np.zeros((batch.count, 8))
        params[:, :3], params[:, 6] = axis, np.inf
        region, edge, inner = generators(batch, params)
        inner_count = np.bincount(region[inner], minlength=batch.count)
        use = inner | work.smooth.take(edge) | (inner_count[region] < 3)
        surrounded, vertex = batch.inner_vertices(3)
        rows = use.nonzero()[0]
        ends = work.ends.take(edge.take(rows), axis=0).ravel()
        group = np.concatenate([region.take(rows).repeat(2), surrounded])
        return _circle(batch, axis, group, np.concatenate([ends, vertex]))

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """At least four generators, or three at equal steps; two strips of like width; and a sagitta well above the
        tolerance."""
        lines, sweep, even = self.evident(batch, params, scale)
        sagitta = params[:, 6] * (1 - np.cos(sweep / 2))
        several = (lines >= 4) | ((lines == 3) & self._regular(batch, params))
        return np.asarray(several & even & (sagitta > SAGITTA * scale.fit) & (params[:, 6] < LARGEST))

    def _regular(self, batch: Batch, params: Params) -> Flags:
        """Whether the strips between ridges are two at least, and subtend the same angle, as do the turns at the
        ridges: three ridges fit a circle anyway, but not with equal steps."""
        work, count = batch.patchwork, batch.count
        region, edge, inner = generators(batch, params)
        region, edge = region[inner], edge[inner]
        total = np.int64(work.count)
        key, times = occurrences(np.concatenate([region * total + work.a[edge], region * total + work.b[edge]]))
        whole = among(batch.keys, key[times >= 2])
        angle = np.concatenate([self.widths(batch, params)[whole], work.angle[edge]])
        low, high = group_range(np.concatenate([batch.region[whole], region]), angle, count)
        # Ratio of the angles of strips and ridges up to which their steps are equal: 2 % is far above rounding. Chosen,
        # not measured.
        return np.asarray((np.bincount(batch.region[whole], minlength=count) >= 2) & (high < 1.02 * low))


def _axis_of_edges(batch: Batch) -> tuple[Array, Array]:
    """(axis, how nearly all inner edges run along it, 1 for exactly) of each region."""
    work = batch.patchwork
    region, edge, inner = batch.edges
    rows = inner.nonzero()[0]
    matrix = group_moments(region.take(rows), work.along(edge.take(rows)).T, batch.count)
    values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
    total = np.maximum(values.sum(axis=1), TINY)
    return np.ascontiguousarray(vectors[:, :, 2]), values[:, 2] / total


def _axis_of_normals(batch: Batch) -> Array:
    """(R, 3) direction across which the normals of each region are most nearly."""
    work = batch.patchwork
    normal, weight = work.normals(batch.polygon), work.area.take(batch.polygon)
    _, vectors = np.linalg.eigh(np.nan_to_num(group_moments(batch.region, normal.T, batch.count, weight)))
    return np.asarray(vectors[:, :, 0])


def _circle(batch: Batch, axis: Array, region: Ints, vertex: Ints) -> tuple[Params, Flags]:
    """The cylinder about each axis through the vertices of its region, and whether there is one."""
    x, y = frames(axis)
    order = ascending(region, batch.count)
    region, points = region.take(order), batch.patchwork.at(vertex.take(order))
    sizes = np.bincount(region, minlength=batch.count)
    middle = group_mean(region, points, batch.count)
    frame = repeated(np.array([*middle.T, *x.T, *y.T]).T, sizes)
    offset = points - frame[:, :3]
    seen = [dot(offset, frame[:, 3:6]), dot(offset, frame[:, 6:])]
    centre, square = spheres_of(region, seen, batch.count)
    params = np.zeros((batch.count, 8))
    params[:, :3] = axis
    params[:, 3:6] = middle + centre[:, :1] * x + centre[:, 1:] * y
    params[:, 6] = np.sqrt(np.maximum(square, 0.0))
    enough = sizes >= LEAST_POINTS
    return params, enough & (square > 0) & (params[:, 6] < LARGEST) & np.isfinite(params).all(axis=1)
