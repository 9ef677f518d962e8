"""Which freedoms of first order pass the second-order test at a closed pose of loops.

A freedom u is the beginning of a motion only if the curvature of the closure along u can be balanced,
wᵀ F''(u, u) = 0 for every w with wᵀ J = 0 (Connelly and Whiteley 1996 for frameworks; Rico, Gallardo and
Duffy 1999 and Müller 2014 for joints, by Lie brackets).
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.mechanism.constants import FREE
from kinform.mechanism.pose import Pose
from kinform.model.arrays import Array
from kinform.model.kinematics import CurvatureVerdict

MOST_TESTED_FREEDOMS = 40
"""Freedoms of a block up to which directions that pass the second-order test are looked for. Chosen, not measured."""
TEST_ITERATIONS = 60
"""Gauss–Newton iterations for a common zero of the forms: where it is double they converge by halving."""
MOST_PASSING = 12
"""Directions that pass the second-order test that are followed. Chosen, not measured."""
SAME_LINE = 0.999
"""Cosine above which two of them are one. Chosen, not measured."""


def second_order(pose: Pose, rng: np.random.Generator) -> tuple[CurvatureVerdict, Array]:
    """What the second-order test says, and first-order freedoms (D, n) that pass it.

    The forms wᵀ F''(u, u) are looked for common zeros on the unit sphere by Gauss–Newton from random starts. Curvature
    of unit freedoms below `SINGLE` is rounding: axes come from files in single precision.
    """
    count = pose.freedoms
    none = np.zeros((0, pose.free.shape[1]))
    if count > MOST_TESTED_FREEDOMS:
        bends = np.linalg.norm(pose.obstruction(units(rng.normal(size=(6, count))) @ pose.free), axis=1)
        return ("extends" if bends.max() < SINGLE else "", none)
    i, j = np.triu_indices(count)
    bent = pose.obstruction(np.concatenate([pose.free[i] + pose.free[j], pose.free[i] - pose.free[j]]))
    flat = 0.25 * (bent[: len(i)] - bent[len(i) :])
    # fewer forms with the same zeros
    _, values, right = np.linalg.svd(flat.T, full_matrices=False)
    flat = (values[:, None] * right)[values > SINGLE]
    if not len(flat):
        return "extends", none
    forms = np.zeros((len(flat), count, count))
    forms[:, i, j] = forms[:, j, i] = flat
    if len(forms) == 1:
        values = np.linalg.eigvalsh(forms[0])
        if values[0] > SINGLE or values[-1] < -SINGLE:
            return "obstructed", none
    u = units(rng.normal(size=(8 + 4 * count, count)))
    for _ in range(TEST_ITERATIONS):
        value = np.einsum("pij,di,dj->dp", forms, u, u)
        slope = 2.0 * np.einsum("pij,dj->dpi", forms, u)
        u = units(u - np.einsum("dip,dp->di", np.linalg.pinv(slope, rcond=SOLVED), value))
    left = np.linalg.norm(np.einsum("pij,di,dj->dp", forms, u, u), axis=1)
    passing = u[left < SINGLE]
    if not len(passing):
        return "obstructed", none
    distinct: list[Array] = []
    for direction in passing:
        if len(distinct) < MOST_PASSING and all(abs(float(direction @ other)) < SAME_LINE for other in distinct):
            distinct.append(direction)
    return "partly", np.array(distinct) @ pose.free


def independent(twists: Array) -> Array:
    """Orthonormal basis (r, m) of what the rows (n, m) span."""
    _, values, right = np.linalg.svd(twists, full_matrices=False)
    return right[: int(np.count_nonzero(values > FREE * values.max(initial=0.0)))]


def complement(space: Array, part: Array) -> Array:
    """Orthonormal rates of `space` (k, n) that are orthogonal to `part` (m, n) of it."""
    if not len(part):
        return space
    _, values, right = np.linalg.svd(part @ space.T)
    return right[int(np.count_nonzero(values > SINGLE)) :] @ space


def units(vectors: Array) -> Array:
    """The vectors (…, n) at length one."""
    out: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), TINY)
    return out
