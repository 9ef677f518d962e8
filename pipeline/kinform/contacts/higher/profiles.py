"""Line contacts of cams, gear flanks and racks: where the smooth outlines of two prismatic parts come closest.

Two smooth curves touch where the line between them is normal to both; that line is the line of action, and its
direction is the contact normal, whatever the facets are (Litvin & Fuentes, Gear Geometry and Applied Theory,
2004, chapter 6). Lines of action that agree within their uncertainty are made one: several pairs of teeth
then give rows that are exactly dependent, as those of true flanks are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from kinform.contacts.higher.outlines import Curve, Sheet, across, curves, segments
from kinform.contacts.mating.mates import EDGE
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.placed import NearSurfaces, PlacedPart, near_facets
from kinform.foundation.meshes.proximity import near_boxes
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

__all__ = ["profile_contacts"]


_TOUCH = 0.12
"""Share of the contact tolerance within which curves touch: the band of full weight."""
_CAPTIVE = 0.42
"""Share within which a tooth that has as much play on either side counts as held between both."""
_ZONE = 0.01
"""Share of the contact tolerance that bounds the zone whose area is stated."""
_DIRECTIONS = 6
"""Directions tried, those of the largest faces first."""
_SAMPLES = 6
"""Samples a segment, to find where two curves come close."""
_ALONG = 9
"""Samples along a line."""
_OFF_END = math.radians(3.0)
"""A curve may end this much before it is parallel to the other: it goes on where it was cut."""
_ROUNDER = 0.2
"""Curves touch along a line where they part from each other at least at this share of their own curvatures."""
_SIGMAS = 3.0
_GRAIN = 1e-3
"""Share of the contact tolerance within which ends of segments are one point."""
_RINGS = 6
"""Rings of facets about the common box of two parts: as many segments settle a spline."""


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
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    tolerance: float,
    tolerances: Tolerances,
    along: Array | None = None,
) -> tuple[list[Patch], tuple[frozenset[int], frozenset[int]]]:
    """Line contacts between outlines that are no plane and no cylinder, in the frame of the pair, and the surfaces
    of a and b that are pieces of the curves that touch. `along`: the only direction to look along."""
    nothing: tuple[list[Patch], tuple[frozenset[int], frozenset[int]]] = ([], (frozenset(), frozenset()))
    if not len(near[0].ids) or not len(near[1].ids):
        return nothing
    low = np.maximum(near[0].lows.min(axis=0), near[1].lows.min(axis=0)) - tolerance
    high = np.minimum(near[0].highs.max(axis=0), near[1].highs.max(axis=0)) + tolerance
    sheets = [_sheet(part, low, high, tolerances) for part in (a, b)]
    for direction in [along] if along is not None else _directions(near):
        found = _meetings(a, b, sheets, direction, tolerance, tolerances)
        if found:
            chosen = _one_line(_nearest(found, tolerance))
            pieces = [frozenset(int(k) for m in found for k in m.curves[side].labels) for side in (0, 1)]
            return [_patch(a, b, m, direction, tolerance) for m in chosen], (pieces[0], pieces[1])
    return nothing


def _directions(near: tuple[NearSurfaces, NearSurfaces]) -> list[Array]:
    """Directions that outlines may run along: normals of planes and axes of both parts, the largest faces first."""
    kinds = [KINDS.index(kind) for kind in ("plane", "cylinder", "extrusion")]
    found: list[tuple[float, Array]] = []
    for side in near:
        for row in np.flatnonzero(np.isin(side.kinds, kinds)):
            found.append((float(side.areas[row]), side.axes[row]))
    found.sort(key=lambda item: (-item[0], *item[1].tolist()))
    out: list[Array] = []
    for _, axis in found:
        if all(float(np.linalg.norm(np.cross(axis, other))) > 1e-3 for other in out):
            out.append(axis)
        if len(out) == _DIRECTIONS:
            break
    return out


def _meetings(
    a: PlacedPart, b: PlacedPart, sheets: list[Sheet], direction: Array, tolerance: float, tolerances: Tolerances
) -> list[_Meeting]:
    """Where the outlines across `direction` (3,) of these facets of a and of b meet."""
    grain = _GRAIN * tolerance
    cut = [
        segments(part, own, direction, tolerances.alignment, grain) for part, own in zip((a, b), sheets, strict=True)
    ]
    if cut[0] is None or cut[1] is None:
        return []
    near = near_boxes(*cut[0].boxes(), *cut[1].boxes(), EDGE * tolerance)
    first = curves(a, cut[0], near[0], tolerances.smooth_edge)
    second = curves(b, cut[1], near[1], tolerances.smooth_edge)
    if not first or not second:
        return []
    boxes = [np.array([[c.points.min(axis=0), c.points.max(axis=0)] for c in own]) for own in (first, second)]
    apart = np.maximum(boxes[0][:, None, 0] - boxes[1][None, :, 1], boxes[1][None, :, 0] - boxes[0][:, None, 1])
    exact = np.outer([c.exact for c in first], [c.exact for c in second])
    found = []
    for i, j in np.argwhere((apart.max(axis=2) <= EDGE * tolerance) & ~exact):
        found += _closest(first[i], second[j], tolerance)
    return _distinct(found, tolerance)


def _sheet(part: PlacedPart, low: Array, high: Array, tolerances: Tolerances) -> Sheet:
    """Facets in a box, with those around them, so that curves do not end where the box does."""
    chosen = np.zeros(len(part.faces), dtype=bool)
    chosen[near_facets(part, low, high)[0]] = True
    inside = np.zeros(len(part.vertices), dtype=bool)
    for _ in range(_RINGS):
        inside[part.faces[chosen]] = True
        chosen |= inside[part.faces].any(axis=1)
    return Sheet.of(part, np.flatnonzero(chosen), tolerances.coplanar, tolerances.smooth_edge)


def _closest(first: Curve, second: Curve, tolerance: float) -> list[_Meeting]:
    """Where two curves are closest, among pairs of points with opposed normals."""
    s = _sampled(first)
    p, tangent, _ = first.at(s)
    t = _sampled(second)
    q, other, _ = second.at(t)
    apart = p[:, None] - q[None]
    facing = np.einsum("ik,jk->ij", tangent, other) < -0.9
    distance = np.where(facing, np.einsum("ijk,ijk->ij", apart, apart), np.inf)
    nearest = distance.argmin(axis=1)
    away = np.sqrt(distance[np.arange(len(s)), nearest])
    outward = np.stack([other[nearest, 1], -other[nearest, 0]], axis=1)
    gap = np.where(np.isfinite(away), np.einsum("ik,ik->i", p - q[nearest], outward), np.inf)
    padded = np.concatenate([[np.inf], gap, [np.inf]])
    lowest = np.flatnonzero((padded[1:-1] <= padded[:-2]) & (padded[1:-1] < padded[2:]) & np.isfinite(gap))
    step = max(float(np.diff(first.knots).max()), float(np.diff(second.knots).max())) / _SAMPLES
    out = []
    for k in lowest:
        if away[k] > EDGE * tolerance + 2.0 * step:
            continue
        met = _refined(first, second, float(s[k]), float(t[nearest[k]]), tolerance)
        if met is not None:
            out.append(met)
    return out


def _sampled(curve: Curve) -> Array:
    """Parameters along those segments that come near the other part, and their neighbours."""
    near = curve.near | np.append(curve.near[1:], False) | np.append(False, curve.near[:-1])
    inner = curve.knots[:-1, None] + np.linspace(0.0, 1.0, _SAMPLES + 1) * np.diff(curve.knots)[:, None]
    return np.unique(inner[near])


def _refined(first: Curve, second: Curve, s: float, t: float, tolerance: float) -> _Meeting | None:
    """Newton's method on: the line between the points is normal to the second curve, and the curves are parallel."""
    ends = (first.knots[-1], second.knots[-1])
    for _ in range(20):
        (p,), (u,), (kappa,) = first.at(np.array([s]))
        (q,), (w,), (lam,) = second.at(np.array([t]))
        speeds = [float(np.linalg.norm(c.spline(x, 1))) for c, x in ((first, s), (second, t))]
        apart = p - q
        turn = float(u[0] * w[1] - u[1] * w[0])
        residual = np.array([float(apart @ w), turn])
        left = np.array([-w[1], w[0]])
        # d/ds and d/dt of (p − q)·w and of u × w
        jacobian = np.array([
            [float(u @ w), -1.0 + lam * float(apart @ left)],
            [-kappa * float(u @ w), lam * float(u @ w)],
        ])  # fmt: skip
        if abs(float(np.linalg.det(jacobian))) < 1e-12 * (abs(kappa) + abs(lam) + 1e-300):
            return None
        move = np.linalg.solve(jacobian, -residual)
        s_new = float(np.clip(s + move[0] / speeds[0], 0.0, ends[0]))
        t_new = float(np.clip(t + move[1] / speeds[1], 0.0, ends[1]))
        still = abs(s_new - s) < 1e-12 * ends[0] and abs(t_new - t) < 1e-12 * ends[1]
        s, t = s_new, t_new
        if still:
            break
    (p,), (u,), (kappa,) = first.at(np.array([s]))
    (q,), (w,), (lam,) = second.at(np.array([t]))
    turn = float(u[0] * w[1] - u[1] * w[0])
    mean = u - w
    mean /= np.linalg.norm(mean)
    normal = np.array([mean[1], -mean[0]])
    gap = float((q - p) @ normal)
    slip = abs(float((q - p) @ mean))
    relative = float(kappa + lam)
    inner = max(tolerance, float(np.diff(first.knots).min()))
    if float(u @ w) > -0.9 or abs(turn) > math.sin(_OFF_END) or abs(gap) > EDGE * tolerance or slip > 0.1 * inner:
        return None
    if relative <= _ROUNDER * max(abs(kappa), abs(lam)):
        return None
    i, j = first.segment(s), second.segment(t)
    shares = np.array([abs(kappa), abs(lam)]) / (abs(kappa) + abs(lam))
    # the flatter side has most of the say about the normal
    doubts = (first.doubt(s), second.doubt(t))
    doubt = shares[1] * doubts[0] + shares[0] * doubts[1] + abs(turn)
    place = (sum(doubts) + abs(turn)) / relative
    chord = float(first.chords[i] + second.chords[j])
    return _Meeting((first, second), (i, j), 0.5 * (p + q), normal, gap, relative, float(doubt), place, chord)


