"""Whether the boundaries of two parts cross, of many pairs at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts.constants import TOUCHING
from kinform.contacts.overlap.constants import EXACT_OVERLAP
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.meshes.probes import Region, crossings_of
from kinform.foundation.meshes.separated_sets import surely_separated
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.contacts import Patch

PARTING_TRIED = 0.9
"""Share of what counts as an overlap by which parts are moved to see whether they are then free: less than all, so that
what is free then is free with certainty."""


def boundaries_cross(asked: Sequence[tuple[PairView, list[Patch]]]) -> list[bool | None]:
    """Whether the boundaries of pairs cross, beside their patches, of all at once; None of those that have no overlap
    that counts, as their boxes have none.

    Parts that a move by less than what counts as an overlap sets free of each other do not. Faces that coincide cross
    or do not as rounding has it, so the question is put once more with the second part moved by as much.
    """
    out: list[bool | None] = [False if _may_overlap(pair) else None for pair, _ in asked]
    moves = {k: _moves(*asked[k]) for k, may in enumerate(out) if may is not None and not asked[k][0].apart}
    curved = {k: found for k in moves if (found := _curved(*asked[k])) is not None}
    clear = _clear({k: asked[k][0] for k, left in moves.items() if left.ends and k not in curved})
    clear |= {k for k, left in moves.items() if not left.ends and _parted(asked[k][0], left.first)}
    moves = {k: left for k, left in moves.items() if k not in clear}
    while moves:
        questions = {k: _moved(*asked[k][0].parts, left.first) for k, left in moves.items()}
        told = _crossing(questions, curved)
        moves, before = {}, moves
        for k, left in before.items():
            if told[k] == left.ends:
                out[k] = told[k]
            elif left.more:
                moves[k] = _Moves(left.more[0], left.more[1:], True)
    return out


_SHIFT = np.array([0.61, 0.53, 0.59])
"""Along no axis: by which parts are moved, in what counts as an overlap."""


@dataclass(frozen=True, eq=False)
class _Moves:
    """Moves (3,) m of the second part at which it is asked whether boundaries cross, one after the other."""

    first: Array
    more: list[Array]
    ends: bool
    """The answer to the first that is the last word; after others they are asked on, and do not cross at the end."""


def _moves(pair: PairView, patches: list[Patch]) -> _Moves:
    """Those of a pair."""
    least = EXACT_OVERLAP * pair.tolerance
    shift = least * _SHIFT
    apart = parting(patches)
    if apart is None:
        return _Moves(np.zeros(3), [shift, -shift], True)
    return _Moves(PARTING_TRIED * least * apart, [np.zeros(3), shift, -shift], False)


def _clear(pairs: dict[int, PairView]) -> set[int]:
    """Of which pairs no facets are as near as the second part is moved, so that none cross wherever that is."""
    asked = []
    for pair in pairs.values():
        first, second = (part.corners(part.probed) for part in pair.parts)
        asked.append((first, second, EXACT_OVERLAP * norm(_SHIFT) * pair.tolerance))
    return {k for k, far in zip(pairs, surely_separated(asked), strict=True) if far}


def _parted(pair: PairView, move: Array) -> bool:
    """Whether a plane across a move (3,) of the second part lies between the parts then, as it does between plates."""
    first, second = (part.corners(part.probed) @ move for part in pair.parts)
    return bool(first.max(initial=-np.inf) < second.min(initial=np.inf) + move @ move)


def _crossing(
    questions: dict[int, tuple[Region, Region, Array]], curved: dict[int, tuple[Region, Region]]
) -> dict[int, bool]:
    """Whether facets of regions cross: of those with `curved` surfaces in contact, whose facets cross by their chord
    errors as a rule, these are asked first."""
    few = {k: (*regions, questions[k][2]) for k, regions in curved.items() if k in questions}
    out = {k: crosses for k, crosses in zip(few, crossings_of(list(few.values())), strict=True) if crosses}
    rest = {k: question for k, question in questions.items() if k not in out}
    return out | dict(zip(rest, crossings_of(list(rest.values())), strict=True))


def _curved(pair: PairView, patches: list[Patch]) -> tuple[Region, Region] | None:
    """The near facets of either part whose surfaces have curved patches with a gap in which facets cross; None without,
    where that is most, and of large parts, for which trees of these facets would be made beside those of all."""
    tight = [
        patch for patch in patches if patch.kind in ("cylinder", "cone", "sphere") and 2.0 * patch.gap <= patch.chord
    ]
    # facets up to which those of round surfaces in contact are asked first
    if not tight or max(len(part.faces) for part in pair.parts) > 20_000:
        return None
    ids = [{patch.surfaces[k] for patch in tight} for k in (0, 1)]
    out = []
    for part, near, chosen in zip(pair.parts, pair.near, ids, strict=True):
        facets = [near.facets[k] for k, number in enumerate(near.ids.tolist()) if number in chosen]
        out.append(Region(part.index, np.sort(np.concatenate([np.zeros(0, np.int64), *facets]))))
    every = [len(part.faces) if part.region.facets is None else len(part.region.facets) for part in pair.parts]
    less = 2 * sum(len(region.facets) for region in out if region.facets is not None) <= sum(every)
    return (out[0], out[1]) if less else None


def _may_overlap(pair: PairView) -> bool:
    """Whether both are solids, of which the boxes overlap by what counts as an overlap."""
    a, b = pair.parts
    if not (a.part.solid and b.part.solid):
        return False
    low, high = np.maximum(a.low, b.low), np.minimum(a.high, b.high)
    return not (high - low).min() < EXACT_OVERLAP * pair.tolerance


def _moved(a: PartView, b: PartView, move: Array) -> tuple[Region, Region, Array]:
    """Both regions, and the pose (4, 4) of the second part in the frame of the first, with the second part moved (3,) m
    in the frame of the pair."""
    X_AF, X_FB = np.eye(4) if a.at_home else np.linalg.inv(a.X_FP), b.X_FP.copy()
    X_FB[:3, 3] += move
    return a.region, b.region, X_AF @ X_FB


def parting(patches: list[Patch]) -> Array | None:
    """The direction (3,) in which the second part leaves all planes, points and lines of contact fastest; None where
    none does.

    The point of least norm in the hull of the normals, by Frank and Wolfe's method.
    """
    touching = [patch.normals for patch in patches if patch.kind in TOUCHING]
    normals = np.concatenate(
        [np.array([patch.axis for patch in patches if patch.kind == "plane"]).reshape(-1, 3), *touching]
    )
    if not len(normals):
        return None
    nearest = np.add.reduce(normals, axis=0) / len(normals)
    # steps of Frank and Wolfe's method
    for _ in range(60):
        step = normals[np.argmin(normals @ nearest)] - nearest
        gain = -float(step @ nearest)
        if gain <= SOLVED:
            break
        nearest = nearest + min(1.0, gain / float(step @ step)) * step
    length = float(np.linalg.norm(nearest))
    # Least speed, of 1, at which parts leave all their plane contacts that counts as leaving them. Chosen, not
    # measured.
    return nearest / length if length > 0.1 else None
