"""From regions of polygons to the surfaces that other stages read, with the uncertainty of each fit.

Uncertainty: covariance of the least squares over the defining vertices, with the larger of their scatter
and of what single-precision storage loses, times COVERAGE. Coordinates here are those of the unit mesh.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinform.foundation.algebra.vectors import canonical_sign, dot
from kinform.foundation.constants import COVERAGE
from kinform.foundation.rounding import ARITHMETIC, SINGLE, TINY
from kinform.foundation.sorting import distinct
from kinform.model.arrays import Array, Ints
from kinform.model.surfaces import SurfaceKind
from kinform.surfaces.groups import columns_of, group_range, group_sum, members, normal_equations, parted, sums_of
from kinform.surfaces.kinds.axial import angular_widths, azimuths, cylindrical
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.kind import Kind
from kinform.surfaces.kinds.ruled import APEX, with_apices
from kinform.surfaces.polygons.coplanar import fit_planes
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.candidates import Candidates

SINGULAR = 1e-14
"""Ratio of eigenvalues below which a direction of the parameters is undetermined."""

ROUNDED_SCATTER = 0.3
"""Least scatter of the vertices of a curved surface, in roundings: rounding to a step of one scatters by 1/√12."""


class Description(NamedTuple):
    """One surface in unit coordinates; fields as those of `Surface`."""

    kind: SurfaceKind
    polygons: Ints
    axis: Array
    point: Array
    radius: float = 0.0
    half_angle: float = 0.0
    minor_radius: float = 0.0
    pitch: float = 0.0
    side: int = 1
    extent: tuple[float, float] = (0.0, 0.0)
    sweep: float = 0.0
    residual: float = 0.0
    axis_uncertainty: float = 0.0
    point_uncertainty: float = 0.0
    chord: float = 0.0
    squares: float = 0.0
    """Sum of squared distances of the defining vertices, and their number."""
    samples: int = 0


def flat(work: Patchwork, number: Ints, scales: Scales) -> list[Description]:
    """The planes that polygons (P,) with equal numbers make, -1 for none, each through all its vertices."""
    planes = members(number)
    count = len(planes)
    if not count:
        return []
    member = np.concatenate(planes)
    group = np.repeat(np.arange(count), [len(polygons) for polygons in planes])
    owner, vertex = work.corners.expand(member)
    total = np.int64(len(work.vertices))
    region, vertex = parted(distinct(group[owner] * total + vertex), int(total))
    points = work.at(vertex)
    outward = group_sum(group, work.normal[member] * work.area[member][:, None], count)
    size = np.linalg.norm(outward, axis=1)
    heads = np.array([polygons[0] for polygons in planes])
    rounding, first = scales.rounding[work.mesh[heads]], work.normal[heads]
    outward = np.where(size[:, None] > 0, outward / np.maximum(size, TINY)[:, None], first)
    normal, centre, variances = fit_planes(region, points, outward)
    distance = dot(points - columns_of(centre, region), columns_of(normal, region))
    squares, samples, deepest = _deviations(region, distance, count)
    # Least scatter of the vertices of planes, in roundings, which are stated twice as carefully.
    scatter = np.maximum(np.sqrt(squares / np.maximum(samples - 3, 1)), 0.6 * rounding)
    spread = np.maximum(np.sqrt(variances[:, 1] * samples), ARITHMETIC)
    angular = np.minimum(COVERAGE * scatter / spread, np.pi / 2)
    linear = np.maximum(COVERAGE * scatter / np.sqrt(np.maximum(samples, 1)), rounding)
    numbers = (values.tolist() for values in (deepest, angular, linear, squares, samples))
    return [
        Description(
            "plane", polygons, axis, point, residual=deep, axis_uncertainty=turn, point_uncertainty=shift, chord=deep,
            squares=square, samples=many,
        )
        for polygons, axis, point, deep, turn, shift, square, many in zip(planes, normal, centre, *numbers, strict=True)
    ]  # fmt: skip


def _deviations(region: Ints, distance: Array, count: int) -> tuple[Array, Ints, Array]:
    """Sum of squares, number and greatest size of the distances of each region's vertices."""
    squares: Array = np.bincount(region, distance * distance, count).astype(float)
    samples: Ints = np.bincount(region, minlength=count).astype(np.int64)
    deepest = np.zeros(count)
    np.maximum.at(deepest, region, np.abs(distance))
    return squares, samples, deepest


