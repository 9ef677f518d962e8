"""End stops: impact, contact while the stop is pushed, release when it would pull.

At an impact the rates become the nearest, by the mass matrix, that no stop in contact forbids: stops push and never
pull, so that an impact on one can lift joints off others (Moreau, Unilateral contact and dry friction in finite freedom
dynamics, 1988). With restitution joints go back at no less than that share of the pace at which they came (Newton). In
contact the joint is held like a prescribed one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kinform.behaviour.signals import Constant, Sine
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.mechanism.rank import factor
from kinform.model.arrays import Array, Ints
from kinform.simulation.constants import HALVINGS, STEP_PARTS
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.actuation import Actuation, Stop
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.solver.constants import LAW_PARTS, MOST_EVENTS
from kinform.simulation.solver.run_state import Run

SLOW_REBOUND = 1e-7
"""rad/s or m/s: rebounds so slow count as the end of a sequence of ever smaller ones without end (Zeno impacts). A
choice: under gravity such a rebound lasts 2e-8 s and goes 5e-16 m."""


class Contact:
    """Which stops hold their joints, in one run."""

    def __init__(self, run: Run):
        self.run = run
        self.holding: list[Stop] = []
        self.impacts = 0
        self.struck: set[str] = set()
        self._before: tuple[Array, float, int] = (run.y.copy(), 0.0, 0)

    def remember(self) -> None:
        """Keep the state before a step, to find the time of a release within it."""
        if self.holding:
            clock, tally = self.run.clock, self.run.tally
            self._before = (self.run.y.copy(), float(clock[layout.NOW]), int(tally[layout.NEXT]))

    def strike(self) -> str:
        """The joint that has reached a stop is brought to rest there and held; "" or why that ends the run."""
        run = self.run
        stop = run.dynamics.actuation.stops[int(run.tally[layout.HIT])]
        self.impacts += 1
        t = float(run.clock[layout.NOW])
        if self.impacts > MOST_EVENTS:
            return f"at t = {t:.6g} s {stop.joint} has struck its end stops {MOST_EVENTS} times"
        tables, stops = run.dynamics.tables, [*self.holding, stop]
        q, v = tables.unpack(run.y)
        loose = self._held([])
        rank = run.rank(loose.free)
        null, matrix = motions(run.dynamics, q, loose.free, rank), run.dynamics.mass_matrix(q)
        impact = impact_on(null, matrix, v, stops)
        if impact is None:
            return (
                f"at t = {t:.6g} s {stop.joint} reaches its end stop at {stop.limit:.6g} (rad or m), and what is "
                "prescribed goes on beyond it: change the law of motion or the stop"
            )
        if stop.joint not in self.struck:
            self.struck.add(stop.joint)
            kept = f"leave {stop.restitution:g} of the speed" if stop.restitution else "are without rebound"
            run.notes.append(f"{stop.joint} reaches its end stop at t = {t:.6g} s; impacts {kept}")
        change, after = impact
        q[stop.q] = stop.limit
        work = float(change @ matrix @ (v + 0.5 * change))
        run.y[-1] += work
        run.y[self.run.dynamics.actuation.meter_of(stop.v) + 1] += work
        v = v + change
        rounding = SOLVED * max(1.0, float(np.abs(after).max()))
        leaving = [each for each, pace in zip(stops, after, strict=True) if pace < -rounding]
        if all(after > -SLOW_REBOUND) and leaving:
            # Zeno impacts: what would soon be back stays, unless it is pulled off.
            still = v.copy()
            still[[each.v for each in leaving]] = 0.0
            if self._stay(stops, q, still) and max(self._pull(each) for each in self.holding) <= 0.0:
                return ""
        self._stay([each for each in stops if each not in leaving], q, v)
        while self.holding:
            pull, loosest = max(((self._pull(each), each) for each in self.holding), key=lambda pair: pair[0])
            if pull <= 0.0:
                break
            self._let_go(loosest)
        return ""

    def _stay(self, wanted: list[Stop], q: Array, v: Array) -> bool:
        """Go on from these positions and rates with these joints held; whether any is."""
        run, tables = self.run, self.run.dynamics.tables
        packed = tables.pack(q, v)
        run.y[: -1 - tables.states] = packed[: -1 - tables.states]
        self._hold(wanted, q)
        return bool(self.holding)

    def _hold(self, wanted: list[Stop], q: Array) -> None:
        """Hold these joints, but those that the others hold already."""
        kept: list[Stop] = []
        for stop in wanted:
            free = self._held(kept).free
            if np.linalg.norm(motions(self.run.dynamics, q, free, self.run.rank(free))[stop.v]) > SOLVED:
                kept.append(stop)
        actuation = self._held(kept)
        self.holding = kept
        self._change(actuation)

    def _held(self, stops: list[Stop]) -> Actuation:
        """What acts when just these stops hold their joints."""
        actuation = self.run.dynamics.actuation
        for stop in self.holding:
            actuation = actuation.released(stop)
        for stop in stops:
            actuation = actuation.held(stop, Constant(stop.limit))
        return actuation

    def longest(self) -> float:
        """s: steps that a law may not turn its push into a pull and back within, while stops hold."""
        if not self.holding:
            return np.inf
        actuation = self.run.dynamics.actuation
        signals = [*actuation.signals, *(actor.signal for actor in actuation.actors)]
        speeds = [abs(signal.speed) for signal in signals if isinstance(signal, Sine) and signal.amplitude != 0.0]
        return np.pi / (LAW_PARTS * max(speeds)) if any(speeds) else np.inf

    def release_if_pulled(self) -> bool:
        """Release a stop that had to pull in the last step, at the time when it began to; whether one did."""
        run, (y, begin, _) = self.run, self._before
        until, reached, sampled = float(run.clock[layout.NOW]), run.y.copy(), run.tally[[layout.NEXT, layout.HIT]]
        if not self.holding or until <= begin:
            return False
        between = self._between(y, begin, reached, until)
        if between is None:
            return False
        asked = (*np.linspace(begin, until, STEP_PARTS + 1)[1:-1], until)
        pulled = next((t for t in asked if self._pulled(t, between(t))), None)
        if pulled is None:
            return False
        end, step = float(run.clock[layout.END]), float(run.clock[layout.STEP])
        low, high = begin, float(pulled)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            self._again(middle)
            low, high = (low, middle) if self._pulled(middle, run.y) else (middle, high)
        self._again(high)
        run.clock[layout.END], run.clock[layout.STEP] = end, step
        loose = self._pulled(high, run.y)
        if loose:
            self._let_go(loose[0])
            return True
        run.y[:], run.clock[layout.NOW], run.tally[[layout.NEXT, layout.HIT]] = reached, until, sampled
        return False

    def _between(self, y: Array, begin: float, reached: Array, until: float) -> Callable[[float], Array] | None:
        """The state between two times, from the states and their derivatives; None where these are not finite."""
        from scipy.interpolate import CubicHermiteSpline

        slopes = []
        for t, state in ((begin, y), (until, reached)):
            slope = np.zeros_like(state)
            self.run.derivative(t, state.copy(), slope)
            slopes.append(slope)
        states = np.stack([y, reached])
        if not (np.isfinite(states).all() and np.isfinite(slopes).all()):
            return None
        between: Callable[[float], Array] = CubicHermiteSpline([begin, until], states, np.stack(slopes))
        return between

    def _pulled(self, t: float, y: Array) -> list[Stop]:
        """The stops that would have to pull in this state."""
        return [stop for stop in self.holding if self._pull(stop, t, y) > 0.0]

    def _again(self, t: float) -> None:
        """The state at t, from the one remembered."""
        run = self.run
        run.y[:], run.clock[layout.NOW], run.tally[layout.NEXT] = self._before
        run.clock[layout.END], run.clock[layout.STEP], run.tally[layout.FRESH] = t, 1.0, 1
        # Steps in which to go again from the start of a step to a time within it, which one or two usually do: a
        # choice, so that a run which cannot ends.
        run.tally[layout.BUDGET] = 1000
        run.tally[layout.PAUSE] = len(run.times) + 1
        if t > self._before[1]:
            run.advance()
        run.tally[layout.FRESH] = 1

    def _pull(self, stop: Stop, t: float | None = None, y: Array | None = None) -> float:
        """Effort with which the stop would pull, now or in the state `y` at t; negative while it is pushed."""
        run = self.run
        tables = run.dynamics.tables
        y = (run.y if y is None else y).copy()
        run.derivative(float(run.clock[layout.NOW]) if t is None else float(t), y, np.zeros_like(y))
        run.tally[layout.FRESH] = 1
        rate = int(np.flatnonzero(tables.v_order == stop.v)[0])
        return stop.sense * float(tables.work[layout.VECTORS][layout.NEED, rate])

    def _let_go(self, stop: Stop) -> None:
        self.holding.remove(stop)
        self._change(self.run.dynamics.actuation.released(stop))

    def _change(self, actuation: Actuation) -> None:
        run, old = self.run, self.run.dynamics
        dynamics = Dynamics(old.mechanism, old.system, old.gravity, actuation, run.rank(actuation.free))
        for k, stop in enumerate(old.actuation.stops):
            dynamics.tables.ints[layout.STOPS][k, layout.HELD] = int(any(stop.v == held.v for held in self.holding))
        run.change(dynamics)


def beyond(stops: Sequence[Stop], q: Array) -> tuple[tuple[str, str], ...]:
    """(joint, why) of the positions `q` (nq,) that stops do not let joints take."""
    return tuple(
        (
            stop.joint,
            f"it starts at {q[stop.q]:.6g}, beyond its end stop at {stop.limit:.6g} (rad or m; 0 is the pose in which "
            "the model is written): state an initial value on this side of the stop, or move the stop",
        )
        for stop in stops
        if stop.sense * (q[stop.q] - stop.limit) > SOLVED
    )


def motions(dynamics: Dynamics, q: Array, free: Ints, rank: int) -> Array:
    """(n, m) motions of the free rates that keep the loops closed."""
    mechanism = dynamics.mechanism
    null = np.zeros((mechanism.rates, len(free) - rank))
    null[free] = factor(mechanism.closure_at(q)[:, free], mechanism.scale[free], rank).null
    return null


def impact_on(null: Array, matrix: Array, v: Array, stops: Sequence[Stop]) -> tuple[Array, Array] | None:
    """Change (n,) of the rates at which no joint goes on beyond the stops it has met, and how fast it then goes there.

    None where no change of the motions `null` (n, m) brings that about; `matrix` (n, n) is that of the masses.
    """
    outward = np.array([stop.sense * null[stop.v] for stop in stops])
    pace = np.array([stop.sense * v[stop.v] for stop in stops])
    back = np.array([stop.restitution for stop in stops]) * np.maximum(pace, 0.0)
    root = np.linalg.cholesky(null.T @ matrix @ null)
    ways = np.linalg.solve(root, outward.T)
    held = np.linalg.norm(outward, axis=1) > SOLVED
    pushes = np.zeros(len(stops))
    if held.any():
        pushes[held] = _pushes(ways[:, held], (pace + back)[held])
    change = -null @ np.linalg.solve(root.T, ways @ pushes)
    after = pace + np.array([stop.sense * change[stop.v] for stop in stops])
    if (after > SINGLE * np.abs(pace).max()).any():
        return None
    return change, after


def _pushes(ways: Array, pace: Array) -> Array:
    """Impulses p ≥ 0 with WᵀW p ≥ pace, and equal where p > 0."""
    if len(pace) == 1:
        return np.maximum(pace / (ways[:, 0] @ ways[:, 0]), 0.0)
    from scipy.optimize import nnls

    return np.asarray(nnls(ways, np.linalg.lstsq(ways.T, pace, rcond=None)[0])[0])
