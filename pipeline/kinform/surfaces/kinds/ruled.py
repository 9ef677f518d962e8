"""Cylinder and cone in one: straight generators about an axis.

distance = (ρ − r) cos α − t sin α, with t along the axis from the reference point, ρ the distance from the
axis, r the radius at the reference point. A cylinder has α = 0. The reference point stays beside the
data, so that neither a slender cone's far apex nor a flat one's wrapping angle harms the fit.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED, TINY
from kinform.foundation.sorting import among, distinct
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.constants import NORMAL_SLACK, ROWS
from kinform.surfaces.groups import (
    columns_of,
    in_order,
    normal_equations,
    ordered_quantile,
    parted,
    repeated,
    slices,
    solve_normal,
    sums_of,
)
from kinform.surfaces.kinds.axial import OF_AXIS, Cylindrical, angular_widths, azimuths, cylindrical, frames
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.constants import CONVERGED, RING_APART, TILT_LIMIT
from kinform.surfaces.kinds.kind import DAMPING, Kind, Moving, Probe, distinct_angles
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork

KEPT_RISE = 2.0
"""Least squares that converge bring vertices nearer; rounding alone does not double what they are off."""
ALONG: float = float(np.cos(np.radians(10.0)))
"""Cosine of the angle between an edge and a generator, above which it is one."""
BOW = 1e-5
"""Depth (spans) to which a generator that leans may dip below the surface: the ends of slanted ridges lie on it,
but a cut between them does not."""
APEX = 0.05
"""Distance from the axis, in radii, within which a vertex of a cone is its apex. Chosen, not measured."""
STEEPEST_CONE = 1.567
"""rad: largest half-angle of a cone, 0.2° short of a plane. Chosen, not measured."""


class _Kept:
    """Surfaces that their vertices lay on before a step took them away from these."""

    def __init__(self, tolerance: Array):
        """To which the vertices of each region are held (R,)."""
        self._square = tolerance * tolerance
        self._lost = np.zeros(len(tolerance), bool)
        self._best: Params | None = None
        self._before: Params | None = None
        self._squares = np.zeros(len(tolerance))

    def forget(self) -> None:
        """Other vertices are looked at from now on."""
        self._before = None

    def look(self, params: Params, squares: Array, sizes: Ints) -> None:
        """At surfaces (R,), by the squares of the distances of so many vertices, summed."""
        mean = squares / np.maximum(sizes, 1)
        if self._before is not None:
            worse = mean > np.maximum(KEPT_RISE**2 * self._squares, self._square)
            # Tolerances within which the vertices of a surface lie, by their root mean square, that is kept where a
            # step of its fit leads away: where they would be off by more than the tolerance, and KEPT_RISE times as
            # much as before.
            near = self._squares <= 3.0**2 * self._square
            lost = worse & near & (sizes > 0) & ~self._lost
            if lost.any():
                self._best = params.copy() if self._best is None else self._best
                self._best[lost] = self._before[lost]
                self._lost |= lost
        self._before, self._squares = params, np.where(sizes > 0, mean, np.inf)

    def of(self, params: Params) -> Params:
        """These surfaces, but those that are kept as they were."""
        return params if self._best is None else np.where(self._lost[:, None], self._best, params)


class Ruled(Kind, Protocol):
    """What cylinders and cones have in common."""

    tapers: bool
    """Whether the half-angle is free."""

    def moving(self, batch: Batch) -> Moving:
        """Which of the regions go on with their least squares."""
        return Moving(batch.mesh, len(batch.patchwork.total))

    def apices(self, params: Params) -> Array:
        """(R,) distance from the axis at which a vertex is at an apex."""
        return APEX * params[:, 6]

    def change(self, matrix: Array, right: Array) -> Array:
        """(R, 5 or 6) solutions of normal equations."""
        return -solve_normal(matrix, right, DAMPING)

    def refine(self, batch: Batch, params: Params, tolerance: Array, steps: int) -> Params:
        """Gauss–Newton over offset, tilt, radius and, for cones, half-angle. A surface that its vertices lie on is kept
        where a step would take it away from them: on a short narrow arc almost any change fits to first order."""
        work, count = batch.patchwork, batch.count
        moving, kept = self.moving(batch), _Kept(tolerance)
        known, change = None, np.zeros((count, 1))
        region = vertex = np.zeros(0, np.int64)
        for step in range(steps):
            if step in (0, 2):
                if step:
                    params = self._looked_at_again(batch, kept, params, change, region, vertex)
                region, vertex = moving.only(*self.defining(batch, params, tolerance))
                kept.forget()
            if not len(region):
                break
            if known is not region:
                known, sizes, sums = region, np.bincount(region, minlength=count), sums_of(region, count)
            at, before = self._about(work, params, region, sizes, vertex), params
            params, middle = _recentre(params, sizes, sums(at.t))
            at.t[:] -= middle.take(region)
            frame = frames(params[:, :3])
            columns, residual = self._equations(at, params, frame, region, sizes)
            kept.look(before, sums(residual * residual), sizes)
            of_group = sums
            if self.tapers:
                tips = (at.rho < self.apices(params).take(region)).nonzero()[0]
                if len(tips):
                    mine, points = params[region[tips]], work.at(vertex[tips])
                    group, columns, residual = with_apices(mine, points, region, columns, residual, tips)
                    of_group = sums_of(group, count)
            matrix, right = normal_equations(of_group, columns.T, residual)
            change = self.change(matrix, right)
            params = kept.of(moving.taken(self.step(params, change, frame), before))
            region, vertex = moving.after(change, CONVERGED, region, vertex)
        return self._looked_at_again(batch, kept, params, change, region, vertex) if steps else params

    def _looked_at_again(
        self, batch: Batch, kept: _Kept, params: Params, change: Array, region: Ints, vertex: Ints
    ) -> Params:
        """The surfaces after a last step by `change` (R, k) with these vertices."""
        # Change of the parameters (rad, spans) by a last step after which the vertices are looked at again: a fit that
        # closes in on its end moves by a thousandth of that.
        leapt = (np.abs(change).max(axis=1) > 1e-3).nonzero()[0]
        if not len(leapt) or not len(region):
            return params
        rows = among(region, leapt).nonzero()[0]
        mine = region[rows]
        off = self._distances(params, mine, batch.patchwork.at(vertex[rows]))
        squares: Array = np.bincount(mine, off * off, batch.count).astype(float)
        kept.look(params, squares, np.bincount(mine, minlength=batch.count))
        return kept.of(params)

    @staticmethod
    def _about(work: Patchwork, params: Params, region: Ints, sizes: Ints, vertex: Ints) -> Cylindrical:
        """The vertices as the axes of their regions see them, each of which has so many (R,)."""
        count = len(region)
        if count <= ROWS:
            return cylindrical(repeated(params[:, :OF_AXIS], sizes), work.at(vertex))
        at = Cylindrical(np.empty(count), np.empty(count), np.empty((3, count)).T)
        for rows in slices(count, ROWS):
            part = cylindrical(columns_of(params[:, :OF_AXIS], region[rows]), work.at(vertex[rows]))
            at.t[rows], at.rho[rows], at.radial[rows] = part
        return at

    def _equations(
        self, at: Cylindrical, params: Params, frame: tuple[Array, Array], region: Ints, sizes: Ints
    ) -> tuple[Array, Array]:  # fmt: skip
        """Derivatives (N, 5 or 6) and distances (N,) of points at these coordinates about their regions' axes, each of
        which has so many (R,)."""
        count = len(region)
        columns, residual = np.empty((6 if self.tapers else 5, count)).T, np.empty(count)
        x, y = frame
        lean = [np.cos(params[:, 7]), np.sin(params[:, 7])] if self.tapers else []
        table = np.array([*x.T, *y.T, params[:, 6], *lean]).T
        for rows in slices(count, ROWS):
            mine = (repeated(table, sizes) if count <= ROWS else columns_of(table, region[rows])).T
            part = Cylindrical(at.t[rows], at.rho[rows], at.radial[rows])
            off = np.subtract(part.rho, mine[6], out=residual[rows])
            tilt = (mine[7], mine[8]) if self.tapers else None
            self._columns(part, (mine[:3].T, mine[3:6].T), off, tilt, columns[rows])
            if tilt is not None:
                cos, sin = tilt
                off *= cos
                off -= part.t * sin
        return columns, residual

    def _lean(self, params: Params, region: Ints) -> tuple[Array, Array] | None:
        """Cosine and sine of the half-angles of these regions, (N,) each, where there are any: so many fewer regions
        than points that they are looked up."""
        if not self.tapers:
            return None
        angle = params[:, 7]
        return np.cos(angle).take(region), np.sin(angle).take(region)

    def probe(self, params: Params, points: Array) -> Probe:
        """Distance, normal and radius of curvature."""
        (t, rho, radial), radius = cylindrical(params, points), params[:, 6]
        if not self.tapers:
            return Probe(distance=rho - radius, normal=radial, curvature_radius=radius)
        cos, sin = np.cos(params[:, 7]), np.sin(params[:, 7])
        return Probe(
            distance=(rho - radius) * cos - t * sin,
            normal=cos[:, None] * radial - sin[:, None] * params[:, :3],
            curvature_radius=np.maximum(radius * cos + t * sin, 0.0),
        )

    def held(self, batch: Batch, params: Params) -> tuple[Ints, Probe]:
        """By their cylindrical coordinates."""
        group, (t, rho, radial) = batch.seen(params, cylindrical, OF_AXIS)
        angle, middles = params[:, 7], len(batch.polygon)
        lean = [np.cos(angle), np.sin(angle)] if self.tapers else []
        radius, *lean = batch.for_seen(np.array([params[:, 6], *lean]).T).T
        distance = rho - radius
        if not lean:
            return group, Probe(distance, radial[:middles], radius)
        cos, sin = lean
        axis = repeated(params[:, :3], batch.size)
        normal = cos[:middles, None] * radial[:middles] - sin[:middles, None] * axis
        rise = t * sin
        distance *= cos
        distance -= rise
        radius *= cos
        radius += rise
        return group, Probe(distance, normal, np.maximum(radius, 0.0, out=radius))

    def _distances(self, params: Params, region: Ints, points: Array) -> Array:
        """(N,) signed distances of points from the surfaces of their regions."""
        at, lean = cylindrical(columns_of(params[:, :OF_AXIS], region), points), self._lean(params, region)
        distance = at.rho - params[:, 6].take(region)
        if lean is not None:
            cos, sin = lean
            distance *= cos
            distance -= at.t * sin
        return distance

    def cuts(self, batch: Batch, params: Params, pairs: Ints, tolerance: Array) -> Flags:
        """Those in which a generator lies, as it does in every facet between two: a chamfer leans away from it."""
        work, polygon = batch.patchwork, batch.polygon.take(pairs)
        mine, normal = columns_of(params, batch.region.take(pairs)), work.normals(polygon)
        leaning = dot(normal, mine[:, :3])
        if self.tapers:
            radial = cylindrical(mine, work.middles(polygon)).radial
            leaning = np.cos(mine[:, 7]) * leaning + np.sin(mine[:, 7]) * dot(normal, radial)
        leaning = np.abs(leaning)
        straight = leaning <= NORMAL_SLACK + work.slack.take(polygon)
        return np.asarray(straight | (leaning * np.sqrt(work.area.take(polygon)) <= tolerance))

    def widths(self, batch: Batch, params: Params) -> Array:
        """Angle about the axis of each polygon."""
        return batch.widths(params, angular_widths)

    def defining(self, batch: Batch, params: Params, tolerance: Array) -> tuple[Ints, Ints]:
        """Ends of inner ridges, of outer generators that lie on the surface, and vertices with three polygons of the
        region.

        After a boolean, outer generators may lie on chords; smooth ones (tangent to the neighbour) do not.
        """
        work = batch.patchwork
        total = np.int64(len(work.vertices))
        region, edge, inner = generators(batch, params)
        surrounded, vertex = batch.inner_vertices(3)
        keys = [surrounded * total + vertex]
        if len(region):
            outer = (~inner).nonzero()[0]
            owner, ends = region.take(outer), work.ends.take(edge.take(outer), axis=0)
            off = np.abs(self._distances(params, owner.repeat(2), work.at(ends.ravel())))
            use = inner.copy()
            use[outer] = np.maximum(off[::2], off[1::2]) < tolerance.take(owner)
            rows = use.nonzero()[0]
            ends = work.ends.take(edge.take(rows), axis=0)
            ends += (region.take(rows) * total)[:, None]
            keys.append(ends.ravel())
        return parted(distinct(np.concatenate(keys)), int(total))

    def jacobian(self, params: Params, points: Array) -> Array:
        """By offset across the axis (2), tilt (2), radius and, for cones, half-angle."""
        at, angle = cylindrical(params, points), params[:, 7]
        out = np.empty((6 if self.tapers else 5, len(points))).T
        lean = (np.cos(angle), np.sin(angle)) if self.tapers else None
        self._columns(at, frames(params[:, :3]), at.rho - params[:, 6], lean, out)
        return out

    @staticmethod
    def _columns(
        at: Cylindrical, frame: tuple[Array, Array], off: Array, lean: tuple[Array, Array] | None, out: Array
    ) -> None:  # fmt: skip
        """Writes the derivatives (N, 5 or 6) of the distance of points at these coordinates about their axes, which are
        so far `off` the radius."""
        (t, rho, radial), (x, y) = at, frame
        rx = radial[:, 0] * x[:, 0] + radial[:, 1] * x[:, 1] + radial[:, 2] * x[:, 2]
        ry = radial[:, 0] * y[:, 0] + radial[:, 1] * y[:, 1] + radial[:, 2] * y[:, 2]
        if lean is None:
            lever = -t
            np.negative(rx, out=out[:, 0])
            np.negative(ry, out=out[:, 1])
            out[:, 4] = -1.0
        else:
            cos, sin = lean
            less = np.negative(cos, out=out[:, 4])
            lever = cos * t
            lever += sin * rho
            np.negative(lever, out=lever)
            np.multiply(less, rx, out=out[:, 0])
            np.multiply(less, ry, out=out[:, 1])
            out[:, 5] = -off * sin - t * cos
        np.multiply(lever, rx, out=out[:, 2])
        np.multiply(lever, ry, out=out[:, 3])

    def step(self, params: Params, change: Array, frame: tuple[Array, Array]) -> Params:
        """The surfaces with their free parameters changed, within bounds; as they were where that is not finite.
        `frame` is that of their axes."""
        (x, y), radius = frame, params[:, 6]
        most = np.full(change.shape, TILT_LIMIT)
        most[:, 4] = np.abs(radius) + SINGLE
        most[:, :2] = most[:, 4:5]
        least = -most
        least[:, 4] /= 2
        change = np.minimum(np.maximum(change, least), most)
        out = params.copy()
        out[:, 3:6] += change[:, :1] * x + change[:, 1:2] * y
        axis = params[:, :3] + change[:, 2:3] * x + change[:, 3:4] * y
        square = axis * axis
        length = np.sqrt(square[:, 0] + square[:, 1] + square[:, 2])
        out[:, :3] = axis / np.maximum(length, TINY)[:, None]
        out[:, 6] = np.maximum(radius + change[:, 4], SOLVED)
        if self.tapers:
            taper = params[:, 7] + change[:, 5]
            out[:, 7] = np.minimum(np.maximum(taper, -STEEPEST_CONE), STEEPEST_CONE)
        finite = np.isfinite(out)
        return out if finite.all() else np.where(finite.all(axis=1, keepdims=True), out, params)

    def evident(self, batch: Batch, params: Params, scale: Scales) -> tuple[Ints, Array, Flags]:
        """What tells a round face from a few flats: the number of distinct generators that lie on each surface, apart
        by more than a fifth of a typical facet; the angle, π at most, that its facets subtend together; and whether its
        widest polygon has a second of like width, which a flat between two bevels has not."""
        count = batch.count
        width = self.widths(batch, params)
        sweep = np.minimum(np.bincount(batch.region, width, count), np.pi)
        ordered = width.take(in_order(batch.region, width, count))
        even = np.zeros(count, bool)
        several = batch.size >= 2
        last = batch.size.cumsum()[several] - 1
        # Least angle of a strip that counts as like the widest, as a share of it. Chosen, not measured.
        even[several] = ordered[last - 1] >= 0.4 * ordered[last]
        region, vertex = self.defining(batch, params, scale.fit)
        if not len(region):
            return np.zeros(count, np.int64), sweep, even
        mine = columns_of(params[:, :OF_AXIS], region)
        angle = azimuths(mine, cylindrical(mine, batch.patchwork.at(vertex)).radial)
        step = RING_APART * ordered_quantile(batch.size, ordered, 0.75)
        return distinct_angles(region, angle, step, count), sweep, even


def generators(batch: Batch, params: Params) -> tuple[Ints, Ints, Flags]:
    """(region, edge, inner) of the edges that run along a generator."""
    region, edge, inner = batch.edges
    work = batch.patchwork
    use = np.empty(len(edge), bool)
    for rows in slices(len(edge), ROWS):
        use[rows] = _along(work, params, region[rows], edge[rows])
    at = use.nonzero()[0]
    return region.take(at), edge.take(at), inner.take(at)


def _along(work: Patchwork, params: Params, region: Ints, edge: Ints) -> Flags:
    """Whether each edge runs along a generator of its region's surface."""
    sizes = np.bincount(region, minlength=len(params))
    bow = 8 * BOW * np.maximum(np.abs(params[:, 6]), ARITHMETIC)
    mine = repeated(np.array([*params.T[:3], bow]).T, sizes)
    direction = mine[:, :3]
    cones = params[:, 7].nonzero()[0]
    if len(cones):
        # regions are in order, and cylinders come before cones
        axes, angle = params[cones[0] :, :OF_AXIS], params[cones[0] :, 7]
        first = int(region.searchsorted(cones[0]))
        table = np.array([*axes.T, np.cos(angle), np.sin(angle)]).T
        leaning = repeated(table, sizes[cones[0] :])
        radial = cylindrical(leaning[:, :OF_AXIS], work.halfway(edge[first:])).radial
        direction[first:] = leaning[:, 6:7] * leaning[:, :3] + leaning[:, 7:8] * radial
    length = work.length.take(edge)
    forward = np.abs(dot(work.along(edge), direction))
    aside = np.maximum(length * length - forward * forward, 0.0)
    return np.asarray((forward > ALONG * length) & (aside < mine[:, 3]) & (length > 0))


