"""Teeth that keep a constant ratio: counted on both outlines, and rolled on each other while one tooth passes.

Known here: plane sections of two parts that turn or slide in one plane. As many teeth of one side pass as of the
other, so over whole pitches the ratio is that of the pitches, whatever the flanks are; how far the motion departs
from it in between (the transmission error) and the play are read from the sections, one on the other, pose by pose
(Litvin & Fuentes, Gear Geometry and Applied Theory, 2004, chapters 4 and 9). Nothing is known of skew or crossing
axes, and of teeth that do not come at even distances.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm, perpendicular
from kinform.foundation.rounding import SOLVED, TINY
from kinform.foundation.sorting import heads, median
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh
from kinform.model.kinematics import Meshing

EVEN_TEETH = 0.03
"""Share of the pitch by which teeth may stand elsewhere than at even distances, or leave the constant ratio:
tessellated involutes of five points a flank stay below a third of it, straight flanks on wheels do not."""
FEWEST_TEETH = 5
"""Teeth of a whole wheel, and teeth in a row of a rack or a sector, from which on they are teeth and no cams. Chosen,
not measured."""
TOOTH_POSES = 24
"""Poses in which the sections are held against each other while one tooth passes. Chosen, not measured."""
IN_PLANE = 1e-3
"""rad: axes that are parallel or perpendicular to this lie in one plane. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Side:
    """One of the two parts, and how it moves when the value of its joint grows."""

    mesh: Mesh
    X_WP: Array
    twist: Array
    """(6,) at the world's origin, relative to the body that carries both joints."""


