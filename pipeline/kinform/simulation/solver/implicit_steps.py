"""Step sizes of the implicit method: by its errors, or so long that a vibration dies out in them.

Steps far longer than the period of a vibration damp it: at ω times the step = y by |R(iy)|, about 3/y for large y
(Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.5). The control of errors would never let
them be that long while it lasts. So some are made without, which leave the slow motion about which it swings; the
control then goes on with that. What a vibration loses counts as the work of a damper, so that the balance of energy
still tells of all other errors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from kinform.foundation.rounding import ARITHMETIC
from kinform.model.arrays import Array
from kinform.model.simulation import Damping
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.states import states_at
from kinform.simulation.solver.constants import LOOK, MOST_EVENTS
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.stiffness import jacobian, vibration

DAMPING_STEP = 100.0
"""Phase (rad) of the fastest vibration in a step that damps it, by 3/100; one of a tenth of its frequency by 0.3, one
of a thousandth by 1e-9 of itself. Steps that are cut short count as damping from 0.3 of it on, by 0.1."""
WITHOUT_CONTROL = 1e3
"""Relative and absolute error a step that no step has: errors do not control the steps that damp. Any great number."""
DAMPING_SETTLED = 1e-10
"""Newton's last correction in such a step, over the state and 1: the absolute tolerance of the implicit method
(`SolverSettings.implicit_atol`)."""
DAMPING_NEWTON = 0.03
"""The same as a share of the change by the step before: what such a step leaves of the vibration, 3/100."""


Rates = Callable[[float, Array], Array]


class ErrorControlled:
    """Steps by their errors."""

    def __init__(self, run: Run):
        self.run, self.made = run, 0

    def solver(self, rates: Rates, longest: float) -> Any:
        """The method from the present state to the end of the stretch, with steps of `longest` (s) at most."""
        run, settings = self.run, self.run.settings
        # s: short enough for decays that begin; Radau lengthens it tenfold a step.
        solver = _radau(run, rates, settings.implicit_rtol, _finest(run), 1e-6, longest)
        if run.dampings:
            # Newton's last correction over the error allowed, where rates are known to roundings only: a third of what
            # Radau takes otherwise, 0.03. A choice.
            solver.newton_tol = 0.01
        return solver

    def corrected(self, y: Array) -> Array:
        """The state as it counts."""
        return y

    def ends(self, solver: Any, before: Array, span: float) -> bool:
        """Whether other steps are to go on after this step of `span` (s) from the state `before`."""
        self.made += 1
        return bool(self.run.dampings) and self.made % LOOK == 0 and lasting_vibration(self.run) > 0.0

    def fault(self) -> str:
        """Why the run cannot be trusted after these steps: errors control them."""
        return ""


class VibrationDamping:
    """Steps in which a vibration of angular frequency `fastest` (1/s) dies out."""

    def __init__(self, run: Run, fastest: float):
        self.run, self.fastest, self.made = run, fastest, 0
        self.kept, self.moving = _balance(run, run.y), _kinetic(run, run.y)
        run.dampings.append(Damping(float(run.clock[layout.NOW]), fastest / (2.0 * np.pi), 0.0))

    def solver(self, rates: Rates, longest: float) -> Any:
        """As of `ErrorControlled`."""
        step, free = DAMPING_STEP / self.fastest, WITHOUT_CONTROL
        solver = _radau(self.run, rates, free, np.full_like(self.run.y, free), step, min(step, longest))
        solver.newton_tol = DAMPING_NEWTON / free
        return solver

    def corrected(self, y: Array) -> Array:
        """The state with what the vibration has lost as work."""
        lost = self.kept - _balance(self.run, y)
        out = y.copy()
        out[-1] -= lost
        return out

    def ends(self, solver: Any, before: Array, span: float) -> bool:
        """As of `ErrorControlled`."""
        run = self.run
        lost = self.kept - _balance(run, run.y)
        run.y[-1] -= lost
        solver.y = run.y.copy()
        run.dampings[-1] = replace(run.dampings[-1], energy=run.dampings[-1].energy + lost)
        # Newton need not be more exact than what the step leaves of the vibration.
        relative = (run.y - before) / (1.0 + np.abs(before))
        change = float(np.sqrt(np.mean(relative[: run.dynamics.tables.metered.start] ** 2)))
        settled = max(DAMPING_SETTLED, DAMPING_NEWTON * change)
        solver.newton_tol = settled / WITHOUT_CONTROL
        self.made += int(self.fastest * span > 0.3 * DAMPING_STEP)
        # Steps that damp: a vibration to 0.1^16, the last bit, at least of what it was.
        return self.made == 16

    def fault(self) -> str:
        """Why the run cannot be trusted after these steps; "" where it can. Steps that damp must not add energy, and
        what goes on must be slow beside them."""
        run, lost = self.run, self.run.dampings[-1].energy
        _, v = run.dynamics.tables.unpack(run.y)
        way = float(np.abs(v / run.dynamics.mechanism.scale).max(initial=0.0)) * DAMPING_STEP / self.fastest
        # Share of the kinetic energy that such steps may add: they never add to what they damp, and keep slow motion
        # far better than that. A choice.
        added = lost < -(ARITHMETIC + 1e-6 * (self.moving + _kinetic(run, run.y)))
        if not added and way <= run.settings.stride:
            return ""
        hertz = self.fastest / (2.0 * np.pi)
        return (
            f"at t = {float(run.clock[layout.NOW]):.6g} s more than {run.settings.steps} steps would be needed: what "
            f"moves beside springs that vibrate with {hertz:.4g} Hz is nearly as fast{run.loops()}"
        )


Stepping = ErrorControlled | VibrationDamping


def lasting_vibration(run: Run) -> float:
    """Angular frequency (1/s) of the vibration that still keeps steps short, in a run that damps them; else 0."""
    if not 0 < len(run.dampings) < MOST_EVENTS:
        return 0.0
    # Implicit steps still to go from which on a vibration that has come up again is damped again: a choice, a hundredth
    # of the budget.
    return vibration(run, float(run.clock[layout.STEP]), 2000)


def _radau(run: Run, rates: Rates, rtol: float, atol: Array, first: float, longest: float) -> Any:
    from scipy.integrate import Radau

    begin, end = float(run.clock[layout.NOW]), float(run.clock[layout.END])
    return Radau(
        rates, begin, run.y.copy(), end, rtol=rtol, atol=atol, first_step=min(first, end - begin), max_step=longest,
        jac=lambda t, y: jacobian(run, t, y),
    )  # fmt: skip


def _balance(run: Run, y: Array) -> float:
    """J: kinetic and potential energy of a state, less what was put in."""
    return float(sum(_energies(run, y)) - y[-1])


def _kinetic(run: Run, y: Array) -> float:
    """J."""
    return _energies(run, y)[0]


def _energies(run: Run, y: Array) -> tuple[float, float]:
    """J: kinetic and potential."""
    q, v = run.dynamics.tables.unpack(y)
    states = states_at(run.dynamics.mechanism, q[None], v[None], np.zeros_like(v)[None])
    kinetic, potential = run.dynamics.energy(q[None], v[None], states)
    return float(kinetic[0]), float(potential[0])


def _finest(run: Run) -> Array:
    """(size,) absolute errors a step: of rates no less than what rounding of positions leaves where springs have made
    vibrations of the frequencies that were damped; of meters any."""
    tables = run.dynamics.tables
    q, v = tables.unpack(run.y)
    fastest = 2.0 * np.pi * max((one.frequency for one in run.dampings), default=0.0)
    out = np.full_like(run.y, run.settings.implicit_atol)
    out[tables.metered] = np.inf
    head = len(out) - 1 - tables.states
    # rounding of positions (rad, lengths) times the frequency is what rates are known to
    rates = tables.pack(np.zeros_like(q), np.full_like(v, ARITHMETIC * fastest))
    out[:head] = np.maximum(rates[:head], out[:head])
    return out
