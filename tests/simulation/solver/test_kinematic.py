"""Driven motion: accelerations of closed loops, and the effort that a prescribed motion takes, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import Z, body, device, drive, joint, rod, sine
from support.port_models import DOWN

from kinform.behaviour import Model, Sine, Table
from kinform.simulation import Course, simulate, simulate_system


def slider_crank(signal):
    """A crank of 0.3 m and a rod of 1 m that drive a slider along x."""
    model = Model()
    model.ground("base")
    model.body("crank", 1.0, (0.15, 0, 0), (0.01, 0.01, 0.01))
    model.body("rod", 1.0, (0.8, 0, 0), (0.01, 0.09, 0.09))
    model.body("slider", 1.0, (1.3, 0, 0), (0.01, 0.01, 0.01))
    model.joint("main", "base", "crank", axis=(0, 0, 1), point=(0, 0, 0))
    model.joint("pin", "crank", "rod", axis=(0, 0, 1), point=(0.3, 0, 0))
    model.joint("wrist", "rod", "slider", axis=(0, 0, 1), point=(1.3, 0, 0))
    model.joint("guide", "base", "slider", "prismatic", axis=(1, 0, 0), point=(1.3, 0, 0))
    model.motion("drive", "main", signal)
    return model.system()


@pytest.mark.parametrize("level", ["kinematic", "dynamic"])
def test_a_slider_crank_moves_with_the_velocities_and_accelerations_of_its_geometry(level):
    law = Sine(0.4, 1.1, 3.0, 0.2)
    run = simulate_system(slider_crank(law), Course(2.0, 0.05, DOWN, level))
    t = run.time
    angle, rate, gain = ([f(x) for x in t] for f in (law.value, law.rate, law.acceleration))
    q, v, a = (np.array(x) for x in (angle, rate, gain))
    # x(q) = r cos q + sqrt(l² − r² sin² q) − its value at zero, and its derivatives.
    r, length = 0.3, 1.0
    root = np.sqrt(length**2 - (r * np.sin(q)) ** 2)
    x = r * np.cos(q) + root - (r + length)
    dx = -r * np.sin(q) - r**2 * np.sin(q) * np.cos(q) / root
    ddx = -r * np.cos(q) - r**2 * np.cos(2 * q) / root - (r**2 * np.sin(q) * np.cos(q)) ** 2 / root**3
    k = run.joint_names.index("guide")
    np.testing.assert_allclose(run.joint_position[:, k], x, atol=1e-11)
    np.testing.assert_allclose(run.joint_velocity[:, k], dx * v, atol=1e-9)
    np.testing.assert_allclose(run.joint_acceleration[:, k], dx * a + ddx * v**2, atol=1e-8)
    assert run.residual.max() < 1e-10


def test_what_drives_do_not_determine_has_no_acceleration_to_tell():
    parts = [rod(f"r{k}", (k, 0, 0), (k, 1, 0)) for k in range(2)]
    parts += [rod("top", (0, 1, 0), (1, 1, 0)), rod("arm", (3, 0, 0), (4, 0, 0))]
    joints = [
        joint("base", "r0", "revolute", Z, (0, 0, 0)), joint("r0", "top", "revolute", Z, (0, 1, 0)),
        joint("r1", "top", "revolute", Z, (1, 1, 0)), joint("base", "r1", "revolute", Z, (1, 0, 0)),
        joint("arm", "base", "revolute", Z, (3, 0, 0)),
    ]  # fmt: skip
    made = device(parts, joints, drives=[drive("arm~base", "motion", sine(10, 1))], duration=0.2, step=0.1)
    run = simulate(*made, level="kinematic")
    known = np.isfinite(run.joint_acceleration).all(axis=0)
    assert known.tolist() == [name == "arm~base" for name in run.joint_names]


def test_a_pendulum_driven_by_a_sine_takes_the_torque_of_its_equation_of_motion():
    """τ = I q̈ + m g l sin q; its peak, root mean square, power and work."""
    law, mass, arm, own = Sine(0.3, 0.8, 2.0 * np.pi, 0.0), 2.0, 0.4, 0.05
    model = Model()
    model.ground("base")
    model.body("bob", mass, (0, -arm, 0), (own, own, own))
    model.joint("hinge", "base", "bob", axis=(0, 0, 1), point=(0, 0, 0))
    model.motion("drive", "hinge", law)
    run = simulate_system(model.system(), Course(2.0, 0.001, DOWN))
    q, v, a = (np.array([f(t) for t in run.time]) for f in (law.value, law.rate, law.acceleration))
    torque = (own + mass * arm**2) * a + mass * 9.81 * arm * np.sin(q)
    np.testing.assert_allclose(run.joint_effort[:, 0], torque, rtol=0, atol=1e-9 * np.abs(torque).max())
    (use,) = run.drives
    assert (use.joint, use.kind) == ("hinge", "motion")
    assert use.peak == pytest.approx(np.abs(torque).max(), rel=1e-9)
    assert use.rms == pytest.approx(np.sqrt(np.trapezoid(torque**2, run.time) / 2.0), rel=1e-9)
    assert use.peak_power == pytest.approx((torque * v).max(), rel=1e-9)
    # Over whole periods the work comes back to nothing.
    assert abs(use.work) < 1e-6 * np.abs(torque * v).max()


def test_a_motion_of_a_loop_takes_the_power_of_its_energy():
    run = simulate_system(slider_crank(Sine(0.0, 1.0, 2.0, 0.0)), Course(1.0, 0.01, DOWN))
    power = run.joint_effort[:, run.joint_names.index("main")] * run.joint_velocity[:, run.joint_names.index("main")]
    energy = run.energy[:, 0] + run.energy[:, 1]
    np.testing.assert_allclose(np.gradient(energy, run.time)[1:-1], power[1:-1], atol=2e-2 * np.abs(power).max())
    assert run.energy[-1, 2] == pytest.approx(energy[-1] - energy[0], abs=1e-8)


def test_a_table_gives_its_accelerations_at_the_kinematic_level_as_its_lines_have_them():
    model = Model()
    model.ground("base")
    model.body("arm", None, (0, 0, 0), (0, 0, 0))
    model.joint("hinge", "base", "arm", axis=(0, 0, 1), point=(0, 0, 0))
    model.motion("drive", "hinge", Table((0.0, 1.0), (0.0, 2.0)))
    run = simulate_system(model.system(), Course(1.5, 0.25, DOWN, "kinematic"))
    assert run.joint_velocity[:, 0].tolist() == [2.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0]
    assert not run.joint_acceleration.any()


def test_bodies_without_mass_are_driven_without_forces():
    parts = [body("stick", mass=None)]
    made = device(parts, [joint("base", "stick", "revolute", Z, (0, 0, 0))],
                  drives=[drive("base~stick", "motion", sine(10, 1))], duration=0.5, step=0.1)  # fmt: skip
    run = simulate(*made)
    assert run.level != "dynamic"
    expected = -np.radians(10) * (2 * np.pi) ** 2 * np.sin(2 * np.pi * run.time)
    np.testing.assert_allclose(run.joint_acceleration[:, 0], expected, atol=1e-12)
    assert run.not_dynamic == (("stick", "its mass is not known"),)
