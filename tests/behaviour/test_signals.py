"""Tables whose rows are on one line are that line, where the run does not go beyond them."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.behaviour import Model, Table
from kinform.simulation import Course, simulate_system

TIMES = tuple(0.1 * k for k in range(11))


def _run(levels, duration, times=TIMES):
    model = Model()
    model.ground("ground")
    model.body("block", 2.0, (0, 0, 0), (0.1, 0.1, 0.1))
    model.joint("slide", "ground", "block", "prismatic", axis=(1, 0, 0))
    model.motion("push", "slide", Table(times, tuple(levels)))
    return simulate_system(model.system(), Course(duration, 0.05, np.zeros(3)))


@pytest.mark.parametrize("digits", [16, 10])
def test_a_straight_table_is_straight_and_needs_no_force(digits):
    run = _run((float(f"{0.2 + 0.7 * t:.{digits}g}") for t in TIMES), 1.0)
    np.testing.assert_allclose(run.joint_position[:, 0], 0.2 + 0.7 * run.time, atol=1e-9)
    np.testing.assert_allclose(run.joint_velocity[:, 0], 0.7, atol=1e-9)
    np.testing.assert_allclose(run.joint_effort[:, 0], 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("levels", "duration", "times"),
    [
        ([0.7 * t for t in TIMES], 1.05, TIMES),  # it ends before the run does
        ([0.7 * t for t in TIMES], 1.0, tuple(t + 0.1 for t in TIMES)),  # it begins after
        ([0.7 * t + 1e-4 * (k == 5) for k, t in enumerate(TIMES)], 1.0, TIMES),
    ],
)
def test_others_are_followed_by_a_curve_and_the_run_says_so(levels, duration, times):
    straight = _run((0.7 * t for t in TIMES), 1.0).assumptions
    assert len(_run(levels, duration, times).assumptions) > len(straight)