@dataclass(frozen=True, eq=False)
class _Outline:
    """The section of one side in its own coordinates: `level` stays, `along` grows with the motion."""

    edges: Array
    """(n, 2, 2) m, material to the left, in the plane."""
    centre: Array
    """(2,) m of a turn; a point of a slide."""
    along: Array
    """(2,) unit of a slide; zero of a turn."""
    sense: float
    """±1: along grows, or falls, with the value of the joint."""

    @property
    def turns(self) -> bool:
        return not self.along.any()

    def coordinates(self, points: Array) -> tuple[Array, Array]:
        """(level, along) of points (n, 2): radius and angle, or offset and distance."""
        arm = points - self.centre
        if self.turns:
            return np.hypot(arm[:, 0], arm[:, 1]), np.arctan2(arm[:, 1], arm[:, 0])
        return arm @ np.array([-self.along[1], self.along[0]]), arm @ self.along

    def move(self, points: Array, by: float) -> Array:
        """Points (…, 2) after a motion of `by` along."""
        if not self.turns:
            return np.asarray(points + by * self.along)
        c, s = math.cos(by), math.sin(by)
        return np.asarray((points - self.centre) @ np.array([[c, s], [-s, c]]) + self.centre)

    def apart(self, one: Array, two: Array) -> Array:
        """Distance along from one to the other; of turns within half a turn."""
        return np.asarray(np.remainder(two - one + math.pi, 2.0 * math.pi) - math.pi if self.turns else two - one)

    def crossings(self, levels: Array, edges: Array) -> tuple[Ints, Array, Flags]:
        """Where edges (n, 2, 2) cross levels (m,): which level (k,), ascending, along (k,), and whether the material
        lies behind, so that a motion forwards brings this side of it against others."""
        first, step = edges[:, 0] - self.centre, edges[:, 1] - edges[:, 0]
        level, edge = _within(levels, *self._spans(first, step))
        start, way = first.take(edge, axis=0), step.take(edge, axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.turns:
                a, b = np.einsum("ij,ij->i", way, way), np.einsum("ij,ij->i", start, way)
                c = np.einsum("ij,ij->i", start, start) - levels.take(level) ** 2
                root = np.sqrt(np.where(b * b - a * c > 0.0, b * b - a * c, np.nan))
                t = np.stack([(-b - root) / a, (-b + root) / a], axis=1)
            else:
                across = np.array([-self.along[1], self.along[0]])
                t = ((levels.take(level) - start @ across) / (way @ across))[:, None]
            pair, which = ((t >= 0.0) & (t < 1.0)).nonzero()
        way = way.take(pair, axis=0)
        at = start.take(pair, axis=0) + t[pair, which][:, None] * way
        outward = np.stack([way[:, 1], -way[:, 0]], axis=1)
        if self.turns:
            along = np.arctan2(at[:, 1], at[:, 0])
            ahead = at[:, 0] * outward[:, 1] - at[:, 1] * outward[:, 0]
        else:
            along, ahead = at @ self.along, outward @ self.along
        return level.take(pair), along, ahead > 0.0

    def _spans(self, first: Array, step: Array) -> tuple[Array, Array]:
        """(n,) least and greatest level of edges that begin at `first` (n, 2), from the centre, and go by `step`."""
        if not self.turns:
            across = np.array([-self.along[1], self.along[0]])
            ends = np.stack([first @ across, (first + step) @ across])
            return ends.min(axis=0), ends.max(axis=0)
        long = np.maximum(np.einsum("ij,ij->i", step, step), TINY)
        foot = first - np.clip(np.einsum("ij,ij->i", first, step) / long, -1.0, 0.0)[:, None] * step
        ends = np.stack([np.hypot(*first.T), np.hypot(*(first + step).T)])
        return np.hypot(*foot.T), ends.max(axis=0)


def _within(levels: Array, low: Array, high: Array) -> tuple[Ints, Ints]:
    """(k,) levels (m,), ascending, and spans from `low` to `high` (n,) that they are in, but for rounding."""
    order = np.argsort(levels, kind="stable")
    spare = SOLVED * np.abs(high).max(initial=0.0)
    begin = levels[order].searchsorted(low - spare)
    count = levels[order].searchsorted(high + spare, side="right") - begin
    span = np.repeat(np.arange(len(low)), count)
    place = np.arange(len(span)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin, count)
    level = order.take(place)
    kept = np.lexsort((span, level))
    return level.take(kept), span.take(kept)


def meshing(sides: tuple[Side, Side], axis: Array, place: Array, normal: Array, ratio: float) -> Meshing | str:
    """What the teeth of two sides that touch at `place` (3,) do, or why they keep no ratio.

    `axis` (3,): unit, across the section; `normal` (3,): unit, of the contact, into the second side; `ratio`: of the
    values at this pose, as the normals give it. "" as a reason where the section says nothing.
    """
    plane = -np.stack(perpendicular(axis))
    outlines = []
    for side in sides:
        outline = _outline(side, axis, place, plane)
        if outline is None:
            return ""
        outlines.append(outline)
    first, second = outlines
    # at the pitch point both sides have teeth, where the contact itself may be at their tips
    touch = _pitch_point(first, second, ratio)
    rows = [_teeth(outline, touch) for outline in outlines]
    for row in rows:
        if isinstance(row, str):
            return row
    first_row, second_row = (row for row in rows if not isinstance(row, str))
    mean = math.copysign(first_row.pitch / second_row.pitch, ratio)
    # Relative: what the ratio at one pose, from the normals of the flanks, may differ from that of the teeth.
    if abs(ratio / mean - 1.0) > 0.01:
        return (
            f"the ratio at this pose is {ratio:.5g}, that of {first_row.count} and {second_row.count} teeth {mean:.5g}"
        )
    ahead, behind = _roll(first, second, first_row.pitch, first.sense * second.sense / mean)
    if not (np.isfinite(ahead).all() and np.isfinite(behind).all()):
        return "the teeth let go of each other before the next ones meet"
    error = float(max(np.ptp(ahead), np.ptp(behind)))
    if error > EVEN_TEETH * second_row.pitch:
        share = error / second_row.pitch
        return f"while one tooth passes the motion departs by {share:.2g} of a pitch from a constant ratio"
    lower, upper = _reach(first, first_row, touch)
    other = [abs(mean) * value for value in _reach(second, second_row, touch)]
    if mean < 0.0:
        other = [-other[1], -other[0]]
    return Meshing(
        ratio=mean,
        teeth=(first_row.count, second_row.count),
        pitches=(first_row.pitch, second_row.pitch),
        deviation=abs(mean) * error,
        play=abs(mean) * max(0.0, float((ahead + behind).min())),
        reach=(max(lower, other[0]), min(upper, other[1])),
        place=_pitch_point(first, second, mean) @ plane + float(axis @ place) * axis,
        normals=np.stack([normal, _mirror_normal(first, second, plane, normal)]),
    )


def _outline(side: Side, axis: Array, place: Array, plane: Array) -> _Outline | None:
    """The section across the axis at the place; None where the side does not move in this plane."""
    omega, v = side.twist[:3], side.twist[3:]
    edges = _section(side.mesh, side.X_WP, axis, place, plane)
    size = norm(omega)
    if size > 0.0:
        if norm(cross(omega, axis)) > IN_PLANE * size:
            return None
        centre = plane @ (cross(omega, v) / size**2)
        return _Outline(edges, centre, np.zeros(2), math.copysign(1.0, float(omega @ axis)))
    along = plane @ v
    if norm(along) < (1.0 - IN_PLANE**2) * norm(v):
        return None
    return _Outline(edges, plane @ place, along / norm(along), 1.0)


def _section(mesh: Mesh, X_WP: Array, axis: Array, place: Array, plane: Array) -> Array:
    """(n, 2, 2) m: edges of the section of a mesh through a place, the material to their left."""
    points = mesh.vertices @ X_WP[:3, :3].T + X_WP[:3, 3]
    above = (points - place) @ axis > 0.0
    faces = mesh.faces[above[mesh.faces].any(axis=1) & ~above[mesh.faces].all(axis=1)]
    # turned so that the corner that is alone on its side comes first
    alone = above[faces] == (above[faces].sum(axis=1) == 1)[:, None]
    turn = (np.argmax(alone, axis=1)[:, None] + np.arange(3)) % 3
    corners = points[np.take_along_axis(faces, turn, axis=1)]
    height = (corners - place) @ axis
    share = height[:, :1] / (height[:, :1] - height[:, 1:])
    cut = corners[:, :1] + share[..., None] * (corners[:, 1:] - corners[:, :1])
    edges = cut @ plane.T
    edges = np.where((height[:, 0] > 0.0)[:, None, None], edges, edges[:, ::-1])
    return np.asarray(edges[np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1) > 0.0])


