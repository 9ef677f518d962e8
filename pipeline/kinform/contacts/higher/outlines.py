"""Outlines of prismatic parts: smooth plane curves through the vertices of facets that run along one direction.

Gear flanks, cams and racks are extrusions. Across their direction the facets are segments whose ends lie on
the true curve, so a cubic spline through the ends has the normals of the curve where those of the facets
are off by half a facet's turn. A curve is cut where it bends sharply, where a long straight segment meets
short ones, and where an exact cylinder begins.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from kinform.contacts.constants import CYLINDER_EXACT, FLUSH_ANGLE
from kinform.contacts.mating.charts import plane_basis
from kinform.contacts.search.pair_view import PartView
from kinform.foundation.algebra import splines
from kinform.foundation.algebra.splines import Cubics
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.graphs.components import components, roots
from kinform.foundation.meshes.edges import shared_edges
from kinform.foundation.meshes.near_points import Near
from kinform.foundation.meshes.surface_table import CYLINDER, SPHERE, TORUS
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.foundation.sorting import ascending, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.surfaces import KINDS

CURVE_SAMPLES = 6
"""Samples a segment to find where two curves come close; Newton's method does the rest. Chosen, not measured."""


_DOUBLY = np.isin(np.arange(len(KINDS)), (SPHERE, TORUS))
"""Of each kind of surface, whether it bends along every direction."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A smooth curve (2-D, m) with the material to its left, by chord length."""

    points: Array
    """(n, 2) the vertices."""
    labels: Ints
    """(n − 1,) surface of each segment."""
    lows: Array
    """(n − 1,) m along the direction."""
    highs: Array
    exact: bool
    """One plane or one cylinder, whose analytic surface is better than any curve through its vertices."""
    near: Flags
    """(n − 1,) segments that come near the other part."""

    @cached_property
    def knots(self) -> Array:
        """(n,) m, of the vertices."""
        length = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(length)])

    @cached_property
    def spline(self) -> Cubics:
        """The curve by its knots."""
        return splines.through(self.knots, self.points)

    @cached_property
    def chords(self) -> Array:
        """(n − 1,) m: distance of the middle of each segment from the curve."""
        middle = 0.5 * (self.knots[:-1] + self.knots[1:])
        return np.asarray(np.linalg.norm(self.spline(middle) - 0.5 * (self.points[:-1] + self.points[1:]), axis=1))

    def at(self, s: Array) -> tuple[Array, Array, Array]:
        """Points (n, 2), unit tangents (n, 2) and signed curvatures (n,) (positive: convex material) at s (n,)."""
        p, d, dd = self.spline.with_derivatives(s)
        size = np.linalg.norm(d, axis=1)
        return p, d / size[:, None], (d[:, 0] * dd[:, 1] - d[:, 1] * dd[:, 0]) / size**3

    @cached_property
    def samples(self) -> tuple[Array, Array, Array]:
        """Parameters (n,) along those segments that come near the other part, and their neighbours; points (n, 2) and
        unit tangents (n, 2) there."""
        near = self.near | np.append(self.near[1:], False) | np.append(False, self.near[:-1])
        inner = self.knots[:-1, None] + np.linspace(0.0, 1.0, CURVE_SAMPLES + 1) * np.diff(self.knots)[:, None]
        s = np.unique(inner[near])
        points, tangents, _ = self.at(s)
        return s, points, tangents

    def segment(self, s: float) -> int:
        """The segment that parameter s lies on."""
        return int(np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.labels) - 1))

    def doubt(self, s: float) -> float:
        """rad: how far the tangent at s may be off, as the difference to that of a parabola through three vertices."""
        if len(self.knots) < 3:
            return 0.0
        k = int(np.clip(np.argmin(np.abs(self.knots - s)), 1, len(self.knots) - 2))
        t, p = self.knots[k - 1 : k + 2], self.points[k - 1 : k + 2]
        parabola = np.polynomial.polynomial.polyfit(t - t[1], p, 2)
        slope = parabola[1]
        tangent = self.spline(t[1], 1)
        length = float(np.linalg.norm(tangent) * np.linalg.norm(slope))
        turn = float(tangent[0] * slope[1] - tangent[1] * slope[0]) / length
        return abs(math.asin(float(np.clip(turn, -1.0, 1.0))))


