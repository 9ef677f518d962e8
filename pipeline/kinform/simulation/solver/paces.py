"""How the implicit method lays its steps: by its errors, or so long that a vibration dies out in them.

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

from kinform.model.arrays import Array
from kinform.model.simulation import Damping
from kinform.simulation import constants
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.states import states_at
from kinform.simulation.solver.run_state import Run
from kinform.simulation.solver.stiffness import jacobian, vibration

Rates = Callable[[float, Array], Array]


class Controlled:
    """Steps by their errors."""

    def __init__(self, run: Run):
        self.run, self.made = run, 0

    def solver(self, rates: Rates, longest: float) -> Any:
        """The method from the present state to the end of the stretch, with steps of `longest` (s) at most."""
        run, settings = self.run, self.run.settings
        solver = _radau(run, rates, settings.implicit_rtol, _finest(run), constants.FIRST_IMPLICIT_STEP, longest)
        if run.dampings:
            solver.newton_tol = constants.STIFF_NEWTON
        return solver

    def corrected(self, y: Array) -> Array:
        """The state as it counts."""
        return y

    def ends(self, solver: Any, before: Array, span: float) -> bool:
        """Whether another pace is to go on after this step of `span` (s) from the state `before`."""
        self.made += 1
        return bool(self.run.dampings) and self.made % constants.LOOK == 0 and lasting(self.run) > 0.0

    def fault(self) -> str:
        """Why the run cannot be trusted after these steps: errors control them."""
        return ""


class Damped:
    """Steps in which a vibration of angular frequency `fastest` (1/s) dies out."""

    def __init__(self, run: Run, fastest: float):
        self.run, self.fastest, self.made = run, fastest, 0
        self.kept, self.moving = _balance(run, run.y), _kinetic(run, run.y)
        run.dampings.append(Damping(float(run.clock[layout.NOW]), fastest / (2.0 * np.pi), 0.0))

    def solver(self, rates: Rates, longest: float) -> Any:
        """As of `Controlled`."""
        step, free = constants.DAMPING_STEP / self.fastest, constants.WITHOUT_CONTROL
        solver = _radau(self.run, rates, free, np.full_like(self.run.y, free), step, min(step, longest))
        solver.newton_tol = constants.DAMPING_NEWTON / free
        return solver

    def corrected(self, y: Array) -> Array:
        """The state with what the vibration has lost as work."""
        lost = self.kept - _balance(self.run, y)
        out = y.copy()
        out[-1] -= lost
        return out

    def ends(self, solver: Any, before: Array, span: float) -> bool:
        """As of `Controlled`."""
        run = self.run
        lost = self.kept - _balance(run, run.y)
        run.y[-1] -= lost
        solver.y = run.y.copy()
        run.dampings[-1] = replace(run.dampings[-1], energy=run.dampings[-1].energy + lost)
        # Newton need not be more exact than what the step leaves of the vibration.
        relative = (run.y - before) / (1.0 + np.abs(before))
        change = float(np.sqrt(np.mean(relative[: run.dynamics.tables.metered.start] ** 2)))
        settled = max(constants.DAMPING_SETTLED, constants.DAMPING_NEWTON * change)
        solver.newton_tol = settled / constants.WITHOUT_CONTROL
        self.made += int(self.fastest * span > constants.DAMPS)
        return self.made == constants.DAMPING_STEPS

    def fault(self) -> str:
        """Why the run cannot be trusted after these steps; "" where it can. Steps that damp must not add energy, and
        what goes on must be slow beside them."""
        run, lost = self.run, self.run.dampings[-1].energy
        _, v = run.dynamics.tables.unpack(run.y)
        way = float(np.abs(v / run.dynamics.mechanism.scale).max(initial=0.0)) * constants.DAMPING_STEP / self.fastest
        added = lost < -(constants.LEAST_DRIFT + constants.DAMPING_GAIN * (self.moving + _kinetic(run, run.y)))
        if not added and way <= run.settings.stride:
            return ""
        hertz = self.fastest / (2.0 * np.pi)
        return (
            f"at t = {float(run.clock[layout.NOW]):.6g} s more than {run.settings.steps} steps would be needed: what "
            f"moves beside springs that vibrate with {hertz:.4g} Hz is nearly as fast{run.loops()}"
        )


def lasting(run: Run) -> float:
    """Angular frequency (1/s) of the vibration that still keeps steps short, in a run that damps them; else 0."""
    if not 0 < len(run.dampings) < constants.MOST_DAMPINGS:
        return 0.0
    return vibration(run, float(run.clock[layout.STEP]), constants.DAMPED_AHEAD)


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
    rates = tables.pack(np.zeros_like(q), np.full_like(v, constants.STIFF_ROUNDING * fastest))
    out[:head] = np.maximum(rates[:head], out[:head])
    return out
