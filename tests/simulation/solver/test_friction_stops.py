"""Friction and end stops in one run: impacts, rest, release, against closed forms and runs without friction."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import first

from kinform.behaviour import Constant, Model, Ramp
from kinform.simulation import Course, simulate_system

NONE, DOWN = np.zeros(3), np.array([0.0, 0.0, -9.81])
MASS, RUB, SPEED = 2.0, 3.0, 2.0


def _slide(end, *, rub=RUB, static=None, rebound=0.0, drive=None, start=(0.0, 0.0), until=2.0, **friction):
    """A block on a slide with friction, whose stops are at ± end."""
    model = Model()
    model.ground("ground")
    model.body("block", MASS, (0, 0, 0), (1, 1, 1))
    model.joint("slide", "ground", "block", "prismatic", axis=(1, 0, 0), point=(0, 0, 0))
    model.friction("rub", "slide", effort=rub, static_effort=static, **friction)
    model.stop("ends", "slide", -end, end, rebound)
    if drive is not None:
        model.effort("drive", "slide", drive)
    course = Course(until, 0.02, DOWN if friction else NONE)
    return simulate_system(model.system(), course, initial={"slide": start})


def _sound(run):
    assert run.status == "done", run.reason
    exchanged = max(np.ptp(run.energy, axis=0).max(), 1e-3)
    assert np.abs(run.energy @ [1.0, 1.0, -1.0] - run.energy[0] @ [1.0, 1.0, -1.0]).max() < 1e-8 * exchanged
    assert run.balance.max() < 1e-9


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_block_bounces_and_slides_to_rest(way):
    """v₁² = v₀² - 2 a s, back with e v₁, to rest (e v₁)² / 2a from the stop."""
    a, end, e = RUB / MASS, 0.5, 0.6
    run = _slide(end, rebound=e, start=(0.0, way * SPEED))
    _sound(run)
    hit = np.sqrt(SPEED**2 - 2.0 * a * end)
    t1 = (SPEED - hit) / a
    back = np.clip(run.time - t1, 0.0, e * hit / a)
    there = np.minimum(run.time, t1)
    exact = SPEED * there - 0.5 * a * there**2 - (e * hit * back - 0.5 * a * back**2)
    np.testing.assert_allclose(run.joint_position[:, 0], way * exact, atol=1e-9)
    assert run.friction_sticks[-1].all()
    stop = next(use for use in run.drives if use.kind == "stop")
    assert stop.work == pytest.approx(-0.5 * MASS * hit**2 * (1.0 - e**2), rel=1e-9)


def test_a_block_pressed_on_its_stop_leaves_when_friction_no_longer_holds_it():
    """A drive 8 - 10 t N, stop at 0.2 m: rests there until the pull is the friction at rest, then with the other."""
    static, end = 4.0, 0.2
    run = _slide(end, static=static, drive=Ramp(8.0, -10.0), until=1.8)
    _sound(run)
    free = (8.0 + static) / 10.0
    resting = (run.time > 1.0) & (run.time <= free)
    assert np.all(run.joint_position[resting, 0] == end)
    on = run.time[run.time > free] - free
    # m a = (f_s - f) + 10 (t - t₀) backwards
    exact = end - ((static - RUB) * on**2 / 2.0 + 10.0 * on**3 / 6.0) / MASS
    np.testing.assert_allclose(run.joint_position[run.time > free, 0], exact, atol=1e-9)
    # what presses beyond friction is the stop's
    names = [use.kind for use in run.drives]
    stop, rub = (run.drive_effort[:, names.index(kind)] for kind in ("stop", "friction"))
    pull = 8.0 - 10.0 * run.time
    np.testing.assert_allclose((stop + rub)[resting], -pull[resting], atol=1e-9)
    assert np.all(stop[resting] <= 1e-12)
    assert np.all(np.abs(rub[resting]) <= static + 1e-12)


def test_it_starts_at_a_stop_and_is_pressed_on_it():
    run = _slide(0.2, drive=Constant(50.0), start=(0.2, 0.0), until=0.2)
    _sound(run)
    assert np.all(run.joint_position == 0.2)


def test_friction_by_load_runs_until_it_strikes():
    """What friction does in an impact is not known: before one it plays no part."""
    run = _slide(5.0, rub=0.0, coefficient=0.1, start=(0.0, SPEED), until=1.0)
    assert run.status == "done", run.reason
    run = _slide(0.5, rub=0.0, coefficient=0.1, start=(0.0, SPEED), until=1.0)
    assert run.status == "stopped"
    hit = (SPEED - np.sqrt(SPEED**2 - 0.981)) / 0.981
    assert hit - 0.02 < run.time[-1] <= hit


def _arm(friction, *, first=True, second=True, rebound=0.3, until=1.5):
    """A double pendulum whose joints have stops, let go from the side."""
    model = Model()
    model.ground("ground")
    model.body("upper", 1.0, (0.5, 0, 0), (0.0, 0.1, 0.1))
    model.body("lower", 0.7, (1.4, 0, 0), (0.0, 0.05, 0.05))
    model.joint("shoulder", "ground", "upper", "revolute", axis=(0, 1, 0), point=(0, 0, 0))
    model.joint("elbow", "upper", "lower", "revolute", axis=(0, 1, 0), point=(1, 0, 0))
    for name, wanted in (("shoulder", first), ("elbow", second)):
        if wanted and friction is not None:
            model.friction(f"rub {name}", name, effort=friction)
    model.stop("end shoulder", "shoulder", -2.0, 1.2, rebound)
    model.stop("end elbow", "elbow", -0.5, 0.4, rebound)
    return simulate_system(model.system(), Course(until, 0.05, DOWN))


@pytest.mark.parametrize("which", first(1, [{}, {"second": False}, {"first": False}]))
def test_an_arm_with_next_to_no_friction_is_the_one_without(which):
    """Impacts on both joints, with friction in either or both: other code, the same motion."""
    plain, rubbed = _arm(None, until=1.0), _arm(1e-10, until=1.0, **which)
    assert plain.status == rubbed.status == "done", rubbed.reason
    assert np.ptp(plain.joint_velocity, axis=0).min() > 1.0
    np.testing.assert_allclose(rubbed.joint_position, plain.joint_position, atol=1e-6)


def test_an_arm_with_friction_comes_to_rest_at_its_stops():
    run = _arm(0.8, rebound=0.0, until=6.0)
    _sound(run)
    lowest = run.joint_position[-1]
    assert np.all(run.joint_velocity[-1] == 0.0)
    assert lowest[0] == 1.2 or lowest[1] in (0.4, -0.5)


def test_a_stop_of_a_joint_that_moves_with_friction_elsewhere_says_so():
    """A slider that a crank drives: which of both bears what, at rest, is not simulated."""
    model = Model()
    model.ground("ground")
    model.body("crank", 1.0, (0.05, 0, 0), (0, 1e-3, 1e-3))
    model.body("rod", 1.0, (0.2, 0, 0.0), (0, 1e-3, 1e-3))
    model.body("slider", 1.0, (0.3, 0, 0), (1e-3, 1e-3, 1e-3))
    for name, a, b, x in (
        ("main", "ground", "crank", 0.0),
        ("pin", "crank", "rod", 0.1),
        ("wrist", "rod", "slider", 0.3),
    ):
        model.joint(name, a, b, "revolute", axis=(0, 1, 0), point=(x, 0, 0))
    model.joint("slide", "ground", "slider", "prismatic", axis=(1, 0, 0), point=(0.3, 0, 0))
    model.friction("rub", "main", effort=0.01)
    model.effort("drive", "main", Constant(0.5))
    model.stop("end", "slide", -0.02, 1.0)
    run = simulate_system(model.system(), Course(1.0, 0.01, NONE), initial={"main": (0.3, 0.0)})
    assert run.status == "stopped"
    assert "main" in run.reason and "slide" in run.reason
