"""Bad models are refused with the name of the component, before anything runs."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.behaviour import Constant, Controller, Ground, Model, Ramp, RigidBody, Sine, Table
from kinform.behaviour.components import JointComponent, System
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.ports import Node
from kinform.behaviour.shafts import MotionDrive
from kinform.simulation import Course, simulate_system

AXIS = {"axis": (0, 0, 1), "point": (0, 0, 0)}


def arm(mass=1.0, inertia=(0.1, 0.1, 0.1)):
    """An arm on a hinge."""
    model = Model()
    model.ground("base")
    model.body("arm", mass, (0.5, 0, 0), inertia)
    model.joint("hinge", "base", "arm", **AXIS)
    return model


def refused(model, level="dynamic", **more):
    system = model if isinstance(model, System) else model.system()
    run = simulate_system(system, Course(0.1, 0.05, np.array([0, -9.81, 0]), level), **more)
    assert run.status == "refused"
    assert len(run.time) == 0
    return dict(run.failures)


def test_a_body_without_mass_cannot_be_dynamic_and_moves_without_forces():
    assert list(refused(arm(None))) == ["arm"]
    model = arm(None)
    model.motion("drive", "hinge", Ramp(0.0, 1.0))
    assert simulate_system(model.system(), Course(0.1, 0.05, level="kinematic")).status == "done"


@pytest.mark.parametrize("mass", [-1.0, np.nan, np.inf])
def test_a_mass_that_cannot_be_names_its_body(mass):
    assert list(refused(arm(mass))) == ["arm"]


def test_an_inertia_that_cannot_be_names_its_body():
    assert list(refused(arm(inertia=(0.1, 0.1, -0.1)))) == ["arm"]
    skewed = np.diag([0.1, 0.1, 0.1])
    skewed[0, 1] = 0.05
    assert list(refused(arm(inertia=skewed))) == ["arm"]


def test_a_chain_whose_end_has_no_mass_names_its_joint():
    model = arm()
    model.body("tip", 0.0, (1, 0, 0), (0, 0, 0))
    model.joint("wrist", "arm", "tip", axis=(0, 0, 1), point=(1, 0, 0))
    assert list(refused(model)) == ["wrist"]


def test_a_body_that_nothing_connects_is_named():
    model = arm()
    model.body("loose", 1.0, (3, 0, 0), (1, 1, 1))
    assert refused(model) == {"loose": "no joints connect this body with the ground"}


def four_bar():
    model = arm(1.0)
    model.body("coupler", 1.0, (1, 0.5, 0), (0.1, 0.1, 0.1))
    model.body("rocker", 1.0, (2, 0.5, 0), (0.1, 0.1, 0.1))
    model.joint("elbow", "arm", "coupler", axis=(0, 0, 1), point=(1, 0, 0))
    model.joint("knee", "coupler", "rocker", axis=(0, 0, 1), point=(1, 1, 0))
    model.joint("foot", "base", "rocker", axis=(0, 0, 1), point=(2, 0, 0))
    return model


def test_a_loop_that_cannot_take_its_initial_values_names_its_joints():
    (name,) = refused(four_bar(), initial={"hinge": (0.3, 0.0), "foot": (-0.5, 0.0)})
    assert name == "hinge, foot"
    (far,) = refused(four_bar(), initial={"hinge": (3.0, 0.0)})
    assert far == "hinge"


def test_two_drives_that_a_loop_cannot_follow_are_named():
    model = four_bar()
    model.motion("one", "hinge", Sine(0.0, 0.1, 1.0, 0.0))
    model.motion("two", "foot", Sine(0.0, -0.1, 2.0, 0.0))
    assert {"hinge, foot"} == set(refused(model)) == set(refused(model, "kinematic"))


def test_a_drive_on_a_joint_that_is_not_there_is_refused_where_it_is_written_and_where_it_is_joined():
    model = arm()
    with pytest.raises(ValueError, match=r'"elbow"'):
        model.motion("drive", "elbow", Constant(0.0))
    model.add(MotionDrive("drive", "drive", Constant(0.0)))
    assert list(refused(model)) == ["drive"]


def test_a_drive_of_a_joint_with_more_freedoms_is_refused_unless_it_says_which():
    model = arm()
    model.body("ball", 1.0, (1, 0, 0), (1, 1, 1))
    model.joint("socket", "arm", "ball", "spherical", point=(1, 0, 0))
    with pytest.raises(ValueError, match='"socket"'):
        model.motion("drive", "socket", Constant(0.0))


LAWS = [Constant(np.nan), Ramp(0.0, np.inf), Sine(0.0, np.nan, 1.0, 0.0), Table((0.0, np.nan), (0.0, 1.0))]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
@pytest.mark.parametrize("level", ["dynamic", "kinematic"])
def test_a_law_that_is_not_a_number_names_its_drive(law, level):
    model = arm()
    model.motion("drive", "hinge", law)
    assert list(refused(model, level)) == ["drive"]


def test_a_table_that_does_not_go_forward_names_its_drive():
    model = arm()
    model.motion("drive", "hinge", Table((0.0, 1.0, 0.5), (0.0, 1.0, 2.0)))
    assert list(refused(model)) == ["drive"]


BAD = [
    ("spring", lambda m: m.spring("x", "hinge", np.nan), "stiffness"),
    ("damper", lambda m: m.damper("x", "hinge", np.inf), "damping"),
    ("stop", lambda m: m.stop("x", "hinge", 1.0, -1.0), "lower"),
    ("stop", lambda m: m.stop("x", "hinge", np.nan), "lower"),
    ("servo", lambda m: m.servo("x", "hinge", Constant(0.0), Controller(np.nan)), "kp"),
    ("motor", lambda m: m.motor("x", "hinge", 2.0, 0.0, 0.1), "terminals"),
    ("load", lambda m: m.load("x", "arm", (np.nan, 0, 0)), "point"),
    ("cord", lambda m: m.spring_between("x", "base", "arm", ((0, 0, 0), (1, 0, 0)), np.nan), "stiffness"),
    ("joint", lambda m: m.joint("x", "base", "arm", axis=(0, 0, 0), point=(1, 0, 0)), "axis"),
    ("joint", lambda m: m.joint("x", "base", "arm", axis=(0, 0, 1)), "point"),
    ("screw", lambda m: m.joint("x", "base", "arm", "screw", **AXIS), "pitch"),
]


@pytest.mark.parametrize(("kind", "add", "number"), BAD, ids=[f"{kind} {number}" for kind, _, number in BAD])
def test_what_cannot_be_is_named_with_the_number_that_is_wrong(kind, add, number):
    model = arm()
    add(model)
    assert number in refused(model)["x"]


def test_a_motor_of_no_resistance_and_one_with_two_supplies_are_named():
    model = arm()
    model.motor("motor", "hinge", 0.0, 0.0, 0.1)
    model.voltage("one", "motor", Constant(1.0))
    assert "resistance" in refused(model)["motor"]
    model = arm()
    model.motor("motor", "hinge", 1.0, 0.0, 0.1)
    model.voltage("one", "motor", Constant(1.0))
    model.voltage("two", "motor", Constant(1.0))
    assert list(refused(model)) == ["motor"]


def test_a_controller_of_another_shaft_is_refused_rather_than_taken_for_its_motors():
    model = arm()
    model.body("tip", 1.0, (1, 0, 0), (1, 1, 1))
    model.joint("wrist", "arm", "tip", axis=(0, 0, 1), point=(1, 0, 0))
    model.motor("motor", "hinge", 1.0, 0.0, 0.1)
    model.controller("pid", "motor", "wrist", Constant(0.0), Controller(1.0))
    assert list(refused(model)) == ["motor"]


def test_joints_without_a_body_two_grounds_and_names_taken_twice_are_named():
    base, other = Ground("base", "base"), Ground("other", "other")
    body = RigidBody("arm", "arm", 1.0, np.zeros(3), np.eye(3))
    hinge = JointComponent("hinge", "hinge", KINDS["fixed"], JointGeometry())
    nodes = (Node((("base", "frame"), ("hinge", "a")), 6), Node((("hinge", "b"),), 6), Node((("arm", "frame"),), 6))
    assert "hinge" in refused(System((base, body, hinge), nodes))
    alone = [Node(((name, "frame"),), 6) for name in ("base", "other")]
    assert "other" in refused(System((base, other), tuple(alone)))
    assert "ground" in refused(System((body,), (Node((("arm", "frame"),), 6),)))
    twin = RigidBody("arm 2", "arm", 1.0, np.zeros(3), np.eye(3))
    three = [Node(((name, "frame"),), 6) for name in ("base", "arm", "arm 2")]
    assert "arm" in refused(System((base, body, twin), tuple(three)))


def test_two_joints_on_one_shaft_are_refused_where_something_drives_them():
    model = arm()
    model.body("tip", 1.0, (1, 0, 0), (1, 1, 1))
    model.joint("wrist", "arm", "tip", axis=(0, 0, 1), point=(1, 0, 0))
    model.join(("wrist", "shaft"), ("hinge", "shaft"))
    assert refused(model)


def test_initial_values_of_joints_that_are_not_there_or_that_are_no_numbers_are_refused():
    with pytest.raises(ValueError, match=r'"elbow".*hinge'):
        refused(arm(), initial={"elbow": (0.0, 0.0)})
    with pytest.raises(ValueError, match='"hinge"'):
        refused(arm(), initial={"hinge": (np.nan, 0.0)})
