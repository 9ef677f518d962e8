"""Which motions the patches between two bodies leave free, and the singular values that say so.

Each candidate motion is tested against each patch; the freedoms are the motions that every patch
preserves, and the singular values of the rows, made exactly consistent with those, confirm that nothing
else is free.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.screws import span
from kinform.foundation.algebra.vectors import norm
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.kinematics.joints.pair.lower_pairs import nearest_pair
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.model.arrays import Array, Flags
from kinform.model.tolerances import Tolerances

CLEARLY_NEW = 0.5
"""Above this share a further motion is not a variant of those already found. Chosen, not measured."""
DIFFERENCE_SLACK = 2.0
"""What is left of a further motion may be off by this many times the tolerances: it is a difference. Chosen, not
measured."""
NEW_FREEDOM = 0.03
"""A motion adds a freedom when this much of its unit twist lies outside those already found. Chosen, not measured."""


def freedoms(
    evidence: Evidence, twists: Array, preserved: Flags, keep: Flags, tolerances: Tolerances
) -> tuple[Array, Array]:
    """Basis (6, k) of what the kept patches leave free, and the singular values (6,) that say so: as a lower pair,
    where it is one but for what they can tell.

    `preserved` (items, motions) is what `preserved_motions` says of the candidate `twists` (6, motions); `keep`
    (items,) which patches count.
    """
    rows, share = evidence.rows_of(keep)
    known = _independent(evidence, twists[:, preserved[keep].all(axis=0)], keep)
    basis, values = left_by(rows, share, known, tolerances.free)
    if evidence.form(basis).type == "general":
        rounded = nearest_pair(basis, evidence.frame)
        if rounded is not None and _all_preserve(evidence, rounded, keep):
            basis, values = left_by(rows, share, rounded, tolerances.free)
    return basis, values


def left_by(rows: Array, share: Array, known: Array, free: float) -> tuple[Array, Array]:
    """Orthonormal basis (6, k) of what rows (n, 6) with the weights `share` (n,) of their squares leave free, and their
    singular values (6,), ascending, of which those below `free` count as none; the rows are made exactly consistent
    with the motions `known` (6, m), orthonormal."""
    rows = rows * np.sqrt(share / share.sum())[:, None]
    rows = rows - (rows @ known) @ known.T
    triangle = np.linalg.qr(rows, mode="r") if len(rows) >= 6 else rows
    _, values, right = np.linalg.svd(np.concatenate([triangle, np.zeros((6, 6))]))
    values, right = values[5::-1], right[5::-1]
    return span(right[values < free].T), values


def beyond(basis: Array, strict: Array) -> Array:
    """(6, n) orthonormal: what the freedoms `basis` (6, k) have beyond the freedoms `strict` (6, m)."""
    basis, strict = np.ascontiguousarray(basis), np.ascontiguousarray(strict)
    vectors, sizes, _ = np.linalg.svd(basis - strict @ (strict.T @ basis), full_matrices=False)
    return np.asarray(vectors[:, sizes > NEW_FREEDOM])


def freedoms_beyond(
    evidence: Evidence, twists: Array, preserved: Flags, keep: Flags, tolerances: Tolerances, strict: Array
) -> tuple[Array, Array]:
    """Basis (6, k) of what the kept patches leave free, as of `freedoms`, and what it has beyond the freedoms `strict`
    (6, k'): (6, n) orthonormal."""
    basis, _ = freedoms(evidence, twists, preserved, keep, tolerances)
    return basis, beyond(basis, strict)


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
