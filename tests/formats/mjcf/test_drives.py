"""Servos that stand for prescribed motions in MJCF: their gains are of what the joint moves, and they hold."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import Z, device, drive, intended, joint, rod, sine
from support.export_models import DOWN, Y, block, design, four_bar, model_of
from support.other_programs import loaded
from support.places import FIXTURES

from kinform.formats.mjcf.writing import writer as mjcf
from kinform.formats.mjcf.writing.reflected import carried
from kinform.model.function import Coupling, Law

STILL = Law("constant", value=0.0)


def held(found, folder, time=1.0):
    """(k,) values of the actuated joints after so long under gravity, less those at the start."""
    mujoco, model, data = loaded(found, folder)
    joints = [int(model.actuator_trnid[k, 0]) for k in range(model.nu)]
    start = [float(data.qpos[model.jnt_qposadr[j]]) for j in joints]
    while data.time < time:
        mujoco.mj_step(model, data)
    return [float(data.qpos[model.jnt_qposadr[j]]) - at for j, at in zip(joints, start, strict=True)]


def test_an_arm_of_two_links_holds_against_gravity(tmp_path):
    """Gravity bends both; aimed aside by its effort over the gain, each stands where it started."""
    parts = [rod("upper", (0, 0, 0), (0.4, 0, 0), 2.0), rod("lower", (0.4, 0, 0), (0.7, 0, 0), 1.0)]
    joints = [joint("base", "upper", "revolute", Y, (0, 0, 0)), joint("upper", "lower", "revolute", Y, (0.4, 0, 0))]
    drives = [drive("base~upper", "motion", STILL), drive("upper~lower", "motion", STILL)]
    found = design(device(parts, joints, drives=drives, duration=0.1, step=0.05, gravity=np.array([0, 0, -9.81])))
    model = model_of(found)
    outer = carried(model, "upper~lower", 0)
    assert outer.inertia == pytest.approx(1.0 * 0.3**2 / 3)
    assert abs(outer.gravity) == pytest.approx(9.81 * 0.15)
    inner = carried(model, "base~upper", 0)
    assert inner.inertia == pytest.approx(2.0 * 0.4**2 / 3 + 0.3**2 / 12 + 0.55**2)
    assert abs(inner.gravity) == pytest.approx(9.81 * (2.0 * 0.2 + 0.55))
    np.testing.assert_allclose(held(found, tmp_path), 0.0, atol=1e-6)


def test_a_gear_reflects_what_it_drives():
    """J1 + J2 / i², as textbooks have it; the arm on the wheel loads the motor by 1 / i."""
    parts = [block("motor", (0, 0, 0), 0.1), block("wheel", (0.5, 0.2, 0), 3.0)]
    wanted = [
        intended("motor", "base", "motor", "revolute", Z, (0, 0, 0)),
        intended("wheel", "base", "wheel", "revolute", Z, (0.5, 0, 0)),
    ]
    made = device(
        parts, [], intended=wanted, couplings=[Coupling(("motor", "wheel"), 20.0, "device.toml", 1)],
        drives=[drive("motor", "motion", sine(5, 1))], level="functional", duration=0.1, step=0.05,
    )  # fmt: skip
    model = model_of(design(made))
    found = carried(model, "base~motor", 0)
    own, other = (next(body for body in model.system.bodies if body.subject == name) for name in ("motor", "wheel"))
    swung = other.inertia[2, 2] + 3.0 * 0.2**2
    assert found.inertia == pytest.approx(own.inertia[2, 2] + swung / 20.0**2)
    assert found.gravity == pytest.approx(0.0, abs=1e-12)


def test_the_crank_of_a_four_bar_holds(tmp_path):
    """What is beyond the joint that closes the loop is carried, too: the tree alone would leave it out."""
    still = [drive("base~crank", "motion", STILL)]
    found = design(four_bar(drives=still, initial=(), gravity=DOWN, duration=0.1, step=0.05))
    assert max(map(abs, held(found, tmp_path))) < 2e-3


def test_a_servo_that_rounding_alone_aims_aside_is_not_said_to_be(derive_design):
    """The outer gimbal turns about the vertical: gravity bends it by rounding; the inner one it bends."""
    found = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    said = {words.split(":")[0]: words for words in mjcf.export(model_of(found)).lost}
    assert "°" not in said["yaw"]
    assert "°" in said["pitch"]
