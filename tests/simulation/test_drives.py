"""Motors, servos and controllers as components, against closed forms and equations integrated elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.devices import Z, body, device, drive, joint, rod, sine
from support.port_models import Model

from kinform.behaviour import (
    Constant,
    Controller,
    DcMotor,
    EndStop,
    MotionDrive,
    VoltageController,
    VoltageSource,
    count,
)
from kinform.behaviour.signals import Sine
from kinform.model.function import Law
from kinform.simulation import Course, simulate, simulate_system

NO_GRAVITY = np.zeros(3)


def wheel(*components, inertia=0.02):
    """A wheel on an axle along z with these components on its shaft."""
    model = Model()
    model.body("wheel", 1.0, (0, 0, 0), [inertia] * 3)
    model.joint("axle", "base", "wheel")
    for component in components:
        model.on("axle", component, terminals="supply")
    return model.system()


MOTOR = DcMotor("motor", "motor", resistance=2.0, inductance=0.05, constant=0.04, gear=5.0)


@pytest.mark.parametrize("inductance", [0.0, 0.05])
def test_a_dc_motor_runs_up_as_its_linear_equations_say(inductance):
    motor = DcMotor("motor", "motor", 2.0, inductance, 0.04, 5.0)
    run = simulate_system(wheel(motor, VoltageSource("source", "source", Constant(6.0))), Course(1.0, 0.05, NO_GRAVITY))
    k, inertia, t = 0.2, 0.02, run.time
    if inductance:
        A = np.array([[-2.0 / inductance, -k / inductance], [k / inertia, 0.0]])
        steady = np.array([0.0, 6.0 / k])
        values, vectors = np.linalg.eig(A)
        parts = np.linalg.solve(vectors, -steady)
        state = np.real((vectors * parts) @ np.exp(np.outer(values, t))).T + steady
        current, speed = state.T
    else:
        speed = 6.0 / k * (1.0 - np.exp(-k * k / (2.0 * inertia) * t))
        current = (6.0 - k * speed) / 2.0
    np.testing.assert_allclose(run.joint_velocity[:, 0], speed, atol=1e-8)
    np.testing.assert_allclose(run.joint_effort[:, 0], k * current, atol=1e-7)
    total = run.energy @ [1.0, 1.0, -1.0]
    assert np.abs(total).max() < 1e-9
    (use,) = run.drives
    assert (use.joint, use.kind) == ("axle", "dc_motor")
    assert use.peak == pytest.approx(np.abs(k * current).max(), abs=1e-8)


def test_a_voltage_controller_closes_a_loop_around_a_motor_within_its_limit():
    """A mechatronic loop: wheel, gear, motor and PID controller, against the same equations elsewhere."""
    pid, goal = Controller(kp=8.0, ki=3.0, kd=0.4, limit=6.0), Sine(0.0, 0.6, 4.0, 0.3)
    system = wheel(MOTOR, VoltageController("pid", "pid", goal, pid))
    assert count(system).balanced
    run = simulate_system(system, Course(2.0, 0.1, NO_GRAVITY))

    def rates(t, y):
        q, v, i, s = y
        wanted = 8.0 * (goal.value(t) - q) + 3.0 * s + 0.4 * (goal.rate(t) - v)
        voltage = np.clip(wanted, -6.0, 6.0)
        stuck = abs(wanted) > 6.0 and (goal.value(t) - q) * wanted > 0.0
        return [v, 0.2 * i / 0.02, (voltage - 2.0 * i - 0.2 * v) / 0.05, 0.0 if stuck else goal.value(t) - q]

    exact = solve_ivp(rates, (0, 2), np.zeros(4), t_eval=run.time, method="RK45", rtol=1e-9, atol=1e-11, max_step=2e-3)
    np.testing.assert_allclose(run.joint_position[:, 0], exact.y[0], atol=1e-6)
    np.testing.assert_allclose(run.joint_effort[:, 0], 0.2 * exact.y[2], atol=1e-6)
    assert np.ptp(run.joint_position) > 0.5


def test_a_servo_of_the_manifest_pulls_its_joint_to_the_target():
    arm = body("arm", 1.0, (0, 0, 0), [0.03] * 3)
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0))]
    acting = drive("arm~base", "servo", Law("constant", value=30.0), kp=4.0, kd=0.5, ki=2.0, limit=50.0)
    run = simulate(*device([arm], joints, drives=[acting], duration=1.0, step=0.1))
    assert (run.status, run.level) == ("done", "dynamic")
    target = np.radians(30.0)

    def rates(t, y):
        q, v, s = y
        return [v, (4.0 * (target - q) - 0.5 * v + 2.0 * s) / 0.03, target - q]

    exact = solve_ivp(rates, (0, 1), np.zeros(3), t_eval=run.time, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(run.joint_position[:, 0], exact.y[0], atol=1e-7)


def test_a_dc_motor_of_the_manifest_turns_the_designers_way():
    arm = body("arm", 1.0, (0, 0, 0), [0.03] * 3)
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0))]
    acting = drive("arm~base", "dc_motor", resistance=2.0, constant=0.05, gear=10.0, voltage=6.0)
    run = simulate(*device([arm], joints, drives=[acting], duration=3.0, step=0.5))
    assert run.joint_velocity[-1, 0] == pytest.approx(6.0 / 0.5, rel=1e-4)


def test_a_motion_drive_reports_the_torque_that_it_needs():
    """Peak, RMS and power of a prescribed pendulum, from its equation of motion."""
    arm = rod("arm", (0, 0, 0), (1, 0, 0), mass=3.0)
    joints = [joint("base", "arm", "revolute", Z, (0, 0, 0))]
    acting = drive("base~arm", "motion", sine(30, 1.0))
    made = device([arm], joints, drives=[acting], duration=2.0, step=0.002, gravity=np.array([0, -9.81, 0]))
    run = simulate(*made)
    w, t = 2 * np.pi, np.linspace(0, 2, 200001)
    angle = np.radians(30) * np.sin(w * t)
    torque = -w * w * angle + 3.0 * 9.81 * 0.5 * np.cos(angle)
    (use,) = run.drives
    assert (use.joint, use.kind) == ("base~arm", "motion")
    assert use.peak == pytest.approx(np.abs(torque).max(), rel=1e-5)
    assert use.rms == pytest.approx(np.sqrt(np.trapezoid(torque**2, t) / 2), rel=1e-5)
    assert use.peak_power == pytest.approx((torque * np.gradient(angle, t)).max(), rel=1e-4)
    assert use.work == pytest.approx(0.0, abs=1e-4)


def test_a_stiff_motor_agrees_whether_it_is_solved_explicitly_or_implicitly():
    from kinform.simulation import SolverSettings

    fast = DcMotor("motor", "motor", 2.0, 1e-4, 0.04, 5.0)
    system = wheel(fast, VoltageSource("source", "source", Sine(0.0, 6.0, 9.0, 0.0)))
    runs = [
        simulate_system(system, Course(0.5, 0.1, NO_GRAVITY), settings=SolverSettings(method=method))
        for method in ("explicit", "implicit")
    ]
    np.testing.assert_allclose(runs[1].joint_position, runs[0].joint_position, atol=1e-7)
    np.testing.assert_allclose(runs[1].joint_effort, runs[0].joint_effort, atol=1e-6)


def hinged(*components, start=0.0):
    model = Model()
    model.body("bob", 1.0, (1, 0, 0), (0, 0, 0))
    model.joint("hinge", "base", "bob")
    for component in components:
        model.on("hinge", component)
    return simulate_system(model.system(), Course(2.0, 0.01, np.array([0, -9.81, 0])), initial={"hinge": (start, 0.0)})


@pytest.mark.parametrize("limit", [-0.5, -1.0])
def test_a_pendulum_comes_to_rest_on_its_end_stop_at_the_time_of_the_closed_form(limit):
    run = hinged(EndStop("stop", "stop", lower=limit))
    assert run.status == "done"
    angle = run.joint_position[:, 0]
    assert angle.min() > limit - 1e-12
    # Time to fall from rest at 0 to the limit: ∫ dθ / √(2 g sin θ).
    x = np.linspace(0, np.sqrt(-limit), 20001)
    slope = np.divide(2 * x, np.sqrt(2 * 9.81 * np.sin(x * x)), out=np.full_like(x, 2 / np.sqrt(19.62)), where=x > 0)
    struck = np.trapezoid(slope, x)
    first = run.time[np.argmax(np.abs(angle - limit) < 1e-9)]
    assert struck <= first < struck + 0.011
    late = run.time > struck
    np.testing.assert_allclose(angle[late], limit, atol=1e-12)
    # The stop carries the weight, and has taken what the fall had gained.
    np.testing.assert_allclose(run.joint_effort[late, 0], 9.81 * np.cos(limit), rtol=1e-9)
    assert run.energy[-1] == pytest.approx([0.0, 9.81 * np.sin(limit), 9.81 * np.sin(limit)], abs=1e-8)


def test_a_stop_lets_go_when_it_would_have_to_pull():
    """Pressed on its stop by a torque that changes sign, a wheel leaves it when the sign changes."""
    from kinform.behaviour import EffortDrive

    torque = Sine(0.0, -0.5, np.pi, 0.0)
    system = wheel(EndStop("stop", "stop", lower=0.0), EffortDrive("drive", "drive", torque))
    run = simulate_system(system, Course(1.5, 0.05, NO_GRAVITY))
    t = run.time - 1.0
    # After t = 1 s the torque is 0.5 sin(π (t − 1)): integrate twice from rest.
    free = np.where(t > 0, 0.5 / 0.02 * (t / np.pi - np.sin(np.pi * t) / np.pi**2), 0.0)
    np.testing.assert_allclose(run.joint_position[:, 0], free, atol=1e-8)


def test_prescribed_motion_and_motor_power_are_counted_apart():
    system = wheel(MotionDrive("lead", "lead", Sine(0.0, 1.0, 2.0, 0.0)))
    run = simulate_system(system, Course(1.0, 0.01, NO_GRAVITY))
    total = run.energy @ [1.0, 1.0, -1.0]
    assert np.ptp(total) < 1e-10
    assert np.ptp(run.energy[:, 2]) > 0.01
