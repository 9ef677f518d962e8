"""Why a run takes many steps: what decays or vibrates far faster than it moves.

At tight tolerances the error estimate of an explicit method keeps its steps well inside the region of
stability, so that the usual test at its edge finds nothing. The eigenvalues of the derivative do: a decay
as fast as the steps are short, in a run that has many steps to go.

A vibration that springs make is in the eigenvalues at the same pose at rest and without gravity: those of a mechanism
that merely turns fast, or swings as a pendulum, are imaginary as well, and vanish there.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.kernel import layout
from kinform.simulation.solver.run_state import Run

FAST_DECAY = 0.4
"""Decay within a step, as an exponent, from which on it is what limits the step: a choice, well inside the region of
stability, which ends at 6."""
VIBRATES = 0.05
"""Phase (rad) of a vibration within a step from which on it is what limits the step: with the tolerances it is 0.3 to
1, whatever the amplitude, as that of a vibration which matters is far above them."""


def is_stiff(run: Run) -> bool:
    """Whether the present state decays along some direction within about a step."""
    t, step = float(run.clock[layout.NOW]), float(run.clock[layout.STEP])
    if step <= 0.0 or (run.clock[layout.END] - t) / step < run.settings.ahead:
        return False
    values = _eigenvalues(run, t, run.y)
    return bool(np.any((-values.real * step > FAST_DECAY) & (np.abs(values.imag) < -values.real)))


def vibration(run: Run, step: float, budget: float) -> float:
    """Angular frequency (1/s) of the fastest vibration of the springs, where it is what keeps steps as short as `step`
    (s), outputs are too far apart to show it, and following it to the end would take more than `budget` of such steps;
    else 0."""
    t, last = float(run.clock[layout.NOW]), float(run.times[-1])
    if step <= 0.0 or (last - t) / step <= budget:
        return 0.0
    q, v = run.dynamics.tables.unpack(run.y)
    still, states = run.y.copy(), run.dynamics.tables.states
    still[: -1 - states] = run.dynamics.tables.pack(q, np.zeros_like(v))[: -1 - states]
    gravity = run.dynamics.tables.nums[layout.CONSTANTS][0, layout.GRAVITY : layout.GRAVITY + 3]
    pull = gravity.copy()
    gravity[:] = 0.0
    values = _eigenvalues(run, t, still)
    gravity[:] = pull
    swings = np.abs(values.imag)[np.abs(values.imag) > np.abs(values.real)]
    fastest = float(swings.max(initial=0.0))
    shown = (last - float(run.times[0])) / (len(run.times) - 1)
    return fastest if fastest * step > VIBRATES and fastest * shown > 2.0 * np.pi else 0.0


def jacobian(run: Run, t: float, at: Array) -> Array:
    """(size, size) central differences of the derivative by the state `at`. Nothing depends on meters and work.

    Rows of meters are left zero: their great numbers, squares of efforts, would be taken for pivots where linear
    equations are solved, and leave few digits of the others. They follow the rest by iteration.
    """
    size, metered = len(at), run.dynamics.tables.metered
    out = np.zeros((size, size))
    ends = np.zeros((2, size))
    for k in range(metered.start):
        # Share of a number of the state (of 1 at least) by which it is changed for the derivative: the third root of a
        # rounding, at which rounding and curvature disturb central differences alike, but for a factor of six.
        h = 1e-6 * max(1.0, abs(at[k]))
        for side, sign in enumerate((1.0, -1.0)):
            y = at.copy()
            y[k] += sign * h
            run.derivative(t, y, ends[side])
        out[:, k] = (ends[0] - ends[1]) / (2.0 * h)
    out[metered] = 0.0
    run.tally[layout.FRESH] = 1
    return out


def _eigenvalues(run: Run, t: float, at: Array) -> Array:
    """Of the derivative at a state; none where it is not finite."""
    matrix = jacobian(run, t, at)
    return np.asarray(np.linalg.eigvals(matrix)) if np.all(np.isfinite(matrix)) else np.zeros(0)
