"""From regions of polygons to the surfaces that other stages read, with the uncertainty of each fit.

Uncertainty: covariance of the least squares over the defining vertices, with the larger of their scatter
and of what single-precision storage loses, times COVERAGE. Coordinates here are those of the unit mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.model.arrays import Array, Ints
from kinform.surfaces.groups import group_sum, normal_equations
from kinform.surfaces.kinds import plane
from kinform.surfaces.kinds import ruled as _revolved
from kinform.surfaces.kinds.kind import Batch, Kind, Params
from kinform.surfaces.kinds.kind import widths as widths_of
from kinform.surfaces.kinds.ruled import basis
from kinform.surfaces.polygons.patchwork import Patchwork, Scale

__all__ = ["COVERAGE", "Description", "canonical", "curved", "flat", "freeform"]

COVERAGE = 3.0
"""Stated uncertainties are this many standard deviations."""


@dataclass(frozen=True, eq=False)
class Description:
    """One surface in unit coordinates; fields as those of `Surface`."""

    kind: str
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


def flat(work: Patchwork, number: Ints, scale: Scale) -> list[Description]:
    """The planes that polygons (P,) with equal numbers make, -1 for none, each through all its vertices."""
    member = np.flatnonzero(number >= 0)
    member = member[np.argsort(number[member], kind="stable")]
    _, group = np.unique(number[member], return_inverse=True)
    count = int(group[-1]) + 1 if len(group) else 0
    owner, vertex = work.corners.expand(member)
    total = np.int64(max(len(work.vertices), 1))
    key = np.unique(group[owner] * total + vertex)
    region, points = key // total, work.vertices[key % total]
    outward = group_sum(group, work.normal[member] * work.area[member][:, None], count)
    size = np.linalg.norm(outward, axis=1)
    first = np.searchsorted(group, np.arange(count + 1))
    outward = np.where(size[:, None] > 0, outward / np.maximum(size, 1e-300)[:, None], work.normal[member[first[:-1]]])
    normal, centre, variances = plane.fit(region, points, outward)
    distance = np.einsum("ij,ij->i", points - centre[region], normal[region])
    squares = np.bincount(region, distance * distance, count)
    samples = np.bincount(region, minlength=count)
    deepest = np.zeros(count)
    np.maximum.at(deepest, region, np.abs(distance))
    scatter = np.maximum(np.sqrt(squares / np.maximum(samples - 3, 1)), 0.6 * scale.rounding)
    spread = np.maximum(np.sqrt(variances[:, 1] * samples), 1e-12)
    angular = np.minimum(COVERAGE * scatter / spread, np.pi / 2)
    linear = np.maximum(COVERAGE * scatter / np.sqrt(np.maximum(samples, 1)), scale.rounding)
    return [
        Description(
            kind="plane",
            polygons=member[first[k] : first[k + 1]],
            axis=normal[k],
            point=centre[k],
            residual=float(deepest[k]),
            axis_uncertainty=float(angular[k]),
            point_uncertainty=float(linear[k]),
            chord=float(deepest[k]),
            squares=float(squares[k]),
            samples=int(samples[k]),
        )
        for k in range(count)
    ]


def freeform(work: Patchwork, polygons: Ints, numbers: Ints) -> Description:
    """A patch that no analytic surface explains; `numbers` are its inner edges."""
    a, b, length = work.a[numbers], work.b[numbers], np.maximum(work.length[numbers], 1e-300)
    area = np.minimum(work.area[a], work.area[b])
    # a short common edge says nothing of how far the two polygons reach from it
    width = np.minimum(area / length, 2 * np.sqrt(area))
    chord = float((width * work.angle[numbers]).max() / 8) if len(numbers) else 0.0
    return Description("freeform", polygons, np.zeros(3), np.zeros(3), chord=chord)


def curved(kind: Kind, batch: Batch, params: Params, side: Ints, tolerance: Array, scale: Scale) -> list[Description]:
    """Every region of one kind, with its final fit."""
    work = batch.patchwork
    params = kind.refine(batch, params, tolerance, 6)
    region = batch.region[batch.corners[0]]
    t = np.einsum("ij,ij->i", batch.points - params[region, 3:6], params[region, :3])
    low, high = np.full(batch.count, np.inf), np.full(batch.count, -np.inf)
    np.minimum.at(low, region, t)
    np.maximum.at(high, region, t)
    placed = _placed(kind.name, params, low, high)
    region, vertex = kind.defining(batch, params, tolerance)
    points = work.vertices[vertex]
    distance = kind.probe(params[region], points).distance
    columns = kind.jacobian(placed[region], points)
    chords = _chords(kind, batch, params)
    widths = _revolved.widths(batch, placed) if kind.name == "torus" else widths_of(kind, batch, params)
    starts = np.searchsorted(batch.region, np.arange(batch.count + 1))
    squares: Array = np.bincount(region, distance * distance, batch.count).astype(float)
    samples: Ints = np.bincount(region, minlength=batch.count).astype(np.int64)
    deepest = np.zeros(batch.count)
    np.maximum.at(deepest, region, np.abs(distance))
    has_axis = kind.name != "sphere"
    group = region
    if kind.name == "cone":
        at = _revolved.apices(params[region], points)
        group, columns, _ = _revolved.with_apices(placed[region], points, region, columns, distance, at)
    angular, linear = _uncertainties(group, columns, squares, samples, scale, has_axis)
    sweeps = _sweeps(placed, batch.region, work.centre[batch.polygon], widths) if has_axis else np.zeros(batch.count)
    out = []
    for k in range(batch.count):
        axis, point, radius, half_angle, extent = _oriented(kind.name, placed[k], params[k], low[k], high[k])
        out.append(
            Description(
                kind=kind.name,
                polygons=batch.polygon[starts[k] : starts[k + 1]],
                axis=axis,
                point=point,
                radius=radius,
                half_angle=half_angle,
                minor_radius=float(params[k, 7]) if kind.name == "torus" else 0.0,
                side=int(side[k]),
                extent=extent,
                sweep=float(sweeps[k]),
                residual=float(deepest[k]),
                axis_uncertainty=float(angular[k]),
                point_uncertainty=float(linear[k]),
                chord=float(chords[k]),
                squares=float(squares[k]),
                samples=int(samples[k]),
            )
        )
    return out


def _placed(name: str, params: Params, low: Array, high: Array) -> Params:
    """Parameters with the reference point where the surface's `point` will be."""
    out = params.copy()
    if name == "cylinder":
        out[:, 3:6] += ((low + high) / 2)[:, None] * params[:, :3]
    elif name == "cone":
        out[:, 3:6] -= (params[:, 6] / np.tan(params[:, 7]))[:, None] * params[:, :3]
        out[:, 6] = 0.0
    return out


