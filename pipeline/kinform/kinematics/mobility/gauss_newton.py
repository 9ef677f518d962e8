"""Closed configurations of loops near given ones, by Gauss–Newton: of one block, or of many blocks at once.

With a pose beside, only as many singular values are used as count at it (`truncation`): where the pose is regular this
converges quadratically, or not at all.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kinform.frozen import dataclass
from kinform.kinematics.mobility.second_order import SLOW_ITERATIONS, Pose
from kinform.kinematics.mobility.truncation import FINEST_VALUE, regular_solution, truncated_solution
from kinform.mechanism.loop_system import Form, LoopSystem, stacked
from kinform.model.arrays import Array

FAST_ITERATIONS = 12
"""Gauss–Newton iterations where convergence is quadratic."""
FAST_CHANGE = 1e-9
"""Change after which such a solve has converged."""
SLOW_CHANGE = 1e-11
"""Change after which a full solve has."""
LONGEST_CHANGE = 0.5
"""Share of a step that one iteration may change at most."""
REDUCED_RATES = 60
"""Rates of a block from which on its closure is made triangular before its singular values are asked: at 100 to 420
rates the two take 0.6 of the time of one, at 40 nine tenths."""


Ends = tuple[Array, Array, Array]
"""Configurations (D, n) that close the loops as well as Gauss–Newton can, their residuals (D,) and Jacobians
(D, 6 loops + ties, n)."""


@dataclass(frozen=True, eq=False)
class Walk:
    """Where do the loops close near configurations beside a pose?"""

    pose: Pose
    start: Array
    """(D, n)."""
    stride: float
    """Length of the steps that led to them."""

    @property
    def likeness(self) -> tuple[Form, int, float]:
        """The same for walks that can be gone together."""
        return self.pose.system.form, self.pose.rank, self.stride

    @property
    def alone(self) -> bool:
        """Whether its solutions are found one by one, or by products whose last bit depends on how many there are."""
        system = self.pose.system
        return system.coordinates >= REDUCED_RATES or len(system.ties) > 0


def ends(walks: Sequence[Walk]) -> list[Ends]:
    """Where each of the walks ends: as if it were gone alone, to the last bit."""
    alike: dict[object, list[int]] = defaultdict(list)
    for k, walk in enumerate(walks):
        alike[k if walk.alone else walk.likeness].append(k)
    out: dict[int, Ends] = {}
    for members in alike.values():
        out |= zip(members, _ends([walks[k] for k in members]), strict=True)
    return [out[k] for k in range(len(walks))]


def _ends(walks: Sequence[Walk]) -> list[Ends]:
    """Of walks that can be gone together, or of one."""
    first, counts = walks[0], [len(walk.start) for walk in walks]
    if len(walks) == 1:
        return [solve(first.pose.system, first.start, first.stride, first.pose)]
    systems = stacked([walk.pose.system for walk in walks], counts)
    found = solve(systems, np.concatenate([walk.start for walk in walks]), first.stride, first.pose)
    borders = np.cumsum(counts)[:-1]
    return list(zip(*(np.split(part, borders) for part in found), strict=True))


def solve(system: LoopSystem, start: Array, step: float, pose: Pose | None = None) -> Ends:
    """Where the loops close near `start` (D, n). No iteration moves by more than half of `step`. With a `pose` only as
    many singular values are used as are its rank, and convergence is quadratic or there is none.
    """
    q = start.copy()
    active = np.arange(len(q))
    for _ in range(SLOW_ITERATIONS if pose is None else FAST_ITERATIONS):
        closed = system.at(active).close(q[active])
        change = -solutions(closed.jacobian, closed.residual, pose)
        size = np.linalg.norm(change, axis=1)
        change *= np.minimum(1.0, LONGEST_CHANGE * step / np.maximum(size, 1e-300))[:, None]
        q[active] += change
        active = active[size > (SLOW_CHANGE if pose is None else FAST_CHANGE)]
        if not len(active):
            break
    closed = system.close(q)
    return q, np.abs(closed.residual).max(axis=1, initial=0.0), closed.jacobian


def solutions(jacobian: Array, missed: Array, pose: Pose | None) -> Array:
    """(D, n) least solutions of J x = missed, (D, m, n) and (D, m), by all singular values that are any, or by those
    that count at a pose beside."""
    jacobian, missed = reduced(jacobian, missed)
    count = jacobian.shape[2]
    if count < REDUCED_RATES or jacobian.shape[1] != count:
        return _by_singular_values(jacobian, missed, pose)
    if pose is not None:
        found = [truncated_solution(*equations, pose.free) for equations in zip(jacobian, missed, strict=True)]
        sure = [solution for solution in found if solution is not None]
        return np.array(sure) if len(sure) == len(found) else _by_singular_values(jacobian, missed, pose)
    found = [regular_solution(*equations) for equations in zip(jacobian, missed, strict=True)]
    out = np.array([np.zeros(count) if solution is None else solution for solution in found])
    rest = [k for k, solution in enumerate(found) if solution is None]
    if rest:
        out[rest] = _by_singular_values(jacobian[rest], missed[rest], None)
    return out


def _by_singular_values(jacobian: Array, missed: Array, pose: Pose | None) -> Array:
    """See `solutions`."""
    left, values, right = np.linalg.svd(jacobian, full_matrices=False)
    used = values > FINEST_VALUE * values.max(axis=1, initial=1e-300, keepdims=True)
    if pose is not None:
        used[:, pose.rank :] = False
    parts = np.einsum("dri,dr->di", left, missed)
    return np.asarray(np.einsum("di,din->dn", np.where(used, parts / np.where(used, values, 1.0), 0.0), right))


def reduced(jacobian: Array, residual: Array) -> tuple[Array, Array]:
    """The equations J change = residual, (D, m, n) and (D, m), in as many rows as columns where a large block has many
    more: the triangle of Householder's reflections, which keeps singular values, right singular vectors and parts of
    the residual along the left ones (Golub and Van Loan, Matrix Computations, 5.3), without these reflections
    themselves. Rows without entries, half of those of planar loops, say nothing."""
    count = jacobian.shape[2]
    if count < REDUCED_RATES or jacobian.shape[1] <= count:
        return jacobian, residual
    used = np.asarray(jacobian.any(axis=(0, 2)))
    if np.count_nonzero(used) <= count:
        used[:] = True
    equations = np.concatenate([jacobian, residual[..., None]], axis=2)[:, used]
    triangle = np.asarray(np.linalg.qr(equations, mode="r"))
    return triangle[:, :count, :count], triangle[:, :count, count]
