"""The implicit method that goes on with stiff models, and that damps vibrations which would take too many steps.

The method is Radau IIA of order 5 on the kernel's derivative. Loops are closed again after every accepted step, as on
the explicit path (Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.8 and VII.2).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from kinform.foundation.rounding import ARITHMETIC
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.constants import HALVINGS
from kinform.simulation.kernel import layout
from kinform.simulation.solver.implicit_steps import ErrorControlled, Stepping, VibrationDamping, lasting_vibration
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.stops import Contact


def run_implicit(run: Run, contact: Contact, report: Callable[[], None], fastest: float = 0.0) -> str:
    """Integrate from the present state to the end of the stretch; why it stopped, or "". A vibration of angular
    frequency `fastest` (1/s), where it is not 0, is damped first."""
    if not fastest and not any("implicit method" in told for told in run.notes):
        run.notes.append(
            f"from t = {run.clock[layout.NOW]:.4g} s on the model is stiff and solved by an implicit method"
        )
    while run.clock[layout.NOW] < run.clock[layout.END]:
        stepping = VibrationDamping(run, fastest) if fastest else ErrorControlled(run)
        why = _until_change(run, contact, report, stepping) or stepping.fault()
        if why:
            return why
        fastest = lasting_vibration(run)
    return ""


def _until_change(run: Run, contact: Contact, report: Callable[[], None], stepping: Stepping) -> str:
    """Integrate until the end of the stretch, an end stop, or where other steps are to go on."""
    settings = run.settings

    def rates(t: float, y: Array) -> Array:
        dy = np.zeros_like(y)
        # A trial state may be far from any motion; what is not finite makes the method shorten its step.
        return dy if run.derivative(t, y.copy(), dy) > 0.0 else np.full_like(y, np.nan)

    solver = stepping.solver(rates, contact.longest())
    while solver.status == "running":
        contact.remember()
        before, y = float(solver.t), run.y.copy()
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
        _sample(run, dense, stepping, place)
        run.y[:] = stepping.corrected(dense(place)) if hit >= 0 else solver.y
        run.clock[layout.NOW], run.clock[layout.STEP] = place, solver.h_abs
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
        if stepping.ends(solver, y, place - before):
            return ""
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
        past = next((t for t in (*beyond.turns(before, end), end) if beyond(t) > ARITHMETIC), None)
        if past is None:
            continue
        low, high = before, past
        for _ in range(HALVINGS):
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
        real = np.sort(roots[np.abs(roots.imag) < ARITHMETIC].real)
        return [float(begin + x * (end - begin)) for x in real if 0.0 < x < 1.0]


def _sample(run: Run, dense: Any, stepping: Stepping, until: float) -> None:
    """Outputs up to a time in the last step."""
    while run.tally[layout.NEXT] < len(run.times) and run.times[run.tally[layout.NEXT]] <= until:
        t = float(run.times[run.tally[layout.NEXT]])
        run.sample(t, np.ascontiguousarray(stepping.corrected(dense(t))), run.out[run.tally[layout.NEXT]])
        run.tally[layout.NEXT] += 1
