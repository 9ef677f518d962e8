"""Whether the boundaries of two parts cross, of many pairs at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts import constants
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.foundation.meshes.probes import Region, crossings_of
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.contacts import Patch


def boundaries_cross(asked: Sequence[tuple[PairView, list[Patch]]]) -> list[bool | None]:
    """Whether the boundaries of pairs cross, beside their patches, of all at once; None of those that have no overlap
    that counts, as their boxes have none.

    Parts that a move by less than what counts as an overlap sets free of each other do not. Faces that coincide cross
    or do not as rounding has it, so the question is put once more with the second part moved by as much.
    """
    out: list[bool | None] = [False if _may_overlap(pair) else None for pair, _ in asked]
    moves = {k: _moves(*asked[k]) for k, may in enumerate(out) if may is not None and not asked[k][0].apart}
    while moves:
        told = crossings_of([_moved(*asked[k][0].parts, left.first) for k, left in moves.items()])
        moves, before = {}, moves
        for (k, left), crosses in zip(before.items(), told, strict=True):
            if crosses == left.ends:
                out[k] = crosses
            elif left.more:
                moves[k] = _Moves(left.more[0], left.more[1:], True)
    return out


@dataclass(frozen=True, eq=False)
class _Moves:
    """Moves (3,) m of the second part at which it is asked whether boundaries cross, one after the other."""

    first: Array
    more: list[Array]
    ends: bool
    """The answer to the first that is the last word; after others they are asked on, and do not cross at the end."""


def _moves(pair: PairView, patches: list[Patch]) -> _Moves:
    """Those of a pair."""
    least = constants.EXACT_OVERLAP * pair.tolerance
    shift = least * np.array([0.61, 0.53, 0.59])
    apart = _parting(patches)
    if apart is None:
        return _Moves(np.zeros(3), [shift, -shift], True)
    return _Moves(constants.PARTING_TRIED * least * apart, [np.zeros(3), shift, -shift], False)


def _may_overlap(pair: PairView) -> bool:
    """Whether both are solids, of which the boxes overlap by what counts as an overlap."""
    a, b = pair.parts
    if not (a.part.solid and b.part.solid):
        return False
    low, high = np.maximum(a.low, b.low), np.minimum(a.high, b.high)
    return not (high - low).min() < constants.EXACT_OVERLAP * pair.tolerance


def _moved(a: PartView, b: PartView, move: Array) -> tuple[Region, Region, Array]:
    """Both regions, and the pose (4, 4) of the second part in the frame of the first, with the second part moved (3,) m
    in the frame of the pair."""
    X_AF, X_FB = np.eye(4) if a.at_home else np.linalg.inv(a.X_FP), b.X_FP.copy()
    X_FB[:3, 3] += move
    return a.region, b.region, X_AF @ X_FB


def _parting(patches: list[Patch]) -> Array | None:
    """The direction (3,) in which the second part leaves all plane contacts fastest; None where none does.

    The point of least norm in the hull of the normals, by Frank and Wolfe's method.
    """
    normals = np.array([patch.axis for patch in patches if patch.kind == "plane"]).reshape(-1, 3)
    if not len(normals):
        return None
    nearest = np.add.reduce(normals, axis=0) / len(normals)
    for _ in range(constants.PARTING_STEPS):
        step = normals[np.argmin(normals @ nearest)] - nearest
        gain = -float(step @ nearest)
        if gain <= 1e-9:
            break
        nearest = nearest + min(1.0, gain / float(step @ step)) * step
    length = float(np.linalg.norm(nearest))
    return nearest / length if length > constants.PARTING_LEAST else None
