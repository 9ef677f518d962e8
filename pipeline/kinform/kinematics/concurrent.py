"""Moves lines and centres by the least that makes them meet exactly where they meet within their uncertainty.

With directions kept, "these lines pass through one point" is linear in the shifts of the lines and in the
point; the shifts, each weighed by its uncertainty, are the solution of least norm. Nothing that meets only
by more than its uncertainty is touched.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.graph import UnionFind
from kinform.kinematics.screws import cross_product, perpendicular

__all__ = ["Locus", "meeting_shifts"]

Array = NDArray[np.float64]

SKEW = 0.05
"""Lines at a smaller angle (sine) meet nowhere in particular."""


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

    def uncertainty(self, place: Array) -> float:
        """m: of the line beside a place (3,)."""
        return self.position + self.angle * float(np.linalg.norm(place - self.point))

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
        shifts += _agreed(loci, parts[root], sigmas)
    return shifts


def _agreed(loci: Sequence[Locus], points: list[tuple[list[int], Array]], sigmas: float) -> Array:
    """Shifts for these points, without the loci that would have to move by more than their uncertainty."""
    while points:
        shifts = _solve(loci, points)
        excess = {
            k: float(np.linalg.norm(shifts[k])) / max(loci[k].uncertainty(place) for m, place in points if k in m)
            for k in sorted({k for members, _ in points for k in members})
        }
        worst = max(excess, key=lambda k: excess[k])
        if excess[worst] <= sigmas:
            return shifts
        left = [([k for k in members if k != worst], place) for members, place in points]
        points = [(members, place) for members, place in left if len(members) > 1]
    return np.zeros((len(loci), 3))


def _meetings(loci: Sequence[Locus], sigmas: float) -> list[tuple[list[int], Array]]:
    """Points where two or more loci meet: their members, ascending, and a place near the point."""
    found: list[tuple[set[int], Array, float]] = []
    for i, j in _neighbours(loci):
        place, sine = _between(loci[i], loci[j])
        if place is None:
            continue
        spread = sigmas * (loci[i].uncertainty(place) + loci[j].uncertainty(place))
        if _distance(loci[i], place) + _distance(loci[j], place) > spread:
            continue
        reach = 2.0 * spread / sine
        for members, other, wide in found:
            if members & {i, j} and np.linalg.norm(other - place) <= reach + wide:
                members |= {i, j}
                break
        else:
            found.append(({i, j}, place, reach))
    return [(sorted(members), place) for members, place, _ in found]


def _neighbours(loci: Sequence[Locus]) -> list[tuple[int, int]]:
    """Pairs (i < j) of loci that share a body, sorted."""
    around: dict[str, list[int]] = {}
    for k, locus in enumerate(loci):
        for body in locus.bodies:
            around.setdefault(body, []).append(k)
    return sorted({(i, j) for members in around.values() for n, i in enumerate(members) for j in members[n + 1 :]})


def _distance(locus: Locus, place: Array) -> float:
    arm = place - locus.point
    return float(np.linalg.norm(arm if locus.axis is None else cross_product(arm, locus.axis)))


def _between(a: Locus, b: Locus) -> tuple[Array | None, float]:
    """The point half-way between two loci where they are closest, and the sine of their angle."""
    if a.axis is None or b.axis is None:
        centre, other = (a, b) if a.axis is None else (b, a)
        arm = centre.point - other.point
        foot = other.point if other.axis is None else other.point + other.axis * float(other.axis @ arm)
        return 0.5 * (centre.point + foot), 1.0
    normal = cross_product(a.axis, b.axis)
    sine = float(np.linalg.norm(normal))
    if sine < SKEW:
        return None, sine
    apart = b.point - a.point
    along_a = float(cross_product(apart, b.axis) @ normal) / sine**2
    along_b = float(cross_product(apart, a.axis) @ normal) / sine**2
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
    rank = int(np.count_nonzero(values > 1e-9 * values[0]))
    rest = left[:, rank:].T
    missed = rest @ right
    if np.abs(missed).max(initial=0.0) <= 1e-15 * max(float(np.abs(loci[k].point).max()) for k in members):
        return shifts
    solution = np.linalg.lstsq(rest @ matrix[:, :width], missed, rcond=1e-9)[0]
    for k in members:
        shifts[k] = solution[start[k] : start[k] + len(bases[k])] @ bases[k]
    return shifts
