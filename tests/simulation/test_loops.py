"""Closed loops: positions in closed form, efforts from virtual work, and clear ends at singular poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.devices import Z, body, device, drive, initial, joint, rod, sine

from kinform.foundation.algebra.spatial import to_matrix
from kinform.model.function import Law
from kinform.simulation import simulate

X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def value(run, name):
    """Values over time of a joint with one freedom."""
    return run.joint_position[:, run.joint_offset[run.joint_names.index(name)]]


def rate(run, name):
    return run.joint_velocity[:, run.joint_offset[run.joint_names.index(name)]]


def place(run, name, point):
    """Where a point of a body is at the end."""
    b = run.body_names.index(name)
    return run.p_WB[-1, b] + to_matrix(run.q_WB[-1, b]) @ point


def slider_crank(crank=0.1, coupler=0.3, *, drives=(), **request):
    """Stretched out along x at the pose of the meshes: a dead point of the slider."""
    a, b = (crank, 0, 0), (crank + coupler, 0, 0)
    parts = [rod("crank", (0, 0, 0), a, 0.2), rod("link", a, b, 0.5), body("slider", 0.3, b, [1e-4] * 3)]
    joints = [
        joint("base", "crank", "revolute", Z, (0, 0, 0)),
        joint("base", "slider", "prismatic", X, b),
        joint("crank", "link", "revolute", Z, a),
        joint("link", "slider", "revolute", Z, b),
    ]
    return device(parts, joints, drives=drives, **request)


TURNING = (drive("base~crank", "motion", Law("ramp", rate=360.0)),)


@pytest.mark.parametrize("level", ["kinematic", "dynamic"])
def test_a_driven_slider_crank_moves_as_in_closed_form(level):
    run = simulate(*slider_crank(drives=TURNING, duration=1.0, step=0.02), level=level)
    assert (run.status, run.level, run.reason) == ("done", level, "")
    angle = 2 * np.pi * run.time
    root = np.sqrt(0.3**2 - (0.1 * np.sin(angle)) ** 2)
    np.testing.assert_allclose(value(run, "base~slider"), 0.1 * np.cos(angle) + root - 0.4, atol=1e-12)
    speed = -0.1 * np.sin(angle) - 0.1**2 * np.sin(angle) * np.cos(angle) / root
    np.testing.assert_allclose(rate(run, "base~slider"), 2 * np.pi * speed, atol=1e-11)
    # The loop through four planar joints has six conditions of which three are independent.
    assert set(run.rank.tolist()) == {3}
    assert run.residual.max() < 1e-12


def test_the_torque_that_drives_a_slider_crank_does_the_work_on_its_slider():
    """With all other masses on the crank's axis and pin, the torque is that of virtual work."""
    a, b, mass = (0.1, 0, 0), (0.4, 0, 0), 0.7
    parts = [body("crank", 1.0, (0, 0, 0), [0.1] * 3), body("link", 0.2, a), body("slider", mass, b)]
    joints = [
        joint("base", "crank", "revolute", Z, (0, 0, 0)),
        joint("base", "slider", "prismatic", X, b),
        joint("crank", "link", "revolute", Z, a),
        joint("link", "slider", "revolute", Z, b),
    ]
    run = simulate(*device(parts, joints, drives=TURNING, duration=1.0, step=0.04))
    assert (run.status, run.level) == ("done", "dynamic")
    w, t = 2 * np.pi, run.time
    s, c = np.sin(w * t), np.cos(w * t)
    root = np.sqrt(0.09 - 0.01 * s**2)
    lever = -0.1 * s - 0.01 * s * c / root
    curve = -0.1 * c - 0.01 * (c**2 - s**2) / root - 0.0001 * s**2 * c**2 / root**3
    torque = mass * w**2 * curve * lever
    effort = run.joint_effort[:, run.joint_offset[run.joint_names.index("base~crank")]]
    np.testing.assert_allclose(effort, torque, atol=1e-9)
    assert np.ptp(torque) > 0.1
    total = run.energy @ [1.0, 1.0, -1.0]
    np.testing.assert_allclose(total, total[0], atol=1e-10)