@dataclass(frozen=True, eq=False)
class Segments:
    """Facets that run along a direction, as directed segments across it: the material lies to their left."""

    points: Array
    """(p, 2) m."""
    start: Ints
    """(n,) index of a point."""
    end: Ints
    lows: Array
    """(n,) m along the direction."""
    highs: Array
    labels: Ints
    """(n,) surface."""

    def boxes(self) -> tuple[Array, Array]:
        """Lowest and highest corners (n, 3)."""
        first, last = self.points[self.start], self.points[self.end]
        low = np.column_stack([np.minimum(first, last), self.lows])
        return low, np.column_stack([np.maximum(first, last), self.highs])


@dataclass(frozen=True, eq=False)
class Sheet:
    """Facets of a part (n,), ascending, and pairs (2, k) of them, by their places, that meet in a smooth edge: a bent
    or a flat one."""

    facets: Ints
    normals: Array
    """(n, 3) unit, in the frame of the pair; zero of facets without area."""
    bends: Ints
    """Both ways round."""
    flats: Ints

    @cached_property
    def solid(self) -> Flags:
        """(n,) facets that have an area."""
        return np.asarray(self.normals.any(axis=1))

    @cached_property
    def faces(self) -> Ints:
        """(n,) number of the plane face that each facet belongs to: facets joined by flat edges are one face, so that
        vertices on chords, which booleans leave, do not count."""
        one, two = self.flats
        return components(one, two, len(self.facets))

    @cached_property
    def sizes(self) -> Ints:
        """(f,) how many facets each face has."""
        return np.bincount(self.faces)

    def faces_among(self, rows: Ints) -> Ints:
        """(m,) the same of facets at these places (m,), ascending, alone, numbered by their first facets."""
        face = self.faces.take(rows)
        number = np.bincount(face, minlength=len(self.sizes))
        torn = (number > 0) & (number < self.sizes)
        if not torn.any():
            return np.asarray(np.cumsum(number > 0) - 1).take(face)
        place = np.full(len(self.facets), -1)
        place[rows] = np.arange(len(rows))
        one, two = self._links_of(torn)
        one, two = place.take(one), place.take(two)
        kept = (np.minimum(one, two) >= 0).nonzero()[0]
        root = roots(one.take(kept), two.take(kept), len(rows))
        # a face that is whole is one, without a look at its links
        first = np.empty(len(self.sizes), np.int64)
        first[face[::-1]] = np.arange(len(rows))[::-1]
        root = np.where(torn.take(face), root, first.take(face))
        return np.asarray((np.cumsum(root == np.arange(len(rows))) - 1).take(root))

    def _links_of(self, torn: Flags) -> tuple[Ints, Ints]:
        """The flat edges of some faces, flagged in `torn` (f,)."""
        one, two = self.flats
        inside = torn.take(self._face_of_flat).nonzero()[0]
        return one.take(inside), two.take(inside)

    @cached_property
    def _face_of_flat(self) -> Ints:
        """The face that each flat edge is in."""
        return np.asarray(self.faces.take(self.flats[0]))

    @staticmethod
    def of(part: PartView, chosen: Flags, flat: float, smooth: float) -> Sheet:
        """The sheet of facets flagged in `chosen` (F,); an edge is bent above `flat`, smooth below `smooth` (rad)."""
        facets = chosen.nonzero()[0]
        normals, met = part.normals(facets), part.index.meeting_facets(chosen)
        if met is None:
            shared = shared_edges(part.faces.take(facets, axis=0), len(part.vertices), by_corner=True)
            one, two = np.ascontiguousarray(shared.facets.T)
        else:
            one, two = (np.cumsum(chosen) - 1).take(met)
        cosine = dot(normals.take(one, axis=0), normals.take(two, axis=0))
        bent = cosine < math.cos(flat)
        smooth_bent = bent & (cosine > math.cos(smooth))
        bends = np.stack([one[smooth_bent], two[smooth_bent]])
        flats = np.stack([one[~bent], two[~bent]])
        return Sheet(facets, normals, np.concatenate([bends, bends[::-1]], axis=1), flats)


