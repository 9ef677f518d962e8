"""Line contacts of cams, gear flanks and racks: where the smooth outlines of two prismatic parts come closest.

Two smooth curves touch where the line between them is normal to both; that line is the line of action, and its
direction is the contact normal, whatever the facets are (Litvin & Fuentes, Gear Geometry and Applied Theory,
2004, chapter 6). Lines of action that agree within their uncertainty are made one: several pairs of teeth
then give rows that are exactly dependent, as those of true flanks are.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import EXACT_GAP, FLUSH_ANGLE, MATING_REACH, PARALLEL_SINE, TOUCH
from kinform.contacts.higher.closest_places import CURVES_OPPOSED, closest_places
from kinform.contacts.higher.constants import CAPTIVE, LINE_SAMPLES, ZONE
from kinform.contacts.higher.outlines import Curve, Segments, Sheet, curves, may_curve, segments
from kinform.contacts.higher.touch_patches import TouchSamples, touch_patch
from kinform.contacts.mating.charts import plane_basis
from kinform.contacts.search.apart import bulge_of
from kinform.contacts.search.pair_view import NearSurfaces, PairView, PartView, near_facets
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.constants import COVERAGE
from kinform.foundation.meshes.boxes import meeting_box
from kinform.foundation.meshes.near_facets import near_boxes
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.tolerances import Tolerances

SLIP_LEAST = 0.1
"""Share of the shortest segment, or of the contact tolerance, by which points that touch may be off each other's
normal. Chosen, not measured."""
ROUNDER = 0.2
"""Share of their own curvatures at which curves that touch along a line diverge at least. Chosen, not measured."""
LENGTH_SHARED = 0.1
"""Least length, in contact tolerances, along which outlines touch. Chosen, not measured."""
DISTINCT_DISTANCE = 0.2
"""Distance, in contact tolerances, within which lines of contact with similar normals are one. Chosen, not measured."""
GAP_ROUNDING = 2e-3
"""Difference of gaps, in contact tolerances, up to which lines of contact touch alike; two chordal deviations where
that is more. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class _Meeting:
    """Two curves at their closest: `point` (2,) between them, `normal` (2,) out of a."""

    curves: tuple[Curve, Curve]
    segments: tuple[int, int]
    point: Array
    normal: Array
    gap: float
    curvature: float
    """1/m, of the two relative to each other."""
    doubt: float
    """rad, of the normal."""
    place: float
    """m, of the point along the curves."""
    chord: float

    @property
    def reach(self) -> tuple[float, float]:
        """Common range along the direction (m)."""
        (a, b), (i, j) = self.curves, self.segments
        return max(float(a.lows[i]), float(b.lows[j])), min(float(a.highs[i]), float(b.highs[j]))


def profile_contacts(
    pair: PairView, along: Array | None = None
) -> tuple[list[Patch], tuple[frozenset[int], frozenset[int]]]:
    """Line contacts between outlines that are no plane and no cylinder, in the frame of the pair, and the surfaces
    of a and b that are pieces of the curves that touch. `along`: the only direction to look along."""
    box = pair.common_box()
    if not any(bulge_of(part, pair.tolerances.smooth_edge) for part in pair.parts):
        box = None
    directions = [] if box is None else [along] if along is not None else _directions(pair.near)
    sheets = [] if box is None else [_sheet(part, *box, pair.tolerances) for part in pair.parts]
    for direction in directions:
        meetings = _meetings(pair, sheets, direction)
        if meetings:
            chosen = _one_line(_nearest(meetings, pair.tolerance))
            a, b = (frozenset(int(k) for m in meetings for k in m.curves[side].labels) for side in (0, 1))
            return [_patch(pair, meeting, direction) for meeting in chosen], (a, b)
    return [], (frozenset(), frozenset())


def _directions(near: tuple[NearSurfaces, NearSurfaces]) -> list[Array]:
    """Directions that outlines may run along: normals of planes and axes of both parts, the largest faces first."""
    axes: list[tuple[float, Array]] = []
    for side in near:
        rows = side.of_kind("plane", "cylinder", "extrusion")
        axes += zip(side.areas.take(rows).tolist(), side.axes.take(rows, axis=0), strict=True)
    axes.sort(key=lambda item: (-item[0], *item[1].tolist()))
    out: list[Array] = []
    for _, axis in axes:
        if all(norm(cross(axis, other)) > PARALLEL_SINE for other in out):
            out.append(axis)
        # those of the largest faces
        if len(out) == 6:
            break
    return out