def four_bar(**request):
    """Grashof crank and rocker, all hinges about z: overconstrained in space."""
    lengths = ground, crank, coupler, rocker = 0.4, 0.1, 0.35, 0.3
    start = np.radians(70.0)
    a = crank * np.array([np.cos(start), np.sin(start), 0])
    base = np.array([ground, 0, 0])
    gap = a - base
    reach = np.linalg.norm(gap)
    corner = np.arccos((rocker**2 + reach**2 - coupler**2) / (2 * rocker * reach))
    turn = np.arctan2(gap[1], gap[0]) - corner
    b = base + rocker * np.array([np.cos(turn), np.sin(turn), 0])
    parts = [rod("a_crank", (0, 0, 0), a), rod("b_coupler", a, b), rod("c_rocker", base, b)]
    joints = [
        joint("a_crank", "b_coupler", "revolute", Z, a),
        joint("a_crank", "base", "revolute", Z, (0, 0, 0)),
        joint("b_coupler", "c_rocker", "revolute", Z, b),
        joint("base", "c_rocker", "revolute", Z, base),
    ]
    return device(parts, joints, **request), lengths, (start, turn)


def test_a_four_bar_obeys_freudensteins_equation_and_returns_after_a_turn():
    drives = [drive("a_crank~base", "motion", Law("ramp", rate=-360.0))]
    made, (ground, crank, coupler, rocker), (start, turn) = four_bar(drives=drives, duration=1.0, step=0.01)
    run = simulate(*made, level="kinematic")
    assert run.status == "done"
    phi = start - value(run, "a_crank~base")
    psi = turn + value(run, "base~c_rocker")
    k1, k2 = ground / crank, ground / rocker
    k3 = (ground**2 + crank**2 - coupler**2 + rocker**2) / (2 * crank * rocker)
    left = k1 * np.cos(psi) - k2 * np.cos(phi) + k3
    np.testing.assert_allclose(left, np.cos(phi - psi), atol=1e-11)
    assert np.ptp(psi) > 0.5
    assert value(run, "base~c_rocker")[-1] == pytest.approx(0.0, abs=1e-10)
    assert set(run.rank.tolist()) == {3}


def test_a_four_bar_swings_with_its_energy_kept():
    made, *_ = four_bar(duration=2.0, step=0.1, gravity=np.array([0, -9.81, 0]))
    run = simulate(*made)
    assert (run.status, run.level) == ("done", "dynamic")
    total = run.energy @ [1.0, 1.0, -1.0]
    assert np.abs(total - total[0]).max() < 1e-8 * np.ptp(run.energy[:, 0])
    assert run.residual.max() < 1e-11


def test_the_rectangular_bricard_linkage_agrees_with_the_benchmark():
    """Six hinges in space that Grübler's count leaves no freedom; position after 10 s from the literature
    problem as computed by two other programs."""
    points = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1.0)])
    names = ["base", "r0", "r1", "r2", "r3", "r4", "base"]
    parts = []
    for k in range(5):
        along = points[k + 1] - points[k]
        share = np.outer(along, along)
        tensor = share / 600 + (np.eye(3) - share) * 1.01 / 12
        parts.append(body(names[k + 1], 1.0, (points[k] + points[k + 1]) / 2, tensor))
    axes = [Y, Z, X, Y, Z, X]
    joints = [joint(*sorted(names[k : k + 2]), "revolute", axes[k], points[k]) for k in range(6)]
    run = simulate(*device(parts, joints, duration=10.0, step=1.0, gravity=np.array([0, -9.81, 0])))
    assert run.status == "done"
    assert set(run.rank.tolist()) == {5}
    np.testing.assert_allclose(place(run, "r2", points[3]), [0.99999996, -1.00026901, 0.99973095], atol=2e-8)


