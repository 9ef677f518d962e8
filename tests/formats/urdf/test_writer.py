"""URDF: forward kinematics by a parser of our own and by other programs, at random joint values."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from support.devices import Z, device, drive, initial, intended, joint, sine
from support.devices import body as bare
from support.export_models import ALL, X, block, design, four_bar, known, model_of, written
from support.other_programs import forward, numbers, posed
from support.places import FIXTURES
from support.validators import package

import kinform
from kinform.exports import export
from kinform.exports.names import comment


@pytest.mark.parametrize("name", ALL)
def test_forward_kinematics_is_ours_at_random_values(name):
    found = known(name)
    text = export(found, "urdf").files["device.urdf"].decode()
    model = model_of(found)
    for seed in range(4):
        values, ours = posed(model, seed)
        theirs = forward(text, values)
        for body, X_WB in ours.items():
            np.testing.assert_allclose(theirs[body], X_WB, atol=1e-9, err_msg=body)


def test_backward_joints_have_negative_axes():
    root = ElementTree.fromstring(export(known("gimbal"), "urdf").files["device.urdf"])
    axes = {node.get("name"): numbers(node.find("axis").get("xyz")) for node in root.findall("joint")}
    np.testing.assert_allclose(axes["base~outer"], Z)
    np.testing.assert_allclose(axes["inner~outer"], -np.array(X))


@pytest.mark.parametrize("name", ["gimbal", "passive_seeker", "four_bar", "every_joint"])
def test_yourdfpy_and_pinocchio_find_the_same_places(name, tmp_path):
    found = known(name)
    path, _ = written(found, "urdf", tmp_path)
    yourdfpy = package("yourdfpy")
    robot = yourdfpy.URDF.load(str(path), load_meshes=False)
    assert robot.validate()
    for seed in range(3):
        values, ours = posed(model_of(found), seed)
        robot.update_cfg({joint: values[joint] for joint in robot.actuated_joint_names})
        for body, X_WB in ours.items():
            np.testing.assert_allclose(robot.get_transform(body, robot.base_link), X_WB, atol=1e-9, err_msg=body)


@pytest.mark.parametrize("name", ["gimbal", "passive_seeker", "four_bar"])
def test_pinocchio_finds_the_same_places_and_inertias(name, tmp_path):
    found = known(name)
    path, _ = written(found, "urdf", tmp_path)
    pin = package("pinocchio")
    robot = pin.buildModelFromUrdf(str(path))
    data = robot.createData()
    for seed in range(3):
        values, ours = posed(model_of(found), seed)
        q = pin.neutral(robot)
        for k, joint_name in enumerate(robot.names):
            if k == 0:
                continue
            start = robot.joints[k].idx_q
            value = values[joint_name]
            q[start : start + robot.joints[k].nq] = (
                [np.cos(value), np.sin(value)] if robot.joints[k].nq == 2 else [value]
            )
        pin.framesForwardKinematics(robot, data, q)
        for body, X_WB in ours.items():
            np.testing.assert_allclose(data.oMf[robot.getFrameId(body)].homogeneous, X_WB, atol=1e-9, err_msg=body)
    masses = sorted(inertia.mass for inertia in robot.inertias if inertia.mass > 0.0)
    np.testing.assert_allclose(masses, sorted(b.mass for b in found.mass.bodies if b.mass is not None), atol=1e-9)


@pytest.mark.parametrize("name", ["seeker_2dof", "four_bar"])
def test_meshes_are_found_and_stand_where_the_parts_do(name, tmp_path, derive_design):
    (manifest,) = FIXTURES.glob(f"*/{name}/{name}.toml")
    found = derive_design(manifest)
    path, _ = written(found, "urdf", tmp_path)
    text = path.read_text(encoding="utf-8")
    places = forward(text, {})
    seen = 0
    for link in ElementTree.fromstring(text).findall("link"):
        for visual in link.findall("visual"):
            mesh = tmp_path / visual.find("geometry/mesh").get("filename")
            corners = read_stl(mesh)
            part = found.assembly.part(visual.get("name"))
            expected = part.mesh.vertices[part.mesh.faces].reshape(-1, 3) @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
            X_WL = places[link.get("name")]
            np.testing.assert_allclose(corners @ X_WL[:3, :3].T + X_WL[:3, 3], expected, atol=1e-7)
            seen += 1
    assert seen == len(found.assembly.parts)


@pytest.mark.parametrize("name", ["seeker_2dof", "four_bar"])
def test_pinocchio_and_mujoco_find_the_meshes(name, tmp_path, derive_design):
    (manifest,) = FIXTURES.glob(f"*/{name}/{name}.toml")
    found = derive_design(manifest)
    path, _ = written(found, "urdf", tmp_path)
    mujoco = package("mujoco")
    assert mujoco.MjModel.from_xml_path(str(path)).ngeom == len(found.assembly.parts)
    pin = package("pinocchio")
    robot = pin.buildModelFromUrdf(str(path))
    shapes = pin.buildGeomFromUrdf(robot, str(path), pin.GeometryType.VISUAL, package_dirs=[str(tmp_path)])
    assert shapes.ngeoms == len(found.assembly.parts)


def read_stl(path):
    """(3 F, 3) corners of a binary STL."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    assert len(data) == 84 + count * record.itemsize
    return np.frombuffer(data, record, offset=84)["corners"].reshape(-1, 3).astype(float)


