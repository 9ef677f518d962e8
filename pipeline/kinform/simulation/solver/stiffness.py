"""Tells whether explicit steps are kept short by motions that have long died out.

At tight tolerances the error estimate of an explicit method keeps its steps well inside the region of
stability, so that the usual test at its edge finds nothing. The eigenvalues of the derivative do: a decay
as fast as the steps are short, in a run that has many steps to go.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.kernel import layout
from kinform.simulation.solver.engine import Engine
from kinform.simulation.solver.run_state import Run

__all__ = ["is_stiff", "jacobian"]


FAST = 0.4
"""Decay within a step, as an exponent, from which on it is what limits the step."""


def is_stiff(run: Run, engine: Engine) -> bool:
    """Whether the present state decays along some direction within about a step."""
    t, step = float(run.clock[layout.NOW]), float(run.clock[layout.STEP])
    if step <= 0.0 or (run.clock[layout.END] - t) / step < run.settings.ahead:
        return False
    found = jacobian(run, engine, t, run.y)
    if not np.all(np.isfinite(found)):
        return False
    values = np.linalg.eigvals(found)
    return bool(np.any((-values.real * step > FAST) & (np.abs(values.imag) < -values.real)))


def jacobian(run: Run, engine: Engine, t: float, at: Array) -> Array:
    """Central differences of the derivative by the state (size,), at a state."""
    size = len(at)
    out = np.zeros((size, size))
    ends = np.zeros((2, size))
    for k in range(size):
        h = 1e-6 * max(1.0, abs(at[k]))
        for side, sign in enumerate((1.0, -1.0)):
            y = at.copy()
            y[k] += sign * h
            engine.derivative(run, t, y, ends[side])
        out[:, k] = (ends[0] - ends[1]) / (2.0 * h)
    run.tally[layout.FRESH] = 1
    return out
