"""Closing loops: the configuration near a given one at which all loops of a mechanism close.

All loops are closed here, but those that the compiled kernel keeps closed (`simulation.kernel.loops`).
The method is that of Gauss and Newton: the closure equations are solved to first order, the least change of the
coordinates that meets them is taken, and so on; from a neighbouring pose three or four steps reach rounding. It is
composed of three parts, each an argument of `close` with one default:

- which equations are independent: `Rank` (`rank`), used by the Newton step (`least_change`),
- how far one step may go: `StepLimit`,
- when to end, and what counts as closed: `Termination`.

What does not close is no error: a `Closing` says which configurations are closed, and how far the others are open.

Source: Nocedal and Wright, Numerical Optimization, 10.3 (Gauss–Newton); Golub and Van Loan, Matrix Computations, 5.5
(least solutions of equations without full rank).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Protocol, Self

import numpy as np

from kinform.foundation.rounding import ARITHMETIC, SINGLE, TINY
from kinform.frozen import dataclass
from kinform.mechanism.least_change import REDUCED_RATES, least_change
from kinform.mechanism.loop_system import Index, LoopSystem, stacked
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array, Flags

CLOSED = ARITHMETIC
"""rad, and shares of the length: loops that are open by less need no more steps."""
ACCEPTED = SINGLE
"""rad, and shares of the length: loops that cannot be closed further, and are open by less, are closed as far as their
axes fit: those of files in single precision miss each other by as much."""
LONGEST_STEP = 0.5
"""rad, and shares of the length: greatest change, as a whole, of one step. Beyond half a radian the linear equations
say little of where loops close. Chosen, not measured."""


class Equations(Protocol):
    """Closure equations at a batch of D configurations, to first order."""

    @property
    def residual(self) -> Array:
        """(D, m) what keeps the loops from closing."""

    @property
    def jacobian(self) -> Array:
        """(D, m, n) its derivative by the coordinates."""


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """Such equations."""

    residual: Array
    jacobian: Array


class System(Protocol):
    """What has loops to close: `LoopSystem`, and others whose configurations are not all coordinates."""

    def equations(self, q: Array) -> Equations:
        """At configurations (D, …)."""

    def advance(self, q: Array, change: Array) -> Array:
        """Configurations (D, …) after a change (D, n)."""

    def rows(self, which: Index) -> Self:
        """The systems of these configurations, where each has its own."""


@dataclass(frozen=True)
class StepLimit:
    """How far one step may go: it is cut to `longest`, as a whole."""

    longest: float = LONGEST_STEP

    def cut(self, change: Array) -> tuple[Array, Array]:
        """Changes (D, n) that are no longer, and how long (D,) they were."""
        size = np.linalg.norm(change, axis=1)
        return change * np.minimum(1.0, self.longest / np.maximum(size, TINY))[:, None], size


@dataclass(frozen=True)
class Termination:
    """When steps end: where the loops are closed to rounding; where they are closed as far as they can be; after so
    many. Or, at poses where residuals say little, as they shrink by the square of the change: where the `change` is
    small. On the way residuals may grow: beside a singular pose the first steps are too long."""

    closed: float = CLOSED
    accepted: float = ACCEPTED
    # Steps at most: three or four are usual, and five more each time that a step is cut at its limit.
    iterations: int = 20
    change: float = 0.0
    """Greatest change of a step after which no other is taken; 0: residuals decide."""

    def reached(self, residual: Array, before: Array) -> Flags:
        """(D,) where residuals (D,), of those `before` the last step, end the steps."""
        if self.change > 0.0:
            return np.zeros(len(residual), dtype=np.bool_)
        # Share of its residual that a step leaves at least where steps gain nothing more: in reach of a solution the
        # next residual is the square of the last.
        stalled = (residual <= self.accepted) & (residual > 0.5 * before)
        return np.asarray((residual <= self.closed) | stalled)


BY_SHARE, LIMIT, BY_RESIDUAL = Rank(), StepLimit(), Termination()
"""What `close` is composed of where nothing else is asked for."""


@dataclass(frozen=True, eq=False)
class Closing:
    """Configurations at which loops close, as well as they can."""

    q: Array
    """(D, …)."""
    residual: Array
    """(D,) the greatest: rad, and shares of the length."""
    jacobian: Array
    """(D, m, n) of the closure equations there."""
    change: Array
    """(D, n) of the coordinates, in all."""
    accepted: float

    @property
    def closed(self) -> Flags:
        """(D,) whether the loops close."""
        return np.asarray(self.residual <= self.accepted)

    def one(self) -> Array | None:
        """The first configuration (…), where its loops close."""
        return np.asarray(self.q[0]) if self.residual[0] <= self.accepted else None


def close(
    system: System,
    q: Array,
    held: Flags | None = None,
    rank: Rank = BY_SHARE,
    limit: StepLimit = LIMIT,
    until: Termination = BY_RESIDUAL,
) -> Closing:
    """Where the loops of the system close near the configurations q (D, …), each by itself; coordinates that are `held`
    (n,) stay as they are. Where steps have stalled, and the last one opened the loops more than it closed them, it is
    taken back."""
    at = system.equations(q)
    n = at.jacobian.shape[2]
    free = slice(None) if held is None or not held.any() else np.flatnonzero(~held)
    state = _State(q.copy(), np.zeros((len(q), n)), at.residual, at.jacobian, _greatest(at.residual))
    before, active, stale = np.full(len(q), np.inf), np.arange(len(q)), np.zeros(len(q), dtype=np.bool_)
    last_q, last_change = state.q, state.change
    for count in range(until.iterations + 1):
        if not len(active):
            break
        if count:
            state.evaluate(system, active)
            stale[active] = False
        ended = until.reached(state.left[active], before[active])
        if ended.any():
            worse = active[ended & (state.left[active] > before[active])]
            state.q[worse], state.change[worse], stale[worse] = last_q[worse], last_change[worse], True
            active = active[~ended]
        if not len(active) or count == until.iterations:
            break
        jacobian, residual = state.jacobian[active], state.residual[active]
        step, size = limit.cut(-least_change(jacobian[:, :, free], residual, rank))
        before[active], last_q, last_change = state.left[active], state.q.copy(), state.change.copy()
        change = np.zeros((len(active), n))
        change[:, free] = step
        state.q[active] = system.advance(state.q[active], change)
        state.change[active] += change
        stale[active] = True
        active = active[size > until.change]
    if stale.any():
        state.evaluate(system, np.flatnonzero(stale))
    return Closing(state.q, state.left, state.jacobian, state.change, until.accepted)


@dataclass(frozen=True, eq=False)
class _State:
    """Configurations (D, …) on their way, how they were changed (D, n), and their equations."""

    q: Array
    change: Array
    residual: Array
    jacobian: Array
    left: Array

    def evaluate(self, system: System, which: Index) -> None:
        """Write the equations of some of the configurations."""
        at = system.rows(which).equations(self.q[which])
        self.residual[which], self.jacobian[which], self.left[which] = at.residual, at.jacobian, _greatest(at.residual)


def _greatest(residual: Array) -> Array:
    """(D,) of the residuals (D, m)."""
    return np.asarray(np.abs(residual).max(axis=1, initial=0.0))


@dataclass(frozen=True, eq=False)
class Task:
    """Where do the loops of one block close near some configurations? The arguments of `close`."""

    system: LoopSystem
    start: Array
    """(D, n)."""
    rank: Rank = Rank()
    limit: StepLimit = StepLimit()
    until: Termination = Termination()

    @property
    def likeness(self) -> object:
        """The same for tasks that can be done together."""
        return self.system.form, self.rank.share, self.rank.number, self.limit, self.until

    @property
    def alone(self) -> bool:
        """Whether its solutions are found one by one, or by products whose last bit depends on how many there are."""
        return self.system.coordinates >= REDUCED_RATES or len(self.system.ties) > 0


def close_each(tasks: Sequence[Task]) -> list[Closing]:
    """What closes the loops of each of several blocks: as if it were alone, to the last bit, though blocks of one form
    are closed at once."""
    alike: dict[object, list[int]] = defaultdict(list)
    for k, task in enumerate(tasks):
        alike[k if task.alone else task.likeness].append(k)
    out: dict[int, Closing] = {}
    for members in alike.values():
        out |= zip(members, _together([tasks[k] for k in members]), strict=True)
    return [out[k] for k in range(len(tasks))]


def _together(tasks: Sequence[Task]) -> list[Closing]:
    """Of tasks that can be done together, or of one."""
    first, counts = tasks[0], [len(task.start) for task in tasks]
    system = first.system if len(tasks) == 1 else stacked([task.system for task in tasks], counts)
    found = close(
        system, np.concatenate([t.start for t in tasks]), rank=first.rank, limit=first.limit, until=first.until
    )
    ends = np.cumsum(counts).tolist()
    of_each = [slice(end - count, end) for count, end in zip(counts, ends, strict=True)]
    return [Closing(found.q[k], found.residual[k], found.jacobian[k], found.change[k], found.accepted) for k in of_each]
