"""Screws as long as a hall, with tonnes on them: what keeps its speed takes no work, and long steps."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.behaviour import Model, Ramp
from kinform.simulation import Course, SolverSettings, simulate_system
from kinform.simulation.kernel.calls import Engine
from kinform.simulation.solver import dynamic

SPEED, PITCH, MASS, DURATION = 20.0 * np.pi, 10.0, 1e6, 10.0
"""rad/s, m a turn: 100 m/s for ten seconds."""


def screw_drive(axis):
    """A screw that turns in its bearing and moves a nut on a guide, 50 m away along x."""
    model = Model()
    model.ground("base")
    model.body("nut", MASS, (50.0, 0, 0), (1.0, 1.0, 1.0))
    model.body("screw", MASS, (0, 0, 0), (1.0, 1.0, 1.0))
    model.joint("guide", "base", "nut", "prismatic", axis=axis)
    model.joint("bearing", "base", "screw", "revolute", point=(0, 0, 0), axis=axis)
    model.joint("thread", "nut", "screw", "screw", point=(0, 0, 0), axis=axis, pitch=PITCH)
    model.motion("motor", "bearing", Ramp(0.0, SPEED))
    return model.system()


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("axis", [(0.36, 0.48, 0.8), (1.0, 0.0, 0.0), (0.0, 0.6, 0.8)])
def test_a_nut_that_keeps_its_speed_takes_what_lifts_it(axis, gravity):
    run = simulate_system(
        screw_drive(axis), Course(DURATION, 1.0, np.array([0.0, 0.0, -gravity])), settings=SolverSettings(steps=2000)
    )
    assert run.status == "done", run.reason
    way = run.p_WB[:, run.body_names.index("nut")] @ np.array(axis)
    np.testing.assert_allclose(np.abs(way - way[0]), SPEED * PITCH / (2.0 * np.pi) * run.time, rtol=1e-9, atol=1e-6)
    lead = -PITCH / (2.0 * np.pi)
    (drive,) = run.drives
    lifted = MASS * gravity * axis[2] * lead * SPEED * DURATION
    energy = 0.5 * MASS * (SPEED * PITCH / (2.0 * np.pi)) ** 2 + MASS * gravity * 100.0
    assert drive.work == pytest.approx(lifted, rel=1e-9, abs=1e-9 * energy)


def test_its_kernel_gives_the_same_bits_compiled_and_not(monkeypatch):
    runs = []
    for plain, loaded in ((10**9, set()), (0, {False})):
        monkeypatch.setattr(dynamic, "PLAIN", plain)
        monkeypatch.setattr(Engine, "loaded", loaded)
        runs.append(simulate_system(screw_drive((0.36, 0.48, 0.8)), Course(1.0, 0.1, np.array([0.0, 0.0, -9.81]))))
    for part in ("time", "p_WB", "q_WB", "joint_velocity", "joint_effort", "energy"):
        np.testing.assert_array_equal(getattr(runs[1], part), getattr(runs[0], part))