def test_what_urdf_cannot_carry_is_named_in_the_file_too():
    for name in ("four_bar", "reversed_joints", "passive_seeker", "seeker"):  # a loop, a ball, a spring, a law
        made = export(known(name), "urdf")
        assert made.lost, name
        text = made.files["device.urdf"].decode()
        for lost in made.lost:
            assert f"<!-- not carried: {comment(lost)} -->" in text


def test_a_plain_chain_loses_nothing():
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0)), joint("one", "two", "prismatic", X, (0.1, 0, 0))]
    found = design(device([block("one", (0.1, 0, 0)), block("two", (0.3, 0, 0))], joints))
    for format in ("urdf", "sdf", "mjcf", "modelica", "vhdl-ams", "json"):
        assert export(found, format).lost == (), format


def test_limits_come_from_the_function_in_our_sign():
    wanted = [
        intended("swing", "one", "base", "revolute", Z, (0, 0, 0), range=(-0.2, 1.5)),
        intended("push", "one", "two", "prismatic", X, (0, 0, 0), range=(-np.inf, 0.3)),
    ]
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0)), joint("one", "two", "prismatic", X, (0.1, 0, 0))]
    parts = [block("one", (0.1, 0, 0)), block("two", (0.3, 0, 0))]
    found = design(device(parts, joints, intended=wanted))
    root = ElementTree.fromstring(export(found, "urdf").files["device.urdf"])
    limits = {n.get("name"): n.find("limit") for n in root.findall("joint")}
    # The designer counts base relative to one: the range is turned round.
    assert [float(limits["base~one"].get(side)) for side in ("lower", "upper")] == [-1.5, 0.2]
    assert [float(limits["one~two"].get(side)) for side in ("lower", "upper")] == [-1e9, 0.3]


def test_limits_are_those_of_the_geometry_where_it_stops_a_joint_and_stated_ones_elsewhere():
    wanted = [intended("swing", "base", "one", "revolute", Z, (0, 0, 0), range=(-0.2, 1.5))]
    found = design(
        device([block("one", (0.1, 0, 0))], [joint("base", "one", "revolute", Z, (0, 0, 0))], intended=wanted)
    )
    seen = {}
    for lower, upper in ((-0.7, None), (None, None), (-0.7, 0.9)):
        (swing,) = found.kinematics.joints
        status = "unbounded" if lower is upper else "found"
        ranged = replace(swing, range_status=status, range_lower=lower, range_upper=upper)
        made = replace(found, kinematics=replace(found.kinematics, joints=(ranged,)))
        limit = ElementTree.fromstring(export(made, "urdf").files["device.urdf"]).find("joint/limit")
        seen[lower, upper] = tuple(float(limit.get(side)) for side in ("lower", "upper"))
    assert seen == {(-0.7, None): (-0.7, 1.5), (None, None): (-0.2, 1.5), (-0.7, 0.9): (-0.7, 0.9)}


