"""Moves lines and centres by the least that makes them meet exactly where they meet within their uncertainty.

With directions kept, "these lines pass through one point" is linear in the shifts of the lines and in the
point; the shifts, each weighed by its uncertainty, are the solution of least norm. Nothing that meets only
by more than its uncertainty is touched, and nothing is shifted by more than its room.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, foot, norm, perpendicular
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.constants import MET
from kinform.model.arrays import Array, Flags, Ints

LEAST_CROSSING = 0.05
"""Lines at a smaller angle (sine) meet nowhere in particular. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Locus:
    """A line, or a centre where `axis` is None, that joints of these bodies turn about."""

    point: Array
    axis: Array | None
    angle: float
    """rad: uncertainty of the direction."""
    position: float
    """m: uncertainty of the place, at `point`."""
    bodies: frozenset[str]
    room: float = np.inf
    """m: the most that it may be shifted by, whatever its uncertainty."""
    shifted: float = 0.0
    """m: by how much it was shifted already."""

    def uncertainty(self, place: Array) -> float:
        """m: of the line beside a place (3,)."""
        return self.position + self.angle * norm(place - self.point)

    def across(self) -> Array:
        """(k, 3) unit vectors along which a shift changes it."""
        return np.eye(3) if self.axis is None else np.array(perpendicular(self.axis))


def meeting_shifts(loci: Sequence[Locus], sigmas: float) -> Array:
    """(n, 3) m: shifts that make loci meet which now miss each other by at most `sigmas` uncertainties.

    Only loci that share a body are compared: axes that are far apart in the mechanism meet by chance.
    """
    shifts = np.zeros((len(loci), 3))
    points = _meetings(loci, sigmas)
    links = UnionFind(len(loci))
    for members, _ in points:
        for other in members[1:]:
            links.union(members[0], other)
    parts: dict[int, list[tuple[list[int], Array]]] = {}
    for members, place in points:
        parts.setdefault(links.find(members[0]), []).append((members, place))
    for root in sorted(parts):
        shifts += _shifts(loci, parts[root], sigmas)
    return shifts


def _shifts(loci: Sequence[Locus], points: list[tuple[list[int], Array]], sigmas: float) -> Array:
    """Shifts for these points, without the loci that would have to move by more than they may."""
    if all(_distance(loci[k], place) <= MET * _reach(loci[k], place) for members, place in points for k in members):
        return np.zeros((len(loci), 3))
    while points:
        shifts = _solve(loci, points)
        excess = {
            k: _excess(loci[k], shifts[k], sigmas * max(loci[k].uncertainty(place) for m, place in points if k in m))
            for k in sorted({k for members, _ in points for k in members})
        }
        worst = max(excess, key=lambda k: excess[k])
        if excess[worst] <= 1.0:
            return shifts
        left = [([k for k in members if k != worst], place) for members, place in points]
        points = [(members, place) for members, place in left if len(members) > 1]
    return np.zeros((len(loci), 3))


def _excess(locus: Locus, shift: Array, uncertain: float) -> float:
    """A shift (3,) over the most that it may be."""
    size, most = norm(shift), min(uncertain - locus.shifted, locus.room)
    return 0.0 if size == 0.0 else size / most if most > 0.0 else np.inf


def _meetings(loci: Sequence[Locus], sigmas: float) -> list[tuple[list[int], Array]]:
    """Points where two or more loci meet: their members, ascending, and a place near the point."""
    meetings: list[tuple[set[int], Array, float]] = []
    points_of: dict[int, set[int]] = {}
    for i, j in _neighbours(loci, sigmas):
        place, sine = _between(loci[i], loci[j])
        if place is None:
            continue
        spread = sigmas * (loci[i].uncertainty(place) + loci[j].uncertainty(place))
        if _distance(loci[i], place) + _distance(loci[j], place) > spread:
            continue
        reach = 2.0 * spread / sine
        for n in sorted(points_of.get(i, set()) | points_of.get(j, set())):
            members, other, wide = meetings[n]
            if norm(other - place) <= reach + wide:
                members |= {i, j}
                break
        else:
            n = len(meetings)
            meetings.append(({i, j}, place, reach))
        for k in (i, j):
            points_of.setdefault(k, set()).add(n)
    return [(sorted(members), place) for members, place, _ in meetings]


def _neighbours(loci: Sequence[Locus], sigmas: float) -> list[tuple[int, int]]:
    """Pairs (i < j) of loci that share a body and may meet, sorted."""
    around: dict[str, list[int]] = {}
    for k, locus in enumerate(loci):
        for body in sorted(locus.bodies):
            around.setdefault(body, []).append(k)
    lines = _Lines(loci)
    pairs: set[tuple[int, int]] = set()
    for members in around.values():
        every = np.array(members)
        if lines.parallel(every):
            continue
        for n, i in enumerate(members[:-1]):
            others = every[n + 1 :]
            pairs.update((i, int(j)) for j in others[lines.may_meet(i, others, sigmas)])
    return sorted(pairs)