@dataclass(frozen=True)
class _Row:
    """Evenly spaced teeth through the place of contact."""

    count: int
    pitch: float
    """rad or m."""
    first: float
    """along of the middle of the first and of the last; -inf and inf of a whole wheel."""
    last: float


def _teeth(outline: _Outline, touch: Array) -> _Row | str:
    """The teeth at the level of the contact, or why there are none.

    A tooth is where the outline enters the material. A whole wheel has them at even distances all round; of a rack or a
    sector count those beside the contact that come at the distance of the median of the nearest gaps.
    """
    levels, places = outline.coordinates(touch[None])
    _, along, leading = outline.crossings(levels, outline.edges)
    # the side that leads of each tooth: they come once a tooth
    starts = np.sort(outline.apart(places[0], along[leading]))
    if len(starts) < FEWEST_TEETH or 2 * len(starts) != len(along):
        return (
            f"one side has only {len(starts)} at the contact where teeth would be" if len(starts) < FEWEST_TEETH else ""
        )
    gaps = np.diff(starts)
    if outline.turns:
        gaps = np.append(gaps, starts[0] + 2.0 * math.pi - starts[-1])
        pitch = 2.0 * math.pi / len(starts)
        if np.abs(starts - starts[0] - pitch * np.arange(len(starts))).max() <= EVEN_TEETH * pitch:
            return _Row(len(starts), pitch, -math.inf, math.inf)
    middle = int(np.argmin(np.abs(starts)))
    pitch = median(gaps[max(0, middle - 2) : middle + 2])
    low, high = middle, middle
    while low > 0 and abs(starts[low] - starts[low - 1] - pitch) <= EVEN_TEETH * pitch:
        low -= 1
    while high + 1 < len(starts) and abs(starts[high + 1] - starts[high] - pitch) <= EVEN_TEETH * pitch:
        high += 1
    if high - low + 1 < FEWEST_TEETH:
        return "the teeth at the contact do not come at even distances"
    pitch = float(starts[high] - starts[low]) / (high - low)
    ends = np.sort(outline.apart(places[0], along[~leading]))
    half = 0.5 * median(np.mod(starts - ends, pitch)) if len(ends) == len(starts) else 0.25 * pitch
    return _Row(high - low + 1, pitch, float(starts[low]) - half, float(starts[high]) - half)


def _roll(first: _Outline, second: _Outline, pitch: float, follow: float) -> tuple[Array, Array]:
    """(POSES,) how far the second side can go forwards and backwards (along) while the first passes one pitch and the
    second follows in the constant ratio `follow` (along over along); nan where nothing stops it."""
    ends = [_near(first, second), _near(second, first)]
    out = np.full((2, TOOTH_POSES), np.nan)
    for k, share in enumerate(np.linspace(0.0, 1.0, TOOTH_POSES, endpoint=False)):
        still = first.move(ends[0], share * pitch)
        moving = second.move(ends[1], share * pitch * follow)
        out[:, k] = _stops(second, still, moving)
    return out[0], out[1]


