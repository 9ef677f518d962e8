"""Reactions in joints: statics by hand, redundancy shared evenly and flagged, balances of whole devices."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import Z, body, device, drive, initial, joint, rod
from support.port_models import DOWN, Model, bricard, four_bars

from kinform.behaviour import Gear, Spring, SpringDamper
from kinform.model.function import Law, Load
from kinform.simulation import Course, simulate, simulate_system


def wrench(run, name, k=0):
    """(6,) on the second body of a joint at an output time."""
    return run.F_B[k, run.joint_names.index(name)]


def test_a_hanging_pendulum_pulls_with_its_weight_and_a_swinging_one_with_more():
    model = Model()
    model.body("bob", 2.0, (0, -0.5, 0), (0.01, 0.01, 0.01))
    model.joint("hinge", "base", "bob")
    still = simulate_system(model.system(), Course(0.1, 0.1, DOWN))
    np.testing.assert_allclose(wrench(still, "hinge"), [0, 0, 0, 0, 2 * 9.81, 0], atol=1e-12)
    swung = simulate_system(model.system(), Course(0.1, 0.1, DOWN), initial={"hinge": (0.0, 3.0)})
    np.testing.assert_allclose(wrench(swung, "hinge"), [0, 0, 0, 0, 2 * (9.81 + 0.5 * 9.0), 0], atol=1e-10)
    np.testing.assert_array_equal(swung.F_A, -swung.F_B)
    assert not swung.undetermined.any()


def test_a_cantilever_passes_force_and_moment_through_a_chain_of_fixed_joints():
    parts = [rod("one", (0, 0, 0), (1, 0, 0), 1.0), rod("two", (1, 0, 0), (2, 0, 0), 1.0)]
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0)), joint("one", "two", "fixed", None, (1, 0, 0))]
    hold = [drive("base~one", "motion", Law("constant", value=0.0))]
    run = simulate(*device(parts, joints, drives=hold, duration=0.1, step=0.1, gravity=DOWN))
    np.testing.assert_allclose(wrench(run, "one~two"), [0, 0, 0.5 * 9.81, 0, 9.81, 0], atol=1e-12)
    np.testing.assert_allclose(wrench(run, "base~one"), [0, 0, 2 * 9.81, 0, 2 * 9.81, 0], atol=1e-12)


def beam(names, order=1.0):
    """A door on two hinges of one line, its weight between them."""
    model = Model()
    model.body("door", 3.0, (0.4, 0, 0.5), (0.2, 0.2, 0.1))
    for name, z in zip(names, (0.0, 1.0), strict=True):
        model.joint(name, "base", "door", point=(0, 0, z))
    return simulate_system(model.system(), Course(0.01, 0.01, np.array([0, 0, -9.81])))


def test_two_hinges_of_a_door_share_its_weight_evenly_whichever_closes_the_loop():
    for names in (("low", "top"), ("b", "a")):
        run = beam(names)
        low, top = (wrench(run, name) for name in names)
        np.testing.assert_allclose(low[3:] + top[3:], [0, 0, 3 * 9.81], atol=1e-10)
        assert low[5] == pytest.approx(top[5], abs=1e-10)
        # Which hinge carries the weight cannot be known: along the line, and the moments across it.
        flags = run.undetermined[run.joint_names.index(names[0])]
        assert flags[5]
        assert run.balance.max() < 1e-12


def test_a_planar_loop_leaves_open_only_what_points_out_of_its_plane():
    run = simulate_system(four_bars(1).system(), Course(0.5, 0.1, DOWN), initial={"foot 0": (0.0, -1.0)})
    assert run.undetermined.tolist() == [[True, True, False, False, False, True]] * 4
    assert run.balance.max() < 1e-9


def test_reactions_do_not_depend_on_the_order_of_joints():
    model = bricard()
    first = simulate_system(model.system(), Course(0.3, 0.1, DOWN))
    ground, *rest = model.components
    model.components = [ground, *reversed(rest)]
    second = simulate_system(model.system(), Course(0.3, 0.1, DOWN))
    order = [second.joint_names.index(name) for name in first.joint_names]
    np.testing.assert_allclose(second.F_B[:, order], first.F_B, atol=1e-7)
    assert (second.undetermined[order] == first.undetermined).all()


def test_reactions_turn_with_the_device():
    turn = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0.0]])
    runs = []
    for R in (np.eye(3), turn):
        model = Model()
        model.body("one", 1.0, R @ [0.5, 0, 0], R @ np.diag([0.01, 0.09, 0.09]) @ R.T)
        model.body("two", 2.0, R @ [1.0, 0.4, 0.1], R @ np.diag([0.05, 0.02, 0.04]) @ R.T)
        model.joint("a", "base", "one", axis=R @ [0, 0, 1])
        model.joint("b", "one", "two", "universal", R @ [0, 1, 0], R @ [1, 0, 0], axis2=R @ [1, 0, 0])
        runs.append(simulate_system(model.system(), Course(0.5, 0.1, R @ DOWN)))
    halves = runs[0].F_B.reshape(-1, 3) @ turn.T
    np.testing.assert_allclose(runs[1].F_B.reshape(-1, 3), halves, atol=1e-7)
    assert max(run.balance.max() for run in runs) < 1e-12


def test_loads_and_springs_between_bodies_are_carried_by_the_joints():
    model = Model()
    model.body("arm", 1.0, (0.5, 0, 0), (0.01, 0.1, 0.1))
    model.joint("hinge", "base", "arm")
    model.add(
        SpringDamper("spring", "spring", np.array([1.0, 1.0, 0]), np.array([1.0, 0, 0]), 50.0, 0.5, 0.9),
        a="body base", b="body arm",
    )  # fmt: skip
    run = simulate_system(model.system(), Course(1.0, 0.1, DOWN))
    assert run.balance.max() < 1e-12
    parts = [body("arm", 1.0, (0.5, 0, 0), [0.01, 0.1, 0.1])]
    push = Load("arm", np.array([0.0, 0, 7.0]), None, np.array([1.0, 0, 0]), "world", "device.toml", 1)
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0))]
    made = device(parts, joints, loads=[push], initial=(initial("arm~base", 0, 60),), duration=0.2, step=0.1)
    run = simulate(*made)
    assert run.balance.max() < 1e-12
    # The force across the plane is the hinge's to hold: on the base, the second body, as it is.
    assert wrench(run, "arm~base")[5] == pytest.approx(7.0 - 9.81, abs=1e-9)


def test_the_balance_of_every_body_and_shaft_is_kept_gears_included():
    model = Model()
    model.rod("one", (0, 0, 0), (1, 0, 0))
    model.rod("two", (2, 0, 0), (3, 0.5, 0))
    model.joint("a", "base", "one")
    model.joint("b", "base", "two", point=(2, 0, 0))
    model.add(Gear("gear", "gear", 3.0), a="shaft a", b="shaft b")
    model.on("a", Spring("spring", "spring", 5.0, 0.2))
    run = simulate_system(model.system(), Course(1.0, 0.1, DOWN))
    assert run.balance_bodies.shape == (11, 3)
    assert run.balance_shafts.shape == run.joint_position.shape
    errors = np.concatenate([run.balance_bodies, np.abs(run.balance_shafts)], axis=1)
    np.testing.assert_array_equal(errors.max(axis=1), run.balance)
    assert 0.0 < run.balance.max() < 1e-11
