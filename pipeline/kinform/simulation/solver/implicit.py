"""Stiff models: how they are recognised, and the implicit method that goes on with them.

At tight tolerances the error estimate of an explicit method keeps its steps well inside the region of
stability, so that the usual test at its edge finds nothing. The eigenvalues of the derivative do: a decay
as fast as the steps are short, in a run that has many steps to go.

The method is Radau IIA of order 5 on the kernel's derivative. Loops are closed again after every accepted step, as on
the explicit path (Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.8 and VII.2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation import constants
from kinform.simulation.kernel import layout
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.stops import Contact


def is_stiff(run: Run) -> bool:
    """Whether the present state decays along some direction within about a step."""
    t, step = float(run.clock[layout.NOW]), float(run.clock[layout.STEP])
    if step <= 0.0 or (run.clock[layout.END] - t) / step < run.settings.ahead:
        return False
    matrix = _jacobian(run, t, run.y)
    if not np.all(np.isfinite(matrix)):
        return False
    values = np.linalg.eigvals(matrix)
    return bool(np.any((-values.real * step > constants.FAST_DECAY) & (np.abs(values.imag) < -values.real)))


def _jacobian(run: Run, t: float, at: Array) -> Array:
    """Central differences of the derivative by the state (size,), at a state."""
    size = len(at)
    out = np.zeros((size, size))
    ends = np.zeros((2, size))
    for k in range(size):
        h = constants.JACOBIAN_STEP * max(1.0, abs(at[k]))
        for side, sign in enumerate((1.0, -1.0)):
            y = at.copy()
            y[k] += sign * h
            run.derivative(t, y, ends[side])
        out[:, k] = (ends[0] - ends[1]) / (2.0 * h)
    run.tally[layout.FRESH] = 1
    return out


def run_implicit(run: Run, contact: Contact, report: Callable[[], None]) -> str:
    """Integrate from the present state to the end of the stretch; why it stopped, or ""."""
    note = f"from t = {run.clock[layout.NOW]:.4g} s on the model is stiff and solved by an implicit method"
    if not any("implicit method" in told for told in run.notes):
        run.notes.append(note)
    while run.clock[layout.NOW] < run.clock[layout.END]:
        why = _until_change(run, contact, report)
        if why:
            return why
    return ""


def _until_change(run: Run, contact: Contact, report: Callable[[], None]) -> str:
    """Integrate until the end of the stretch or an end stop."""
    from scipy.integrate import Radau

    settings, end = run.settings, float(run.clock[layout.END])

    def rates(t: float, y: Array) -> Array:
        dy = np.zeros_like(y)
        # A trial state may be far from any motion; what is not finite makes the method shorten its step.
        return dy if run.derivative(t, y.copy(), dy) > 0.0 else np.full_like(y, np.nan)

    start = float(run.clock[layout.NOW])
    solver: Any = Radau(
        rates, start, run.y.copy(), end, rtol=settings.implicit_rtol, atol=settings.implicit_atol,
        first_step=min(constants.FIRST_IMPLICIT_STEP, end - start), max_step=contact.longest(),
        jac=lambda t, y: _jacobian(run, t, y),
    )  # fmt: skip
    while solver.status == "running":
        contact.remember()
        before = float(solver.t)
        try:
            with np.errstate(all="ignore"):
                solver.step()
        except (ValueError, np.linalg.LinAlgError):
            return f"after t = {before:.6g} s the motion grew beyond all numbers"
        run.tally[layout.STEPS] += 1
        if solver.status == "failed":
            return f"at t = {solver.t:.6g} s the motion becomes too fast to follow, also by the implicit method"
        hit, place = _passed(run, solver, before)
        dense = solver.dense_output()
        _sample(run, dense, place)
        run.y[:] = dense(place) if hit >= 0 else solver.y
        run.clock[layout.NOW] = place
        run.tally[layout.HIT] = hit
        if contact.release_if_pulled():
            return ""
        if hit >= 0:
            return contact.strike()
        if run.dynamics.rank:
            gap, kept = run.project(place, run.y)
            if not 0.0 <= gap < settings.open:
                return f"at t = {place:.6g} s the loops cannot be closed any more: the pose is singular{run.loops()}"
            if kept < settings.keep:
                run.choose()
            solver.y = run.y.copy()
            solver.f = rates(place, solver.y)
        report()
        if run.tally[layout.STEPS] > settings.steps:
            return f"at t = {place:.6g} s {settings.steps} steps were used up: the model is stiff"
    return ""


def _passed(run: Run, solver: Any, before: float) -> tuple[int, float]:
    """The stop that is passed first in the last step, and when; −1 and the end of the step."""
    tables, dense = run.dynamics.tables, solver.dense_output()
    hit, end = -1, float(solver.t)
    for k, (at, _, sense, held) in enumerate(tables.ints[layout.STOPS]):
        if held:
            continue
        # The curve over the step is a cubic: where it turns, and its ends, are where it reaches farthest.
        beyond = _Beyond(dense, int(at), int(sense), float(tables.nums[layout.STOPS][k, 0]))
        past = next((t for t in (*beyond.turns(before, end), end) if beyond(t) > constants.STOP_PASSED), None)
        if past is None:
            continue
        low, high = before, past
        for _ in range(constants.STOP_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if beyond(middle) > 0.0 else (middle, high)
        hit, end = k, high
    return hit, end


@dataclass(frozen=True)
class _Beyond:
    """How far a coordinate is beyond its limit over a step, by the dense output of the method."""

    dense: Any
    at: int
    sense: int
    limit: float

    def __call__(self, t: float) -> float:
        return float(self.sense * (self.dense(t)[self.at] - self.limit))

    def turns(self, begin: float, end: float) -> list[float]:
        """Times within (begin, end) at which the coordinate turns, ascending."""
        share = np.linspace(0.0, 1.0, 4)
        cubic = np.linalg.solve(np.vander(share), [self(begin + x * (end - begin)) for x in share])
        roots = np.roots(np.polyder(cubic))
        real = np.sort(roots[np.abs(roots.imag) < constants.REAL_ROOT].real)
        return [float(begin + x * (end - begin)) for x in real if 0.0 < x < 1.0]


def _sample(run: Run, dense: Any, until: float) -> None:
    """Outputs up to a time in the last step."""
    while run.tally[layout.NEXT] < len(run.times) and run.times[run.tally[layout.NEXT]] <= until:
        t = float(run.times[run.tally[layout.NEXT]])
        run.sample(t, np.ascontiguousarray(dense(t)), run.out[run.tally[layout.NEXT]])
        run.tally[layout.NEXT] += 1