def _oriented(
    name: str, placed: Array, params: Array, low: float, high: float
) -> tuple[Array, Array, float, float, tuple[float, float]]:
    """(axis, point, radius, half-angle, extent from the point) in the senses that `Surface` promises."""
    point = placed[3:6].copy()
    if name == "sphere":
        return np.zeros(3), point, float(params[6]), 0.0, (0.0, 0.0)
    axis = params[:3].copy()
    if name == "torus":
        return axis * canonical(axis), point, float(params[6]), 0.0, (float(low), float(high))
    if name == "cylinder":
        half = float(high - low) / 2
        return axis * canonical(axis), point, float(params[6]), 0.0, (-half, half)
    along = float((params[3:6] - point) @ axis)
    bounds = sorted((float(low) + along, float(high) + along))
    if params[7] < 0:
        axis, bounds = -axis, [-bounds[1], -bounds[0]]
    return axis, point, 0.0, abs(float(params[7])), (bounds[0], bounds[1])


def canonical(axis: Array) -> float:
    """The sign that makes the largest component positive (ties within 1e-3: x, y, z)."""
    size = np.abs(axis)
    first = int(np.flatnonzero(size > size.max() - 1e-3)[0])
    return 1.0 if axis[first] >= 0 else -1.0


def _uncertainties(
    region: Ints, columns: Array, squares: Array, samples: Ints, scale: Scale, has_axis: bool
) -> tuple[Array, Array]:  # fmt: skip
    """(rad, unit lengths) of each region, from the least squares at the surface's point."""
    count, free = len(samples), columns.shape[1]
    freedom = np.maximum(samples - free, 1)
    scatter = np.maximum(np.sqrt(squares / freedom), 0.3 * scale.rounding)
    matrix, _ = normal_equations(region, columns, np.zeros(len(columns)), count)
    size = np.sqrt(np.maximum(np.einsum("rii->ri", matrix), 1e-300))
    outer = size[:, :, None] * size[:, None, :]
    inverse = np.linalg.pinv(matrix / outer, hermitian=True, rcond=1e-14) / outer
    largest = (
        [_largest(inverse[:, :3, :3])] if not has_axis else [_largest(inverse[:, i : i + 2, i : i + 2]) for i in (0, 2)]
    )
    vague = samples <= free
    linear = np.where(vague, 1.0, COVERAGE * scatter * largest[0])
    if not has_axis:
        return np.where(vague, np.pi / 2, 0.0), linear
    angular = np.where(vague, np.pi / 2, np.minimum(COVERAGE * scatter * largest[1], np.pi / 2))
    return angular, np.maximum(linear, 0.3 * scale.rounding)


def _largest(covariance: Array) -> Array:
    """Root of the largest eigenvalue of each matrix."""
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(covariance)[:, -1], 0.0)))


def _chords(kind: Kind, batch: Batch, params: Params) -> Array:
    """Greatest depth of a facet's edge middles and centroid below each surface."""
    work = batch.patchwork
    deepest = np.zeros(batch.count)
    region, edge, _ = batch.edges
    middles = (work.vertices[work.ends[edge, 0]] + work.vertices[work.ends[edge, 1]]) / 2
    centres = work.centre[batch.polygon]
    for owner, points in ((region, middles), (batch.region, centres)):
        np.maximum.at(deepest, owner, np.abs(kind.probe(params[owner], points).distance))
    return deepest


def _sweeps(params: Params, region: Ints, centres: Array, widths: Array) -> Array:
    """Length of the union of the angles that each region's polygons, in order, subtend about its axis."""
    count, turn = len(params), 2 * np.pi
    x, y = basis(params[:, :3])
    offset = centres - params[region, 3:6]
    middle = np.arctan2(np.einsum("ij,ij->i", offset, y[region]), np.einsum("ij,ij->i", offset, x[region]))
    low = np.mod(middle - widths / 2, turn)
    high = low + widths
    order = np.lexsort((low, region))
    region, low, high = region[order], low[order], high[order]
    wrapped = np.zeros(count)
    np.maximum.at(wrapped, region, high - turn)
    apart = 10 * turn * region
    first = np.r_[True, region[1:] != region[:-1]]
    before = np.maximum.accumulate(high + apart)
    reach = np.where(first, wrapped[region], np.r_[0.0, before[:-1]] - apart)
    reach = np.maximum(reach, wrapped[region])
    covered = np.bincount(region, np.maximum(np.minimum(high, turn) - np.maximum(low, reach), 0), count) + wrapped
    return np.where(covered > turn - 1e-6, turn, covered)
