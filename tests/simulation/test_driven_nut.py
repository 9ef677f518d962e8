"""A nut that something turns on a screw at rest: what turns it does not press on the thread, what the thread passes on
does (Shigley's Mechanical Engineering Design, equations 8-1 and 8-2, with the mass of the nut)."""

from __future__ import annotations

import math

import numpy as np
import pytest

import kinform

G, MASS, INERTIA, RADIUS, LEAD, FLANK = 9.81, 20.0, 0.002, 0.01, 0.02, math.radians(14.5)

NUT = """
schema = 1
[assembly]
name = "jack"
units = "mm"
ground = "BASE"
[[part]]
name = "BASE"
[[part]]
name = "NUT"
mass = 20
centre_of_mass = [0, 0, 0]
inertia = [[0.001, 0, 0], [0, 0.001, 0], [0, 0, 0.002]]
[function]
[[function.joint]]
name = "thread"
between = ["BASE", "NUT"]
type = "screw"
axis = [0, 0, 1]
point = [0, 0, 0]
pitch = PITCH
[[function.drive]]
joint = "thread"
kind = "friction"
coefficient = MU
radius = 10
flank = 14.5
DRIVE
[simulation]
duration = 0.1
step = 0.05
gravity = [0, 0, -9.81]
"""
EFFORT = """[[function.drive]]
joint = "thread"
kind = "effort"
law = {{ type = "constant", value = {} }}
"""
MOTION = '[[function.drive]]\njoint = "thread"\nkind = "motion"\nlaw = {{ type = "ramp", rate = {} }}\n'
NAMES = [("base", "nut"), ("screw", "nut")]


def _run(tmp_path, names, drive, mu, pitch=1e3 * LEAD):
    text = NUT.replace("PITCH", repr(pitch)).replace("MU", repr(mu)).replace("DRIVE", drive)
    path = tmp_path / "jack.toml"
    path.write_text(text.replace("BASE", names[0]).replace("NUT", names[1]))
    run = kinform.run(path).simulation
    assert run.status == "done", run.reason
    assert run.level == "dynamic"
    return run


def _arm(mu, lead, way):
    """m: torque of the thread by its load, where the nut climbs (1) or comes down (−1)."""
    slope = math.atan(lead / (2.0 * math.pi * RADIUS))
    normal = math.atan(math.tan(FLANK) * math.cos(slope))
    return RADIUS * math.tan(slope + way * math.atan(mu / math.cos(normal)))


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize(("torque", "way"), [(1.5, 1), (0.2, -1), (-0.3, -1), (0.0, -1)])
def test_a_torque_on_the_nut_moves_it_as_the_handbook_has_it(tmp_path, names, torque, way):
    run = _run(tmp_path, names, EFFORT.format(torque), 0.08)
    arm, forward = _arm(0.08, LEAD, way), LEAD / (2.0 * math.pi)
    exact = (torque - MASS * G * arm) / (INERTIA + MASS * forward * arm)
    assert np.sign(exact) == way
    np.testing.assert_allclose(np.abs(run.joint_velocity[-1, 0]), 0.1 * abs(exact), rtol=1e-8)


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize("way", [1, -1])
def test_a_nut_that_is_led_takes_the_torque_of_the_handbook(tmp_path, names, way):
    """With a fine thread that locks itself: it has to be driven both ways."""
    run = _run(tmp_path, names, MOTION.format(36.0 * way), 0.12, 5.0)
    (led,) = [k for k, drive in enumerate(run.drives) if drive.kind == "motion"]
    exact = MASS * G * _arm(0.12, 0.005, way)
    assert exact * way > 0.0
    np.testing.assert_allclose(np.abs(run.drive_effort[1, led]), abs(exact), rtol=1e-9)
