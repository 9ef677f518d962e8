"""What a remedy gives to be pasted is pasted, and the finding is gone.

A lever on a pin, whose axis, place and range a file states wrongly: a manifest in inches, and descriptions in which the
link of the lever has a frame of its own.
"""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.places import FIXTURES
from support.solids import box, rod, save

from kinform import form, stages
from kinform.consistency.context import Context
from kinform.consistency.rules import RULES
from kinform.design import Design

CODES = ("KF403", "KF404", "KF412")
AXIS = np.array([np.sin(np.radians(2.0)), 0.0, np.cos(np.radians(2.0))])
"""Stated, in the world: 2° beside the pin."""
POINT = np.array([0.003, -0.004, 0.005])
"""m, world: stated, 5 mm beside the pin."""
TURN = Rotation.from_euler("xyz", [0.4, -0.3, 0.9])
"""Of the link of the lever in the world; so stands the body of the lever in an MJCF."""
RPY = " ".join(map(repr, TURN.as_euler("xyz").tolist()))


def meshes(folder):
    """frame.stl in the world's frame and lever.stl in that of its link, mm; a post ends the turn either way."""
    frame = rod(50, -5, 0, 32) + rod(5, 0, 10, 32) + rod(8, 10, 13, 32)
    for angle in np.radians([70.0, -40.0]):
        frame += rod(2, 0, 10, 32).translate((40 * np.cos(angle), 40 * np.sin(angle), 0))
    lever = box(-10, 50, -10, 10, 0, 10) - rod(5, -1, 11, 32)
    save(frame, folder / "frame.stl")
    save(lever, folder / "whole.stl")
    inverse = TURN.inv().as_matrix()
    save(lever.transform(np.column_stack([inverse, inverse @ (-1e3 * POINT)])), folder / "lever.stl")


def said(values):
    return " ".join(map(repr, np.asarray(values).tolist()))


def manifest(folder):
    text = 'schema = 1\n[assembly]\nname = "lever"\nunits = "in"\nground = "frame"\n'
    for name, mesh in (("frame", "frame.stl"), ("lever", "whole.stl")):
        text += f'[[part]]\nname = "{name}"\nmesh = "{mesh}"\nunits = "mm"\n'
    point = ", ".join(map(repr, (POINT / 0.0254).tolist()))
    text += '[[function.joint]]\nname = "swing"\nbetween = ["lever", "frame"]\ntype = "revolute"\n'
    return text + f"axis = [{AXIS[0]}, 0, {AXIS[2]}]\npoint = [{point}]\nrange = [-90, 80]\n"


def urdf(folder):
    def visual(name):
        return (
            f'<visual><origin xyz="0 0 0"/><geometry><mesh filename="{name}.stl" scale="0.001 0.001 0.001"/></geometry>'
            "</visual>"
        )

    return (
        f'<robot name="r"><link name="frame">{visual("frame")}</link><link name="lever">{visual("lever")}</link>\n'
        f'<joint name="swing" type="revolute"><parent link="frame"/><child link="lever"/>\n'
        f'<origin xyz="{said(POINT)}" rpy="{RPY}"/><axis xyz="{said(TURN.inv().apply(AXIS))}"/>\n'
        '<limit lower="-1.5" upper="1.4" effort="1" velocity="1"/></joint></robot>'
    )


def mjcf(folder):
    quat = TURN.as_quat()[[3, 0, 1, 2]]
    return (
        '<mujoco model="r"><asset><mesh name="frame" file="frame.stl" scale="0.001 0.001 0.001"/>'
        '<mesh name="lever" file="lever.stl" scale="0.001 0.001 0.001"/></asset><worldbody>'
        '<body name="frame"><geom type="mesh" mesh="frame"/>'
        f'<body name="lever" pos="{said(POINT)}" quat="{said(quat)}"><geom type="mesh" mesh="lever"/>'
        f'<joint name="swing" type="hinge" axis="{said(TURN.inv().apply(AXIS))}" pos="0 0 0" range="-86 80"/>'
        "</body></body></worldbody></mujoco>"
    )


def sdf(folder):
    def visual(name):
        return (
            f'<visual name="v"><geometry><mesh><uri>{name}.stl</uri><scale>0.001 0.001 0.001</scale></mesh></geometry>'
            "</visual>"
        )

    return (
        f'<sdf version="1.9"><model name="r"><link name="frame">{visual("frame")}</link>'
        f'<link name="lever"><pose>{said(POINT)} {RPY}</pose>{visual("lever")}</link>'
        '<joint name="swing" type="revolute"><parent>frame</parent><child>lever</child><pose>0 0 0 0 0 0</pose>'
        f"<axis><xyz>{said(TURN.inv().apply(AXIS))}</xyz>"
        "<limit><lower>-1.5</lower><upper>1.4</upper></limit></axis></joint></model></sdf>"
    )


def judged(path):
    design = stages.joints(stages.contacts(stages.import_(path)))
    report = stages.check(stages.simulate(stages.mass(design), ranges=True)).report
    return {finding.code: finding for finding in report.findings if finding.code in CODES}


