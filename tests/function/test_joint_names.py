"""Names of joints in the designer's words stand for derived joints, with the sign between their values."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.devices import HERE, Z, assembly, body, intended, joint, kinematics

from kinform.function import as_intended, designers_joints, resolve_joint
from kinform.model.assembly import Group
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.function import Function
from kinform.model.kinematics import Body
from kinform.model.simulation import DriveUse, Simulation

PARTS = [body("arm"), body("base"), body("cover"), body("plate"), body("tool")]
DOWN = (0.0, 0.0, -1.0)


def design(*joints):
    """Base and plate are fastened as the group `frame`; arm turns in it, tool hangs free."""
    made = assembly(PARTS, Function(joints=joints))
    made = replace(made, groups=(Group("frame", ("base", "plate"), HERE),))
    bodies = (
        Body("arm", ("arm",), False),
        Body("cover", ("cover",), False),
        Body("frame", ("base", "plate"), True),
        Body("tool", ("tool",), False),
    )
    derived = (joint("arm", "frame", "revolute", Z, (0, 0, 0)), joint("cover", "frame", "spherical", None, (0, 0, 0)))
    return made, replace(kinematics(PARTS, derived), bodies=bodies)


@pytest.mark.parametrize(
    ("between", "axis", "sign"),
    [
        (("arm", "frame"), Z, 1),
        (("arm", "base"), DOWN, -1),
        (("plate", "arm"), Z, -1),
        (("frame", "arm"), DOWN, 1),
        (("frame", "arm"), None, -1),
    ],
)
def test_order_of_bodies_and_sense_of_axis_make_the_sign(between, axis, sign):
    found = resolve_joint(*design(intended("yaw", *between, "revolute", axis)), "yaw")
    assert found.joint is not None
    assert found.joint.name == "arm~frame"
    assert found.sign == sign
    assert found.bodies == tuple("frame" if side != "arm" else "arm" for side in between)
    assert found.intended is not None
    assert found.reason == ""


def test_a_joint_is_found_under_the_name_that_kinform_gives_it():
    found = resolve_joint(*design(), "arm~frame")
    assert found.joint is not None
    assert (found.sign, found.intended, found.bodies) == (1, None, ("arm", "frame"))


def test_the_designers_name_goes_before_kinforms():
    wanted = intended("arm~frame", "frame", "cover", "spherical")
    found = resolve_joint(*design(wanted), "arm~frame")
    assert found.joint is not None
    assert found.joint.name == "cover~frame"


@pytest.mark.parametrize(
    ("between", "bodies"),
    [
        (("base", "plate"), ("frame", "frame")),
        (("arm", "tool"), ("arm", "tool")),
        (("arm", "nothing"), ("arm", "")),
    ],
)
def test_a_joint_that_is_not_there_says_why(between, bodies):
    found = resolve_joint(*design(intended("yaw", *between, "revolute", Z)), "yaw")
    assert found.joint is None
    assert found.bodies == bodies
    assert found.reason


def test_an_unknown_name_lists_those_that_are_known():
    found = resolve_joint(*design(intended("yaw", "arm", "frame", "revolute", Z)), "yow")
    assert found.joint is None
    assert found.bodies == ("", "")
    assert "yaw" in found.reason
    assert "arm~frame" in found.reason


def test_a_group_that_is_spread_over_bodies_is_no_side():
    made, chain = design(intended("yaw", "pair", "frame", "revolute", Z))
    made = replace(made, groups=(*made.groups, Group("pair", ("arm", "tool"), HERE)))
    found = resolve_joint(made, chain, "yaw")
    assert found.joint is None and found.reason


def made_run(design, rng):
    """A run of the two joints, with a drive and a range on the first."""
    run = Simulation(
        "done", "", "dynamic", np.arange(3.0), (), np.zeros((3, 0, 3)), np.zeros((3, 0, 4)),
        ("arm~frame", "cover~frame"), ("revolute", "spherical"), np.array([0, 1, 5]),
        *rng.normal(size=(3, 3, 5)), np.zeros((3, 3)), np.zeros(3), np.zeros(3, dtype=np.int64), (),
    )  # fmt: skip
    ends = RangeEnd("found", -1.0), RangeEnd("found", 3.0, leaves=4.0)
    use = DriveUse("arm~frame", "servo", 1.0, 1.0, 1.0, 1.0)
    return replace(run, drives=(use,), ranges=(JointRange("arm~frame", *ends),))


@pytest.mark.parametrize(("axis", "sign"), [(Z, 1), (DOWN, -1)])
def test_a_run_has_the_designers_names_and_senses(axis, sign):
    made, derived = design(intended("yaw", "arm", "base", "revolute", axis))
    run = made_run(made, np.random.default_rng(3))
    seen = as_intended(run, designers_joints(made, derived))
    assert seen.joint_names == ("yaw", "cover~frame")
    signs = [sign, 1, 1, 1, 1]
    for name in ("joint_position", "joint_velocity", "joint_effort"):
        np.testing.assert_array_equal(getattr(seen, name), signs * getattr(run, name))
    assert seen.drives[0].joint == "yaw"
    (item,) = seen.ranges
    assert (item.joint, item.lower.value, item.upper.value) == ("yaw", *((-1.0, 3.0) if sign > 0 else (-3.0, 1.0)))
    assert item.upper.leaves == (4.0 if sign > 0 else None) and item.lower.leaves == (None if sign > 0 else -4.0)


def test_what_has_no_one_sense_keeps_the_name_that_kinform_gives_it():
    twice = intended("one", "arm", "frame", "revolute", Z), intended("two", "arm", "frame", "revolute", Z)
    assert designers_joints(*design(*twice)) == {}
    assert designers_joints(*design(intended("ball", "frame", "cover", "spherical"))) == {}
    assert set(designers_joints(*design(intended("ball", "cover", "frame", "spherical")))) == {"cover~frame"}
    assert designers_joints(*design(intended("cover~frame", "arm", "frame", "revolute", Z))) == {}
