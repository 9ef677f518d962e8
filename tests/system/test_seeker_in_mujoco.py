"""The gimballed seeker, from its meshes, in kinform and in MuJoCo: one trajectory."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.devices import sine
from support.export_models import swinging
from support.other_programs import gap, loaded
from support.places import FIXTURES

from kinform import stages
from kinform.model.function import Drive, InitialValue, SimulationRequest

TURNS = {"yaw": 80.0, "pitch": -150.0}
"""Degrees a second at the start."""
TORQUES = {"base~outer": (0.02, 1.3), "inner~outer": (0.004, 2.1)}
"""N·m and Hz of sines."""
STEP = 2.5e-4
"""s, of MuJoCo's Runge and Kutta of order 4: with half of it, its trajectory changes by less than 1e-9."""


@pytest.fixture(scope="module")
def seeker(derive_design):
    return derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")


def spun(seeker):
    """Left to itself under slanted gravity, turning from the start."""
    given = tuple(InitialValue(name, 0.0, speed, 1e-3, "seeker.toml", 1) for name, speed in TURNS.items())
    return swinging(seeker, duration=2.0, step=0.1, initial=given)


def parted(found, folder, push=None):
    """Greatest distance (m, or of an entry of a rotation) from MuJoCo's trajectory over all outputs; `push` gives
    the torques (N·m by joint) at a time."""
    mujoco, model, data = loaded(found, folder)
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, STEP
    run = found.simulation

    def control(model, data):
        for name, torque in push(data.time).items():
            data.qfrc_applied[model.joint(name).dofadr[0]] = torque

    worst = gap(found, model, data, mujoco, 0)
    mujoco.set_mjcb_control(control if push else None)
    try:
        for k in range(1, len(run.time)):
            mujoco.mj_step(model, data, round((run.time[k] - run.time[k - 1]) / STEP))
            mujoco.mj_kinematics(model, data)
            worst = max(worst, gap(found, model, data, mujoco, k))
    finally:
        mujoco.set_mjcb_control(None)
    return worst


def test_a_free_seeker_moves_as_in_mujoco(seeker, tmp_path):
    found = spun(seeker)
    assert found.simulation.status == "done"
    assert np.ptp(found.simulation.joint_position, axis=0).min() > 0.5
    assert parted(found, tmp_path) < 1e-6


@pytest.mark.slow
def test_a_seeker_under_torques_moves_as_in_mujoco(seeker, tmp_path):
    """Torques of sines, against the same masses and joints with these put in."""
    free = swinging(seeker, duration=1.0, step=0.1)
    drives = tuple(Drive(n, "effort", sine(a, f), {}, 1e-3, "seeker.toml", 1) for n, (a, f) in TORQUES.items())
    function = replace(free.assembly.function, drives=drives)
    driven = stages.simulate(
        replace(free, assembly=replace(free.assembly, function=function)), level="dynamic", ranges=False
    )
    run = driven.simulation
    assert run.status == "done"
    assert np.abs(run.joint_position - free.simulation.joint_position).max(axis=0).min() > 0.1

    def push(t):
        return {n: a * np.sin(2.0 * np.pi * f * t) for n, (a, f) in TORQUES.items()}

    assert parted(replace(free, simulation=run), tmp_path, push) < 1e-6


@pytest.mark.slow
def test_a_led_seeker_needs_the_efforts_that_mujoco_finds(seeker, tmp_path):
    """Both turns led by the laws of the manifest: our motion is put in; MuJoCo says where all is and what it takes."""
    request = SimulationRequest(duration=2.0, step=0.1, gravity=np.array([3.0, -2.0, -9.0]))
    assembly = replace(seeker.assembly, simulation=request)
    led = stages.simulate(replace(seeker, assembly=assembly), level="dynamic")
    run = led.simulation
    assert run.status == "done"
    mujoco, model, data = loaded(swinging(seeker, duration=1.0, step=0.1), tmp_path)
    order = [run.joint_names.index(model.joint(k).name) for k in range(model.njnt)]
    greatest = np.abs(run.joint_effort).max()
    for k in range(len(run.time)):
        data.qpos[:], data.qvel[:] = run.joint_position[k][order], run.joint_velocity[k][order]
        data.qacc[:] = run.joint_acceleration[k][order]
        mujoco.mj_inverse(model, data)
        assert gap(led, model, data, mujoco, k) < 1e-9
        np.testing.assert_allclose(data.qfrc_inverse, run.joint_effort[k][order], atol=1e-6 * greatest)
