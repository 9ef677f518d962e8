"""Which motions the patches between two bodies leave free, and the singular values that say so.

Each candidate motion is tested against each patch; the freedoms are the motions that every patch
preserves, and the singular values of the rows, made exactly consistent with those, confirm that nothing
else is free.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.kinematics.joints.pair.in_step import NEW_FREEDOM, Remainder, Remains, Steps
from kinform.kinematics.joints.pair.lower_pairs import nearest_pair
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.model.arrays import Array, Flags
from kinform.model.tolerances import Tolerances

CLEARLY_NEW = 0.5
"""Above this share a further motion is not a variant of those already found. Chosen, not measured."""
DIFFERENCE_SLACK = 2.0
"""What is left of a further motion may be off by this many times the tolerances: it is a difference. Chosen, not
measured."""


def freedoms(
    evidence: Evidence, twists: Array, preserved: Flags, keep: Flags, tolerances: Tolerances
) -> Steps[tuple[Array, Array]]:
    """Basis (6, k) of what the kept patches leave free, and the singular values (6,) that say so.

    `preserved` (items, motions) is what `preserved_motions` says of the candidate `twists` (6, motions); `keep`
    (items,) which patches count.
    """
    basis, values, _, _ = yield from _remains(evidence, twists, preserved, keep, tolerances, None)
    return basis, values


def freedoms_beyond(
    evidence: Evidence, twists: Array, preserved: Flags, keep: Flags, tolerances: Tolerances, strict: Array
) -> Steps[tuple[Array, Array]]:
    """Basis (6, k) of what the kept patches leave free, as of `freedoms`, and what it has beyond the freedoms `strict`
    (6, k'): (6, n) orthonormal."""
    basis, _, _, freed = yield from _remains(evidence, twists, preserved, keep, tolerances, strict)
    return basis, freed


def _remains(
    evidence: Evidence, twists: Array, preserved: Flags, keep: Flags, tolerances: Tolerances, strict: Array | None
) -> Steps[Remains]:
    """What the kept patches leave: as a lower pair, where it is one but for what they can tell."""
    rows, share = evidence.rows_of(keep)
    known = _independent(evidence, twists[:, preserved[keep].all(axis=0)], keep)
    left = yield Remainder(rows, share, known, tolerances.free, strict)
    basis, _, turns, _ = left
    if evidence.form(basis, turns).type == "general":
        rounded = nearest_pair(basis, evidence.frame)
        if rounded is not None and _all_preserve(evidence, rounded, keep):
            left = yield Remainder(rows, share, rounded, tolerances.free, strict)
    return left


def _independent(evidence: Evidence, twists: Array, keep: Flags) -> Array:
    """Orthonormal basis (6, k) of twists (6, n) that the kept patches preserve. One that differs from those before it
    by less than the patches can tell adds nothing."""
    basis = np.zeros((6, 0))
    for twist in twists.T:
        rest = twist - basis @ (basis.T @ twist) if basis.size else twist
        size = norm(rest)
        if size <= NEW_FREEDOM:
            continue
        unit = rest / size
        if size > CLEARLY_NEW or (_all_preserve(evidence, unit, keep, DIFFERENCE_SLACK)):
            basis = np.column_stack([basis, unit]) if basis.size else unit[:, None]
    return basis


def _all_preserve(evidence: Evidence, twists: Array, keep: Flags, slack: float = 1.0) -> bool:
    """Does every kept patch slide on itself under the twist (6,), or each of the twists (6, n)?"""
    twists = twists.reshape(6, -1)
    return bool(preserved_motions(evidence, twists, slack)[keep].all())
