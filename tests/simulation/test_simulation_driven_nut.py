"""A nut that something turns on a screw at rest: what turns it does not press on the thread, what the thread passes on
does (Shigley's Mechanical Engineering Design, equations 8-1 and 8-2, with the mass of the nut)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.diagonal import diagonal
from support.nuts import INERTIA, LEAD, MASS, G, arm, nut

import kinform

EFFORT = """[[function.drive]]
joint = "thread"
kind = "effort"
law = {{ type = "constant", value = {} }}
"""
MOTION = '[[function.drive]]\njoint = "thread"\nkind = "motion"\nlaw = {{ type = "ramp", rate = {} }}\n'
NAMES = [("base", "nut"), ("screw", "nut")]


SIMULATION = "[simulation]\nduration = 0.1\nstep = 0.05\ngravity = [0, 0, -9.81]\n"


def _run(tmp_path, names, drive, shaft="[function]\n", **thread):
    path = tmp_path / "jack.toml"
    path.write_text(nut(*names, **thread).replace("[function]\n", shaft, 1) + drive + SIMULATION)
    run = kinform.run(path).simulation
    assert run.status == "done", run.reason
    assert run.level == "dynamic"
    return run


@diagonal(names=NAMES, driven=[(1.5, 1), (0.2, -1), (-0.3, -1), (0.0, -1)])
def test_a_torque_on_the_nut_moves_it_as_the_handbook_has_it(tmp_path, names, driven):
    torque, way = driven
    run = _run(tmp_path, names, EFFORT.format(torque))
    by_load, forward = arm(0.08, way), LEAD / (2.0 * math.pi)
    exact = (torque - MASS * G * by_load) / (INERTIA + MASS * forward * by_load)
    assert np.sign(exact) == way
    np.testing.assert_allclose(np.abs(run.joint_velocity[-1, 0]), 0.1 * abs(exact), rtol=1e-8)


@diagonal(names=NAMES, way=[1, -1])
def test_a_nut_that_is_led_takes_the_torque_of_the_handbook(tmp_path, names, way):
    """With a fine thread that locks itself: it has to be driven both ways."""
    run = _run(tmp_path, names, MOTION.format(36.0 * way), mu=0.12, lead=0.005)
    (led,) = [k for k, drive in enumerate(run.drives) if drive.kind == "motion"]
    exact = MASS * G * arm(0.12, way, 0.005)
    assert exact * way > 0.0
    np.testing.assert_allclose(np.abs(run.drive_effort[1, led]), abs(exact), rtol=1e-9)


SHAFT = """[[part]]
name = "shaft"
mass = 0.1
centre_of_mass = [100, 0, 0]
inertia = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]]
[function]
[[function.joint]]
name = "motor"
between = ["BASE", "shaft"]
type = "revolute"
axis = [0, 0, 1]
point = [100, 0, 0]
[[function.coupling]]
joints = JOINTS
ratio = RATIO
"""


@diagonal(names=NAMES, turned=[False, True])
def test_what_a_coupling_gives_the_nut_does_not_press_on_its_thread_either(tmp_path, names, turned):
    """A motor turns five times as fast as the nut, the other way."""
    shaft = SHAFT.replace("JOINTS", '["thread", "motor"]' if turned else '["motor", "thread"]')
    shaft = shaft.replace("RATIO", "-0.2" if turned else "-5.0").replace("BASE", names[0])
    run = _run(tmp_path, names, EFFORT.format(-0.3).replace("thread", "motor"), shaft)
    by_load, forward = arm(0.08, 1), LEAD / (2.0 * math.pi)
    exact = (5.0 * 0.3 - MASS * G * by_load) / (INERTIA + 25.0 * 1e-4 + MASS * forward * by_load)
    nut = run.body_names.index(names[1])
    assert run.p_WB[-1, nut, 2] - run.p_WB[0, nut, 2] == pytest.approx(0.5 * exact * forward * 0.1**2, rel=1e-8)
