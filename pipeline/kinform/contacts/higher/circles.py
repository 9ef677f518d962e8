"""Rims: circles, or arcs of circles, in which two surfaces of a part meet at a sharp convex edge.

Axis and place come from the surfaces, and the radius from the vertices, which lie on both; the mesh tells besides which
arcs are there. The chords of its edges are not the rim.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.constants import FLUSH_ANGLE, ROUND_SWEEP
from kinform.contacts.higher.beside import EXACT_KINDS, beside
from kinform.contacts.higher.constants import BALL_BORE_SAMPLES
from kinform.contacts.higher.nearest import Circle
from kinform.contacts.higher.sharp import ConvexEdges
from kinform.contacts.mating.charts import perpendicular
from kinform.contacts.search.pair_view import NearSurfaces, PairView
from kinform.foundation.algebra.vectors import cross, lengths, times
from kinform.foundation.meshes.boxes import meeting_box
from kinform.foundation.rounding import SOLVED
from kinform.foundation.sorting import heads, median
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.surfaces import KINDS

RIM_UNEVEN = 0.02
"""Vertices of a rim are on one circle to within this: a sixth of what touches."""


_TURNING, _EXACT, _PLANE, _SPHERE = (
    np.isin(KINDS, kinds) for kinds in (("cylinder", "cone", "torus"), EXACT_KINDS, ("plane",), ("sphere",))
)
"""By kind."""


@dataclass(frozen=True, eq=False)
class Rim(Circle):
    """Arcs of a circle of a part, in the frame of the pair (m)."""

    surface: int
    """Which its axis is of, in the part's MeshSurfaces."""
    faces: tuple[int, int]
    """Both surfaces that meet here."""
    starts: Array
    """(e,) rad where each edge begins, ascending."""
    spans: Array
    """(e,) rad."""
    slopes: Array
    """(2, 2) directions from the rim into either face: away from the axis, and along it."""
    turn: float
    shift: float
    """Standard uncertainties of the axis (rad) and of the place (m)."""
    low: Array
    high: Array
    """(3,) box of the edges."""

    def rises(self, angles: Array, normals: Array) -> Flags:
        """(n,) whether both faces leave a surface that touches the rim at these angles, with outward normals (n, 3)."""
        speeds = np.stack([(self.outward(angles) * normals).sum(axis=1), normals @ self.axis])
        return np.asarray((self.slopes @ speeds > math.sin(FLUSH_ANGLE)).all(axis=0))

    def has(self, angles: Array, slack: float) -> Flags:
        """(n,) whether the part has an edge there, or within `slack` (rad)."""
        beyond = np.mod(angles[:, None] - self.starts + slack, 2.0 * math.pi)
        return np.asarray((beyond <= self.spans + 2.0 * slack).any(axis=1))

    @property
    def closed(self) -> bool:
        """Whether it goes all round."""
        return float(self.spans.sum()) >= ROUND_SWEEP

    def samples(self) -> tuple[Array, float]:
        """(n,) angles evenly over what is there of it, and the arc (m) that each stands for."""
        total = float(self.spans.sum())
        most = BALL_BORE_SAMPLES
        # Fewest samples along a partial rim: two at either end hold a plane. Chosen, not measured.
        count = min(max(math.ceil(most * total / (2.0 * math.pi) - SOLVED), 4), most)
        passed = (np.arange(count) + 0.5) / count * total
        ends = np.cumsum(self.spans)
        edge = np.minimum(np.searchsorted(ends, passed), len(ends) - 1)
        return self.starts[edge] + passed - (ends - self.spans)[edge], self.radius * total / count


def rims_of(view: PairView, edges: ConvexEdges, lows: Array, highs: Array) -> list[Rim]:
    """The rims of the first part that are among its edges, as far as they are near the boxes from `lows` to `highs`
    (n, 3); those that come to none of them are left out."""
    part, near = view.a, view.near[0]
    if not len(edges.ends) or not len(near.ids):
        return []
    labels = part.surfaces.labels.take(edges.facets)
    apart = (labels[:, 0] != labels[:, 1]).nonzero()[0]
    labels = labels.take(apart, axis=0).T
    rows = np.minimum(near.ids.searchsorted(labels), len(near.ids) - 1)
    kinds = near.kinds.take(rows)
    turning, exact, flat, ball = (of.take(kinds) for of in (_TURNING, _EXACT, _PLANE, _SPHERE))
    wanted = exact[0] & exact[1] & (turning[0] | turning[1] | ((flat[0] | flat[1]) & (ball[0] | ball[1])))
    known = near.ids.take(rows) == labels
    wanted = (wanted & known[0] & known[1]).nonzero()[0]
    at, rows = apart.take(wanted), rows.take(wanted, axis=1)
    starts, stops = (part.vertices.take(ends, axis=0) for ends in edges.ends.take(at, axis=0).T)
    low, high = np.minimum(starts, stops), np.maximum(starts, stops)
    met = meeting_box(low, high, lows.min(axis=0), highs.max(axis=0)).nonzero()[0]
    if not len(met):
        return []
    at, low, high = at.take(met), low.take(met, axis=0), high.take(met, axis=0)
    rows = np.sort(rows.take(met, axis=1).T, axis=1)
    keys = rows[:, 0] * np.int64(len(near.ids)) + rows[:, 1]
    order = np.argsort(keys, kind="stable")
    starts = np.flatnonzero(heads(keys[order]))
    least, most = np.minimum.reduceat(low[order], starts), np.maximum.reduceat(high[order], starts)
    meets = np.asarray(((most[:, None] >= lows) & (least[:, None] <= highs)).all(axis=2))
    groups = np.split(order, starts[1:])
    chosen = [group for group, met in zip(groups, meets, strict=True) if met.any()]
    return [rim for group in chosen for rim in _circles(view, rows[group[0]], edges.ends[at[group]])]


