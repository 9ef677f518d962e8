"""A real arm through the exports: its six axes are where the truth has them. Skipped without the data."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from support.arms import joints_of_arm
from support.export_models import model_of, written
from support.other_programs import analysed, forward, judged, numbers, posed
from support.places import shared
from support.validators import package

from kinform import stages
from kinform.exports import export


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    manifest = shared("data/so100") / "so100.toml"
    found = stages.simulate(stages.mass(joints_of_arm(tmp_path_factory, manifest)), ranges=False)
    return found, json.loads((manifest.parent / "truth.json").read_text())


def six(found, truth):
    """For each true joint: the name of ours between the same bodies, its true axis and a point of it."""
    for wanted in truth["joints"]:
        groups = [truth["rigid_groups"][wanted[k]] for k in ("parent_group", "child_group")]
        pair = {found.kinematics.body_of(group[0]).name for group in groups}
        (joint,) = (j for j in found.kinematics.joints if set(j.bodies) == pair)
        yield joint.name, np.array(wanted["axis"]) / np.linalg.norm(wanted["axis"]), np.array(wanted["origin"])


def near(axis, point, true_axis, true_point):
    """Within half a degree, and a fifth of a millimetre."""
    return (
        np.linalg.norm(np.cross(axis, true_axis)) < np.sin(np.radians(0.5))
        and np.linalg.norm(np.cross(point - true_point, true_axis)) < 2e-4
    )


def test_urdf_has_the_six_axes_where_they_are(arm):
    found, truth = arm
    text = export(found, "urdf").files["so100.urdf"].decode()
    places = forward(text, {})
    joints = {node.get("name"): node for node in ElementTree.fromstring(text).findall("joint")}
    assert len(joints) == 6
    for name, axis, point in six(found, truth):
        X_WL = places[joints[name].find("child").get("link")]
        assert near(X_WL[:3, :3] @ numbers(joints[name].find("axis").get("xyz")), X_WL[:3, 3], axis, point), name


def test_yourdfpy_loads_it_with_its_meshes_and_finds_the_six_axes(arm, tmp_path):
    yourdfpy = package("yourdfpy")
    found, truth = arm
    path, _ = written(found, "urdf", tmp_path)
    robot = yourdfpy.URDF.load(str(path))
    assert robot.validate()
    assert len(robot.actuated_joint_names) == 6
    assert len(robot.scene.geometry) == len(found.assembly.parts)
    for name, axis, point in six(found, truth):
        joint = robot.joint_map[name]
        X_WL = robot.get_transform(joint.child, robot.base_link)
        assert near(X_WL[:3, :3] @ joint.axis, X_WL[:3, 3], axis, point), name
    for seed in range(3):
        values, ours = posed(model_of(found), seed)
        robot.update_cfg({joint: values[joint] for joint in robot.actuated_joint_names})
        for body, X_WB in ours.items():
            np.testing.assert_allclose(robot.get_transform(body, robot.base_link), X_WB, atol=1e-9, err_msg=body)


def test_mujoco_finds_the_six_axes(arm, tmp_path):
    mujoco = package("mujoco")
    found, truth = arm
    path, lost = written(found, "mjcf", tmp_path)
    assert any("1e-09" in text for text in lost)
    of_bodies = [text.partition(":")[0] for text in lost if "mass" in text]
    assert len(of_bodies) == len(set(of_bodies))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for name, axis, point in six(found, truth):
        k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
        assert near(data.xaxis[k], data.xanchor[k], axis, point), name


def test_ghdl_accepts_the_arm(arm, tmp_path):
    ran = analysed(export(arm[0], "vhdl-ams"), tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


def test_the_khronos_validator_accepts_the_arm(arm, tmp_path):
    (data,) = export(arm[0], "glb").files.values()
    issues = judged(data, tmp_path)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


def test_what_the_arm_lacks_is_named(arm):
    """Two of its meshes are open, so two bodies have no mass: no format may pass over that."""
    found, _ = arm
    unknown = {b.name for b in found.mass.bodies if b.mass is None and not _ground(found, b.name)}
    assert unknown
    for format in ("urdf", "sdf", "mjcf", "modelica", "vhdl-ams", "json"):
        lost = export(found, format).lost
        for name in unknown:
            assert [text.partition(":")[0] for text in lost].count(name) == 1, format


def _ground(found, name):
    return any(body.name == name and body.ground for body in found.kinematics.bodies)