class _Lines:
    """All loci as arrays, to leave out at once those that cannot meet; what is left is tested one by one."""

    def __init__(self, loci: Sequence[Locus]):
        self.points = np.array([locus.point for locus in loci]).reshape(-1, 3)
        self.axes = np.array([np.zeros(3) if locus.axis is None else locus.axis for locus in loci]).reshape(-1, 3)
        self.centre = np.array([locus.axis is None for locus in loci], dtype=bool)
        self.angle = np.array([locus.angle for locus in loci])
        self.position = np.array([locus.position for locus in loci])

    def parallel(self, members: Ints) -> bool:
        """Whether all of these are lines of one direction, so that no two can meet."""
        off = np.abs(self.axes[members] - self.axes[members[0]])
        return not self.centre[members].any() and float(off.max()) < 0.25 * LEAST_CROSSING

    def may_meet(self, i: int, others: Ints, sigmas: float) -> Flags:
        """Which of the others are not parallel to line i, and near enough to it."""
        a, b = self.axes[i], self.axes[others]
        if not self.centre[i] and not self.centre[others].any() and float(np.abs(b - a).max()) < 0.5 * LEAST_CROSSING:
            return np.zeros(len(others), dtype=bool)
        normal = cross(b, a)
        sine = np.linalg.norm(normal, axis=1)
        apart = self.points[others] - self.points[i]
        along = np.linalg.norm(apart, axis=1)
        skew = sine >= LEAST_CROSSING
        near = np.abs((apart * normal).sum(axis=1)) / np.where(skew, sine, 1.0)
        # the places where both are closest lie at most so far from the points of the lines
        reach = 2.0 * along / np.where(skew, sine, 1.0)
        spread = sigmas * (self.position[i] + self.position[others] + (self.angle[i] + self.angle[others]) * reach)
        # a centre and a line, or two centres, are few: no test
        # Slack of the first look at which lines may meet, which must not lose any to rounding.
        return np.asarray(self.centre[i] | self.centre[others] | (skew & (near <= 1.001 * spread)))


def _reach(locus: Locus, place: Array) -> float:
    return float(np.abs(locus.point).max() + np.abs(place).max())


def _distance(locus: Locus, place: Array) -> float:
    arm = place - locus.point
    return norm(arm if locus.axis is None else cross(arm, locus.axis))


def _between(a: Locus, b: Locus) -> tuple[Array | None, float]:
    """The point half-way between two loci where they are closest, and the sine of their angle."""
    if a.axis is None or b.axis is None:
        centre, other = (a, b) if a.axis is None else (b, a)
        place = other.point if other.axis is None else foot(other.point, other.axis, centre.point)
        return 0.5 * (centre.point + place), 1.0
    normal = cross(a.axis, b.axis)
    sine = norm(normal)
    if sine < LEAST_CROSSING:
        return None, sine
    apart = b.point - a.point
    along_a = float(cross(apart, b.axis) @ normal) / sine**2
    along_b = float(cross(apart, a.axis) @ normal) / sine**2
    return 0.5 * (a.point + along_a * a.axis + b.point + along_b * b.axis), sine


def _solve(loci: Sequence[Locus], points: list[tuple[list[int], Array]]) -> Array:
    """(n, 3) m: least weighted shifts of the loci that make them pass through these points."""
    shifts = np.zeros((len(loci), 3))
    members = sorted({k for group, _ in points for k in group})
    scale = max(loci[k].position for k in members)
    bases = {k: loci[k].across() * (loci[k].position / scale) for k in members}
    start, width = {}, 0
    for k in members:
        start[k], width = width, width + len(bases[k])
    count = sum(len(bases[k]) for group, _ in points for k in group)
    # each unknown meeting point is measured from its place, so that all unknowns are small
    matrix, right, row = np.zeros((count, width + 3 * len(points))), np.zeros(count), 0
    for n, (group, place) in enumerate(points):
        for k in group:
            across = loci[k].across()
            here = slice(row, row + len(across))
            matrix[here, start[k] : start[k] + len(across)] = across @ bases[k].T
            matrix[here, width + 3 * n : width + 3 * n + 3] = -across
            right[here] = across @ (place - loci[k].point)
            row += len(across)
    # eliminate the points, then take the least shifts that satisfy what is left
    free = matrix[:, width:]
    left, values, _ = np.linalg.svd(free, full_matrices=True)
    rank = int(np.count_nonzero(values > SOLVED * values[0]))
    rest = left[:, rank:].T
    missed = rest @ right
    if np.abs(missed).max(initial=0.0) <= MET * max(float(np.abs(loci[k].point).max()) for k in members):
        return shifts
    solution = np.linalg.lstsq(rest @ matrix[:, :width], missed, rcond=SOLVED)[0]
    for k in members:
        shifts[k] = solution[start[k] : start[k] + len(bases[k])] @ bases[k]
    return shifts
