"""Four-bars in a row that pass their flat pose again and again, started and built with other last bits each time."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from kinform.simulation import Course, simulate_system
from support.port_models import DOWN, four_bars

HINGES_OFF = 4e-16
"""m: two roundings of a metre."""
WITHIN = (1e-7, 1e-6)
"""rad, rad/s after 10 s, in which energy is exchanged as often as a run at the default tolerances loses 1e-8 of it."""


def pendulum(count, initial, times):
    """(t, 2) angle and rate of the uprights, which all turn alike while couplers do not: a pendulum with the inertia of
    all of them. `initial`: angle from upright, and rate."""
    inertia, lever = (count + 1) / 3 + count, (count + 1) / 2 + count

    def falling(t, y):
        return [y[1], -9.81 * lever / inertia * np.cos(y[0])]

    start = [np.pi / 2 + initial[0], initial[1]]
    exact = solve_ivp(falling, (0.0, times[-1]), start, method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times)
    return exact.y.T - [np.pi / 2, 0.0]


def perturbed_run(count, seed):
    """(run of 10 s, its greatest error of angles, and of rates) with a start that is off by 1e-15 to 1e-12, and hinges
    that are off by their rounding."""
    rng = np.random.default_rng([count, seed])
    size = 10.0 ** rng.uniform(-15, -12)
    initial = np.array([0.0, -1.0]) + size * rng.uniform(-1, 1, 2)
    model = four_bars(count, lambda: np.append(HINGES_OFF * rng.uniform(-1, 1, 2), 0.0))
    run = simulate_system(model.system(), Course(10.0, 1.0, DOWN), initial={"foot 0": tuple(initial)})
    columns = [run.joint_offset[run.joint_names.index(f"foot {k}")] for k in range(count + 1)]
    exact = pendulum(count, initial, run.time)
    errors = [
        float(np.abs(values[:, columns] - exact[:, [k]]).max())
        for k, values in enumerate((run.joint_position, run.joint_velocity))
    ]
    return run, *errors