def _meetings(pair: PairView, sheets: list[Sheet], direction: Array) -> list[_Meeting]:
    """Where the outlines across `direction` (3,) of these facets of a and of b meet."""
    tolerance, tolerances, limit = pair.tolerance, pair.tolerances, MATING_REACH * pair.tolerance
    found: dict[int, Segments] = {}
    # of few facets none runs along it sooner than of many
    for k in sorted((0, 1), key=lambda k: len(sheets[k].facets)):
        pieces = segments(pair.parts[k], sheets[k], direction, tolerances.alignment, EXACT_GAP * tolerance)
        if pieces is None:
            return []
        found[k] = pieces
    cut = [found[0], found[1]]
    may = [may_curve(part, pieces, tolerances.smooth_edge) for part, pieces in zip(pair.parts, cut, strict=True)]
    if not any(flags.any() for flags in may):
        return []
    boxes = [pieces.boxes() for pieces in cut]
    if not _may_be_near(boxes, may, limit):
        return []
    near = near_boxes(*boxes[0], *boxes[1], limit)
    bent = [of_part & flags for of_part, flags in zip(near, may, strict=True)]
    # an exact curve is compared with those that are not
    wanted = [
        np.ones(len(of_part), bool) if other.any() else flags
        for of_part, flags, other in zip(near, may, bent[::-1], strict=True)
    ]
    if not all((of_part & flags).any() for of_part, flags in zip(near, wanted, strict=True)):
        return []
    first, second = (
        curves(part, pieces, of_part, flags, tolerances.smooth_edge)
        for part, pieces, of_part, flags in zip(pair.parts, cut, near, wanted, strict=True)
    )
    if not first or not second:
        return []
    flat = [np.array([[c.points.min(axis=0), c.points.max(axis=0)] for c in side]) for side in (first, second)]
    apart = np.maximum(flat[0][:, None, 0] - flat[1][None, :, 1], flat[1][None, :, 0] - flat[0][:, None, 1])
    exact = np.outer([c.exact for c in first], [c.exact for c in second])
    meetings = []
    for i, j in np.argwhere((apart.max(axis=2) <= limit) & ~exact):
        meetings += _closest(first[i], second[j], tolerance)
    return _distinct(meetings, tolerance)


def _may_be_near(boxes: list[tuple[Array, Array]], may: list[Flags], margin: float) -> bool:
    """Whether any segments flagged in `may` of either part, of which these are all boxes, come within `margin` (m) of
    the box of the other part's."""
    for flags, (low, high), (low_other, high_other) in zip(may, boxes, boxes[::-1], strict=True):
        beside = meeting_box(low[flags], high[flags], low_other.min(axis=0) - margin, high_other.max(axis=0) + margin)
        if beside.any():
            return True
    return False


def _sheet(part: PartView, low: Array, high: Array, tolerances: Tolerances) -> Sheet:
    """Facets in a box, with those around them, so that curves do not end where the box does."""
    chosen = np.zeros(len(part.faces), dtype=bool)
    chosen[near_facets(part, low, high)[0]] = True
    inside = np.zeros(len(part.vertices), dtype=bool)
    corners = [np.ascontiguousarray(column) for column in part.faces.T]
    fresh = chosen.nonzero()[0]
    # six rings of facets about the common box of two parts: as many segments settle a spline
    for _ in range(6):
        inside[part.faces[fresh]] = True
        around = inside[corners[0]] | inside[corners[1]] | inside[corners[2]]
        fresh = (around & ~chosen).nonzero()[0]
        if not len(fresh):
            break
        chosen[fresh] = True
    return Sheet.of(part, chosen, tolerances.coplanar, tolerances.smooth_edge)


def _closest(first: Curve, second: Curve, tolerance: float) -> list[_Meeting]:
    """Where two curves are closest, among pairs of points with opposed normals."""
    met = [_refined(first, second, s, t, tolerance) for s, t in closest_places(first, second, tolerance)]
    return [meeting for meeting in met if meeting is not None]


