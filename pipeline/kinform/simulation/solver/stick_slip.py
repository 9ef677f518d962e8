"""Motion with Coulomb friction: from one change between sticking and slipping to the next, each found in time.

What sticks is held, like a joint at its end stop (`stops`): its value is the same number from then on, and no law
smoothed near rest lets it creep. While the effort that holds it stays within what friction takes at rest it goes on
sticking; when that ends is found within the step, and so is when what slips comes to rest (`sticking`). In between the
friction in motion has a known direction, its size follows from the loads (`slip`), and the equations are smooth: DOP853
(scipy's, with its dense output) goes from change to change, and loops are closed after each step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from kinform.behaviour.signals import Sine
from kinform.foundation.algebra.vectors import norm
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.simulation.constants import HALVINGS, STEP_PARTS
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.calls import engine, ready
from kinform.simulation.mechanism.actuation import Stop
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.states import states_at
from kinform.simulation.record import FrictionRecord, Record
from kinform.simulation.settings import Conduct
from kinform.simulation.solver.constants import CONVERGED, LAW_PARTS
from kinform.simulation.solver.friction_forces import NotDeterminedError, set_efforts
from kinform.simulation.solver.friction_stops import strike
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.start import Start
from kinform.simulation.solver.sticking import Hold, Sticking, grouped, ways

SLIP_PARTS = 8
"""Parts of a step at whose ends rates are looked at for a reversal: the dense output, a polynomial of order 7, turns
less often."""
MOST_SWITCHES = 100_000
"""Changes between sticking and slipping before a run gives up: a choice."""
SWITCHES_AT_ONCE = 8
"""Changes at one and the same time, for each friction, before a run gives up as one that goes to and fro: three are
ordinary."""


Dense = Callable[[float], Array]


def run_with_friction(dynamics: Dynamics, start: Start, times: Array, conduct: Conduct) -> Record:
    """As `run_dynamic`, of a mechanism with friction in joints."""
    first, last = float(times[0]), float(times[-1])
    knots = [knot for knot in dynamics.actuation.knots if first < knot < last]
    run = Run(dynamics, start, times, conduct.settings)
    driver = _Driver(run, conduct, start.q)
    if not run.begin():
        return driver.record(f"after t = {first:.6g} s a free motion moves no mass")
    try:
        for begin, end in zip([first, *knots], [*knots, last], strict=True):
            why = driver.stretch(begin, end) if end > begin or first == last else ""
            if why:
                return driver.record(why)
    except NotDeterminedError as error:
        return driver.record(str(error))
    return driver.record("")


@dataclass(frozen=True)
class Struck:
    """An end stop that is reached, by its number."""

    stop: int


class _Driver:
    """Integrates a run with friction."""

    def __init__(self, run: Run, conduct: Conduct, q: Array):
        self.run, self.progress = run, conduct.progress
        run.engine = engine(compiled=ready(run.dynamics.tables) and run.dynamics.mechanism.closed)
        actuation = run.dynamics.actuation
        groups, led, _ = grouped(ways(run.dynamics, actuation, q, run.settings.free))
        self.state = Sticking(run, groups, led)
        count = len(run.times), len(actuation.frictions)
        self.efforts, self.limits = np.zeros(count), np.zeros(count)
        self.sticking: Flags = np.zeros(count, dtype=np.bool_)
        self.steps, self.at_once = 0, (-np.inf, 0)
        self.begun = False

    def record(self, stopped: str) -> Record:
        """What there is."""
        record = self.run.record(stopped)
        done = len(record.time)
        return replace(record, friction=FrictionRecord(self.efforts[:done], self.limits[:done], self.sticking[:done]))

    def stretch(self, begin: float, end: float) -> str:
        """Integrate over a stretch in which all laws are smooth; why it stopped, or ""."""
        run, state = self.run, self.state
        run.open_stretch(begin, end)
        if not self.begun:
            state.begin(begin)
            self._sample(0, begin, run.y)
            self.begun = True
        else:
            state.look_at_led(begin)
            state.settle(begin)
        t = begin
        while t < end:
            t, why = self._smooth(t, end)
            if why:
                return why
        return ""

    def _slope(self, t: float, y: Array) -> Array:
        """Derivative of the state, frictions found."""
        if self.state.acting:
            self.state.answer(t, y)
        else:
            set_efforts(self.run.dynamics, np.zeros(len(self.state.rubbings)))
        out = np.zeros_like(y)
        self.run.derivative(t, y.copy(), out)
        return out

    def _energy(self) -> float:
        """J: the size of what friction may turn into heat: the motion's energy, and that of all weights in a fall as
        high as the mechanism."""
        run = self.run
        dynamics, mechanism = run.dynamics, run.dynamics.mechanism
        q, v = dynamics.tables.unpack(run.y)
        states = states_at(mechanism, q[None], v[None], np.zeros_like(v)[None])
        weight = float(dynamics.mass.sum()) * norm(dynamics.gravity)
        return float(dynamics.energy(q[None], v[None], states)[0][0]) + weight * mechanism.length

    def _smooth(self, t: float, end: float) -> tuple[float, str]:
        """Integrate up to the next change, or to the end: (how far, why it cannot go on)."""
        from scipy.integrate import DOP853

        run, settings = self.run, self.run.settings
        # Nothing depends on meters: their errors do not shorten steps.
        atol = np.full_like(run.y, settings.atol)
        atol[run.dynamics.tables.metered] = np.inf
        # work is as large as what moves is heavy, and the motion is not
        atol[-1] *= max(1.0, self._energy())
        solver = DOP853(self._slope, t, run.y.copy(), end, rtol=settings.rtol, atol=atol, max_step=self._longest())
        while solver.status == "running":
            solver.step()
            self.steps += 1
            if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
                return float(solver.t), (
                    f"at t = {solver.t:.6g} s the motion becomes too fast to follow: the mechanism is singular there "
                    f"or the model is stiff{run.loops()}"
                )
            if self.steps > settings.steps:
                return float(solver.t), f"at t = {solver.t:.6g} s {settings.steps} steps were used up"
            dense = solver.dense_output()
            change = self._change(float(solver.t_old), float(solver.t), dense)
            reached = float(solver.t) if change is None else change[0]
            self._outputs(reached, dense, last=change is None and solver.status == "finished")
            run.clock[layout.NOW] = reached
            if change is not None:
                run.y[:] = dense(reached)
                return reached, self._switch(*change)
            run.y[:] = solver.y
            gap, kept = run.project(reached, run.y)
            if gap > settings.open:
                return reached, f"at t = {reached:.6g} s the loops cannot be closed any more{run.loops()}"
            if kept < settings.keep:
                run.choose()
            solver.y[:] = run.y
            solver.f = self._slope(reached, run.y)
            if self.progress is not None:
                self.progress(int(run.tally[layout.NEXT]), len(run.times))
        return float(solver.t), ""

    def _switch(self, t: float, what: Hold | Struck | int, way: int) -> str:
        """A group is let go, or comes to rest, or a joint is at its end stop; why that ends the run, or ""."""
        run, state = self.run, self.state
        run.project(t, run.y)
        if isinstance(what, Struck):
            why = strike(state, what.stop, t)
            if why:
                return why
        elif isinstance(what, Hold):
            state.release(what, way, t)
            state.settle(t)
        else:
            state.stopped(what, t)
        before, count = self.at_once
        self.at_once = (t, count + 1) if t <= before + SOLVED * (run.times[-1] - run.times[0]) else (t, 1)
        if (
            self.at_once[1] > SWITCHES_AT_ONCE * (len(state.rubbings) + len(state.base.stops))
            or state.switches > MOST_SWITCHES
        ):
            names = ", ".join(dict.fromkeys(one.joint for one in state.rubbings))
            return f"at t = {t:.6g} s friction in {names} changes between sticking and slipping without end"
        return ""

    def _change(self, begin: float, end: float, dense: Dense) -> tuple[float, Hold | Struck | int, int] | None:
        """(time, what, which way) of the first change in a step; None where there is none."""
        state, tables = self.state, self.run.dynamics.tables
        found: list[tuple[float, Hold | Struck | int, int]] = []
        for number, stop in enumerate(state.base.stops):
            if number in state.resting:
                continue

            def room(t: float, stop: Stop = stop) -> float:
                return stop.sense * (stop.limit - float(tables.unpack(dense(t))[0][stop.q]))

            # A joint that has just left its stop is there but for rounding.
            least = min(room(begin), 0.0)
            when = _falls(lambda t, room=room, least=least: room(t) - least, begin, end, SLIP_PARTS)  # type: ignore[misc]
            if when is not None:
                found.append((when, Struck(number), 0))
        for k, sense in enumerate(state.senses):
            if sense:
                at = state.rubbings[k].v

                def pace(t: float, at: int = at, sense: int = int(sense)) -> float:
                    return sense * float(tables.unpack(dense(t))[1][at])

                when = _falls(pace, begin, end, SLIP_PARTS)
                if when is not None:
                    found.append((when, k, 0))
        for hold in state.holds:
            known: dict[float, dict[int, float]] = {}

            def left(t: float, way: int, hold: Hold = hold, known: dict[float, dict[int, float]] = known) -> float:
                if t not in known:
                    known[t] = {w: margin for margin, w in state.margins(hold, t, dense(t))}
                return known[t][way]

            for way in (1, -1):
                when = _falls(partial(left, way=way), begin, end, STEP_PARTS)
                if when is not None:
                    found.append((when, hold, way))
        return min(found, key=lambda change: change[0]) if found else None

    def _outputs(self, until: float, dense: Dense, *, last: bool) -> None:
        """Write the outputs that are due up to a time."""
        run = self.run
        while run.tally[layout.NEXT] < len(run.times):
            k = int(run.tally[layout.NEXT])
            t = float(run.times[k])
            if t > until and not (last and k == len(run.times) - 1 and run.clock[layout.END] >= t):
                return
            self._sample(k, t, dense(t))
            run.tally[layout.NEXT] += 1

    def _sample(self, k: int, t: float, y: Array) -> None:
        """Write output k, and what the frictions do then."""
        run, state = self.run, self.state
        y = y.copy()
        run.project(t, y)
        answer = state.answer(t, y)
        run.sample(t, y, run.out[k])
        self.efforts[k] = state.held_effort(answer)
        self.limits[k] = state.limits(answer)
        self.sticking[k] = state.sticking

    def _longest(self) -> float:
        """s: steps that a law may not turn what sticks and back within."""
        if not self.state.holds:
            return np.inf
        actuation = self.state.base
        signals = [*actuation.signals, *(actor.signal for actor in actuation.actors)]
        signals += [load.signal for load in actuation.loads]
        speeds = [abs(signal.speed) for signal in signals if isinstance(signal, Sine) and signal.amplitude != 0.0]
        return np.pi / (LAW_PARTS * max(speeds)) if any(speeds) else np.inf


def _falls(function: Callable[[float], float], begin: float, end: float, parts: int) -> float | None:
    """The first time in a step at which the function, not negative at its begin, becomes negative; None where it does
    not at any of so many parts of it."""
    from scipy.optimize import brentq

    before = begin
    for t in np.linspace(begin, end, parts + 1)[1:]:
        if function(float(t)) < 0.0:
            low = function(before)
            if low <= 0.0:
                return before if before > begin or low < 0.0 else _after(function, begin, float(t))
            return float(brentq(function, before, float(t), xtol=4.0 * np.spacing(max(abs(end), TINY)), rtol=CONVERGED))
        before = float(t)
    return None


def _after(function: Callable[[float], float], begin: float, end: float) -> float | None:
    """As `_falls` for a function that is zero at the begin: when it falls after it has risen."""
    from scipy.optimize import brentq

    t = end
    for _ in range(HALVINGS):
        t = begin + 0.5 * (t - begin)
        if function(t) > 0.0:
            return float(brentq(function, t, end, rtol=CONVERGED))
    return begin