def freeform(polygons: Ints, chord: float) -> Description:
    """A patch that no analytic surface explains."""
    return Description("freeform", polygons, np.zeros(3), np.zeros(3), chord=chord)


def standoffs(work: Patchwork, edges: Ints) -> Array:
    """(n,) how far the facets at these edges may stand off a smooth surface through their vertices."""
    a, b, length = work.a[edges], work.b[edges], np.maximum(work.length[edges], TINY)
    area = np.minimum(work.area[a], work.area[b])
    # a short common edge says nothing of how far the two polygons reach from it
    width = np.minimum(area / length, 2 * np.sqrt(area))
    return np.asarray(width * work.angle[edges] / 8)


def patch_chords(work: Patchwork, number: Ints) -> Array:
    """(n,) the greatest of those inside each patch of polygons (P,), numbered from 0, -1 for none."""
    edges = np.flatnonzero(work.smooth)
    mine = number[work.a[edges]]
    inside = np.flatnonzero((mine >= 0) & (mine == number[work.b[edges]]))
    out = np.zeros(int(number.max(initial=-1)) + 1)
    np.maximum.at(out, mine[inside], standoffs(work, edges[inside]))
    return out


def curved(surfaces: Candidates, batch: Batch, scale: Scales) -> list[Description]:
    """Every region of one kind, with its final fit."""
    work, count, kind = batch.patchwork, batch.count, surfaces.kind
    params = surfaces.refine(batch, 6).params
    region = batch.region[batch.corners[0]]
    low, high = group_range(
        region, dot(batch.points - columns_of(params[:, 3:6], region), columns_of(params[:, :3], region)), count
    )
    placed = _reference_points(kind.name, params, low, high)
    region, vertex = kind.defining(batch, params, surfaces.tolerance)
    points = work.at(vertex)
    distance = kind.probe(columns_of(params, region), points).distance
    squares, samples, deepest = _deviations(region, distance, count)
    columns, group = kind.jacobian(columns_of(placed, region), points), region
    if kind.name == "cone":
        tips = np.flatnonzero(cylindrical(params[region], points).rho < APEX * params[region, 6])
        group, columns, _ = with_apices(placed[region[tips]], points[tips], region, columns, distance, tips)
    has_axis = kind.name != "sphere"
    angular, linear = _uncertainties(group, columns, squares, samples, scale, has_axis)
    chords = _chords(kind, batch, params)
    width = angular_widths(batch, placed) if kind.name == "torus" else kind.widths(batch, params)
    sweeps = angles_covered(placed, batch, width) if has_axis else np.zeros(count)
    numbers = (surfaces.side, low, high, sweeps, deepest, angular, linear, chords, squares, samples)
    out = []
    for k, (polygons, side, start, end, sweep, deep, turn, shift, chord, square, many) in enumerate(
        zip(members(batch.region), *(values.tolist() for values in numbers), strict=True)
    ):
        axis, point, radius, half_angle, extent = _in_senses(kind.name, placed[k], params[k], start, end)
        out.append(
            Description(
                kind.name, batch.polygon[polygons], axis, point, radius=radius, half_angle=half_angle,
                minor_radius=float(params[k, 7]) if kind.name == "torus" else 0.0, side=side, extent=extent,
                sweep=sweep, residual=deep, axis_uncertainty=turn, point_uncertainty=shift, chord=chord,
                squares=square, samples=many,
            )
        )  # fmt: skip
    return out


def _reference_points(name: str, params: Params, low: Array, high: Array) -> Params:
    """Parameters with the reference point where the surface's `point` will be."""
    out = params.copy()
    if name == "cylinder":
        out[:, 3:6] += ((low + high) / 2)[:, None] * params[:, :3]
    elif name == "cone":
        out[:, 3:6] -= (params[:, 6] / np.tan(params[:, 7]))[:, None] * params[:, :3]
        out[:, 6] = 0.0
    return out


