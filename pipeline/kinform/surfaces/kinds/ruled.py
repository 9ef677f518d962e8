"""Cylinder and cone in one: straight generators about an axis.

distance = (ρ − r) cos α − t sin α, with t along the axis from the reference point, ρ the distance from the
axis, r the radius at the reference point. A cylinder has α = 0. The reference point stays beside the
data, so that neither a slender cone's far apex nor a flat one's wrapping angle harms the fit.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import distinct, group_sum, normal_equations, occurrences, quantile, solve_normal
from kinform.surfaces.kinds.kind import ALONG, Batch, Params, Probe

__all__ = [
    "CONVERGED",
    "apices",
    "axis_of_edges",
    "basis",
    "defining",
    "even",
    "gauss_newton",
    "generators",
    "jacobian",
    "lines",
    "probe",
    "regular",
    "split",
    "widths",
    "with_apices",
]  # fmt: skip

BOW = 1e-5
"""Depth (diagonals) to which a generator that leans may dip below the surface: the ends of slanted ridges lie on it,
but a cut between them does not."""

CONVERGED = 1e-13
"""Change of the parameters (rad, diagonals) at which a fit stands still."""

APEX = 0.05
"""Distance from the axis, in radii, within which a vertex of a cone is its apex."""

SECOND = 0.4
"""A strip counts as like the widest when it subtends at least this share of its angle."""


def basis(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors across each axis (N, 3), without branches (Duff and others 2017)."""
    ax, ay, az = axis[:, 0], axis[:, 1], axis[:, 2]
    sign = np.where(az < 0, -1.0, 1.0)
    a = -1.0 / (sign + az)
    b = ax * ay * a
    x, y = np.empty((len(axis), 3)), np.empty((len(axis), 3))
    x[:, 0], x[:, 1], x[:, 2] = 1.0 + sign * ax * ax * a, sign * b, -sign * ax
    y[:, 0], y[:, 1], y[:, 2] = b, sign + ay * ay * a, -ay
    return x, y


def split(params: Params, points: Array) -> tuple[Array, Array, Array]:
    """(t along the axis, ρ across it, unit radial direction) of each point.

    Column by column: the hottest lines of the package, and broadcasting over rows of three costs twice that.
    """
    ax, ay, az = params[:, 0], params[:, 1], params[:, 2]
    x, y, z = points[:, 0] - params[:, 3], points[:, 1] - params[:, 4], points[:, 2] - params[:, 5]
    t = x * ax + y * ay + z * az
    x -= t * ax
    y -= t * ay
    z -= t * az
    rho = np.sqrt(x * x + y * y + z * z)
    scale = 1.0 / np.maximum(rho, 1e-300)
    radial = np.empty((len(t), 3))
    np.multiply(x, scale, out=radial[:, 0])
    np.multiply(y, scale, out=radial[:, 1])
    np.multiply(z, scale, out=radial[:, 2])
    return t, rho, radial


def probe(params: Params, points: Array) -> Probe:
    """Holds points (N, 3) against cones and cylinders (N, 8)."""
    t, rho, radial = split(params, points)
    radius, angle = params[:, 6], params[:, 7]
    if not angle.any():
        return Probe(distance=rho - radius, normal=radial, curvature_radius=radius)
    cos, sin = np.cos(angle), np.sin(angle)
    return Probe(
        distance=(rho - radius) * cos - t * sin,
        normal=cos[:, None] * radial - sin[:, None] * params[:, :3],
        curvature_radius=np.maximum(radius * cos + t * sin, 0.0),
    )


def jacobian(params: Params, points: Array, cone: bool) -> Array:
    """(N, 5 or 6): by offset across the axis (2), tilt (2), radius, and half-angle for cones."""
    x, y = basis(params[:, :3])
    return _columns(*split(params, points), params[:, 6], params[:, 7], x, y, cone)


def _columns(
    t: Array, rho: Array, radial: Array, radius: Array, angle: Array, x: Array, y: Array, cone: bool
) -> Array:  # fmt: skip
    rx = radial[:, 0] * x[:, 0] + radial[:, 1] * x[:, 1] + radial[:, 2] * x[:, 2]
    ry = radial[:, 0] * y[:, 0] + radial[:, 1] * y[:, 1] + radial[:, 2] * y[:, 2]
    out = np.empty((len(t), 6 if cone else 5))
    if cone:
        cos, sin = np.cos(angle), np.sin(angle)
        lever = cos * t + sin * rho
        np.multiply(-cos, rx, out=out[:, 0])
        np.multiply(-cos, ry, out=out[:, 1])
        out[:, 4] = -cos
        out[:, 5] = -(rho - radius) * sin - t * cos
    else:
        lever = t
        np.negative(rx, out=out[:, 0])
        np.negative(ry, out=out[:, 1])
        out[:, 4] = -1.0
    np.multiply(-lever, rx, out=out[:, 2])
    np.multiply(-lever, ry, out=out[:, 3])
    return out


