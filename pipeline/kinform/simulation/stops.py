"""End stops: impact without rebound, contact while the stop is pushed, release when it would pull.

At an impact the rates change by what least changes the kinetic energy of the rest (the mass-weighted
projection onto a joint at rest); in contact the joint is held like a prescribed one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.behaviour.signals import Constant
from kinform.simulation.actuation import Actuation, Stop
from kinform.simulation.closure import factor
from kinform.simulation.dynamics import Dynamics
from kinform.simulation.engine import Engine
from kinform.simulation.kernel import layout
from kinform.simulation.run import Run

__all__ = ["Contact"]

Array = NDArray[np.float64]

MOST = 1000
"""Impacts in one run, after which it chatters."""


class Contact:
    """Which stops hold their joints, in one run."""

    def __init__(self, run: Run):
        self.run = run
        self.holding: list[Stop] = []
        self.impacts = 0
        self._before: tuple[Array, float, int] = (run.y.copy(), 0.0, 0)

    def remember(self) -> None:
        """Keep the state before a step, to find the time of a release within it."""
        if self.holding:
            clock, tally = self.run.clock, self.run.tally
            self._before = (self.run.y.copy(), float(clock[layout.NOW]), int(tally[layout.NEXT]))

    def strike(self, engine: Engine) -> str:
        """The joint that has reached a stop is brought to rest there and held; "" or why that ends the run."""
        run = self.run
        stop = run.dynamics.actuation.stops[int(run.tally[layout.HIT])]
        self.impacts += 1
        t = float(run.clock[layout.NOW])
        if self.impacts > MOST:
            return f"at t = {t:.6g} s {stop.joint} has struck its end stops {MOST} times"
        if self.impacts == 1:
            run.notes.append(f"{stop.joint} reaches its end stop at t = {t:.6g} s; impacts are without rebound")
        tables = run.dynamics.tables
        q, v = tables.unpack(run.y)
        change, lost = _impact(run.dynamics, q, v, stop.v)
        q[stop.q] = stop.limit
        packed = tables.pack(q, v + change)
        run.y[: -1 - tables.states] = packed[: -1 - tables.states]
        run.y[-1] -= lost
        self._hold(stop, engine)
        return ""

    def _hold(self, stop: Stop, engine: Engine) -> None:
        """Hold the joint, unless the stop would have to pull at once."""
        self.holding.append(stop)
        self._change(self.run.dynamics.actuation.held(stop, Constant(stop.limit)))
        if self._pull(engine, stop) > 0.0:
            self._let_go(stop)

    def release_if_pulled(self, engine: Engine) -> None:
        """Release the stops that would have to pull, at the time when they began to."""
        run = self.run
        for stop in [s for s in self.holding if self._pull(engine, s) > 0.0]:
            end, step = float(run.clock[layout.END]), float(run.clock[layout.STEP])
            low, high = self._before[1], float(run.clock[layout.NOW])
            for _ in range(40):
                middle = 0.5 * (low + high)
                self._again(engine, middle)
                if self._pull(engine, stop) > 0.0:
                    high = middle
                else:
                    low = middle
            self._again(engine, high)
            run.clock[layout.END], run.clock[layout.STEP] = end, step
            self._let_go(stop)
            return

    def _again(self, engine: Engine, t: float) -> None:
        """The state at t, from the one remembered."""
        run = self.run
        run.y[:], run.clock[layout.NOW], run.tally[layout.NEXT] = self._before
        run.clock[layout.END], run.clock[layout.STEP], run.tally[layout.FRESH] = t, 1.0, 1
        run.tally[layout.BUDGET] = 1000
        run.tally[layout.PAUSE] = len(run.times) + 1
        if t > self._before[1]:
            engine.advance(run)
        run.tally[layout.FRESH] = 1

    def _pull(self, engine: Engine, stop: Stop) -> float:
        """Effort with which the stop would pull; negative while it is pushed."""
        run = self.run
        tables = run.dynamics.tables
        y = run.y.copy()
        engine.derivative(run, float(run.clock[layout.NOW]), y, np.zeros_like(y))
        run.tally[layout.FRESH] = 1
        rate = int(np.flatnonzero(tables.v_order == stop.v)[0])
        return stop.sense * float(tables.work[layout.VECTORS][layout.NEED, rate])

    def _let_go(self, stop: Stop) -> None:
        self.holding.remove(stop)
        self._change(self.run.dynamics.actuation.released(stop))

    def _change(self, actuation: Actuation) -> None:
        run, old = self.run, self.run.dynamics
        made = Dynamics(old.mechanism, old.system, old.gravity, actuation, run.rank(actuation.free))
        for k, stop in enumerate(old.actuation.stops):
            made.tables.ints[layout.STOPS][k, 3] = int(any(stop.v == held.v for held in self.holding))
        run.change(made)


def _impact(dynamics: Dynamics, q: Array, v: Array, at: int) -> tuple[Array, float]:
    """Change (n,) of the rates that brings rate `at` to rest, and the kinetic energy lost (J)."""
    mechanism, free = dynamics.mechanism, dynamics.actuation.free
    rows = mechanism.closure(mechanism.screws(mechanism.poses(q)))
    null = np.zeros((mechanism.rates, len(free) - dynamics.rank))
    null[free] = factor(rows[:, free], mechanism.scale[free], dynamics.rank).null
    matrix = dynamics.mass_matrix(q)
    inner = null.T @ matrix @ null
    answer = np.linalg.solve(inner, null[at])
    change = null @ answer * (-v[at] / (null[at] @ answer))
    return change, -float(change @ matrix @ (v + 0.5 * change))