def _in_senses(
    name: str, placed: Array, params: Array, low: float, high: float
) -> tuple[Array, Array, float, float, tuple[float, float]]:
    """(axis, point, radius, half-angle, extent from the point) in the senses that `Surface` promises."""
    point = placed[3:6].copy()
    if name == "sphere":
        return np.zeros(3), point, float(params[6]), 0.0, (0.0, 0.0)
    axis = params[:3].copy()
    if name == "torus":
        return axis * canonical_sign(axis), point, float(params[6]), 0.0, (float(low), float(high))
    if name == "cylinder":
        half = float(high - low) / 2
        return axis * canonical_sign(axis), point, float(params[6]), 0.0, (-half, half)
    along = float((params[3:6] - point) @ axis)
    bounds = sorted((float(low) + along, float(high) + along))
    if params[7] < 0:
        axis, bounds = -axis, [-bounds[1], -bounds[0]]
    return axis, point, 0.0, abs(float(params[7])), (bounds[0], bounds[1])


def _uncertainties(
    region: Ints, columns: Array, squares: Array, samples: Ints, scale: Scales, has_axis: bool
) -> tuple[Array, Array]:  # fmt: skip
    """(rad, unit lengths) of each region, from the least squares at the surface's point."""
    count, free = len(samples), columns.shape[1]
    freedom = np.maximum(samples - free, 1)
    scatter = np.maximum(np.sqrt(squares / freedom), ROUNDED_SCATTER * scale.rounding)
    matrix, _ = normal_equations(sums_of(region, count), columns.T, np.zeros(len(columns)))
    size = np.sqrt(np.maximum(np.einsum("rii->ri", matrix), TINY))
    outer = size[:, :, None] * size[:, None, :]
    inverse = np.linalg.pinv(np.ascontiguousarray(matrix) / outer, hermitian=True, rcond=SINGULAR) / outer
    vague = samples <= free
    offset = _largest(inverse[:, :2, :2] if has_axis else inverse[:, :3, :3])
    linear = np.where(vague, 1.0, COVERAGE * scatter * offset)
    if not has_axis:
        return np.where(vague, np.pi / 2, 0.0), linear
    tilt = _largest(inverse[:, 2:4, 2:4])
    angular = np.where(vague, np.pi / 2, np.minimum(COVERAGE * scatter * tilt, np.pi / 2))
    return angular, np.maximum(linear, ROUNDED_SCATTER * scale.rounding)


def _largest(covariance: Array) -> Array:
    """Root of the largest eigenvalue of each matrix."""
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(covariance)[:, -1], 0.0)))


def _chords(kind: Kind, batch: Batch, params: Params) -> Array:
    """Greatest depth of a facet's edge middles and centroid below each surface."""
    work = batch.patchwork
    deepest = np.zeros(batch.count)
    region, edge, _ = batch.edges
    middles = (work.at(work.ends[:, 0].take(edge)) + work.at(work.ends[:, 1].take(edge))) / 2
    centres = work.middles(batch.polygon)
    for owner, points in ((region, middles), (batch.region, centres)):
        np.maximum.at(deepest, owner, np.abs(kind.probe(columns_of(params, owner), points).distance))
    return deepest


def angles_covered(params: Params, batch: Batch, width: Array) -> Array:
    """Length of the union of the angles that each region's polygons, in order, subtend about its axis."""
    count, region, turn = len(params), batch.region, 2 * np.pi
    mine = columns_of(params, region)
    middle = azimuths(mine, batch.patchwork.middles(batch.polygon) - mine[:, 3:6])
    low = np.mod(middle - width / 2, turn)
    high = low + width
    order = np.lexsort((low, region))
    region, low, high = region[order], low[order], high[order]
    wrapped = np.zeros(count)
    np.maximum.at(wrapped, region, high - turn)
    # the greatest angle reached before each polygon, by ranks: sums with the number of the region would be rounded
    by_size = np.argsort(high, kind="stable")
    rank = np.empty(len(high), np.int64)
    rank[by_size] = np.arange(len(high))
    before = np.maximum.accumulate(region * np.int64(len(high)) + rank)
    reach = wrapped[region]
    same = np.flatnonzero(region[1:] == region[:-1]) + 1
    reach[same] = np.maximum(reach[same], high[by_size[before[same - 1] % len(high)]])
    covered = np.bincount(region, np.maximum(np.minimum(high, turn) - np.maximum(low, reach), 0), count) + wrapped
    return np.where(covered > turn - SINGLE, turn, covered)