@dataclass(frozen=True, eq=False)
class _Place:
    """A place s on one curve and t on another: points p and q (2,), unit tangents u and w, curvatures kappa and lam."""

    s: float
    t: float
    p: Array
    q: Array
    u: Array
    w: Array
    kappa: float
    lam: float

    @staticmethod
    def of(first: Curve, second: Curve, s: float, t: float) -> _Place:
        """The place at these parameters."""
        (p,), (u,), (kappa,) = first.at(np.array([s]))
        (q,), (w,), (lam,) = second.at(np.array([t]))
        return _Place(s, t, p, q, u, w, kappa, lam)

    @property
    def turn(self) -> float:
        """Sine of the angle between the tangents."""
        return float(self.u[0] * self.w[1] - self.u[1] * self.w[0])


def _parallel_place(first: Curve, second: Curve, s: float, t: float) -> _Place | None:
    """Newton's method on: the line between the points is normal to the second curve, and the curves are parallel.

    From the parameters s and t; None where the Jacobian is singular.
    """
    ends = (float(first.knots[-1]), float(second.knots[-1]))
    # steps of Newton's method to where two curves are parallel
    for _ in range(20):
        (px, py), (ux, uy), kappa, speed = _at(first, s)
        (qx, qy), (wx, wy), lam, other_speed = _at(second, t)
        ax, ay, along = px - qx, py - qy, ux * wx + uy * wy
        # (p − q)·w and u × w, and their derivatives along either curve
        off, turn = ax * wx + ay * wy, ux * wy - uy * wx
        a, b, c, d = along, -1.0 + lam * (ay * wx - ax * wy), -kappa * along, lam * along
        size = a * d - b * c
        if abs(size) < ARITHMETIC * (abs(kappa) + abs(lam) + TINY):
            return None
        s_new = min(max(s + (b * turn - d * off) / size / speed, 0.0), ends[0])
        t_new = min(max(t + (c * off - a * turn) / size / other_speed, 0.0), ends[1])
        still = abs(s_new - s) < ARITHMETIC * ends[0] and abs(t_new - t) < ARITHMETIC * ends[1]
        s, t = s_new, t_new
        if still:
            break
    return _Place.of(first, second, s, t)


def _at(curve: Curve, s: float) -> tuple[tuple[float, float], tuple[float, float], float, float]:
    """Point, unit tangent, signed curvature and speed at a parameter, as `Curve.at`."""
    (x, dx, ddx), (y, dy, ddy) = curve.spline.place(s)
    speed = math.sqrt(dx * dx + dy * dy) or 1.0
    return (x, y), (dx / speed, dy / speed), (dx * ddy - dy * ddx) / speed**3, speed


def _refined(first: Curve, second: Curve, s: float, t: float, tolerance: float) -> _Meeting | None:
    """The meeting of two curves near the parameters s and t, where they touch there as convex profiles do."""
    at = _parallel_place(first, second, s, t)
    if at is None or not float(at.u @ at.w) <= CURVES_OPPOSED:
        return None
    turn, kappa, lam = at.turn, at.kappa, at.lam
    mean = at.u - at.w
    mean /= np.linalg.norm(mean)
    normal = np.array([mean[1], -mean[0]])
    gap = float((at.q - at.p) @ normal)
    slip = abs(float((at.q - at.p) @ mean))
    relative = float(kappa + lam)
    inner = max(tolerance, float(np.diff(first.knots).min()))
    if abs(turn) > math.sin(FLUSH_ANGLE):
        return None
    if abs(gap) > MATING_REACH * tolerance or slip > SLIP_LEAST * inner:
        return None
    if relative <= ROUNDER * max(abs(kappa), abs(lam)):
        return None
    i, j = first.segment(at.s), second.segment(at.t)
    shares = np.array([abs(kappa), abs(lam)]) / (abs(kappa) + abs(lam))
    # the flatter side has most of the say about the normal
    doubts = (first.doubt(at.s), second.doubt(at.t))
    doubt = shares[1] * doubts[0] + shares[0] * doubts[1] + abs(turn)
    place = (sum(doubts) + abs(turn)) / relative
    chord = float(first.chords[i] + second.chords[j])
    return _Meeting((first, second), (i, j), 0.5 * (at.p + at.q), normal, gap, relative, float(doubt), place, chord)


