"""Names of joints in the designer's words stand for derived joints, with the sign between their values."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.devices import HERE, Z, assembly, body, intended, joint, kinematics

from kinform.function import resolve_joint
from kinform.model.assembly import Group
from kinform.model.function import Function
from kinform.model.kinematics import Body

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
    ("between", "words"),
    [
        (("base", "plate"), 'both sides belong to the body "frame"'),
        (("arm", "tool"), "do not touch"),
        (("arm", "nothing"), 'no part or group "nothing"'),
    ],
)
def test_a_joint_that_is_not_there_says_why(between, words):
    found = resolve_joint(*design(intended("yaw", *between, "revolute", Z)), "yaw")
    assert found.joint is None
    assert words in found.reason


def test_an_unknown_name_lists_those_that_are_known():
    found = resolve_joint(*design(intended("yaw", "arm", "frame", "revolute", Z)), "yow")
    assert found.joint is None
    assert found.bodies == ("", "")
    assert "yaw" in found.reason
    assert "arm~frame" in found.reason


def test_a_group_that_is_spread_over_bodies_is_no_side():
    made, chain = design(intended("yaw", "pair", "frame", "revolute", Z))
    made = replace(made, groups=(*made.groups, Group("pair", ("arm", "tool"), HERE)))
    assert "spread over the bodies arm, tool" in resolve_joint(made, chain, "yaw").reason
