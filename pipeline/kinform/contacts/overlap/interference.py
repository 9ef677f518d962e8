"""Solids that overlap: how much, how deep, and whether mating surfaces explain it.

Facets of two tessellated surfaces that mate overlap without any overlap of the surfaces that they stand
for: a 32-gon in a 24-gon of radius 10 mm by up to 0.09 mm at zero gap. So a piece of overlap counts only
where it is deeper than the chord errors of the surfaces that bound it. Where only what the facets about it may stand
off their surfaces explains it, an overlap is possible, and not known.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.constants import SAMPLES
from kinform.contacts.overlap.constants import EXACT_OVERLAP
from kinform.contacts.overlap.samples import Allowance, Samples, inset, joined_samples, measured, measured_on
from kinform.contacts.overlap.shrunk import are_within
from kinform.contacts.overlap.slight import counts_of, is_slight
from kinform.contacts.overlap.solids import Piece, SolidStore, bounds_volume
from kinform.contacts.search.pair_view import PairView, PartView, near_facets
from kinform.foundation.meshes.boxes import middles
from kinform.foundation.meshes.ray_parity import winding
from kinform.model.arrays import Array, Flags, Ints, freeze
from kinform.model.contacts import Interference, OverlapMethod, Patch

CUT_FEW = 1500
"""Facets of either part up to which a cut takes no longer, 2 ms, than it takes to see that none is needed, where round
surfaces touch and one mostly is."""
THINNER = 0.25
"""Share of what counts as an overlap by which a solid is made thinner to see that it shares nothing with another. No
depth is more than that then, and no ball that both share is larger, so that pieces of the overlap are no thicker than
half of what counts: their volume is no more than their area by the radius of that ball."""


Overlaps = tuple[Interference | None, Interference | None]
"""The overlap of a pair that is sure, and, where there is none, one that is possible."""


def find_interference(pair: PairView, patches: list[Patch], solids: SolidStore, crosses: bool | None) -> Overlaps:
    """Overlap of two solids beyond the chord errors of their surfaces, in the frame of the pair; `crosses` as
    `boundaries_cross` says."""
    a, b = pair.parts
    least = EXACT_OVERLAP * pair.tolerance
    if crosses is None or not (crosses or _holds(a, b) or _holds(b, a)):
        return None, None
    closed = bounds_volume(a.index.mesh) and bounds_volume(b.index.mesh)
    # facets of round surfaces cross by their chord errors as a rule
    cross = any(patch.kind != "plane" for patch in patches)
    few = cross and max(len(part.faces) for part in pair.parts) <= CUT_FEW
    if closed and not few and are_within(a, b, THINNER * least):
        return None, None
    allowance = Allowance.of(pair, patches, least)
    overlap = solids.overlap(a, b, allowance.floor**3) if closed else None
    if overlap is None:
        return _by_facets(a, b, allowance)
    if is_slight(a, b, overlap, allowance):
        return None, None
    return _by_volume(a, b, overlap.pieces, allowance)


def _holds(outer: PartView, inner: PartView) -> bool:
    """Whether a whole shell of `inner` lies inside `outer`, given that no facets cross."""
    shells = inner.index.shells
    if len(shells) == 1 and ((inner.low < outer.low) | (inner.high > outer.high)).any():
        return False
    inside = middles(inner.vertices.take(inner.faces[shells], axis=0))
    inside = inside[((inside > outer.low) & (inside < outer.high)).all(axis=1)]
    return bool(len(inside)) and bool(_contains(outer, inside).any())


def _contains(part: PartView, points: Array) -> Flags:
    """(n,) whether points (n, 3) are inside of a part; of an open mesh, whose gaps rays pass through, only those that
    are by far."""
    return _surely(part, points, part.index.contains(part.to_part(points)))


def _surely(part: PartView, points: Array, crossed: Flags) -> Flags:
    """(n,) which of some points (n, 3), that are inside of a part by counting crossings, are so for sure."""
    out = crossed.copy()
    if not part.index.mesh.health.watertight and out.any():
        # How often the facets of an open mesh go round a point that counts as inside: of a round gap in them, as wide
        # as it is deep, less is seen, and what lies nearer to the gap has no depth that is known.
        out[out] = np.abs(winding(part.index.mesh, part.to_part(points[out]))) > 0.75
    return out


def _sampled(a: PartView, b: PartView, pieces: list[Piece], counts: list[int]) -> list[Samples]:
    """Depths at about so many points of each piece: middles of its facets, and just inside their corners."""
    chosen = []
    for piece, count in zip(pieces, counts, strict=True):
        points, part, facet = _points_of(piece)
        some = slice(0, None, max(1, math.ceil(len(points) / count)))
        chosen.append((points[some], part[some], facet[some]))
    if not chosen:
        return []
    points, part, facet = (np.concatenate(columns) for columns in zip(*chosen, strict=True))
    number = np.repeat(np.arange(len(chosen)), [len(one[0]) for one in chosen])
    all_ = measured_on(a, b, points, part, facet)
    # those on facets of the first part come before those on facets of the second
    number = np.concatenate([number[part == 0], number[part == 1]])
    return [
        Samples(all_.points[number == k], all_.depth[number == k], all_.surfaces[number == k])
        for k in range(len(chosen))
    ]


def _deepest(a: PartView, b: PartView, piece: Piece, samples: Samples, deep: Flags) -> float:
    """Greatest depth (m) of the piece: of the deep samples, and of the points beside the deepest of them."""
    best = int(np.argmax(np.where(deep, samples.depth, -math.inf)))
    points, part, facet = _points_of(piece)
    off = np.linalg.norm(points - samples.points[best], axis=1)
    # a hundred points beside the deepest one are measured too
    beside = np.lexsort((np.arange(len(off)), off))[:100]
    more = measured_on(a, b, points[beside], part[beside], facet[beside])
    return max(float(samples.depth[best]), float(more.depth.max()))


def _points_of(piece: Piece) -> tuple[Array, Ints, Ints]:
    """Middles of the facets of a piece, and points just inside their corners; of which part and facet each is."""
    middle = middles(piece.corners)
    part, facet = (np.concatenate([numbers, np.repeat(numbers, 3)]) for numbers in (piece.part, piece.facet))
    return inset(piece.corners, middle), part, facet


def _by_volume(a: PartView, b: PartView, pieces: list[Piece], allowance: Allowance) -> Overlaps:
    """The pieces of the overlap that are deeper than the surfaces explain, as one interference."""
    sure, possible = _Sum(), _Sum()
    # Faces that coincide leave sheets of no thickness: they need no measuring.
    thick_ones = [piece for piece in pieces if piece.volume > allowance.floor**3]
    facets = sum(len(piece.corners) for piece in pieces)
    counts = counts_of([len(piece.corners) for piece in thick_ones], facets)
    every = _sampled(a, b, thick_ones, counts)
    for piece, samples, (deep, thin, facets_explain) in zip(thick_ones, every, allowance.judged(every), strict=True):
        thick = 2.0 * piece.volume / piece.area
        if deep.any() and not facets_explain:
            sure.add(piece, _deepest(a, b, piece, samples, deep), mated=allowance.at_mates(samples, deep))
        elif thick > thin:
            # Two boundaries that coincide have no depth below each other: a part placed twice.
            sure.add(piece, thick, mated=False)
        elif facets_explain:
            possible.add(piece, float(samples.depth[deep].max()), mated=False)
    return (sure.overlap(a, b), None) if sure.volume > 0.0 else (None, possible.overlap(a, b))


class _Sum:
    """Pieces as one overlap."""

    def __init__(self) -> None:
        self.volume, self.depth, self.moment, self.mated = 0.0, 0.0, np.zeros(3), True

    def add(self, piece: Piece, depth: float, *, mated: bool) -> None:
        """One more of them, of this depth (m)."""
        self.volume += piece.volume
        self.moment += piece.volume * piece.centroid
        self.depth = max(self.depth, depth)
        self.mated &= mated

    def overlap(self, a: PartView, b: PartView) -> Interference | None:
        """All of them; None if there are none."""
        if self.volume <= 0.0:
            return None
        return _interference(a, b, self.volume, self.depth, self.moment / self.volume, self.mated, "manifold")


def _by_facets(a: PartView, b: PartView, allowance: Allowance) -> Overlaps:
    """Overlap of meshes that bound no volume: points of either inside the other, by counting crossings."""
    sides = ((a, b, True), (b, a, False))
    every = [measured(owner, other, *_crossed(owner, other), first) for owner, other, first in sides]
    # what goes round a point is asked of those first that would count: mostly none of them is inside
    counts = [samples.depth > allowance.chords_of(samples) for samples in every]
    inside = [
        _surely(other, samples.points, some) for (_, other, _), samples, some in zip(sides, every, counts, strict=True)
    ]
    if not any(some.any() for some in inside):
        return None, None
    inside = [
        sure | _surely(other, samples.points, ~some)
        for (_, other, _), samples, some, sure in zip(sides, every, counts, inside, strict=True)
    ]
    joined = joined_samples([samples.where(sure) for samples, sure in zip(every, inside, strict=True)])
    deep, _, facets_explain = allowance.judged([joined])[0]
    if not deep.any():
        return None, None
    depth, weights = float(joined.depth[deep].max()), joined.depth[deep]
    place = weights @ joined.points[deep] / weights.sum()
    mated = not facets_explain and allowance.at_mates(joined, deep)
    found = _interference(a, b, math.nan, depth, place, mated, "facets")
    return (None, found) if facets_explain else (found, None)


def _crossed(owner: PartView, other: PartView) -> tuple[Array, Ints]:
    """Points on the owner's facets that are inside the other part by counting crossings, and their facets."""
    near, _, _ = near_facets(owner, other.low, other.high)
    corners = owner.vertices.take(owner.faces[near], axis=0)
    points, facets = inset(corners, middles(corners)), np.concatenate([near, np.repeat(near, 3)])
    within = np.nonzero(((points > other.low) & (points < other.high)).all(axis=1))[0]
    chosen = within[:: max(1, math.ceil(len(within) / SAMPLES))]
    points, facets = points[chosen], facets[chosen]
    inside = other.index.contains(other.to_part(points))
    return points[inside], facets[inside].astype(np.int64)


def _interference(
    a: PartView, b: PartView, volume: float, depth: float, place: Array, mated: bool, method: OverlapMethod
) -> Interference:
    names = (a.part.name, b.part.name)
    return Interference(names, volume, depth, np.asarray(freeze(place)), mated, method)