def segments(part: PartView, sheet: Sheet, direction: Array, alignment: float, grain: float) -> Segments | None:
    """Those of the facets that run along `direction` (3,) within `alignment` (rad), and are no strip of a surface
    that bends along it too; ends nearer to each other than `grain` (m) are one."""
    upright = (np.abs(sheet.normals @ direction) < math.sin(alignment)) & sheet.solid
    # balls and tubes run along no direction, though facets of theirs lie along one by chance
    upright &= ~_DOUBLY[part.table.kinds.take(part.surfaces.labels.take(sheet.facets))]
    if not upright.any():
        return None
    inner, outer = sheet.bends
    leaves = upright.take(inner)
    leaves &= ~upright.take(outer)
    leaving = leaves.nonzero()[0]
    if len(leaving):
        inner, outer = inner.take(leaving), outer.take(leaving)
        heights = [_height(part, sheet.facets.take(side), direction) for side in (inner, outer)]
        # a facet is a strip of a doubly curved surface where its neighbour along the direction is longer than this
        # share
        upright[inner[heights[1] > 0.3 * heights[0]]] = False
    rows = upright.nonzero()[0]
    if not len(rows):
        return None
    facets, plane, face = sheet.facets.take(rows), plane_basis(direction), sheet.faces_among(rows)
    # faces are numbered by their first facets
    first_of = heads(np.maximum.accumulate(face)).nonzero()[0]
    lead = facets.take(first_of)
    normals = sheet.normals.take(rows.take(first_of), axis=0) @ plane.T
    along = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    # one long product takes a fifth of the time of many short ones
    corners = part.vertices.take(part.faces.take(facets, axis=0).ravel(), axis=0)
    flat, height = corners @ plane.T, corners @ direction
    owner = np.repeat(face, 3)
    reach = np.einsum("ik,ik->i", flat, along.take(owner, axis=0))
    order = ascending(owner, len(lead))
    starts = heads(owner.take(order)).nonzero()[0]
    first, last = _ends(reach, order, starts)
    ordered = height.take(order)
    lows, highs = np.minimum.reduceat(ordered, starts), np.maximum.reduceat(ordered, starts)
    keep = (reach.take(last) - reach.take(first) > grain).nonzero()[0]
    if not len(keep):
        return None
    ends = np.concatenate([first.take(keep), last.take(keep)])
    ids, points = _merged(flat.take(ends, axis=0), grain)
    key = ids[: len(keep)] * np.int64(len(points)) + ids[len(keep) :]
    order = ascending(key, len(points) ** 2)
    key = key.take(order)
    begin = heads(key).nonzero()[0]
    low = np.minimum.reduceat(lows.take(keep).take(order), begin)
    high = np.maximum.reduceat(highs.take(keep).take(order), begin)
    start, end = np.divmod(key.take(begin), np.int64(len(points)))
    # a chain of points each within the grain of the next may make one point of both ends
    long = start != end
    if not long.any():
        return None
    labels = part.surfaces.labels.take(lead.take(keep.take(order.take(begin))))
    return Segments(points, start[long], end[long], low[long], high[long], labels[long])


def _height(part: PartView, facets: Ints, direction: Array) -> Array:
    """(n,) m that facets (n,) extend along a direction (3,)."""
    corners = part.vertices.take(part.faces.take(facets, axis=0).ravel(), axis=0) @ direction
    first, second, third = corners.reshape(-1, 3).T
    high = np.maximum(np.maximum(first, second), third)
    return np.asarray(high - np.minimum(np.minimum(first, second), third))


