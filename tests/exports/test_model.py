"""Limits of effort and speed of a robot description, in other formats."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from support.robots import LIMITED, write
from support.validators import package

import kinform
from kinform.exports import export
from kinform.exports import write as write_export

LIMITS = {"base~upper": (12.0, 3.0), "slider~upper": (50.0, 0.4), "base~wheel": (None, None)}


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return kinform.run(write(tmp_path_factory.mktemp("robot"), LIMITED)).design


def joints_in(design, format):
    """The text of the file and its joints by name, those that move."""
    made = export(design, format)
    (text,) = (made.files[name].decode() for name in made.files if name.endswith((".sdf", ".xml", ".urdf")))
    root = ElementTree.fromstring(text)
    return text, made, {joint.get("name"): joint for joint in root.iter("joint") if joint.get("name") in LIMITS}


def number(element, path):
    text = element.findtext(path)
    return None if text is None else float(text)


def test_sdf_has_limits_of_effort_and_velocity_and_none_where_none_is_stated(robot):
    """SDF 1.11, joint/axis/limit: `effort` and `velocity` are without limit where they are left out."""
    _, made, joints = joints_in(robot, "sdf")
    found = {
        name: (number(joint, "axis/limit/effort"), number(joint, "axis/limit/velocity"))
        for name, joint in joints.items()
    }
    assert found == LIMITS
    assert not [said for said in made.lost if said.partition(":")[0] in LIMITS]


def test_mjcf_has_limits_of_effort_and_names_those_of_speed(robot):
    text, made, joints = joints_in(robot, "mjcf")
    for name, (effort, speed) in LIMITS.items():
        bounds = joints[name].get("actuatorfrcrange")
        assert bounds == (None if effort is None else f"{-effort} {effort}")
        (said,) = [one for one in made.lost if one.partition(":")[0] == name] or [None]
        assert (said is None) == (speed is None)
        if speed is not None:
            assert f"not carried: {said}" in text


def test_mujoco_keeps_to_the_limits_of_effort(robot, tmp_path):
    mujoco = package("mujoco")
    write_export(export(robot, "mjcf"), tmp_path)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    for name, (effort, _) in LIMITS.items():
        joint = model.joint(name)
        assert bool(model.jnt_actfrclimited[joint.id]) == (effort is not None)
        if effort is not None:
            np.testing.assert_allclose(model.jnt_actfrcrange[joint.id], [-effort, effort])


def test_urdf_written_from_another_format_has_both(robot, tmp_path):
    """SDF that is read and written as URDF: the numbers of the first URDF."""
    write_export(export(robot, "sdf"), tmp_path)
    again = kinform.run(tmp_path / "arm.sdf").design
    _, _, joints = joints_in(again, "urdf")
    for name, (effort, speed) in LIMITS.items():
        limit = joints[name].find("limit")
        if effort is None:
            assert limit is None
        else:
            assert (float(limit.get("effort")), float(limit.get("velocity"))) == (effort, speed)


OVERLAP = """<robot name="arm"><link name="base"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link>
<link name="upper"><visual><origin xyz="{x} 0 0"/><geometry><box size="{size}"/></geometry></visual></link>
<joint name="turn" type="{type}"><parent link="base"/><child link="upper"/><axis xyz="{axis}"/>
<limit lower="-1" upper="1.5" effort="1" velocity="1"/></joint></robot>"""
BOX, SMALL = "0.1 0.1 0.1", "0.05 0.05 0.05"


@pytest.mark.parametrize(
    "x,size,type,axis,expected",
    [
        (0.05, BOX, "revolute", "0 0 1", (-1.0, 1.5)),
        (0.0, BOX, "revolute", "0 0 1", (-1.0, 1.5)),
        (0.0, BOX, "prismatic", "0 1 0", (-1.0, 1.5)),
        (0.2, SMALL, "prismatic", "1 0 0", (-0.125, 1.5)),
    ],
    ids=["flush", "twice", "twice on a slide", "a true stop"],
)
def test_what_overlaps_as_it_is_drawn_is_no_limit(tmp_path, x, size, type, axis, expected):
    text = OVERLAP.format(x=x, size=size, type=type, axis=axis)
    design = kinform.run(write(tmp_path, text)).design
    made = export(design, "sdf")
    (text,) = (made.files[name].decode() for name in made.files if name.endswith(".sdf"))
    (joint,) = (item for item in ElementTree.fromstring(text).iter("joint") if item.get("type") != "fixed")
    found = [number(joint, f"axis/limit/{side}") for side in ("lower", "upper")]
    assert found == pytest.approx(expected, abs=1e-4)
