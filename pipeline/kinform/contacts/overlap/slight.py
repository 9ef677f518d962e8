"""Whether an overlap is slight: none of its pieces deeper than what tessellation explains, of all pieces at once.

Two tessellations of a shaft and its bore share a sliver for each facet, dozens of them, of which none counts. All are
asked at the points at which they would be measured one by one.
"""

from __future__ import annotations

import numpy as np

from kinform.contacts import constants
from kinform.contacts.overlap.samples import Allowance, Samples, measured_on
from kinform.contacts.overlap.solids import Overlap
from kinform.contacts.search.pair_view import PartView
from kinform.foundation.meshes.boxes import middles
from kinform.model.arrays import Array, Ints


def counts_of(own: list[int], facets: int) -> list[int]:
    """How many points of each piece are measured, of its `own` facets, of so many facets of all pieces."""
    return [max(constants.DEPTH_SAMPLES_LEAST, round(constants.DEPTH_SAMPLES * number / facets)) for number in own]


def is_slight(a: PartView, b: PartView, overlap: Overlap, allowance: Allowance) -> bool:
    """Whether it is sure that no piece counts as an overlap."""
    own = np.diff(overlap.ends)
    if not len(own):
        return True
    volumes, areas = overlap.sizes
    thick = np.flatnonzero(volumes > (1.0 - constants.SURELY_SLIGHT) * allowance.floor**3)
    if not len(thick):
        return True
    counts = np.array(counts_of(own[thick].tolist(), len(overlap.cut)))
    row, corner, piece = _chosen(np.array(overlap.ends)[thick], own[thick], counts)
    points, part, facet = _places(overlap.corners, row, corner), overlap.part[row], overlap.facet[row]
    samples = measured_on(a, b, points, part, facet)
    piece = np.concatenate([piece[part == 0], piece[part == 1]])
    chords = allowance.chords_of(samples)
    if (samples.depth > _allowed(allowance, samples, chords, piece, len(thick))).any():
        return False
    most = np.zeros(len(thick))
    np.maximum.at(most, piece, chords)
    # two boundaries that coincide have no depth below each other: a part placed twice
    return bool((2.0 * volumes[thick] <= (1.0 - constants.SURELY_SLIGHT) * most * areas[thick]).all())


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
    inner = constants.SHELL_INSET * chosen[beside, corner[beside]]
    out = middle.copy()
    out[beside] = inner + (1.0 - constants.SHELL_INSET) * middle[beside]
    return out


def _allowed(allowance: Allowance, samples: Samples, chords: Array, piece: Ints, pieces: int) -> Array:
    """(n,) m: depth that is explained at samples of so many pieces, as `Allowance.unexplained` has it."""
    i, j = samples.surfaces.T
    out = chords.copy()
    for (s, t), patch in allowance.mates.items():
        there = np.zeros((2, pieces), bool)
        there[0, piece[i == s]] = True
        there[1, piece[j == t]] = True
        at = (there[0] & there[1])[piece]
        out[at] = np.maximum(out[at], patch.chord + patch.uncertainty[1] + allowance.floor)
    return out
