"""Open chains against closed forms and against equations of motion derived and integrated separately."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from support.devices import Z, body, device, drive, initial, intended, joint, rod, sine

from kinform.foundation.algebra.spatial import to_matrix
from kinform.model.function import Law, Load
from kinform.simulation import simulate

DOWN = np.array([0.0, -9.81, 0.0])


def position(run, name):
    """Values of a joint over time."""
    k = run.joint_names.index(name)
    return run.joint_position[:, run.joint_offset[k] : run.joint_offset[k + 1]]


def velocity(run, name):
    k = run.joint_names.index(name)
    return run.joint_velocity[:, run.joint_offset[k] : run.joint_offset[k + 1]]


def effort(run, name):
    k = run.joint_names.index(name)
    return run.joint_effort[:, run.joint_offset[k]]


def place(run, name, point, k=-1):
    """Where a point of a body is at output k."""
    b = run.body_names.index(name)
    return run.p_WB[k, b] + to_matrix(run.q_WB[k, b]) @ point


def balance(run):
    """Greatest change of kinetic + potential − work."""
    total = run.energy @ [1.0, 1.0, -1.0]
    return np.abs(total - total[0]).max()


def test_a_simple_pendulum_has_its_exact_period():
    period = 4 * ellipk(0.5) * np.sqrt(1 / 9.81)
    assert period == pytest.approx(2.3678420, abs=1e-7)
    bob = body("bob", 1.0, (-1, 0, 0))
    joints = [joint("base", "bob", "revolute", Z, (0, 0, 0))]
    # At four periods and a quarter it falls through the bottom, where its speed shows an error of time.
    run = simulate(*device([bob], joints, duration=4.25 * period, step=0.05, gravity=DOWN))
    assert (run.status, run.level) == ("done", "dynamic")
    angle, speed = position(run, "base~bob")[-1, 0], velocity(run, "base~bob")[-1, 0]
    assert speed == pytest.approx(np.sqrt(2 * 9.81), rel=1e-9)
    assert abs((angle - np.pi / 2) / speed) < 1e-8
    assert balance(run) < 1e-7
    np.testing.assert_allclose(place(run, "bob", [-1, 0, 0]), [0, -1, 0], atol=1e-7)


def test_a_double_pendulum_follows_lagranges_equations():
    m1, m2, l1, l2, g = 1.2, 0.7, 0.9, 0.6, 9.81
    parts = [body("one", m1, (l1, 0, 0)), body("two", m2, (l1 + l2, 0, 0))]
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0)), joint("one", "two", "revolute", Z, (l1, 0, 0))]
    run = simulate(*device(parts, joints, duration=3.0, step=0.1, gravity=DOWN))

    def lagrange(t, y):
        # Angles from the vertical, both absolute: the textbook form.
        a, b, da, db = y
        c, s = np.cos(a - b), np.sin(a - b)
        M = np.array([[(m1 + m2) * l1, m2 * l2 * c], [l1 * c, l2]])
        f = [-m2 * l2 * db**2 * s - (m1 + m2) * g * np.sin(a), l1 * da**2 * s - g * np.sin(b)]
        return [da, db, *np.linalg.solve(M, f)]

    exact = solve_ivp(
        lagrange, (0, 3), [np.pi / 2, np.pi / 2, 0, 0], t_eval=run.time, method="DOP853", rtol=1e-11, atol=1e-12
    )
    ours = np.column_stack([position(run, "base~one"), position(run, "one~two")])
    np.testing.assert_allclose(ours[:, 0], exact.y[0] - np.pi / 2, atol=2e-7)
    np.testing.assert_allclose(ours.sum(axis=1), exact.y[1] - np.pi / 2, atol=2e-7)
    assert balance(run) < 1e-8


def test_a_spherical_pendulum_under_a_side_force_follows_newton():
    mass, length, own = 2.0, 0.5, 0.01
    bob = body("bob", mass, (length, 0, 0), [own] * 3)
    wind = Load("bob", np.array([0.0, 0.0, 5.0]), None, None, "world", "device.toml", 1)
    joints = [joint("base", "bob", "spherical", None, (0, 0, 0))]
    run = simulate(*device([bob], joints, loads=[wind], duration=2.0, step=0.1, gravity=DOWN))
    share = mass * length**2 / (mass * length**2 + own)
    pull = DOWN + np.array([0, 0, 5.0]) / mass

    def newton(t, y):
        r, v = y[:3], y[3:]
        return np.concatenate([v, share * (pull - (pull @ r) * r / length**2) - (v @ v) * r / length**2])

    exact = solve_ivp(newton, (0, 2), [length, 0, 0, 0, 0, 0], t_eval=run.time, method="DOP853", rtol=1e-11, atol=1e-12)
    ours = [place(run, "bob", [length, 0, 0], k) for k in range(len(run.time))]
    np.testing.assert_allclose(ours, exact.y[:3].T, atol=1e-7)
    assert np.ptp(exact.y[2]) > 0.1
    assert balance(run) < 1e-8
    np.testing.assert_allclose(np.linalg.norm(position(run, "base~bob"), axis=1), 1.0, atol=1e-14)
    assert np.all(velocity(run, "base~bob")[:, 0] == 0.0)


def test_a_free_body_in_gimbals_without_mass_keeps_its_angular_momentum():
    inertia = np.diag([1.0, 1.7, 2.3])
    parts = [body("outer", 1e-9), body("inner", 1e-9), body("rotor", 1.0, (0, 0, 0), inertia)]
    joints = [
        joint("base", "outer", "revolute", Z, (0, 0, 0)),
        joint("inner", "outer", "revolute", (1, 0, 0), (0, 0, 0)),
        joint("inner", "rotor", "revolute", (0, 1, 0), (0, 0, 0)),
    ]
    start = [initial("base~outer", 0, 20), initial("inner~outer", 0, 15), initial("inner~rotor", 0, 60)]
    run = simulate(*device(parts, joints, initial=tuple(start), duration=4.0, step=0.1))
    assert run.status == "done"
    names = ("base~outer", "inner~outer", "inner~rotor")
    rates = np.column_stack([velocity(run, name)[:, 0] for name in names])
    momenta = []
    for k in range(len(run.time)):
        R = {n: to_matrix(run.q_WB[k, run.body_names.index(n)]) for n in ("outer", "inner", "rotor")}
        # The joint inner~outer counts the outer ring relative to the inner: its sense is reversed.
        w = rates[k] @ [np.eye(3)[2], -R["outer"][:, 0], R["inner"][:, 1]]
        momenta.append(R["rotor"] @ inertia @ R["rotor"].T @ w)
    np.testing.assert_allclose(momenta, np.broadcast_to(momenta[0], (len(momenta), 3)), atol=1e-8)
    assert np.ptp(rates[:, 2]) > 0.05
    assert balance(run) < 1e-9


def test_a_prescribed_pendulum_needs_the_torque_of_its_equation_of_motion():
    mass, length, own = 0.8, 0.3, 0.02
    bob = body("bob", mass, (length, 0, 0), [own] * 3)
    joints = [joint("base", "bob", "revolute", Z, (0, 0, 0))]
    law = sine(40, 0.7, phase=20, offset=5)
    run = simulate(
        *device([bob], joints, drives=[drive("base~bob", "motion", law)], duration=2.0, step=0.05, gravity=DOWN)
    )
    w, t = 2 * np.pi * 0.7, run.time
    angle = np.radians(5 + 40 * np.sin(w * t + np.radians(20)))
    acceleration = -np.radians(40) * w**2 * np.sin(w * t + np.radians(20))
    np.testing.assert_allclose(position(run, "base~bob")[:, 0], angle, atol=1e-14)
    torque = (own + mass * length**2) * acceleration + mass * 9.81 * length * np.cos(angle)
    np.testing.assert_allclose(effort(run, "base~bob"), torque, rtol=1e-12)
    assert balance(run) < 5e-9


def test_one_driven_and_one_free_joint_are_solved_together():
    """A pendulum hung from a slider that shakes: its own equation in the accelerated frame."""
    mass, length = 0.5, 0.4
    parts = [body("cart", 2.0, (0, 0, 0)), body("bob", mass, (0, -length, 0))]
    joints = [joint("base", "cart", "prismatic", (1, 0, 0), (0, 0, 0)), joint("bob", "cart", "revolute", Z, (0, 0, 0))]
    drives = [drive("base~cart", "motion", sine(0.05, 1.3))]
    run = simulate(*device(parts, joints, drives=drives, duration=3.0, step=0.1, gravity=DOWN))
    w = 2 * np.pi * 1.3

    def swing(t, y):
        shake = -0.05 * w**2 * np.sin(w * t)
        return [y[1], (-9.81 * np.sin(y[0]) - shake * np.cos(y[0])) / length]

    exact = solve_ivp(swing, (0, 3), [0, 0], t_eval=run.time, method="DOP853", rtol=1e-11, atol=1e-12)
    angle = -position(run, "bob~cart")[:, 0]
    np.testing.assert_allclose(angle, exact.y[0], atol=1e-7)
    assert np.ptp(exact.y[0]) > 0.1
    # The force on the slider carries the cart and the horizontal momentum of the bob.
    acceleration = np.array([swing(t, y)[1] for t, y in zip(run.time, exact.y.T, strict=True)])
    shake = -0.05 * w**2 * np.sin(w * run.time)
    pull = 2.5 * shake + mass * length * (np.cos(exact.y[0]) * acceleration - np.sin(exact.y[0]) * exact.y[1] ** 2)
    np.testing.assert_allclose(effort(run, "base~cart"), pull, atol=1e-5)
    assert balance(run) < 1e-9


def test_a_spring_and_a_damper_ring_down_as_the_closed_form_says():
    inertia, stiffness, damping, rest = 0.04, 3.0, 0.1, 30.0
    wheel = body("wheel", 1.0, (0, 0, 0), [inertia] * 3)
    # The designer names the wheel first: spring and damper act alike, the rest position is reversed.
    wanted = [intended("spin", "wheel", "base", "revolute", Z, (0, 0, 0))]
    drives = [drive("spin", "spring", stiffness=stiffness, rest=rest), drive("spin", "damper", damping=damping)]
    joints = [joint("base", "wheel", "revolute", Z, (0, 0, 0))]
    run = simulate(*device([wheel], joints, drives=drives, intended=wanted, duration=3.0, step=0.05))
    decay = damping / (2 * inertia)
    w = np.sqrt(stiffness / inertia - decay**2)
    goal = -np.radians(rest)
    t = run.time
    exact = goal - goal * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    np.testing.assert_allclose(position(run, "base~wheel")[:, 0], exact, atol=1e-9)
    assert run.energy[-1, 2] < -0.1
    assert balance(run) < 1e-10


@pytest.mark.parametrize("times", [(0.0, 0.5, 1.0), (0.2, 0.21, 0.7)])
def test_a_tabulated_torque_accelerates_by_its_integral(times):
    wheel = body("wheel", 1.0, (0, 0, 0), [0.5] * 3)
    law = Law("table", times=times, values=(0.0, 2.0, -1.0))
    joints = [joint("base", "wheel", "revolute", Z, (0, 0, 0))]
    run = simulate(*device([wheel], joints, drives=[drive("base~wheel", "effort", law)], duration=1.5, step=0.1))
    grid = np.unique(np.concatenate([np.linspace(0, 1.5, 30001), times]))
    torque = np.interp(grid, times, law.values)
    impulse = np.concatenate([[0], np.cumsum(0.5 * (torque[1:] + torque[:-1]) * np.diff(grid))])
    np.testing.assert_allclose(velocity(run, "base~wheel")[:, 0], np.interp(run.time, grid, impulse) / 0.5, atol=1e-7)
    np.testing.assert_allclose(effort(run, "base~wheel"), np.interp(run.time, times, law.values), atol=1e-12)
    assert balance(run) < 1e-10


def test_a_finely_tabulated_motion_is_followed_by_a_spline():
    wheel = body("wheel", 1.0, (0, 0, 0), [0.5] * 3)
    times = np.linspace(0.0, 1.0, 41)
    law = Law("table", times=tuple(times), values=tuple(30.0 * (1.0 - np.cos(2 * np.pi * times))))
    joints = [joint("base", "wheel", "revolute", Z, (0, 0, 0))]
    run = simulate(*device([wheel], joints, drives=[drive("base~wheel", "motion", law)], duration=1.0, step=0.05))
    torque = 0.5 * np.radians(30.0) * (2 * np.pi) ** 2 * np.cos(2 * np.pi * run.time)
    np.testing.assert_allclose(effort(run, "base~wheel")[2:-2], torque[2:-2], atol=0.01 * torque.max())


def test_a_dwell_in_a_coarse_table_is_a_dwell_in_the_motion():
    wheel = body("wheel", 1.0, (0, 0, 0), [0.5] * 3)
    law = Law("table", times=(0.0, 0.5, 1.0, 1.5), values=(0.0, 30.0, 30.0, -10.0))
    joints = [joint("base", "wheel", "revolute", Z, (0, 0, 0))]
    run = simulate(*device([wheel], joints, drives=[drive("base~wheel", "motion", law)], duration=1.5, step=0.05))
    values = np.degrees(position(run, "base~wheel")[:, 0])
    np.testing.assert_allclose(values[(run.time > 0.49) & (run.time < 1.01)], 30.0, atol=1e-9)
    assert values.max() < 30.0 + 1e-9
    assert values.min() > -10.0 - 1e-9
    assert balance(run) < 1e-9


def test_a_coarsely_tabulated_motion_is_followed_within_its_rows():
    wheel = body("wheel", 1.0, (0, 0, 0), [0.5] * 3)
    law = Law("table", times=(0.0, 0.5, 1.0), values=(0.0, 30.0, 10.0))
    joints = [joint("base", "wheel", "revolute", Z, (0, 0, 0))]
    run = simulate(*device([wheel], joints, drives=[drive("base~wheel", "motion", law)], duration=1.25, step=0.25))
    np.testing.assert_allclose(np.degrees(position(run, "base~wheel")[[0, 2, 4, 5], 0]), [0, 30, 10, 10], atol=1e-9)
    assert np.isfinite(run.joint_effort).all()
    assert balance(run) < 1e-9


def test_a_load_that_turns_with_its_body_winds_it_up():
    arm = rod("arm", (0, 0, 0), (1, 0, 0), mass=3.0)
    push = Load("arm", np.array([0.0, 2.0, 0.0]), None, np.array([1.0, 0, 0]), "body", "device.toml", 1)
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0))]
    run = simulate(*device([arm], joints, loads=[push], duration=2.0, step=0.5, gravity=np.zeros(3)))
    # Inertia about the hinge is m l²/3 = 1, so the torque of 2 N·m gives 2 rad/s²; the value is base in arm.
    np.testing.assert_allclose(position(run, "arm~base")[:, 0], -(run.time**2), atol=1e-9)
    assert run.energy[-1, 2] == pytest.approx(2.0 * 4.0, rel=1e-9)


def test_the_arm_far_from_the_origin_moves_like_the_one_at_it():
    shift = np.array([3.0, -2.0, 5.0])
    runs = []
    for p in (np.zeros(3), shift):
        parts = [rod("one", p, p + [1, 0, 0]), rod("two", p + [1, 0, 0], p + [1.5, 0.2, 0])]
        joints = [joint("base", "one", "revolute", Z, p), joint("one", "two", "revolute", (0, 1, 0), p + [1, 0, 0])]
        runs.append(simulate(*device(parts, joints, duration=1.0, step=0.1, gravity=np.array([0, -9.81, -3]))))
    np.testing.assert_allclose(runs[1].joint_position, runs[0].joint_position, atol=1e-9)
    for k in range(11):
        tip = place(runs[0], "two", [1.5, 0.2, 0], k)
        np.testing.assert_allclose(place(runs[1], "two", shift + [1.5, 0.2, 0], k), tip + shift, atol=1e-9)


def test_fixed_joints_weld_bodies_and_the_pair_swings_as_one():
    whole = rod("whole", (0, 0, 0), (1, 0, 0), mass=2.0)
    halves = [rod("left", (0, 0, 0), (0.5, 0, 0)), rod("right", (0.5, 0, 0), (1, 0, 0))]
    hinge = {"axis": Z, "point": (0, 0, 0)}
    one = simulate(*device([whole], [joint("base", "whole", "revolute", **hinge)], duration=1.0, gravity=DOWN))
    joints = [joint("base", "left", "revolute", **hinge), joint("left", "right", "fixed")]
    two = simulate(*device(halves, joints, duration=1.0, gravity=DOWN))
    np.testing.assert_allclose(position(two, "base~left"), position(one, "base~whole"), atol=1e-9)
    assert two.joint_offset.tolist() == [0, 1, 1]
    np.testing.assert_allclose(
        two.p_WB[:, two.body_names.index("left")], two.p_WB[:, two.body_names.index("right")], atol=1e-14
    )


def test_a_quaternion_never_changes_sign_over_many_turns():
    wheel = body("wheel", 1.0, (0, 0, 0), [0.5] * 3)
    joints = [joint("base", "wheel", "revolute", Z, (0.2, 0, 0))]
    law = Law("ramp", rate=720.0)
    run = simulate(*device([wheel], joints, drives=[drive("base~wheel", "motion", law)], duration=2.0, step=0.02))
    q = run.q_WB[:, run.body_names.index("wheel")]
    half = 0.5 * position(run, "base~wheel")[:, 0]
    np.testing.assert_allclose(q, np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)]), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(run.q_WB, axis=2), 1.0, atol=1e-14)
