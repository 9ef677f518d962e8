"""Pairs whose facets cross only as round surfaces that mate are tessellated, of many pairs at once: a pin in its bore
shares a sliver with it for each facet, and none of them is an overlap. It is seen without a cut.

Once the parts have left each other by less than what counts, facets that cross are those of mates, and planes that cut
these off. Move the round ones of the coarser part off the other's, no corner by more than what the mates explain: where
nothing crosses any more, no point of either surface was deeper in the other solid (see `shrunk`), and all that the
solids share lay beside these. What is beside them and mates with none, as a boss on a shaft, may be as deep as they
alone explain: it crosses nothing where they are moved by that.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts.constants import TOUCHING
from kinform.contacts.overlap.boundaries import PARTING_TRIED, parting
from kinform.contacts.overlap.constants import EXACT_OVERLAP
from kinform.contacts.overlap.samples import Allowance
from kinform.contacts.overlap.shrunk import SHELL_TRIED, outward
from kinform.contacts.overlap.solids import bounds_volume
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.foundation.meshes.boxes import middles
from kinform.foundation.meshes.slivers import CROSSED_FEW, CROSSED_MOST, Met, met_among, near_swept
from kinform.foundation.meshes.surface_table import PLANE
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch


@dataclass(frozen=True, eq=False)
class _Question:
    """The near facets of both parts of a pair, the second a little off the first, and those of the second once the
    round ones are moved, too."""

    parts: tuple[PartView, PartView]
    """The one that stays as it is, and the one whose facets are moved."""
    facets: tuple[Ints, Ints]
    """Near ones."""
    corners: tuple[Array, Array]
    """(n, 3, 3) and (m, 3, 3) m."""
    moved: Array
    """(m, 3, 3) m."""
    beside: Flags
    """(n,) which near facets of the first part mate with no round surface."""
    moved_less: Array
    """(m, 3, 3) m: as `moved`, by no more than the round surfaces that are moved explain alone."""
    shift: Array
    """(3,) m, of the second part."""
    mating: tuple[Flags, Flags]
    """(s,) which surfaces of either mate."""
    cut_off: bool
    """Whether planes may cut these off: not those that touch in points."""

    def holds_none(self) -> bool:
        """Whether no shell of either part is inside the other, as they are where nothing crosses."""
        still, other = self.parts
        first, second = (_tried(part) for part in self.parts)
        there = middles(other.corners(second)) + self.shift
        place = np.minimum(self.facets[1].searchsorted(second), len(self.facets[1]) - 1)
        near = self.facets[1][place] == second
        there[near] = middles(self.moved[place[near]])
        # what the second part has become is within what it was
        here = middles(still.corners(first)) - self.shift
        return _outside(other, here, still) and _outside(still, there, other)

    def may_cross(self, met: Met) -> bool:
        """Whether facets that meet, by their places among the near ones, may: those of surfaces that mate, and planes,
        which cut these off or lie in one."""
        for part, facets, places, may in zip(self.parts, self.facets, met, self.mating, strict=True):
            if self.cut_off:
                may = may | _flags(part, (part.table.kinds == PLANE).nonzero()[0])
            if not may[part.surfaces.labels[facets[places]]].all():
                return False
        return True


def explained(asked: Sequence[tuple[PairView, list[Patch]]]) -> list[bool]:
    """Of pairs with their patches whether it is sure that they share no more than the tessellation of surfaces that
    mate explains; asked of those that may be expected to cross. What is said of one does not depend on the others."""
    questions = {k: made for k, one in enumerate(asked) if (made := _question(*one)) is not None}
    near = {k: near_swept(one.corners[0], one.corners[1], one.moved, CROSSED_MOST) for k, one in questions.items()}
    left = {k: (questions[k], pairs) for k, pairs in near.items() if pairs is not None}
    met = met_among([(one.corners[0], one.moved) for one, _ in left.values()], [pairs for _, pairs in left.values()])
    left = _of_none(left, met)
    pairs_beside = [(pairs[0][some], pairs[1][some]) for one, pairs in left.values() for some in [one.beside[pairs[0]]]]
    met = met_among([(one.corners[0], one.moved_less) for one, _ in left.values()], pairs_beside)
    left = _of_none(left, met)
    met = met_among([one.corners for one, _ in left.values()], [pairs for _, pairs in left.values()])
    out = [False] * len(asked)
    for (k, (one, _)), crossing in zip(left.items(), met, strict=True):
        if crossing is not None and one.may_cross(crossing):
            out[k] = one.holds_none()
    return out


_Asked = dict[int, tuple[_Question, Met]]


def _of_none(asked: _Asked, met: list[Met | None]) -> _Asked:
    """Those of which none meet."""
    told = zip(asked.items(), met, strict=True)
    return {k: one for (k, one), pairs in told if pairs is not None and not len(pairs[0])}


def _question(pair: PairView, patches: list[Patch]) -> _Question | None:
    """What is to be asked of a pair; None where it would not be sure, or there are too many facets."""
    if pair.apart or not any(patch.kind != "plane" and 2.0 * patch.gap <= patch.chord for patch in patches):
        return None
    if not all(bounds_volume(part.index.mesh) for part in pair.parts):
        return None
    least = EXACT_OVERLAP * pair.tolerance
    allowance = Allowance.of(pair, patches, least)
    rounds = [patch for patch in allowance.mates.values() if patch.kind != "plane"]
    if not rounds or not all(_of_round_surfaces(pair, patch) for patch in rounds):
        return None
    alone = [min(float(allowance.chords[k][patch.surfaces[k]]) for patch in rounds) for k in (0, 1)]
    sides = (0, 1) if alone[1] >= alone[0] else (1, 0)
    parts = (pair.parts[sides[0]], pair.parts[sides[1]])
    facets = (parts[0].probed, parts[1].probed)
    if len(facets[0]) * len(facets[1]) > CROSSED_FEW:
        return None
    # Share of the depth that surfaces which mate explain by which facets are moved to see whether all is explained:
    # pieces of the overlap are then thinner, too, than what their surfaces explain, as no two sides of one are further
    # apart.
    depth = 0.9 * min(_explained_by(patch, allowance) for patch in rounds)
    apart = parting(patches)
    shift = np.zeros(3) if apart is None else (sides[1] - sides[0]) * PARTING_TRIED * least * apart
    inwards, less = (most - float(np.linalg.norm(shift)) for most in (depth, min(depth, alone[sides[1]] + least)))
    if inwards <= 0.0 or less < 0.0 or depth > min(part.clear for part in parts):
        return None
    first, second = (part.corners(own) for part, own in zip(parts, facets, strict=True))
    walls = [
        _flags(part, [patch.surfaces[k] for patch in rounds])[part.surfaces.labels[own]]
        for part, own, k in zip(parts, facets, sides, strict=True)
    ]
    second += shift
    off = outward(parts[1], facets[1], np.flatnonzero(walls[1]))
    mating = [_flags(part, [both[k] for both in allowance.mates]) for part, k in zip(parts, sides, strict=True)]
    return _Question(
        parts=parts,
        facets=facets,
        corners=(first, second),
        moved=second - inwards * off,
        beside=~walls[0],
        moved_less=second - less * off,
        shift=shift,
        mating=(mating[0], mating[1]),
        cut_off=not any(patch.kind in TOUCHING for patch in rounds),
    )


def _flags(part: PartView, surfaces: list[int] | Ints) -> Flags:
    """(s,) which surfaces of a part are among some; as the last, that facets of none are not."""
    out = np.zeros(len(part.table.kinds) + 1, dtype=bool)
    out[surfaces] = True
    return out


def _of_round_surfaces(pair: PairView, patch: Patch) -> bool:
    """Whether both its surfaces are round, not flats that stand for one, and it is not of lines, along which others
    that do not mate lie as near."""
    kinds = [part.table.kinds[k] for part, k in zip(pair.parts, patch.surfaces, strict=True)]
    return patch.kind != "line" and PLANE not in kinds


def _explained_by(patch: Patch, allowance: Allowance) -> float:
    """m that round surfaces which mate may be in each other, whichever facets are the nearest."""
    chords = sum(float(of_part[k]) for of_part, k in zip(allowance.chords, patch.surfaces, strict=True))
    return min(patch.chord + patch.uncertainty[1], chords) + allowance.floor


def _tried(part: PartView) -> Ints:
    """Facets of which it is asked whether they are inside the other part: one of each shell, and some of one alone."""
    shells = part.index.shells
    return shells if len(shells) > 1 else np.arange(0, len(part.faces), -(-len(part.faces) // SHELL_TRIED))


def _outside(outer: PartView, points: Array, inner: PartView) -> bool:
    """Whether points (n, 3) m, on facets `_tried` of the inner part, say that none of its shells is in the outer."""
    one = len(inner.index.shells) == 1
    if one and ((points < outer.low) | (points > outer.high)).any():
        return True
    held = outer.index.contains(outer.to_part(points))
    return not (held.all() if one else held.any())
