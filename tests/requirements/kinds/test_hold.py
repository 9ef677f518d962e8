"""The static effort that holds a joint, against the lever arms of the loads."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.devices import drive
from support.requirements import G, arm, parallelogram, state

from kinform.mass import compile_mass
from kinform.model.function import Load


def test_the_torque_that_holds_an_arm_against_gravity():
    made, torque = arm(), G * (1.0 * 0.15 + 0.5 * 0.45)
    assert state(made, "hold", joint="shoulder", limit=1.0001 * torque)[0] == "met"
    assert state(made, "hold", joint="shoulder", limit=0.9999 * torque)[0] == "violated"
    assert state(made, "hold", joint="elbow", limit=1.0001 * G * 0.5 * 0.15)[0] == "met"
    assert state(made, "hold", joint="elbow", limit=0.9999 * G * 0.5 * 0.15)[0] == "violated"


@pytest.mark.parametrize("sign", [1, -1])
def test_poses_are_in_the_designers_sign(sign):
    # elbow bent by 90°: the forearm hangs below or stands above its joint
    bent = {"shoulder": 0.0, "elbow": sign * math.pi / 2}
    torque = G * (1.0 * 0.15 + 0.5 * 0.3)
    assert state(arm(), "hold", joint="shoulder", limit=1.0001 * torque, poses=[bent])[0] == "met"
    # shoulder by 30° and elbow by −30°·sign: only one sign makes the forearm level
    tilted = {"shoulder": math.radians(30), "elbow": -sign * math.radians(30)}
    lever = 0.3 * math.cos(math.radians(30))
    level = G * (0.15 * math.cos(math.radians(30)) + 0.5 * (lever + 0.15))
    other = G * (0.15 * math.cos(math.radians(30)) + 0.5 * (lever + 0.15 * math.cos(math.radians(60))))
    exact = level if sign == 1 else other
    assert state(arm(), "hold", joint="shoulder", limit=exact + 1e-6, poses=[tilted])[0] == "met"
    assert state(arm(), "hold", joint="shoulder", limit=exact - 1e-6, poses=[tilted])[0] == "violated"


def test_loads_and_springs_take_part_in_holding():
    load = Load("lower", np.array([0, 0, -10.0]), None, np.array([0.6, 0, 0]), "world", "m.toml", 1)
    torque = G * (1.0 * 0.15 + 0.5 * 0.45) + 10.0 * 0.6
    assert state(arm(loads=[load]), "hold", joint="shoulder", limit=torque + 1e-6)[0] == "met"
    assert state(arm(loads=[load]), "hold", joint="shoulder", limit=torque - 1e-6)[0] == "violated"
    # gravity turns the arm down, about +y: a spring at rest 0.5 rad above holds 2 N·m of it
    spring = drive("shoulder", "spring", stiffness=4.0, rest=math.degrees(-0.5))
    left = G * (1.0 * 0.15 + 0.5 * 0.45) - 2.0
    assert state(arm(drives=[spring]), "hold", joint="shoulder", limit=left + 1e-6)[0] == "met"
    assert state(arm(drives=[spring]), "hold", joint="shoulder", limit=left - 1e-6)[0] == "violated"


def test_a_loop_is_held_by_its_one_drive():
    # at 30° from the vertical the coupler, which does not turn, pulls 2·g·0.1·sin 30°
    pose, torque = {"drive": math.radians(30)}, 2.0 * G * 0.1 * 0.5
    assert state(parallelogram(), "hold", joint="drive", limit=torque + 1e-6, poses=[pose])[0] == "met"
    assert state(parallelogram(), "hold", joint="drive", limit=torque - 1e-6, poses=[pose])[0] == "violated"


def test_what_an_unknown_mass_leaves_open():
    made = arm()
    parts = tuple(replace(p, override=None) if p.name == "lower" else p for p in made.assembly.parts)
    model = replace(made.assembly, parts=parts)
    made = replace(made, assembly=model, mass=compile_mass(model, made.kinematics))
    assert state(made, "hold", joint="shoulder", limit=100.0)[0] == "undecided"


@pytest.mark.parametrize(("bend", "found"), [(29.0, "met"), (30.0, "met"), (31.0, "undecided"), (-31.0, "undecided")])
def test_a_pose_outside_of_the_range_is_not_held(bend, found):
    made = arm(elbow=(-math.radians(30.0), math.radians(30.0)))
    pose = {"elbow": math.radians(bend)}
    assert state(made, "hold", joint="shoulder", limit=100.0, poses=[pose])[0] == found