def test_two_four_bars_in_a_row_pass_their_collinear_pose_as_the_benchmark_does():
    """N-four-bar, N = 2: published runs converge to this position; it passes singular poses on the way."""
    parts, joints = [], []
    for k in range(3):
        parts.append(rod(f"r{k}", (k, 0, 0), (k, 1, 0)))
        joints.append(joint("base", f"r{k}", "revolute", Z, (k, 0, 0)))
    for k in range(2):
        parts.append(rod(f"s{k}", (k, 1, 0), (k + 1, 1, 0)))
        joints.append(joint(f"r{k}", f"s{k}", "revolute", Z, (k, 1, 0)))
        joints.append(joint(f"r{k + 1}", f"s{k}", "revolute", Z, (k + 1, 1, 0)))
    start = (initial("base~r0", 0, -np.degrees(1.0)),)
    made = device(parts, joints, initial=start, duration=10.0, step=2.0, gravity=np.array([0, -9.81, 0]))
    run = simulate(*made)
    assert run.status == "done"
    assert run.energy[0, 0] == pytest.approx(1.5, rel=1e-12)
    np.testing.assert_allclose(place(run, "r0", [0, 1, 0])[:2], [0.32845810, 0.94451854], atol=1e-6)


def test_a_position_that_is_solved_for_is_where_the_loop_puts_it():
    """The crank at 60°, the slider thrown along: x = r cos θ + √(l² − r² sin² θ), and the crank's rate from dx/dθ."""
    r, rod_length, angle = 0.1, 0.3, np.radians(60.0)
    solved = replace(initial("base~slider", 0.0, 0.2), solved=True)
    made = slider_crank(r, rod_length, initial=(initial("base~crank", 60.0), solved), duration=0.02, step=0.01,
                        gravity=np.zeros(3))  # fmt: skip
    run = simulate(*made)
    assert run.status == "done", run.reason
    at = {name: k for k, name in enumerate(run.joint_names)}
    root = np.sqrt(rod_length**2 - (r * np.sin(angle)) ** 2)
    moved = r * np.cos(angle) + root - (r + rod_length)
    slope = -r * np.sin(angle) * (1.0 + r * np.cos(angle) / root)
    assert abs(run.joint_position[0, at["base~slider"]]) == pytest.approx(-moved, rel=1e-9)
    assert abs(run.joint_velocity[0, at["base~crank"]]) == pytest.approx(0.2 / abs(slope), rel=1e-9)
    assert any("base~slider" in note for note in run.assumptions)


def test_a_crank_that_cannot_turn_through_stops_with_its_time_and_reason():
    """A crank longer than the coupler locks where it stands across: sin φ = 0.2 / 0.3."""
    made = slider_crank(0.3, 0.2, drives=TURNING, duration=1.0, step=0.01, level="kinematic")
    run = simulate(*made)
    dead = np.arcsin(0.2 / 0.3) / (2 * np.pi)
    assert run.status == "stopped"
    assert dead - 0.011 < run.time[-1] <= dead
    assert "base~crank" in run.reason
    assert len(run.p_WB) == len(run.time) == len(run.joint_position)


def test_a_slider_stops_at_its_dead_point_instead_of_choosing_a_side():
    """Driven outwards from a crank at 60°, the slider stretches the linkage and can go no further."""
    start = (initial("base~crank", 60.0),)
    there = 0.1 * 0.5 + np.sqrt(0.09 - 0.01 * 0.75) - 0.4
    first = simulate(*slider_crank(initial=start, duration=0.1, step=0.1, level="kinematic"))
    assert value(first, "base~slider")[-1] == pytest.approx(there, abs=1e-12)
    made = slider_crank_at_sixty(drives=[drive("base~slider", "motion", Law("ramp", rate=0.1))], duration=2.0)
    run = simulate(*made)
    assert run.status == "stopped"
    assert run.time[-1] == pytest.approx(-there / 0.1, abs=0.011)
    assert "base~slider" in run.reason


