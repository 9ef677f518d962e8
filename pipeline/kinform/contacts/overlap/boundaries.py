"""Whether the boundaries of two parts cross: what is asked first, of many pairs at once, and what then of one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts import constants
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.foundation.meshes.probes import Region, crossings_of
from kinform.model.arrays import Array
from kinform.model.contacts import Patch


def first_crossings(asked: Sequence[tuple[PairView, list[Patch]]]) -> list[bool | None]:
    """What is asked first of pairs with their patches, of all at once: whether their boundaries cross, the second part
    moved off plane contacts where it has any; None where nothing is asked, as they have no overlap that counts."""
    may = [k for k, (pair, _) in enumerate(asked) if _may_overlap(pair)]
    questions = {k: _first(*asked[k]) for k in may if not asked[k][0].apart}
    told = dict.fromkeys(may, False) | dict(zip(questions, crossings_of(list(questions.values())), strict=True))
    return [told.get(k) for k in range(len(asked))]


def _may_overlap(pair: PairView) -> bool:
    """Whether both are solids, of which the boxes overlap by what counts as an overlap."""
    a, b = pair.parts
    if not (a.part.solid and b.part.solid):
        return False
    low, high = np.maximum(a.low, b.low), np.minimum(a.high, b.high)
    return not (high - low).min() < constants.EXACT_OVERLAP * pair.tolerance


def _first(pair: PairView, patches: list[Patch]) -> tuple[Region, Region, Array]:
    """Both regions, and the pose (4, 4) of the second part in the frame of the first at which they are asked first."""
    apart = _parting(patches)
    least = constants.EXACT_OVERLAP * pair.tolerance
    return _moved(*pair.parts, np.zeros(3) if apart is None else constants.PARTING_TRIED * least * apart)


def _moved(a: PartView, b: PartView, move: Array) -> tuple[Region, Region, Array]:
    """The same with the second part moved (3,) m in the frame of the pair."""
    X_AF, X_FB = np.eye(4) if a.at_home else np.linalg.inv(a.X_FP), b.X_FP.copy()
    X_FB[:3, 3] += move
    return a.region, b.region, X_AF @ X_FB


def boundaries_cross(pair: PairView, patches: list[Patch], first: bool) -> bool:
    """Whether the two boundaries cross, of parts whose boxes overlap; `first` as `first_crossings` says.

    Parts that a move by less than what counts as an overlap sets free of each other do not. Faces that coincide cross
    or do not as rounding has it, so the question is put once more with the second part moved by as much.
    """
    if pair.apart:
        return False
    shift = constants.EXACT_OVERLAP * pair.tolerance * np.array([0.61, 0.53, 0.59])
    moves = [shift, -shift]
    if _parting(patches) is not None:
        if not first:
            return False
        moves = [np.zeros(3), *moves]
    elif first:
        return True
    return any(region.crosses(other, X_AB) for region, other, X_AB in (_moved(*pair.parts, move) for move in moves))


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
