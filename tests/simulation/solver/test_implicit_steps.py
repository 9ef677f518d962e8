"""Springs that vibrate too fast to be followed: what is left is the slow motion, and what went is said."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.port_models import DOWN, four_bars, pendulum

from kinform.behaviour import Constant, Model, Spring, Table
from kinform.simulation import Course, SolverSettings, simulate_system

MASS, LENGTH, STIFF = 1.5, 0.8, 4e9
NONE = np.zeros(3)
FEW = SolverSettings(steps=20_000)


def _on_a_spring(stiffness=STIFF, law=None):
    model = Model()
    model.ground("ground")
    model.body("block", MASS, (0, 0, 0), (0.01, 0.01, 0.01))
    model.joint("slide", "ground", "block", "prismatic", axis=(1, 0, 0))
    model.spring("spring", "slide", stiffness=stiffness)
    if law is not None:
        model.effort("push", "slide", law)
    return model.system()


def _pendulum(stiffness):
    """A point mass on an arm that a spring along it holds at its length, swinging in the plane of x and z."""
    model = Model()
    model.ground("ground")
    model.body("arm", 1e-3, (0, 0, 0), (1e-7, 1e-7, 1e-7))
    model.body("bob", MASS, (LENGTH, 0, 0), (1e-9, 1e-9, 1e-9))
    model.joint("hinge", "ground", "arm", "revolute", point=(0, 0, 0), axis=(0, 1, 0))
    model.joint("along", "arm", "bob", "prismatic", axis=(1, 0, 0))
    model.spring("spring", "along", stiffness=stiffness)
    return model.system()


def _drift(run):
    total = run.energy @ np.array([1.0, 1.0, -1.0])
    return float(np.abs(total - total[0]).max())


def test_a_block_on_a_stiff_spring_comes_to_rest_where_the_spring_holds_it():
    push = 6e5
    run = simulate_system(_on_a_spring(law=Constant(push)), Course(2.0, 0.1, NONE), initial={"slide": (3e-3, 0.0)})
    assert run.status == "done"
    rest = push / STIFF
    np.testing.assert_allclose(run.joint_position[1:, 0], rest, rtol=1e-8)
    (damping,) = run.dampings
    assert damping.frequency == pytest.approx(np.sqrt(STIFF / MASS) / (2 * np.pi), rel=1e-5)
    # All that was in the vibration: ½ k of what it was stretched from where it rests.
    assert run.damped == pytest.approx(0.5 * STIFF * (3e-3 - rest) ** 2, rel=1e-6)
    assert _drift(run) < 1e-8 * run.damped


def test_a_pendulum_on_a_stiff_spring_swings_as_a_rigid_one():
    run = simulate_system(_pendulum(STIFF), Course(3.0, 0.1), initial={"hinge": (0.4, 0.0)})
    rigid = solve_ivp(
        lambda t, y: [y[1], (MASS * 9.81 * LENGTH * np.cos(y[0])) / (MASS * LENGTH**2 + 1e-7 + 1e-9)],
        (0, 3.0), [0.4, 0.0], "DOP853", run.time, rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    assert run.status == "done" and run.dampings
    np.testing.assert_allclose(run.joint_position[:, 0], rigid.y[0], atol=2e-6)
    # The spring holds the weight and what turns the mass: its stretch is a few nanometres.
    pull = MASS * (9.81 * np.sin(rigid.y[0]) + LENGTH * rigid.y[1] ** 2)
    np.testing.assert_allclose(run.joint_position[2:, 1], pull[2:] / STIFF, atol=2e-12)
    assert run.damped_share < 1e-6


def test_softer_springs_come_to_the_same_slow_motion():
    """The distance from the rigid pendulum falls with the stretch, that is with one over the stiffness."""
    courses = [simulate_system(_pendulum(k), Course(1.0, 0.1), settings=FEW) for k in (4e7, 4e8, 4e9)]
    assert all(run.dampings for run in courses)
    ends = [run.joint_position[-1, 0] for run in courses]
    assert abs(ends[0] - ends[1]) < 1e-4 and abs(ends[1] - ends[2]) < 0.2 * abs(ends[0] - ends[1])


def test_what_can_be_followed_is_followed():
    stretch, stiffness = 1e-3, 1e5
    run = simulate_system(_on_a_spring(stiffness), Course(1.0, 0.05, NONE), initial={"slide": (stretch, 0.0)})
    assert run.status == "done" and not run.dampings
    np.testing.assert_allclose(
        run.joint_position[:, 0], stretch * np.cos(np.sqrt(stiffness / MASS) * run.time), atol=1e-8
    )


def test_a_vibration_that_outputs_show_is_not_taken_away():
    fine = 0.2 * np.pi / np.sqrt(STIFF / MASS)
    settings = SolverSettings(steps=500)
    run = simulate_system(
        _on_a_spring(), Course(400 * fine, fine, NONE), initial={"slide": (1e-3, 0.0)}, settings=settings
    )
    assert run.status == "stopped" and not run.dampings


def test_an_explicit_run_is_never_damped():
    settings = SolverSettings(method="explicit", steps=2000)
    run = simulate_system(_on_a_spring(), Course(1.0, 0.1, NONE), initial={"slide": (1e-3, 0.0)}, settings=settings)
    assert run.status == "stopped" and not run.dampings


def test_what_merely_turns_fast_is_no_vibration():
    """Two bars in a row, whirling at 3000 rad/s: the steps are as short, and nothing of it may be damped."""
    model = Model()
    model.ground("ground")
    model.body("inner", 1.0, (0.5, 0, 0), (0.001, 0.08, 0.08))
    model.body("outer", 1.0, (1.5, 0, 0), (0.001, 0.08, 0.08))
    model.joint("first", "ground", "inner", "revolute", point=(0, 0, 0), axis=(0, 1, 0))
    model.joint("second", "inner", "outer", "revolute", point=(1, 0, 0), axis=(0, 1, 0))
    settings = SolverSettings(steps=5000)
    run = simulate_system(
        model.system(), Course(0.5, 0.05), initial={"first": (0.0, 3000.0), "second": (0.3, 500.0)}, settings=settings
    )
    assert run.status == "stopped" and not run.dampings


def test_a_pendulum_is_no_vibration_of_a_spring():
    """It swings by gravity: with outputs too far apart to show it, and too few steps, it is not damped either."""
    course, settings = Course(400.0, 10.0, DOWN), SolverSettings(steps=1500)
    run = simulate_system(pendulum().system(), course, settings=settings)
    assert run.status == "stopped" and not run.dampings


def test_what_turns_as_fast_as_a_spring_vibrates_ends_the_run():
    """A block on a spring on an arm that whirls at a tenth of its frequency: no slow motion is left of it."""
    model = Model()
    model.ground("ground")
    model.body("arm", 1.0, (0, 0, 0), (0.1, 0.1, 0.1))
    model.body("block", MASS, (LENGTH, 0, 0), (1e-3, 1e-3, 1e-3))
    model.joint("hinge", "ground", "arm", "revolute", point=(0, 0, 0), axis=(0, 1, 0))
    model.joint("along", "arm", "block", "prismatic", axis=(1, 0, 0))
    model.spring("spring", "along", stiffness=1e6)
    pace = 0.1 * np.sqrt(1e6 / MASS)
    start = {"hinge": (0.0, pace), "along": (1e-3, 0.0)}
    run = simulate_system(model.system(), Course(50.0, 5.0, NONE), initial=start, settings=SolverSettings(steps=2000))
    assert run.status == "stopped" and run.time[-1] < 50.0


def test_a_push_that_shakes_it_again_is_damped_again():
    law = Table((0.0, 0.5, 0.5 + 1e-6, 2.0), (0.0, 0.0, 6e5, 6e5))
    run = simulate_system(_on_a_spring(law=law), Course(2.0, 0.1, NONE), initial={"slide": (1e-3, 0.0)})
    assert run.status == "done" and len(run.dampings) >= 2
    np.testing.assert_allclose(run.joint_position[-1, 0], 6e5 / STIFF, rtol=1e-8)
    assert _drift(run) < 1e-6 * run.damped


def test_loops_stay_closed_and_rest_where_statics_has_them():
    """A parallelogram of rods on a stiff spring at one foot: k (θ - rest) = 2 m g sin θ."""
    bars, stiffness, rest = four_bars(1), 2e8, 0.3
    bars.on("foot 0", Spring("hold", "hold", stiffness, rest))
    run = simulate_system(bars.system(), Course(3.0, 0.2, DOWN), initial={"foot 0": (rest + 0.05, 0.0)})
    assert run.status == "done" and run.dampings
    angle = run.joint_position[-1, run.joint_names.index("foot 0")]
    assert angle - rest == pytest.approx(2.0 * 9.81 * np.sin(rest) / stiffness, rel=1e-4)
    assert run.residual.max() < 1e-12 and run.balance.max() < 1e-6
    assert _drift(run) < 1e-7 * run.damped
