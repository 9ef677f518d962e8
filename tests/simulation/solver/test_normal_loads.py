"""Friction of bearings on which meshing teeth press, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.behaviour import Constant, Model, Rubs, Sine
from kinform.simulation import Course, simulate_system

A, B = 0.3, 0.5
"""kg·m² of the wheels."""
RADII, JOURNALS = (0.125, 0.375), (0.02, 0.05)
PRESSURE, MU = 0.35, 0.2
NONE, SPIN = np.zeros(3), (0.0, 0.0, 1.0)


def _pair(at_a, at_b, *, mu=MU, static=None, efficiency=1.0, until=0.5, step=0.05):
    """Two wheels that mesh, each on a journal that the force between the teeth presses."""
    model = Model()
    model.ground("ground")
    for name, x, inertia, radius in (("a", 0.0, A, JOURNALS[0]), ("b", sum(RADII), B, JOURNALS[1])):
        model.body(name.upper(), 1.0, (x, 0, 0), (1, 1, inertia))
        model.joint(name, "ground", name.upper(), "revolute", point=(x, 0, 0), axis=SPIN)
        model.friction(f"rub {name}", name, mu, static=static, surfaces=Rubs(radius=radius))
    flanks = [(np.sin(PRESSURE), way * np.cos(PRESSURE), 0.0) for way in (1.0, -1.0)]
    ratio = -RADII[1] / RADII[0]
    model.gear("gear", "a", "b", ratio, pitch_point=(RADII[0], 0, 0), flanks=flanks, efficiency=efficiency)
    for joint, effort in (("a", at_a), ("b", at_b)):
        model.effort(f"effort {joint}", joint, effort)
    return simulate_system(model.system(), Course(until, step, NONE))


def _sound(run):
    assert run.status == "done", run.reason
    assert np.ptp(run.energy @ [1.0, 1.0, -1.0]) < 1e-9
    assert run.balance.max() < 1e-9


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_force_between_the_teeth_brakes_both_bearings(way):
    """F (r_b cos α - μ ρ_b) = I_b α_b + L,  I_a α_a = T - F (r_a cos α + μ ρ_a)."""
    torque, load = 2.0, 1.5
    run = _pair(Constant(way * torque), Constant(way * load), until=0.2)
    _sound(run)
    lever = np.cos(PRESSURE)
    share = (RADII[0] * lever + MU * JOURNALS[0]) / (RADII[1] * lever - MU * JOURNALS[1])
    slow = RADII[0] / RADII[1]
    rate = (torque - load * share) / (A + B * slow * share)
    np.testing.assert_allclose(run.joint_velocity[:, 0], way * rate * run.time, rtol=1e-9)
    force = (B * slow * rate + load) / (RADII[1] * lever - MU * JOURNALS[1])
    np.testing.assert_allclose(run.gear_force[:, 0], force, rtol=1e-9)
    braked = np.broadcast_to(MU * force * np.array(JOURNALS), (len(run.time) - 1, 2))
    np.testing.assert_allclose(np.abs(run.friction_effort[1:]), braked, rtol=1e-9)


def test_at_rest_it_holds_what_the_bearings_take():
    """T between those at which it begins to move one way and the other."""
    load, lever, static = 1.5, np.cos(PRESSURE), 0.25
    for way in (1.0, -1.0):
        limit = load * (RADII[0] * lever + way * static * JOURNALS[0]) / (RADII[1] * lever - way * static * JOURNALS[1])
        held = _pair(Constant(limit * (1.0 - way * 1e-6)), Constant(load), static=static, until=0.05)
        assert held.status == "done", held.reason
        assert np.all(held.joint_position == 0.0)
        moved = _pair(Constant(limit * (1.0 + way * 1e-6)), Constant(load), static=static, until=0.05)
        _sound(moved)
        assert way * moved.joint_position[-1, 0] > 0.0


def _swung(way):
    """A drive that swings against a load, with signs turned round for −1."""
    return _pair(Sine(0.0, 4.0 * way, 24.0, -0.5), Constant(0.1 * way), until=0.16, step=0.02)


def test_teeth_that_change_sides_press_on():
    run = _swung(1.0)
    _sound(run)
    assert (np.diff(np.sign(run.gear_effort[:, 0, 0])) != 0).sum() >= 2


@pytest.mark.sweep
def test_teeth_that_change_sides_press_on_alike_with_signs_turned_round():
    np.testing.assert_allclose(_swung(1.0).joint_position, -_swung(-1.0).joint_position, atol=1e-9)


def test_a_lossy_gear_on_such_bearings_loses_both():
    """In slow motion: what the teeth lose comes on top."""
    torque = 2.0
    lever = np.cos(PRESSURE)
    run = _pair(Constant(torque), Constant(0.0), efficiency=0.9, until=0.2)
    _sound(run)
    share = (RADII[0] * lever / 0.9 + MU * JOURNALS[0]) / (RADII[1] * lever - MU * JOURNALS[1])
    rate = torque / (A + B * RADII[0] / RADII[1] * share)
    np.testing.assert_allclose(run.joint_velocity[:, 0], rate * run.time, rtol=1e-9)