def _distinct(found: list[_Meeting], tolerance: float) -> list[_Meeting]:
    """Without those that two pieces of one curve both found, and those that share no length along the direction."""
    out: list[_Meeting] = []
    for met in sorted(found, key=lambda m: (m.doubt, m.gap, *m.point.tolist())):
        low, high = met.reach
        if high - low <= 0.1 * tolerance:
            continue
        if all(
            float(np.linalg.norm(met.point - other.point)) > 0.2 * tolerance or float(met.normal @ other.normal) < 0.9
            for other in out
        ):
            out.append(met)
    return out


def _nearest(found: list[_Meeting], tolerance: float) -> list[_Meeting]:
    """Those that touch. Where nothing touches, those that hold a tooth between them with equal play."""
    least = min(met.gap for met in found)
    margin = max(2.0 * max(met.chord for met in found), 2e-3 * tolerance)
    close = [met for met in found if met.gap <= max(least, 0.0) + margin]
    limit = _TOUCH * tolerance
    if least > limit:
        opposed = any(float(x.normal @ y.normal) < 0.0 for x in close for y in close)
        limit = _CAPTIVE * tolerance if opposed else limit
    return sorted((m for m in close if abs(m.gap) <= limit), key=lambda m: (*m.point.tolist(),))


def _one_line(found: list[_Meeting]) -> list[_Meeting]:
    """The meetings with lines of action that agree within their uncertainty made exactly one."""
    out = list(found)
    left = list(range(len(found)))
    while left:
        lead = min(left, key=lambda k: (found[k].doubt, k))
        group = [k for k in left if _agree(found[lead], found[k])]
        left = [k for k in left if k not in group]
        if len(group) > 1:
            weight = np.array([1.0 / max(found[k].doubt, 1e-6) ** 2 for k in group])
            normal = np.sum([w * found[k].normal for w, k in zip(weight, group, strict=True)], axis=0)
            normal /= np.linalg.norm(normal)
            middle = np.average([found[k].point for k in group], axis=0, weights=weight)
            for k in group:
                on = middle + normal * float(normal @ (found[k].point - middle))
                out[k] = replace(found[k], point=on, normal=normal)
    return out