def slider_crank_at_sixty(**request):
    """The slider-crank with its meshes in another pose."""
    a = 0.1 * np.array([0.5, np.sqrt(0.75), 0])
    b = np.array([a[0] + np.sqrt(0.09 - a[1] ** 2), 0, 0])
    parts = [rod("crank", (0, 0, 0), a), rod("link", a, b), body("slider", 0.3, b, [1e-4] * 3)]
    joints = [
        joint("base", "crank", "revolute", Z, (0, 0, 0)),
        joint("base", "slider", "prismatic", X, b),
        joint("crank", "link", "revolute", Z, a),
        joint("link", "slider", "revolute", Z, b),
    ]
    return device(parts, joints, level="kinematic", **request)


def test_a_change_point_is_a_stop_not_a_guess():
    """A parallelogram may fold into an antiparallelogram where its bars are in line."""
    parts = [rod("a", (0, 0, 0), (0, 1, 0)), rod("b", (0, 1, 0), (2, 1, 0)), rod("c", (2, 0, 0), (2, 1, 0))]
    joints = [
        joint("a", "b", "revolute", Z, (0, 1, 0)),
        joint("a", "base", "revolute", Z, (0, 0, 0)),
        joint("b", "c", "revolute", Z, (2, 1, 0)),
        joint("base", "c", "revolute", Z, (2, 0, 0)),
    ]
    drives = [drive("a~base", "motion", Law("ramp", rate=100.0))]
    run = simulate(*device(parts, joints, drives=drives, duration=3.0, step=0.07, level="kinematic"))
    assert run.status == "stopped"
    assert 0.9 - 0.071 < run.time[-1] <= 0.9
    np.testing.assert_allclose(value(run, "base~c"), -value(run, "a~base"), atol=1e-10)


def test_two_drives_on_one_freedom_are_refused():
    drives = (*TURNING, drive("crank~link", "motion", sine(10, 1)))
    run = simulate(*slider_crank(drives=drives, duration=1.0))
    assert run.status == "refused"
    assert run.failures


def test_a_loop_without_drive_rests_in_kinematics_and_says_so():
    made, *_ = four_bar(duration=0.2, step=0.1)
    run = simulate(*made, level="kinematic")
    assert run.status == "done"
    assert np.abs(run.p_WB).max() == 0.0


def test_a_loop_starts_at_the_stated_position_on_its_own_branch():
    made, (ground, crank, coupler, rocker), (start, turn) = four_bar(
        initial=(initial("base~c_rocker", 10.0),), duration=0.1, step=0.1
    )
    run = simulate(*made, level="kinematic")
    phi, psi = start - value(run, "a_crank~base")[0], turn + np.radians(10.0)
    assert value(run, "base~c_rocker")[0] == pytest.approx(np.radians(10.0), abs=1e-14)
    pin_a = crank * np.array([np.cos(phi), np.sin(phi)])
    pin_b = np.array([ground, 0]) + rocker * np.array([np.cos(psi), np.sin(psi)])
    assert np.linalg.norm(pin_a - pin_b) == pytest.approx(coupler, abs=1e-12)
    assert np.array_equal(run.p_WB[:, run.body_names.index("base")], np.zeros((2, 3)))


def test_a_loop_with_universal_and_spherical_joints_stays_closed_and_keeps_its_energy():
    """Two rods in series hang from the ground by a universal joint and a ball: one freedom."""
    p, m, e = np.array([0, 0, 0.0]), np.array([0.4, 0.1, -0.3]), np.array([0.8, 0, 0.1])
    ball = body("one", 0.5, 0.5 * (p + m), [2e-3, 3e-3, 4e-3])
    other = body("two", 0.4, 0.5 * (m + e), [3e-3, 2e-3, 4e-3])
    joints = [
        joint("base", "one", "universal", X, p, axis2=Y),
        joint("base", "two", "spherical", None, e),
        joint("one", "two", "universal", Y, m, axis2=Z),
    ]
    run = simulate(*device([ball, other], joints, duration=1.0, step=0.05))
    assert (run.status, run.level) == ("done", "dynamic")
    total = run.energy @ [1.0, 1.0, -1.0]
    assert np.ptp(run.energy[:, 0]) > 0.01
    assert np.abs(total - total[0]).max() < 1e-9
    assert run.residual.max() < 1e-11
