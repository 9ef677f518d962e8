"""Whether an overlap is slight: none of its pieces deeper than what tessellation explains, of all pieces at once.

Two tessellations of a shaft and its bore share a sliver for each facet, dozens of them, of which none counts. All are
asked at the points at which they would be measured one by one.
"""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import SAMPLES
from kinform.contacts.overlap.samples import SHELL_INSET, Allowance, measured_on
from kinform.contacts.overlap.solids import Overlap
from kinform.contacts.search.pair_view import PartView
from kinform.foundation.meshes.boxes import middles, triangle_boxes
from kinform.foundation.meshes.closest_facets import distances_between
from kinform.foundation.rounding import SINGLE
from kinform.foundation.sorting import distinct, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

SLIGHT_MOST = 400_000
"""Points times the facets that bound their piece up to which it is asked which are near each other: 10 MB, and 5 ms."""


def counts_of(own: list[int], facets: int) -> list[int]:
    """How many points of each piece are measured, of its `own` facets, of so many facets of all pieces."""
    # of one piece at least 16
    return [max(16, round(SAMPLES * number / facets)) for number in own]


def is_slight(a: PartView, b: PartView, overlap: Overlap, allowance: Allowance) -> bool:
    """Whether it is sure that no piece counts as an overlap."""
    own = np.diff(overlap.ends)
    if not len(own):
        return True
    volumes, areas = overlap.sizes
    thick = np.flatnonzero(volumes > (1.0 - SINGLE) * allowance.floor**3)
    if not len(thick):
        return True
    counts = np.array(counts_of(own[thick].tolist(), len(overlap.cut)))
    chosen = _chosen(np.array(overlap.ends)[thick], own[thick], counts)
    row, _, piece = chosen
    part, facet = overlap.part[row], overlap.facet[row]
    points = _places(overlap.corners, row, chosen[1])
    thickness = 2.0 * volumes[thick] / ((1.0 - SINGLE) * areas[thick])
    first = _Told(points, part, _labels(a, b, part, facet), piece)
    if _is_within(a, b, overlap, thick, first, thickness, allowance):
        return True
    # a few pieces are measured piece by piece: 0.2 ms each, beside what all take together
    if len(thick) <= 16:
        return False
    samples = measured_on(a, b, points, part, facet)
    piece = np.concatenate([piece[part == 0], piece[part == 1]])
    chords = allowance.chords_of(samples)
    if (samples.depth > _allowed(allowance, samples.surfaces, chords, piece, len(thick))).any():
        return False
    # two boundaries that coincide have no depth below each other: a part placed twice
    return bool((thickness <= _greatest(chords, piece, len(thick))).all())


@dataclass(frozen=True, eq=False)
class _Told:
    """What is known of samples before they are measured."""

    points: Array
    part: Ints
    """(n,) 0 or 1: on whose facets they are."""
    labels: Ints
    """(n,) of these facets."""
    piece: Ints
    """(n,) number of the piece."""


def _labels(a: PartView, b: PartView, part: Ints, facet: Ints) -> Ints:
    """(n,) surfaces of facets (n,) of either part (0, 1)."""
    out = np.empty(len(part), np.int64)
    for k, own in enumerate((a, b)):
        of = np.flatnonzero(part == k)
        out[of] = own.surfaces.labels[facet[of]]
    return out


def _is_within(
    a: PartView, b: PartView, overlap: Overlap, thick: Ints, told: _Told, thickness: Array, allowance: Allowance
) -> bool:
    """Whether the facets of the other part that bound the same piece are near enough to all samples, whichever facet is
    the nearest: mostly they are, and no others need to be looked for."""
    pieces, chords = len(thick), np.full(len(told.part), allowance.floor)
    surfaces = np.full((len(told.part), 2), -1)
    for k, mine in enumerate(allowance.chords):
        of = np.flatnonzero(told.part == k)
        chords[of] += mine[told.labels[of]] + allowance.chords[1 - k].min(initial=0.0)
        surfaces[of, k] = told.labels[of]
    if (thickness > _greatest(chords, told.piece, pieces)).any():
        return False
    allowed = _allowed(allowance, surfaces, chords, told.piece, pieces)
    # the distinct facets of each part that bound each piece
    number = np.full(len(overlap.ends) - 1, -1)
    number[thick] = np.arange(pieces)
    bounding = np.repeat(number, np.diff(overlap.ends))
    kept = np.flatnonzero(bounding >= 0)
    count = np.int64(max(len(a.faces), len(b.faces)))
    keys = distinct((2 * bounding[kept] + overlap.part[kept]) * count + overlap.facet[kept])
    side, facet = np.divmod(keys, count)
    corners = np.empty((len(keys), 3, 3))
    for k, part in enumerate((a, b)):
        some = np.flatnonzero(side % 2 == k)
        corners[some] = part.vertices.take(part.faces[facet[some]], axis=0)
    bounded = _Bounded(side, corners, *triangle_boxes(corners))
    allowed *= 1.0 - SINGLE
    wanted = 2 * told.piece + 1 - told.part
    # where much is deep, some of them tell
    # one point in eight is asked before all are: overlaps that count are deep at most of them
    return all(
        bounded.are_near(told.points[some], wanted[some], allowed[some]) for some in (slice(None, None, 8), slice(None))
    )