def _ends(values: Array, order: Ints, starts: Ints) -> tuple[Ints, Ints]:
    """Where the least and the greatest of values (n,) are in each run of `order` (n,) that begins at `starts` (r,): of
    equal ones the first and the last."""
    ordered, after = values.take(order), np.empty_like(starts)
    after[:-1], after[-1] = starts[1:], len(order)
    number = after - starts
    low = (ordered == np.repeat(np.minimum.reduceat(ordered, starts), number)).nonzero()[0]
    high = (ordered == np.repeat(np.maximum.reduceat(ordered, starts), number)).nonzero()[0]
    return order[low[np.searchsorted(low, starts)]], order[high[np.searchsorted(high, after) - 1]]


def _merged(points: Array, grain: float) -> tuple[Ints, Array]:
    """Points (n, 2) with those nearer than `grain` made one: index of each, and the points."""
    order = np.lexsort((points[:, 1], points[:, 0]))
    points = points.take(order, axis=0)
    leader = _leaders(points, grain)
    leads = leader == np.arange(len(points))
    ids = np.empty(len(points), dtype=np.int64)
    ids[order] = (np.cumsum(leads) - 1).take(leader)
    return ids, points[leads]


def _leaders(points: Array, grain: float) -> Ints:
    """(n,) of points (n, 2), sorted, the first that each is near to, or the first that this is near to, and so on.

    Steps of more than the grain along either coordinate part them into groups; a group that is no larger is near
    itself, and only others need to be measured."""
    spare, count = SOLVED, len(points)
    x, y = np.ascontiguousarray(points.T)
    aside, step, group = np.zeros(count, bool), np.zeros(count, bool), np.empty(count, np.int64)
    np.greater(x[1:] - x[:-1], (1.0 + spare) * grain, out=aside[1:])
    order = np.lexsort((y, np.cumsum(aside)))
    ordered = y.take(order)
    np.greater(ordered[1:] - ordered[:-1], (1.0 + spare) * grain, out=step[1:])
    step |= aside
    number = np.cumsum(step)
    group[order] = number
    starts = heads(number).nonzero()[0]
    lead = np.minimum.reduceat(order, starts)
    tall = np.maximum.reduceat(ordered, starts) - np.minimum.reduceat(ordered, starts)
    ordered = x.take(order)
    wide = np.maximum.reduceat(ordered, starts) - np.minimum.reduceat(ordered, starts)
    leader = lead.take(group)
    loose = ((wide * wide + tall * tall > (1.0 - spare) * grain * grain).take(group)).nonzero()[0]
    if len(loose):
        leader[loose] = loose
        pairs = loose.take(Near(points.take(loose, axis=0), grain).pairs)
        np.minimum.at(leader, pairs.max(axis=1), pairs.min(axis=1))
    while (leader[leader] != leader).any():
        leader = leader[leader]
    return leader


def curves(part: PartView, pieces: Segments, near: Flags, wanted: Flags, smooth_edge: float) -> list[Curve]:
    """The smooth curves that segments make and that have a segment flagged in `near` (n,), of those runs of segments
    that are `wanted` (n,)."""
    out = []
    for chain in _chains(pieces.start, pieces.end, len(pieces.points), near & wanted):
        out += _cut(part, pieces, chain, near, smooth_edge)
    return out


def may_curve(part: PartView, pieces: Segments, smooth_edge: float) -> Flags:
    """(n,) segments of those unbranched runs of which some smooth curve may be no exact one: most outlines are straight
    and round, which the turns from segment to segment tell sooner than the curves do."""
    count, number = len(pieces.points), len(pieces.start)
    leaving, entering = np.full(count, -1), np.full(count, -1)
    leaving[pieces.start], entering[pieces.end] = np.arange(number), np.arange(number)
    through = (np.bincount(pieces.start, minlength=count) == 1) & (np.bincount(pieces.end, minlength=count) == 1)
    exact = _circular(part, pieces.labels)
    joints = (through & ~(exact.take(entering) | exact.take(leaving))).nonzero()[0]
    steps = pieces.points.take(pieces.end, axis=0) - pieces.points.take(pieces.start, axis=0)
    before = entering.take(joints)
    one, two = steps.take(before, axis=0), steps.take(leaving.take(joints), axis=0)
    turn = np.abs(np.arctan2(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0], dot(one, two)))
    # for rounding; and a closed curve that is nowhere cut overlaps itself, and turns there twice
    spare = 1.0 + SINGLE
    turn[turn >= spare * smooth_edge] = 0.0
    if 2.0 * spare * turn.sum() < FLUSH_ANGLE:
        return np.zeros(number, bool)
    run = components(entering[through], leaving[through], number)
    bent = np.bincount(run.take(before), turn, number)
    return np.asarray((2.0 * spare * spare * bent >= FLUSH_ANGLE).take(run))