def generators(batch: Batch, params: Params) -> tuple[Ints, Ints, Flags, Flags]:
    """(region, edge, inner, smooth) of the edges that run along a generator."""
    region, edge, inner = batch.edges
    work = batch.patchwork
    start, end = work.vertices[work.ends[edge, 0]], work.vertices[work.ends[edge, 1]]
    mine = params[region]
    _, _, radial = split(mine, (start + end) / 2)
    direction = np.cos(mine[:, 7])[:, None] * mine[:, :3] + np.sin(mine[:, 7])[:, None] * radial
    length = work.length[edge]
    forward = np.abs(np.einsum("ij,ij->i", end - start, direction))
    aside = np.maximum(length * length - forward * forward, 0.0)
    straight = aside < 8 * BOW * np.maximum(np.abs(mine[:, 6]), 1e-12)
    use = (forward > ALONG * length) & straight & (length > 0)
    return region[use], edge[use], inner[use], work.smooth[edge[use]]


def defining(batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
    """(region, vertex): ends of inner ridges, of outer generators that lie on the surface, and vertices
    with three polygons of the region.

    After a boolean, outer generators may lie on chords; smooth ones (tangent to the neighbour) do not.
    """
    work = batch.patchwork
    total = np.int64(len(work.vertices))
    region, edge, inner, _ = generators(batch, params)
    surrounded, vertex = batch.inner_vertices(3)
    keys = [surrounded * total + vertex]
    if len(region):
        ends = work.ends[edge]
        distance = np.maximum(
            np.abs(probe(params[region], work.vertices[ends[:, 0]]).distance),
            np.abs(probe(params[region], work.vertices[ends[:, 1]]).distance),
        )
        use = inner | (distance < tolerance[region])
        keys.append(np.repeat(region[use], 2) * total + ends[use].ravel())
    key = distinct(np.concatenate(keys))
    return key // total, key % total


def gauss_newton(
    batch: Batch, params: Params, tolerance: Array, steps: int, cone: bool, fixed: tuple[Ints, Ints] | None = None
) -> Params:  # fmt: skip
    """Refines over the defining vertices; regions that do not converge keep what they had."""
    work = batch.patchwork
    count = batch.count
    for step in range(steps):
        if fixed is not None:
            region, vertex = fixed
        elif step in (0, 2):
            region, vertex = defining(batch, params, tolerance)
        if not len(region):
            return params
        points = work.vertices[vertex]
        t, rho, radial = split(params[region], points)
        params, middle = _recentred(params, region, t, count)
        t -= middle[region]
        radius, angle = params[region, 6], params[region, 7]
        x, y = basis(params[:, :3])
        columns = _columns(t, rho, radial, radius, angle, x[region], y[region], cone)
        residual = (rho - radius) * np.cos(angle) - t * np.sin(angle) if cone else rho - radius
        group = region
        if cone:
            at = np.flatnonzero(rho < APEX * radius)
            group, columns, residual = with_apices(params[region], points, region, columns, residual, at)
        matrix, right = normal_equations(group, columns, residual, count)
        change = -solve_normal(matrix, right, 1e-11)
        params = _moved(params, change, cone)
        if np.abs(change).max(initial=0.0) < CONVERGED:
            break
    return params


def apices(params: Params, points: Array) -> Ints:
    """Which points lie at the apex of their cone."""
    _, rho, _ = split(params, points)
    return np.flatnonzero(rho < APEX * params[:, 6])


def with_apices(
    params: Params, points: Array, region: Ints, columns: Array, residual: Array, at: Ints
) -> tuple[Ints, Array, Array]:  # fmt: skip
    """The equations, with vertices at an apex put on the axis: their distance has no gradient there, and
    without them a cone of one ring and a point may tilt as it likes."""
    if not len(at):
        return region, columns, residual
    columns = columns.copy()
    columns[at, :4] = 0.0
    mine = params[at]
    t = np.einsum("ij,ij->i", points[at] - mine[:, 3:6], mine[:, :3])
    across = points[at] - mine[:, 3:6] - t[:, None] * mine[:, :3]
    extra, off = [], []
    for number, direction in enumerate(basis(mine[:, :3])):
        row = np.zeros((len(at), columns.shape[1]))
        row[:, number], row[:, 2 + number] = -1.0, -t
        extra.append(row)
        off.append(np.einsum("ij,ij->i", across, direction))
    return (
        np.concatenate([region, region[at], region[at]]),
        np.concatenate([columns, *extra]),
        np.concatenate([residual, *off]),
    )


def _recentred(params: Params, region: Ints, t: Array, count: int) -> tuple[Params, Array]:
    """Moves each reference point along its axis beside the mean of the points; by how much (R,)."""
    size = np.maximum(np.bincount(region, minlength=count), 1)
    middle = np.bincount(region, t, count) / size
    out = params.copy()
    out[:, 3:6] += middle[:, None] * params[:, :3]
    out[:, 6] += middle * np.tan(params[:, 7])
    return out, middle


def _moved(params: Params, change: Array, cone: bool) -> Params:
    x, y = basis(params[:, :3])
    limit = np.abs(params[:, 6])[:, None] + 1e-6
    shift = np.clip(change[:, :2], -limit, limit)
    tilt = np.clip(change[:, 2:4], -0.3, 0.3)
    out = params.copy()
    out[:, 3:6] += shift[:, :1] * x + shift[:, 1:] * y
    axis = params[:, :3] + tilt[:, :1] * x + tilt[:, 1:] * y
    out[:, :3] = axis / np.maximum(np.linalg.norm(axis, axis=1), 1e-300)[:, None]
    out[:, 6] = np.maximum(params[:, 6] + np.clip(change[:, 4], -limit[:, 0] / 2, limit[:, 0]), 1e-9)
    if cone:
        out[:, 7] = np.clip(params[:, 7] + np.clip(change[:, 5], -0.3, 0.3), -1.567, 1.567)
    good = np.all(np.isfinite(out), axis=1, keepdims=True)
    return np.where(good, out, params)


def axis_of_edges(batch: Batch) -> tuple[Array, Array]:
    """(axis, how nearly all inner edges run along it, 1 for exactly) of each region."""
    work = batch.patchwork
    region, edge, inner = batch.edges
    region, edge = region[inner], edge[inner]
    along = work.vertices[work.ends[edge, 1]] - work.vertices[work.ends[edge, 0]]
    matrix = group_sum(region, along[:, :, None] * along[:, None, :], batch.count)
    values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
    total = np.maximum(values.sum(axis=1), 1e-300)
    return np.ascontiguousarray(vectors[:, :, 2]), values[:, 2] / total


def widths(batch: Batch, params: Params) -> Array:
    """(pairs,) angle about the axis that each polygon subtends."""
    work = batch.patchwork
    owner, _ = batch.corners
    mine = params[batch.region]
    _, _, middle = split(mine, work.centre[batch.polygon])
    _, rho, radial = split(mine[owner], batch.points)
    cos = np.einsum("ij,ij->i", radial, middle[owner])
    side = cross(mine[:, :3], middle)
    sin = np.einsum("ij,ij->i", radial, side[owner])
    angle = np.where(rho > 1e-3 * np.abs(mine[owner, 6]), np.arctan2(sin, cos), 0.0)
    high, low = np.zeros(len(batch.polygon)), np.zeros(len(batch.polygon))
    np.maximum.at(high, owner, angle)
    np.minimum.at(low, owner, angle)
    return high - low


def even(batch: Batch, width: Array) -> Flags:
    """Whether each region's widest polygon has a second of like width: a flat between two bevels is none."""
    order = np.lexsort((-width, batch.region))
    region, ordered = batch.region[order], width[order]
    start = np.searchsorted(region, np.arange(batch.count + 1))
    out = np.zeros(batch.count, bool)
    several = np.diff(start) >= 2
    first = start[:-1][several]
    out[several] = ordered[first + 1] >= SECOND * ordered[first]
    return out


def regular(batch: Batch, params: Params) -> Flags:
    """Whether the strips between ridges are two at least, and subtend the same angle, as do the turns at the
    ridges: three ridges fit a circle anyway, but not with equal steps."""
    work, count = batch.patchwork, batch.count
    region, edge, inner, _ = generators(batch, params)
    region, edge = region[inner], edge[inner]
    total = np.int64(work.count)
    sides = np.r_[region * total + work.a[edge], region * total + work.b[edge]]
    key, times = occurrences(sides)
    whole = np.isin(batch.region * total + batch.polygon, key[times >= 2])
    width = widths(batch, params)
    group = np.r_[batch.region[whole], region]
    angle = np.r_[width[whole], work.angle[edge]]
    low, high = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(low, group, angle)
    np.maximum.at(high, group, angle)
    return np.asarray((np.bincount(batch.region[whole], minlength=count) >= 2) & (high < 1.02 * low))


def lines(batch: Batch, params: Params, tolerance: Array) -> Ints:
    """Number of distinct generators, apart by more than a fifth of a typical facet, that lie on the surface."""
    work = batch.patchwork
    region, vertex = defining(batch, params, tolerance)
    if not len(region):
        return np.zeros(batch.count, np.int64)
    mine = params[region]
    x, y = basis(mine[:, :3])
    _, _, radial = split(mine, work.vertices[vertex])
    angle = np.arctan2(np.einsum("ij,ij->i", radial, y), np.einsum("ij,ij->i", radial, x))
    order = np.lexsort((angle, region))
    region, angle = region[order], angle[order]
    step = 0.2 * quantile(batch.region, widths(batch, params), batch.count, 0.75)
    fresh = np.r_[True, (region[1:] != region[:-1]) | (np.diff(angle) > step[region[1:]])]
    return np.bincount(region[fresh], minlength=batch.count).astype(np.int64)
