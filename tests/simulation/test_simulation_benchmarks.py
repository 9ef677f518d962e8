"""The benchmark mechanisms of the multibody literature, through the port model, at their stated accuracy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from support.port_models import DOWN, SQUEEZER, bricard, four_bars, governor, pendulum, squeezer
from support.squeezer_equations import end

from kinform.behaviour import Constant, EffortDrive, SpringDamper
from kinform.foundation.algebra.spatial import to_matrix
from kinform.simulation import Course, SolverSettings, simulate_system


def place(run, name, point, k=-1):
    """Where a point of a body is at an output time."""
    b = run.body_names.index(name)
    return run.p_WB[k, b] + to_matrix(run.q_WB[k, b]) @ point


def sound(run):
    """The run came to its end, and its monitors are within what every run must keep."""
    assert (run.status, run.reason) == ("done", "")
    total = run.energy @ [1.0, 1.0, -1.0]
    assert np.abs(total - total[0]).max() < 1e-7 * np.ptp(run.energy, axis=0).max()
    assert run.residual.max() < 1e-10
    assert run.balance.max() < 1e-9


def test_a_simple_pendulum_keeps_its_period():
    period = 4 * ellipk(0.5) * np.sqrt(1 / 9.81)
    run = simulate_system(pendulum().system(), Course(4.25 * period, 0.05, DOWN))
    sound(run)
    # At four periods and a quarter it falls through the bottom, where its angle shows an error of time.
    late = (run.joint_position[-1, 0] - np.pi / 2) / run.joint_velocity[-1, 0]
    assert abs(late) / (4.25 * period) < 1e-9


@pytest.mark.parametrize(
    ("count", "end", "within"),
    [(2, (0.328458096, 0.944518543), 1e-6), (10, (0.20435348, 0.97889716), 2e-5)],
)
def test_four_bars_in_a_row_pass_their_collinear_pose(count, end, within):
    run = simulate_system(four_bars(count).system(), Course(10.0, 1.0, DOWN), initial={"foot 0": (0.0, -1.0)})
    sound(run)
    np.testing.assert_allclose(place(run, "r0", [0, 1, 0])[:2], end, atol=within)


@pytest.mark.parametrize("count", [2, 10, pytest.param(40, marks=pytest.mark.slow)])
def test_four_bars_in_a_row_move_as_the_one_freedom_that_they_share(count):
    """All uprights turn alike and the couplers do not turn: a pendulum with the inertia of all of them."""
    course = Course(10.0, 1.0, DOWN)
    run = simulate_system(four_bars(count).system(), course, initial={"foot 0": (0.0, -1.0)})
    sound(run)
    inertia, lever = (count + 1) / 3 + count, (count + 1) / 2 + count

    def falling(t, y):
        return [y[1], -9.81 * lever / inertia * np.cos(y[0])]

    exact = solve_ivp(falling, (0, 10), [np.pi / 2, -1.0], method="DOP853", rtol=1e-13, atol=1e-13, t_eval=run.time)
    columns = [run.joint_offset[run.joint_names.index(f"foot {k}")] for k in range(count + 1)]
    angles = np.pi / 2 + run.joint_position[:, columns]
    np.testing.assert_allclose(angles, np.tile(exact.y[0], (count + 1, 1)).T, atol=1e-7)
    np.testing.assert_allclose(run.joint_velocity[:, columns], np.tile(exact.y[1], (count + 1, 1)).T, atol=1e-6)


def test_andrews_squeezer_agrees_with_its_equations_and_with_the_published_values():
    """Positions, velocities and reactions. The published velocities miss their own constraints by 1e-9 m/s,
    hence the equations themselves as the finer reference, and the published ones within what they can bear."""
    model, fixed, moving = squeezer()
    model.add(SpringDamper("spring", "spring", fixed, moving, 4530.0, 0.0, 0.07785), a="body base", b="body K3")
    model.on("O", EffortDrive("drive", "drive", Constant(0.033)))
    course = Course(0.03, 0.003, np.zeros(3))
    run = simulate_system(model.system(), course, settings=SolverSettings(rtol=1e-12, atol=1e-14))
    sound(run)
    columns = [run.joint_offset[run.joint_names.index(name)] for name in ("O", "F", "B", "G", "A5", "H", "A7")]
    q, v = SQUEEZER + run.joint_position[:, columns], run.joint_velocity[:, columns]
    forces = [run.F_B[:, run.joint_names.index(name), 3:5] for name in ("E3", "E4", "E6")]
    multipliers = np.concatenate(forces, axis=1)
    positions, velocities, reactions = end(SQUEEZER)
    np.testing.assert_allclose(q[-1], positions, rtol=1e-9)
    np.testing.assert_allclose(v[-1], velocities, rtol=1e-9)
    np.testing.assert_allclose(multipliers[-1], reactions, rtol=1e-8)
    published = [
        15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
        0.5244099658805304, 0.5347301163226948, 1.048080741042263,
    ]  # fmt: skip
    np.testing.assert_allclose(q[-1], published, rtol=1e-9)
    rates = [
        1139.920302151208, -1424.379294994111, 11.03291221937134, 19.29337464421385,
        0.5735699284790808, -19.29337464421385, 0.3231791658026955,
    ]  # fmt: skip
    np.testing.assert_allclose(v[-1], rates, atol=1e-9 * 1424.4)
    np.testing.assert_allclose(multipliers[0], [98.5668703962410896, -6.12268834425566266, 0, 0, 0, 0], atol=1e-8)
    late = [
        199.1753333731910, -29.75531228015052, 23.06654119098399,
        31.45271365475927, 22.64249232082739, 11.61740700019673,
    ]  # fmt: skip
    np.testing.assert_allclose(multipliers[-1], late, atol=1e-7 * 199.2)


def test_the_bricard_linkage_agrees_with_two_other_programs():
    run = simulate_system(bricard().system(), Course(10.0, 1.0, DOWN))
    sound(run)
    np.testing.assert_allclose(place(run, "r2", [1, -1, 1]), [0.99999996, -1.00026901, 0.99973095], atol=1e-7)
    assert set(run.rank.tolist()) == {5}


def test_a_stiff_governor_takes_the_implicit_path_and_agrees_with_fine_explicit_steps():
    model, start = governor().system(), {"spin": (0.0, 2 * np.pi)}
    course = Course(3.0, 0.5, DOWN)
    stiff = simulate_system(model, course, initial=start, settings=SolverSettings(method="implicit"))
    sound(stiff)
    fine = simulate_system(model, course, initial=start, settings=SolverSettings(method="explicit"))
    sound(fine)
    assert len(stiff.assumptions) == len(fine.assumptions) + 1
    np.testing.assert_allclose(stiff.joint_position, fine.joint_position, atol=1e-6)
    slider = stiff.joint_position[:, stiff.joint_names.index("slide")]
    assert np.ptp(slider) > 0.01