def pasted(format, text, findings):
    """The text with what stands between backticks in the remedies."""
    given = {code: re.findall(r"`([^`]+)`", findings[code].remedy) for code in CODES}
    (axis,), (place, *rest), (reach,) = (given[code] for code in CODES)
    if format == "toml":
        for key in (axis, place, reach):
            text = re.sub(rf"(?m)^{key.split()[0]} = .*$", key, text)
        return text
    if format == "urdf":
        text = re.sub(r"<axis [^>]*/>", axis, text)
        text = re.sub(r'lower="[^"]*" upper="[^"]*"', reach, text)
        text = re.sub(r'(?<=<origin )xyz="[^"]*"(?= rpy)', place, text)
        before, _, after = text.partition('<link name="lever">')
        return before + '<link name="lever">' + after.replace('xyz="0 0 0"', f'xyz="{rest[0]}"', 1)
    if format == "xml":
        (joint,) = re.findall(r"<joint [^>]*>", text)
        for key in (axis, place, reach):
            joint = re.sub(rf' {key.split("=")[0]}="[^"]*"', f" {key}", joint)
        return re.sub(r"<joint [^>]*>", joint, text)
    text = re.sub(r"<xyz>[^<]*</xyz>", axis, text)
    text = re.sub(r"<lower>.*</upper>", reach, text)
    return text.replace("<pose>0 0 0 0 0 0</pose>", f"<pose>{place} 0 0 0</pose>")


@pytest.mark.parametrize(("format", "write"), [("toml", manifest), ("urdf", urdf), ("xml", mjcf), ("sdf", sdf)])
def test_what_the_remedies_give_is_pasted_and_the_findings_are_gone(tmp_path, format, write):
    meshes(tmp_path)
    path = tmp_path / f"lever.{format}"
    path.write_text(write(tmp_path))
    found = judged(path)
    assert set(found) == set(CODES), found
    path.write_text(pasted(format, path.read_text(), found))
    assert judged(path) == {}, path.read_text()


RACK = '[[function.coupling]]\njoints = ["rack_bearing", "pinion_bearing"]\nratio = 2\n'


@pytest.mark.parametrize(
    ("fixture", "code", "old", "new"),
    [
        ("pairs/screw_right", "KF405", "pitch = 4", "pitch = 5"),
        ("mechanisms/rack_and_pinion", "KF411", "\n[[function.joint]]", f"\n{RACK}\n[[function.joint]]"),
    ],
)
def test_a_ratio_and_a_lead_are_given_in_the_units_of_the_manifest(tmp_path, fixture, code, old, new):
    path = FIXTURES / fixture / f"{fixture.rpartition('/')[2]}.toml"
    for mesh in path.parent.glob("*.stl"):
        shutil.copy(mesh, tmp_path)
    text = path.read_text().replace(old, new, 1)

    def found():
        (tmp_path / "m.toml").write_text(text)
        rule = next(rule for rule in RULES if rule.code == code)
        return rule.outcome(Context(stages.joints(stages.contacts(stages.import_(tmp_path / "m.toml"))))).findings

    (finding,) = found()
    (given,) = re.findall(r"`([^`]+)`", finding.remedy)
    text = re.sub(rf"(?m)^{given.split()[0]} = .*$", given, text)
    assert not found()


def by_rule(path, code):
    rule = next(rule for rule in RULES if rule.code == code)
    return rule.outcome(Context(Design(form.load(path)))).findings


@pytest.mark.parametrize("limits", ['lower="1.5" upper="-1.2"', 'lower="-90" upper="70"'])
def test_limits_are_given_in_their_order_and_in_radians(tmp_path, limits):
    meshes(tmp_path)
    path = tmp_path / "lever.urdf"
    path.write_text(urdf(tmp_path).replace('lower="-1.5" upper="1.4"', limits))
    (finding,) = by_rule(path, "KF415")
    (given,) = re.findall(r"`([^`]+)`", finding.remedy)
    path.write_text(path.read_text().replace(limits, given))
    assert not by_rule(path, "KF415")


def test_the_file_that_is_meant_is_named(tmp_path):
    meshes(tmp_path)
    path = tmp_path / "lever.urdf"
    (tmp_path / "lever.stl").rename(tmp_path / "part_2.stl")
    path.write_text(urdf(tmp_path).replace("lever.stl", "part2.stl"))
    missing = next(finding for finding in by_rule(path, "KF131") if finding.severity == "error")
    (given,) = re.findall(r"`([^`]+)`", missing.remedy)
    assert given == "part_2.stl"
    path.write_text(path.read_text().replace("part2.stl", given))
    assert not [finding for finding in by_rule(path, "KF131") if finding.severity == "error"]


def test_the_middle_of_a_link_is_given_in_its_frame(tmp_path):
    meshes(tmp_path)
    path = tmp_path / "lever.urdf"
    inertial = (
        '<inertial><origin xyz="9 0 0"/><mass value="0.1"/>'
        '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    path.write_text(urdf(tmp_path).replace('<link name="lever">', f'<link name="lever">{inertial}'))
    (finding,) = by_rule(path, "KF124")
    (given,) = re.findall(r"`([^`]+)`", finding.remedy)
    path.write_text(path.read_text().replace('xyz="9 0 0"', f'xyz="{given}"'))
    assert not by_rule(path, "KF124")