def with_apices(
    params: Params, points: Array, region: Ints, columns: Array, residual: Array, at: Ints
) -> tuple[Ints, Array, Array]:  # fmt: skip
    """The equations, with vertices at an apex put on the axis: their distance has no gradient there, and
    without them a cone of one ring and a point may tilt as it likes. `at` says which vertices those are, `params` and
    `points` are theirs."""
    if not len(at):
        return region, columns, residual
    columns = columns.copy()
    columns[at, :4] = 0.0
    t = dot(points - params[:, 3:6], params[:, :3])
    across = points - params[:, 3:6] - t[:, None] * params[:, :3]
    extra, off = [], []
    for number, direction in enumerate(frames(params[:, :3])):
        row = np.zeros((len(at), columns.shape[1]))
        row[:, number], row[:, 2 + number] = -1.0, -t
        extra.append(row)
        off.append(dot(across, direction))
    return (
        np.concatenate([region, region[at], region[at]]),
        np.concatenate([columns, *extra]),
        np.concatenate([residual, *off]),
    )


def _recentre(params: Params, sizes: Ints, total: Array) -> tuple[Params, Array]:
    """Moves each reference point along its axis beside the mean of its points, so many (R,), whose places along it have
    this `total` (R,); by how much (R,)."""
    middle = total / np.maximum(sizes, 1)
    out = params.copy()
    out[:, 3:6] += middle[:, None] * params[:, :3]
    out[:, 6] += middle * np.tan(params[:, 7])
    return out, middle
