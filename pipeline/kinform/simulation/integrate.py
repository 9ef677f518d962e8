"""Motion under forces, through time: DOP853 with its dense output, loops closed again after each step.

The state is positions, rates and the work done so far; prescribed joints are put where their laws have
them at every evaluation. Where a law is not smooth the integrator starts afresh.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.simulation.dynamics import Dynamics, SingularMassError
from kinform.simulation.record import Record, Sample
from kinform.simulation.settings import SolverSettings
from kinform.simulation.start import Start

__all__ = ["run_dynamic"]

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]


class _Run:
    """One run: the state and the samples so far."""

    def __init__(self, dynamics: Dynamics, start: Start, times: Array, settings: SolverSettings):
        self.dynamics, self.times, self.settings = dynamics, times, settings
        self.mechanism, self.actuation = dynamics.mechanism, dynamics.actuation
        self.sizes = len(start.q), len(start.q) + len(start.v)
        self.y = np.concatenate([start.q, start.v, [0.0]])
        self.samples: list[Sample] = []
        self.steps = 0
        self.margin, self.tightest = np.inf, 0.0

    def split(self, t: float, y: Array) -> tuple[Array, Array, float]:
        """Positions, rates and work, prescribed joints on their laws."""
        q, v = y[: self.sizes[0]].copy(), y[self.sizes[0] : self.sizes[1]].copy()
        if len(self.actuation.led):
            q[self.actuation.led_q] = self.actuation.led_values(t)
            v[self.actuation.led] = self.actuation.led_rates(t)
        return q, v, float(y[-1])

    def closed(self, t: float, y: Array) -> tuple[Array, Array, float]:
        """The same with loops closed."""
        q, v, work = self.split(t, y)
        if self.mechanism.closed:
            q, v = self.dynamics.project(q, v)
        return q, v, work

    def rates(self, t: float, y: Array) -> Array:
        """Derivative of the state."""
        q, v, _ = self.split(t, y)
        motion = self.dynamics.motion(t, q, v)
        if motion.margin < self.margin:
            self.margin, self.tightest = motion.margin, t
        if motion.margin < self.settings.near:
            # Close to a singular pose the accelerations depend on how well the loops are closed.
            q, v = self.dynamics.project(q, v)
            motion = self.dynamics.motion(t, q, v)
        return np.concatenate([self.mechanism.q_rates(q, v), motion.acceleration, [motion.power]])

    def sample(self, t: float, y: Array) -> None:
        """Keep the state at an output time."""
        q, v, work = self.closed(t, y)
        effort = self.dynamics.motion(t, q, v).effort
        self.samples.append(Sample(t, q, v, effort, (*self.dynamics.energy(q, v), work)))

    def record(self, stopped: str) -> Record:
        """What there is, with a warning where the loops came close to a singular pose."""
        notes: tuple[str, ...] = ()
        if self.margin < self.settings.doubtful:
            notes = (
                f"near t = {self.tightest:.4g} s the loops pass a singular pose, where they could go on in "
                "several ways: taken is the one that the momentum continues",
            )
        return Record(tuple(self.samples), stopped, notes)

    def gap(self, t: float) -> float:
        """Largest gap of the loops at the present state."""
        q, _, _ = self.split(t, self.y)
        return float(np.abs(self.mechanism.gap(self.mechanism.poses(q), q)).max(initial=0.0))


def run_dynamic(
    dynamics: Dynamics, start: Start, times: Array, settings: SolverSettings, progress: Progress | None
) -> Record:
    """Positions, rates, efforts and energy at `times` (s), until the end or until it cannot go on."""
    run = _Run(dynamics, start, times, settings)
    first, last = float(times[0]), float(times[-1])
    inner = [knot for knot in dynamics.actuation.knots if first < knot < last]
    try:
        run.sample(first, run.y)
        for begin, end in zip([first, *inner], [*inner, last], strict=True):
            why = _segment(run, begin, end, progress) if end > begin else ""
            if why:
                return run.record(why)
    except SingularMassError:
        reached = run.samples[-1].time if run.samples else first
        return run.record(f"after t = {reached:.6g} s a free motion moves no mass")
    except np.linalg.LinAlgError:
        reached = run.samples[-1].time if run.samples else first
        return run.record(f"after t = {reached:.6g} s the motion grew beyond all numbers")
    return run.record("")


def _segment(run: _Run, begin: float, end: float, progress: Progress | None) -> str:
    """Integrate over a stretch in which all laws are smooth; why it stopped, or ""."""
    from scipy.integrate import DOP853

    settings = run.settings
    before_end = float(np.nextafter(end, begin))

    def rates(t: float, y: Array) -> Array:
        return run.rates(min(t, before_end), y)

    solver: Any = DOP853(rates, begin, run.y, end, rtol=settings.rtol, atol=settings.atol)
    while solver.status == "running":
        solver.step()
        run.steps += 1
        if solver.status == "failed":
            return (
                f"at t = {solver.t:.6g} s the motion becomes too fast to follow: "
                "the mechanism is singular there or the model is stiff"
            )
        dense = solver.dense_output()
        while len(run.samples) < len(run.times) and run.times[len(run.samples)] <= solver.t:
            t = float(run.times[len(run.samples)])
            run.sample(t, dense(t))
            if progress is not None:
                progress(len(run.samples), len(run.times))
        q, v, work = run.closed(solver.t, solver.y)
        run.y = np.concatenate([q, v, [work]])
        if run.mechanism.closed:
            if not run.gap(solver.t) < settings.open:
                return f"at t = {solver.t:.6g} s the loops cannot be closed any more: the pose is singular"
            # The integrator goes on from the closed state, and so must the slope that it keeps.
            solver.y, solver.f = run.y, rates(solver.t, run.y)
        if run.steps > settings.steps:
            return f"at t = {solver.t:.6g} s {settings.steps} steps were used up: the model is stiff"
    return ""