@dataclass(frozen=True, eq=False)
class _Bounded:
    """The facets that bound pieces: `side` (m,), ascending, is twice the number of the piece, and one more of those of
    the second part."""

    side: Ints
    corners: Array
    """(m, 3, 3) m."""
    low: Array
    high: Array

    def are_near(self, points: Array, wanted: Ints, reach: Array) -> bool:
        """Whether each of points (n, 3) is within its `reach` (n,) of facets of the side that is `wanted` (n,); not of
        too many to be asked about."""
        begin, end = self.side.searchsorted(wanted), self.side.searchsorted(wanted, side="right")
        number = end - begin
        if not number.all() or int(number.sum()) > SLIGHT_MOST:
            return False
        of = np.repeat(np.arange(len(points)), number)
        at = np.arange(len(of)) + np.repeat(end - np.cumsum(number), number)
        # few are near enough by their boxes
        for axis in range(3):
            place, far = points[:, axis].take(of), reach.take(of)
            near = self.low[:, axis].take(at) - place <= far
            near &= place - self.high[:, axis].take(at) <= far
            of, at = of[near], at[near]
        away = distances_between(points.take(of, axis=0), self.corners.take(at, axis=0))
        return int(np.count_nonzero(heads(of[away <= reach.take(of)]))) == len(points)


def _greatest(values: Array, piece: Ints, pieces: int) -> Array:
    """(p,) the greatest of values (n,) of each of so many pieces, or nothing."""
    out = np.zeros(pieces)
    np.maximum.at(out, piece, values)
    return out


def _chosen(starts: Ints, own: Ints, counts: Ints) -> tuple[Ints, Ints, Ints]:
    """Of pieces of `own` (p,) facets that begin at `starts` (p,), each of which has its middles and then three points
    beside corners for each facet: those evenly chosen of which there are about `counts` (p,), as the row of the facet,
    the corner (−1: the middle), and the number of the piece."""
    steps = np.maximum(1, -(-4 * own // counts))
    numbers = -(-4 * own // steps)
    piece = np.repeat(np.arange(len(own)), numbers)
    place = np.arange(len(piece)) - np.repeat(np.cumsum(numbers) - numbers, numbers)
    place *= steps[piece]
    beside = place - own[piece]
    row, corner = np.divmod(beside, 3)
    middle = beside < 0
    row[middle], corner[middle] = place[middle], -1
    return row + starts[piece], corner, piece


def _places(corners: Array, row: Ints, corner: Ints) -> Array:
    """(n, 3) those points, of facets (t, 3, 3), as `inset` has them."""
    chosen = corners.take(row, axis=0)
    middle = middles(chosen)
    beside = np.flatnonzero(corner >= 0)
    inner = SHELL_INSET * chosen[beside, corner[beside]]
    out = middle.copy()
    out[beside] = inner + (1.0 - SHELL_INSET) * middle[beside]
    return out


def _allowed(allowance: Allowance, surfaces: Ints, chords: Array, piece: Ints, pieces: int) -> Array:
    """(n,) m: depth that is explained at samples of so many pieces, on `surfaces` (n, 2) of both parts as far as these
    are known, as `Allowance.unexplained` has it."""
    i, j = surfaces.T
    out = chords.copy()
    for (s, t), patch in allowance.mates.items():
        there = np.zeros((2, pieces), bool)
        there[0, piece[i == s]] = True
        there[1, piece[j == t]] = True
        at = (there[0] & there[1])[piece]
        out[at] = np.maximum(out[at], patch.chord + patch.uncertainty[1] + allowance.floor)
    return out