def _distinct(meetings: list[_Meeting], tolerance: float) -> list[_Meeting]:
    """Without those that two pieces of one curve both found, and those that share no length along the direction."""
    out: list[_Meeting] = []
    for met in sorted(meetings, key=lambda m: (m.doubt, m.gap, *m.point.tolist())):
        low, high = met.reach
        if high - low <= LENGTH_SHARED * tolerance:
            continue
        # normals within 26°
        if all(
            float(np.linalg.norm(met.point - other.point)) > DISTINCT_DISTANCE * tolerance
            or float(met.normal @ other.normal) < 0.9
            for other in out
        ):
            out.append(met)
    return out


def _nearest(meetings: list[_Meeting], tolerance: float) -> list[_Meeting]:
    """Those that touch. Where nothing touches, those that hold a tooth between them with equal play."""
    least = min(met.gap for met in meetings)
    margin = max(2.0 * max(met.chord for met in meetings), GAP_ROUNDING * tolerance)
    close = [met for met in meetings if met.gap <= max(least, 0.0) + margin]
    limit = TOUCH * tolerance
    if least > limit:
        opposed = any(float(x.normal @ y.normal) < 0.0 for x in close for y in close)
        limit = CAPTIVE * tolerance if opposed else limit
    return sorted((m for m in close if abs(m.gap) <= limit), key=lambda m: (*m.point.tolist(),))


def _one_line(meetings: list[_Meeting]) -> list[_Meeting]:
    """The meetings with lines of action that agree within their uncertainty made exactly one."""
    out = list(meetings)
    left = list(range(len(meetings)))
    while left:
        lead = min(left, key=lambda k: (meetings[k].doubt, k))
        group = [k for k in left if _agree(meetings[lead], meetings[k])]
        left = [k for k in left if k not in group]
        if len(group) > 1:
            weight = np.array([1.0 / max(meetings[k].doubt, SINGLE) ** 2 for k in group])
            normal = np.sum([w * meetings[k].normal for w, k in zip(weight, group, strict=True)], axis=0)
            normal /= np.linalg.norm(normal)
            middle = np.average([meetings[k].point for k in group], axis=0, weights=weight)
            for k in group:
                on = middle + normal * float(normal @ (meetings[k].point - middle))
                out[k] = replace(meetings[k], point=on, normal=normal)
    return out


def _agree(one: _Meeting, two: _Meeting) -> bool:
    """Whether both lie on one line of action."""
    allowed = COVERAGE * (one.doubt + two.doubt) + SINGLE
    if float(one.normal @ two.normal) < 0.0:
        return False
    angle = abs(float(one.normal[0] * two.normal[1] - one.normal[1] * two.normal[0]))
    apart = two.point - one.point
    off = abs(float(one.normal[0] * apart[1] - one.normal[1] * apart[0]))
    place = COVERAGE * (one.place + two.place)
    return angle <= allowed and off <= allowed * float(np.linalg.norm(apart)) + place


def _patch(pair: PairView, met: _Meeting, direction: Array) -> Patch:
    """The line in which two outlines meet, along the direction."""
    plane = plane_basis(direction)
    low, high = met.reach
    height = low + (high - low) * (np.arange(LINE_SAMPLES) + 0.5) / LINE_SAMPLES
    points = met.point @ plane + height[:, None] * direction
    labels = [int(curve.labels[k]) for curve, k in zip(met.curves, met.segments, strict=True)]
    bends = [_radius(curve, met) for curve in met.curves]
    samples = TouchSamples(
        points,
        np.tile(met.normal @ plane, (LINE_SAMPLES, 1)),
        np.full(LINE_SAMPLES, met.gap),
        2.0 * math.sqrt(2.0 * ZONE * pair.tolerance / met.curvature) * (high - low) / LINE_SAMPLES,
        axis=direction,
        radii=(bends[0], bends[1]),
        uncertainty=(met.doubt, met.place),
        chord=met.chord,
    )
    return touch_patch(pair, (labels[0], labels[1]), samples, EXACT_GAP * pair.tolerance)


def _radius(curve: Curve, met: _Meeting) -> float:
    """Radius of curvature (m) where they meet; 0 for a straight line."""
    k = int(np.argmin(np.linalg.norm(curve.points - met.point, axis=1)))
    bend = abs(float(curve.at(curve.knots[k : k + 1])[2][0]))
    return 1.0 / bend if bend > SOLVED / max(float(curve.knots[-1]), TINY) else 0.0