def _near(outline: _Outline, other: _Outline) -> Array:
    """Edges of an outline that come where the other can reach while one tooth passes."""
    level = other.coordinates(other.edges.reshape(-1, 2))[0]
    reached = other.coordinates(outline.edges.reshape(-1, 2))[0].reshape(-1, 2)
    if other.turns:
        # Teeth up to this share of the other wheel's tip radius are within its reach.
        return np.asarray(outline.edges[(reached <= 1.02 * level.max()).any(axis=1)])
    return np.asarray(outline.edges[((reached >= level.min()) & (reached <= level.max())).any(axis=1)])


def _stops(motion: _Outline, still: Array, moving: Array) -> tuple[float, float]:
    """How far `moving` edges can go forwards and backwards until they meet `still` ones; negative where they overlap.

    Straight edges meet first at a corner of one of them: each corner of the one side is held against the material of
    the other at its own level.
    """
    forwards: list[float] = []
    backwards: list[float] = []
    for corners, edges, sign in ((still, moving, 1.0), (moving, still, -1.0)):
        level, place = motion.coordinates(corners[:, 0])
        corner, along, leading = motion.crossings(level, edges)
        # of the edges as seen from the corner
        away = motion.apart(place.take(corner), along)
        below, ends_below = _nearest(corner, away, leading, len(level), away <= 0.0, last=True)
        above, begins_above = _nearest(corner, away, leading, len(level), away > 0.0, last=False)
        ends_above = ~begins_above
        # outside: free from the end of material below to its beginning above; inside: the nearer side is passed
        inside = np.isfinite(below) & np.isfinite(above) & ~ends_below & ~ends_above
        nearer = above < -below
        gap_below = np.where(np.isfinite(below) & ends_below, -below, np.where(inside & nearer, -above, np.inf))
        gap_above = np.where(np.isfinite(above) & ends_above, above, np.where(inside & ~nearer, below, np.inf))
        (forwards if sign > 0.0 else backwards).append(gap_below.min(initial=np.inf))
        (backwards if sign > 0.0 else forwards).append(gap_above.min(initial=np.inf))
    forward, backward = (value if math.isfinite(value) else math.nan for value in (min(forwards), min(backwards)))
    return forward, backward


def _nearest(
    corner: Ints, away: Array, leading: Flags, corners: int, among: Flags, *, last: bool
) -> tuple[Array, Flags]:
    """(m,) the last or first of the crossings of each corner that count, infinite where there are none, and whether it
    leads."""
    rows = among.nonzero()[0]
    place = -rows if last else rows  # of equal ones the first that was found
    rows = rows[np.lexsort((place, away[rows], corner[rows]))]
    ordered = corner[rows]
    ends = heads(ordered[::-1])[::-1] if last else heads(ordered)
    out, leads = np.full(corners, -np.inf if last else np.inf), np.zeros(corners, dtype=bool)
    out[ordered[ends]], leads[ordered[ends]] = away[rows[ends]], leading[rows[ends]]
    return out, leads


def _reach(outline: _Outline, row: _Row, touch: Array) -> tuple[float, float]:
    """Values of the joint between which the teeth are where the contact is."""
    lower, upper = -(row.last + 0.5 * row.pitch), -(row.first - 0.5 * row.pitch)
    return (lower, upper) if outline.sense > 0.0 else (-upper, -lower)


def _pitch_point(first: _Outline, second: _Outline, ratio: float) -> Array:
    """(2,) where both sides have the same velocity."""
    a, b = first.sense * ratio, second.sense
    if first.turns and second.turns:
        return np.asarray((a * first.centre - b * second.centre) / (a - b))
    wheel, slide, share = (first, second, b / a) if first.turns else (second, first, a / b)
    return np.asarray(wheel.centre + share * np.array([slide.along[1], -slide.along[0]]))


def _mirror_normal(first: _Outline, second: _Outline, plane: Array, normal: Array) -> Array:
    """The normal of the other flank: the mirror image across the line of centres, or across the way of a slide."""
    if first.turns and second.turns:
        line = second.centre - first.centre
        across = np.array([-line[1], line[0]]) / max(norm(line), TINY)
    else:
        across = first.along + second.along
        across /= max(norm(across), TINY)
    t = across @ plane
    return np.asarray(normal - 2.0 * float(normal @ t) * t)