@dataclass(frozen=True, eq=False)
class _Axis:
    """About which circles are looked for."""

    row: int
    """Of the surface whose axis it is, among the near ones."""
    along: Array
    point: Array
    turn: float
    shift: float


def _axis(near: NearSurfaces, rows: Ints) -> _Axis:
    """That of one of two surfaces that meet; a plane tells the direction of what it ends better than a short cylinder,
    and of a ball all of it."""
    turning = [int(row) for row in rows if _TURNING[near.kinds[row]]]
    flat = [int(row) for row in rows if _PLANE[near.kinds[row]]]
    own = min(turning, key=lambda row: (near.axis_uncertainty[row], row)) if turning else flat[0]
    middle = own if turning else next(int(row) for row in rows if row != own)
    by_plane = bool(flat) and near.axis_uncertainty[flat[0]] < near.axis_uncertainty[own]
    along = flat[0] if by_plane else own
    direction = math.copysign(1.0, float(near.axes[along] @ near.axes[own])) * near.axes[along]
    turn, shift = float(near.axis_uncertainty[along]), float(near.point_uncertainty[middle])
    return _Axis(own, direction, near.points[middle], turn, shift)


def _circles(view: PairView, rows: Ints, ends: Ints) -> list[Rim]:
    """The circles about one axis on which edges (e, 2) between two near surfaces lie, if all are level."""
    limit = RIM_UNEVEN * view.tolerance
    axis = _axis(view.near[0], rows)
    along = times(view.a.vertices.take(ends, axis=0) - axis.point, axis.along)
    if float(np.ptp(along, axis=1).max()) > limit:
        return []
    heights = along.mean(axis=1)
    order = np.argsort(heights, kind="stable")
    levels = np.split(order, np.flatnonzero(np.diff(heights[order]) > limit) + 1)
    rims = [_rim(view, rows, axis, ends[np.sort(level)]) for level in levels]
    return [rim for rim in rims if rim is not None]


def _rim(view: PairView, rows: Ints, axis: _Axis, ends: Ints) -> Rim | None:
    """The circle about an axis on which edges (e, 2) between two near surfaces lie. Of a mesh that was cut, some end on
    the chords of others."""
    near, limit, corners = view.near[0], RIM_UNEVEN * view.tolerance, view.a.vertices[ends]
    arm = corners - axis.point
    along = times(arm, axis.along)
    aside = arm - along[..., None] * axis.along
    far = lengths(aside)
    radius, centre = median(far.ravel()), axis.point + float(along.mean()) * axis.along
    off = np.abs(far - radius)
    loose = float(off.max()) > limit + float(near.chords[rows].max()) or np.ptp(along) > limit
    # most vertices of a rim are on its circle
    if loose or radius <= limit or np.count_nonzero(off <= limit) < 0.75 * off.size:
        return None
    outward = perpendicular(axis.along)
    slopes = _slopes(near, rows, centre + radius * outward, axis.along, outward)
    if slopes is None:
        return None
    basis = np.stack([outward, cross(axis.along, outward)])
    starts, spans = _arcs(times(aside, basis.T))
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    faces, surface = (int(near.ids[rows[0]]), int(near.ids[rows[1]])), int(near.ids[axis.row])
    return Rim(
        axis.along, centre, radius, basis, surface, faces, starts, spans, slopes, axis.turn, axis.shift, low, high
    )


def _arcs(aside: Array) -> tuple[Array, Array]:
    """Where edges between places (e, 2, 2) in the plane of a circle begin (e,), ascending, and how far they go (e,)
    rad."""
    angles = np.arctan2(aside[..., 1], aside[..., 0])
    step = np.mod(angles[:, 1] - angles[:, 0] + math.pi, 2.0 * math.pi) - math.pi
    starts = np.mod(np.where(step < 0.0, angles[:, 1], angles[:, 0]), 2.0 * math.pi)
    order = np.argsort(starts, kind="stable")
    return starts[order], np.abs(step)[order]


def _slopes(near: NearSurfaces, rows: Ints, on: Array, axis: Array, outward: Array) -> Array | None:
    """(2, 2) directions in which two near surfaces leave a place (3,) on the circle in which they meet: `outward`, away
    from its axis, and along it. None where they go on into each other."""
    normals = np.zeros((2, 2))
    for k, row in enumerate(rows.tolist()):
        normal = beside(near, row, on[None]).normals[0]
        normals[k] = normal @ outward, normal @ axis
    slopes = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    # where the edge is convex, each face goes down beside the other
    down = np.array([slopes[0] @ normals[1], slopes[1] @ normals[0]])
    return None if np.abs(down).min() < math.sin(FLUSH_ANGLE) else -np.sign(down)[:, None] * slopes