def _chains(start: Ints, end: Ints, count: int, near: Flags) -> list[Ints]:
    """Segments in order along unbranched runs that have one flagged in `near`; a closed run begins anywhere."""
    out_of, into = np.bincount(start, minlength=count), np.bincount(end, minlength=count)
    through = ((out_of == 1) & (into == 1)).tolist()
    leaving, entering = np.full(count, -1), np.full(count, -1)
    leaving[start], entering[end] = np.arange(len(start)), np.arange(len(start))
    after = [int(leaving[p]) if through[p] else -1 for p in end]
    before = [int(entering[p]) if through[p] else -1 for p in start]
    used: set[int] = set()
    chains = []
    for seed in near.nonzero()[0].tolist():
        if seed in used:
            continue
        head = seed
        while before[head] not in (-1, seed):
            head = before[head]
        run, k = [head], after[head]
        while k not in (-1, head):
            run.append(k)
            k = after[k]
        used.update(run)
        chains.append(np.array(run, dtype=np.int64))
    return chains


def _cut(part: PartView, pieces: Segments, chain: Ints, near: Flags, smooth_edge: float) -> list[Curve]:
    """One chain as smooth curves; a closed one is turned to begin at a cut, or overlaps itself where it has none."""
    corners = pieces.points[np.append(pieces.start[chain], pieces.end[chain[-1]])]
    labels, count = pieces.labels[chain], len(chain)
    closed = bool(pieces.start[chain[0]] == pieces.end[chain[-1]]) and count > 2
    steps = np.diff(corners, axis=0)
    length = np.sqrt(dot(steps, steps))
    unit = steps / length[:, None]
    exact = _circular(part, labels)
    before, after = np.arange(-1, count - 1), np.arange(1, count + 1) % count
    turn = np.arctan2(unit[before, 0] * unit[:, 1] - unit[before, 1] * unit[:, 0], dot(unit[before], unit))
    # a segment three times as long as both neighbours is a straight face between curves
    flat = length > 3.0 * np.maximum(length[before], length[after])
    cut = (np.abs(turn) >= smooth_edge) | flat | flat[before]
    cut |= (labels != labels[before]) & (exact | exact[before])
    if not closed:
        cut[0] = True
    if cut.any():
        starts = cut.nonzero()[0]
        ends = np.append(starts[1:], starts[0] + count)
        runs = [np.arange(s, e) % count for s, e in zip(starts, ends, strict=True)]
    else:
        runs = [np.arange(count + min(4, count)) % count]
    return [
        Curve(
            points=np.concatenate([corners[run], corners[run[-1] + 1][None]]),
            labels=labels[run],
            lows=pieces.lows[chain[run]],
            highs=pieces.highs[chain[run]],
            exact=bool(exact[run].all() or np.abs(turn[run[1:]]).sum() < FLUSH_ANGLE),
            near=near[chain[run]],
        )
        for run in runs
        if near[chain[run]].any()
    ]


def _circular(part: PartView, labels: Ints) -> Flags:
    """Whether each segment belongs to an exact cylinder."""
    table = part.table
    round_ = table.kinds.take(labels) == CYLINDER
    return np.asarray(round_ & (table.residuals.take(labels) < CYLINDER_EXACT * table.chords.take(labels)))
