"""A closed pose of loops, and its freedoms of first order."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.mechanism.constants import FREE
from kinform.mechanism.loop_system import Form, LoopSystem, stacked
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class Pose:
    """A closed configuration with its first-order freedoms."""

    q: Array
    """(n,)."""
    columns: Array
    """(n, 6) twist of each coordinate where it is there."""
    rank: int
    """How many closure equations are independent."""
    free: Array
    """(freedoms, n) orthonormal rates that close the loops."""
    reach: Array
    """(rows, rank) orthonormal: what rates change in the closure."""
    system: LoopSystem

    @staticmethod
    def at(system: LoopSystem, q: Array, tolerance: float = FREE) -> Pose:
        """The pose at the closed configuration q (n,); relative `tolerance` of its rank."""
        return _poses([system], system, q[None], tolerance)[0]

    @property
    def freedoms(self) -> int:
        """Of first order."""
        return len(self.free)

    @property
    def regular(self) -> Rank:
        """The rank of the equations near the pose, if it is regular: that at the pose."""
        return Rank(number=self.rank, free=self.free)

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
        out |= zip(members, _poses(of_form, stacked(of_form, [1] * len(of_form)), q, FREE), strict=True)
    return [out[k] for k in range(len(systems))]


def _poses(systems: Sequence[LoopSystem], together: LoopSystem, q: Array, tolerance: float) -> list[Pose]:
    """The poses of systems that are stacked `together`, each at its own closed configuration of q (D, n)."""
    closed = together.equations(q)
    rows, columns = closed.jacobian.shape[1:]
    # all right vectors, and no left ones without need
    left, values, right = np.linalg.svd(closed.jacobian, full_matrices=rows < columns)
    out = []
    for k, system in enumerate(systems):
        share = max(tolerance, system.rounding)
        rank = int(np.count_nonzero(values[k] > share * max(values[k].max(initial=0.0), TINY)))
        out.append(Pose(q[k], closed.columns[k], rank, right[k, rank:], left[k, :, :rank], system))
    return out