@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf"])
def test_joints_without_limits_are_named_in_a_note(format):
    made = export(known("gimbal"), format)
    (note,) = (text for text in made.remarks if "a rotor~inner" in text)
    assert note.endswith("a rotor~inner, base~outer, inner~outer")
    assert note.encode() in next(data for name, data in made.files.items() if "/" not in name)


def test_a_body_that_nothing_holds_floats_and_is_named():
    blocks, hinge = (
        [block("one", (0.1, 0, 0)), block("two", (0.3, 0, 0))],
        joint("base", "one", "revolute", Z, (0, 0, 0)),
    )
    found = design(device(blocks, [hinge]), run=False)
    made = export(found, "urdf")
    root = ElementTree.fromstring(made.files["device.urdf"])
    (free,) = (n for n in root.findall("joint") if n.get("type") == "floating")
    assert free.find("child").get("link") == "two"
    assert "two" in [text.partition(":")[0] for text in made.lost]


def test_dampers_and_drives_are_dynamics_and_transmissions():
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0))]
    drives = [drive("base~one", "damper", damping=0.25), drive("base~one", "motion", sine(10, 1))]
    found = design(device([block("one", (0.1, 0, 0))], joints, drives=drives, initial=(initial("base~one", 0, 0),)))
    root = ElementTree.fromstring(export(found, "urdf").files["device.urdf"])
    assert root.find("joint/dynamics").get("damping") == "0.25"
    assert root.find("transmission/joint").get("name") == "base~one"


def test_a_driven_joint_is_not_the_one_that_is_left_out():
    """The loop is opened at a hinge on which nothing acts, whatever the names of the joints."""
    for driven in ("base~crank", "base~rocker", "coupler~crank", "coupler~rocker"):
        found = design(four_bar(drives=[drive(driven, "damper", damping=0.01)]), run=False)
        for format in ("urdf", "sdf", "mjcf"):
            made = export(found, format)
            assert driven not in [text.partition(":")[0] for text in made.lost], (driven, format)


@pytest.mark.parametrize("format", ["sdf", "mjcf"])
def test_a_free_body_of_unknown_mass_is_a_grain_and_named(format):
    """Both formats take a mass of their own where none is stated: a wrong answer that nobody asked for."""
    found = design(device([bare("stick", mass=None)], []), run=False)
    made = export(found, format)
    root = ElementTree.fromstring(next(iter(made.files.values())))
    masses = [float(node.text) for node in root.iter("mass")] + [
        float(n.get("mass")) for n in root.iter("inertial") if n.get("mass")
    ]
    assert masses == [1e-9]
    assert [text.partition(":")[0] for text in made.lost].count("stick") >= 1


def test_limits_of_a_description_are_kept_in_another_format_where_the_parts_leave_more(tmp_path):
    text = """<robot name="r"><link name="base"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link>
    <link name="arm"><visual><origin xyz="0 0.1 0"/><geometry><box size="0.02 0.2 0.02"/></geometry></visual></link>
    <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0.2 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-0.4" upper="UPPER" effort="1" velocity="1"/></joint></robot>"""
    meets = math.atan2(0.15, 0.05) - math.asin(0.01 / math.hypot(0.15, 0.05))  # the arm's side at an edge of the base
    for upper, kept in ((0.3, 0.3), (2.0, meets)):
        (tmp_path / "r.urdf").write_text(text.replace("UPPER", str(upper)))
        root = ElementTree.fromstring(export(kinform.run(tmp_path / "r.urdf").design, "mjcf").files["r.xml"])
        joint = root.find(".//joint")
        ends = [float(joint.get("axis").split()[2]) * float(end) for end in joint.get("range").split()]
        assert sorted(ends) == pytest.approx([-0.4, kept], abs=1e-3)
