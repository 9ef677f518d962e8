"""A closed pose of a block of loops: its freedoms of first order, and which of them pass the second-order test.

A freedom u is the beginning of a motion only if the curvature of the closure along u can be balanced,
wᵀ F''(u, u) = 0 for every w with wᵀ J = 0 (Connelly and Whiteley 1996 for frameworks; Rico, Gallardo and
Duffy 1999 and Müller 2014 for joints, by Lie brackets).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kinform.frozen import dataclass
from kinform.kinematics.constants import RCOND
from kinform.mechanism.constants import CLOSED
from kinform.mechanism.loop_system import Form, LoopSystem, stacked
from kinform.model.arrays import Array
from kinform.model.kinematics import CurvatureVerdict

BALANCED = 1e-6
"""Curvature (of unit freedoms) that is rounding."""
MOST_TESTED_FREEDOMS = 40
"""Freedoms of a block up to which directions that pass the second-order test are looked for."""
SLOW_ITERATIONS = 60
"""Gauss–Newton iterations where convergence is linear: halving, at a simple singularity."""
MOST_PASSING = 12
"""Directions that pass the second-order test that are followed."""
SAME_LINE = 0.999
"""Cosine above which two of them are one."""
COMPLEMENT = 1e-6
"""Singular value below which a direction has no part in a space."""


@dataclass(frozen=True, eq=False)
class Pose:
    """A closed configuration with its first-order freedoms."""

    q: Array
    columns: Array
    rank: int
    free: Array
    """(freedoms, n) orthonormal rates that close the loops."""
    reach: Array
    """(rows, rank) orthonormal: what rates change in the closure."""
    system: LoopSystem

    @staticmethod
    def at(system: LoopSystem, q: Array, tolerance: float = CLOSED) -> Pose:
        """The pose at the closed configuration q (n,); relative `tolerance` of its rank."""
        return _poses([system], system, q[None], tolerance)[0]

    @property
    def freedoms(self) -> int:
        """Of first order."""
        return len(self.free)

    def obstruction(self, rates: Array) -> Array:
        """(D, rows) curvature of the closure along rates (D, n) that no further rates balance."""
        bent = self.system.curvature(self.columns, rates)
        left: Array = bent - (bent @ self.reach) @ self.reach.T
        return left


def reference_poses(systems: Sequence[LoopSystem]) -> list[Pose]:
    """The reference pose of each system: as if it were alone, to the last bit."""
    alike: dict[Form, list[int]] = defaultdict(list)
    for k, system in enumerate(systems):
        alike[system.form].append(k)
    out: dict[int, Pose] = {}
    for members in alike.values():
        of_form = [systems[k] for k in members]
        q = np.zeros((len(of_form), of_form[0].coordinates))
        out |= zip(members, _poses(of_form, stacked(of_form, [1] * len(of_form)), q, CLOSED), strict=True)
    return [out[k] for k in range(len(systems))]


def _poses(systems: Sequence[LoopSystem], together: LoopSystem, q: Array, tolerance: float) -> list[Pose]:
    """The poses of systems that are stacked `together`, each at its own closed configuration of q (D, n)."""
    closed = together.close(q)
    rows, columns = closed.jacobian.shape[1:]
    # all right vectors, and no left ones without need
    left, values, right = np.linalg.svd(closed.jacobian, full_matrices=rows < columns)
    out = []
    for k, system in enumerate(systems):
        share = max(tolerance, system.rounding)
        rank = int(np.count_nonzero(values[k] > share * max(values[k].max(initial=0.0), 1e-300)))
        out.append(Pose(q[k], closed.columns[k], rank, right[k, rank:], left[k, :, :rank], system))
    return out


def first_order(system: LoopSystem) -> int:
    """Freedoms of first order at the reference pose."""
    return Pose.at(system, np.zeros(system.coordinates)).freedoms


def second_order(pose: Pose, rng: np.random.Generator) -> tuple[CurvatureVerdict, Array]:
    """What the second-order test says, and first-order freedoms (D, n) that pass it.

    The forms wᵀ F''(u, u) are looked for common zeros on the unit sphere by Gauss–Newton from random starts.
    """
    count = pose.freedoms
    none = np.zeros((0, pose.free.shape[1]))
    if count > MOST_TESTED_FREEDOMS:
        bends = np.linalg.norm(pose.obstruction(units(rng.normal(size=(6, count))) @ pose.free), axis=1)
        return ("extends" if bends.max() < BALANCED else "", none)
    i, j = np.triu_indices(count)
    bent = pose.obstruction(np.concatenate([pose.free[i] + pose.free[j], pose.free[i] - pose.free[j]]))
    flat = 0.25 * (bent[: len(i)] - bent[len(i) :])
    # fewer forms with the same zeros
    _, values, right = np.linalg.svd(flat.T, full_matrices=False)
    flat = (values[:, None] * right)[values > BALANCED]
    if not len(flat):
        return "extends", none
    forms = np.zeros((len(flat), count, count))
    forms[:, i, j] = forms[:, j, i] = flat
    if len(forms) == 1:
        values = np.linalg.eigvalsh(forms[0])
        if values[0] > BALANCED or values[-1] < -BALANCED:
            return "obstructed", none
    u = units(rng.normal(size=(8 + 4 * count, count)))
    for _ in range(SLOW_ITERATIONS):
        value = np.einsum("pij,di,dj->dp", forms, u, u)
        slope = 2.0 * np.einsum("pij,dj->dpi", forms, u)
        u = units(u - np.einsum("dip,dp->di", np.linalg.pinv(slope, rcond=RCOND), value))
    left = np.linalg.norm(np.einsum("pij,di,dj->dp", forms, u, u), axis=1)
    passing = u[left < BALANCED]
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
    return right[: int(np.count_nonzero(values > CLOSED * values.max(initial=0.0)))]


def complement(space: Array, part: Array) -> Array:
    """Orthonormal rates of `space` (k, n) that are orthogonal to `part` (m, n) of it."""
    if not len(part):
        return space
    _, values, right = np.linalg.svd(part @ space.T)
    return right[int(np.count_nonzero(values > COMPLEMENT)) :] @ space


def units(vectors: Array) -> Array:
    """The vectors (…, n) at length one."""
    out: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)
    return out