def _agree(one: _Meeting, two: _Meeting) -> bool:
    """Whether both lie on one line of action."""
    allowed = _SIGMAS * (one.doubt + two.doubt) + 1e-6
    if float(one.normal @ two.normal) < 0.0:
        return False
    angle = abs(float(one.normal[0] * two.normal[1] - one.normal[1] * two.normal[0]))
    apart = two.point - one.point
    off = abs(float(one.normal[0] * apart[1] - one.normal[1] * apart[0]))
    place = _SIGMAS * (one.place + two.place)
    return angle <= allowed and off <= allowed * float(np.linalg.norm(apart)) + place


def _patch(a: PlacedPart, b: PlacedPart, met: _Meeting, direction: Array, tolerance: float) -> Patch:
    plane = across(direction)
    low, high = met.reach
    height = low + (high - low) * (np.arange(_ALONG) + 0.5) / _ALONG
    points = met.point @ plane + height[:, None] * direction
    each = 2.0 * math.sqrt(2.0 * _ZONE * tolerance / met.curvature) * (high - low) / _ALONG
    gaps = np.full(_ALONG, met.gap)
    labels = [int(curve.labels[k]) for curve, k in zip(met.curves, met.segments, strict=True)]
    bends = [_radius(curve, met) for curve in met.curves]
    return Patch(
        parts=(a.part.name, b.part.name),
        surfaces=(labels[0], labels[1]),
        kind="line",
        one_sided=False,
        points=points,
        normals=np.tile(met.normal @ plane, (_ALONG, 1)),
        gaps=gaps,
        weights=np.full(_ALONG, each),
        area=each * _ALONG,
        gap=met.gap,
        axis=direction,
        point=points.mean(axis=0),
        radii=(bends[0], bends[1]),
        misalignment=0.0,
        offset=0.0,
        uncertainty=(met.doubt, met.place),
        chord=met.chord,
        fit=classify_fit(gaps, met.chord, 1e-3 * tolerance, tolerance),
    )


def _radius(curve: Curve, met: _Meeting) -> float:
    """Radius of curvature (m) where they meet; 0 for a straight line."""
    k = int(np.argmin(np.linalg.norm(curve.points - met.point, axis=1)))
    bend = abs(float(curve.at(curve.knots[k : k + 1])[2][0]))
    return 1.0 / bend if bend > 1e-9 / max(float(curve.knots[-1]), 1e-300) else 0.0
