"""The loops of a mechanism in joint coordinates, as `mechanism.closing` closes them."""

from __future__ import annotations

import numpy as np

from kinform.frozen import dataclass
from kinform.mechanism.closing import Closing, FirstOrder, close
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array, Ints
from kinform.simulation.mechanism.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class Loops:
    """Loops that some of the rates close; positions may be quaternions, and rates are compared at their scale."""

    mechanism: Mechanism
    unknown: Ints
    """(k,) rates."""

    def equations(self, q: Array) -> FirstOrder:
        """At positions (D, nq): gaps (D, m), by the unknown rates over their scale (D, m, k)."""
        poses = [self.mechanism.poses(one) for one in q]
        rows = [self.mechanism.closure(self.mechanism.screws(X))[:, self.unknown] for X in poses]
        gaps = [self.mechanism.gap(X, one) for X, one in zip(poses, q, strict=True)]
        return FirstOrder(np.array(gaps), np.array(rows) * self.mechanism.scale[self.unknown])

    def advance(self, q: Array, change: Array) -> Array:
        """Positions (D, nq) after changes (D, k) of the unknown rates over their scale."""
        steps = np.zeros((len(q), self.mechanism.rates))
        steps[:, self.unknown] = change * self.mechanism.scale[self.unknown]
        return np.array([self.mechanism.advance(one, step) for one, step in zip(q, steps, strict=True)])

    def rows(self, which: Ints) -> Loops:
        """The same, as all configurations are those of one mechanism."""
        return self


def closed(mechanism: Mechanism, q: Array, unknown: Ints, rank: int) -> Closing:
    """Where the loops close near positions q (nq,), by the `unknown` rates; `rank` of the equations count."""
    return close(Loops(mechanism, unknown), q[None], rank=Rank(number=rank))
