"""URDF: what a description says is what the assembly has; what is wrong is told with file, line and remedy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.support.robots import ARM, BASE, JOINT, TOOL, ring, urdf, write

from kinform import form
from kinform.errors import InputError
from kinform.form.sources import Reading


def faults(path, **settings):
    with pytest.raises(InputError) as caught:
        form.load(path, **settings)
    return caught.value.problems


def test_links_are_groups_and_shapes_are_parts(tmp_path):
    assembly = form.load(write(tmp_path, urdf()))
    assert [(g.name, g.parts) for g in assembly.groups] == [("arm", ("shaft",)), ("base", ("base.obj",))]
    assert [p.name for p in assembly.parts] == ["base.obj", "shaft", "tool"]
    assert assembly.part("tool").mesh is None
    assert assembly.ground == "base"
    assert np.allclose(assembly.part("tool").X_WP[:3, 3], [0.0, 0.0, 0.08])


def test_a_scaled_mesh_is_in_metres_and_a_primitive_has_its_exact_size(tmp_path):
    assembly = form.load(write(tmp_path, urdf()))
    low, high = assembly.part("base.obj").mesh.box
    assert np.allclose(np.r_[low, high], [-0.03, -0.03, 0.0, 0.03, 0.03, 0.06])
    shaft = assembly.part("shaft").mesh
    assert shaft.health.watertight and shaft.health.manifold_status == "NoError"
    sides = shaft.vertices[np.abs(shaft.vertices[:, :2]).max(axis=1) > 1e-6]
    assert np.allclose(np.linalg.norm(sides[:, :2], axis=1), 0.01, rtol=1e-14)
    assert shaft.health.volume == pytest.approx(math.pi * 0.01**2 * 0.06, rel=1e-3)


def test_a_joint_is_function_with_its_range_limits_and_damping(tmp_path):
    function = form.load(write(tmp_path, urdf())).function
    turn, tip = sorted(function.joints, key=lambda joint: joint.name, reverse=True)
    assert (turn.name, turn.type, turn.between) == ("turn", "revolute", ("base", "arm"))
    assert np.allclose(turn.axis, [0.0, 0.0, 1.0]) and np.allclose(turn.point, [0.0, 0.0, 0.03])
    assert turn.range == pytest.approx((-1.0, 2.0), rel=1e-15)
    assert (tip.type, tip.between) == ("fixed", ("arm", "tool"))
    assert [(r.kind, r.values["limit"], r.when_run) for r in function.requirements] == [
        ("torque", 3.0, True), ("speed", pytest.approx(4.0), True),
    ]  # fmt: skip
    assert [(d.kind, d.parameters) for d in function.drives] == [("damper", {"damping": 0.25})]
    assert function.complete == ("",)


def test_an_inertial_is_the_stated_mass_of_its_group(tmp_path):
    turned = BASE.replace('<origin xyz="0 0 0.1"/>', '<origin xyz="0 0 0.1" rpy="0 0 1.5707963267948966"/>')
    assembly = form.load(write(tmp_path, urdf(base=turned)))
    stated = next(g.override for g in assembly.groups if g.name == "base")
    assert stated.mass == 2.0 and np.allclose(stated.centre_of_mass, [0.0, 0.0, 0.1])
    assert np.allclose(stated.inertia, [[0.03, -0.001, 0.0], [-0.001, 0.02, 0.0], [0.0, 0.0, 0.04]])


def test_what_is_not_carried_is_listed_once_by_name(tmp_path):
    notes = form.load(write(tmp_path, urdf())).notes
    (note,) = notes
    assert "<transmission>" in note and "friction" in note


def test_collision_geometry_on_request(tmp_path):
    assembly = form.load(write(tmp_path, urdf()), reading=Reading(geometry="collision"))
    assert [p.name for p in assembly.parts] == ["arm box", "base", "tool"]
    assert np.allclose(np.ptp(assembly.part("arm box").mesh.vertices, axis=0), [0.02, 0.02, 0.06])


def test_a_negative_scale_mirrors_the_mesh_and_keeps_its_outside_out(tmp_path):
    shift = '<origin xyz="0.1 0 0"/>'
    plain = form.load(write(tmp_path / "a", urdf(base=BASE.replace("<visual>", "<visual>" + shift))))
    mirrored = BASE.replace("0.001 0.001 0.001", "0.001 0.001 -0.001").replace("<visual>", "<visual>" + shift)
    other = form.load(write(tmp_path / "b", urdf(base=mirrored)))
    a, b = (item.part("base.obj").mesh for item in (plain, other))
    assert b.health.volume == pytest.approx(a.health.volume, rel=1e-12) and a.health.volume > 0.0
    assert np.allclose(b.box[0], a.box[0] * [1, 1, 0] - [0.0, 0.0, 0.06])


@pytest.mark.parametrize("sign", [1.0, -2.0])
def test_mimic_is_a_coupling(tmp_path, sign):
    finger = '<link name="f"/><joint name="f" type="continuous"><parent link="arm"/><child link="f"/>'
    finger += f'<axis xyz="1 0 0"/><mimic joint="turn" multiplier="{sign}"/></joint>'
    coupling = form.load(write(tmp_path, urdf(more=finger))).function.couplings[0]
    assert coupling.joints == ("f", "turn") and coupling.ratio == pytest.approx(sign)


def test_a_rack_is_a_coupling_in_si(tmp_path):
    rack = '<link name="f"/><joint name="f" type="prismatic"><parent link="arm"/><child link="f"/>'
    rack += '<limit lower="0" upper="1"/><mimic joint="turn" multiplier="0.25"/></joint>'
    assert form.load(write(tmp_path, urdf(more=rack))).function.couplings[0].ratio == pytest.approx(0.25, rel=1e-14)


def link(name):
    return f'<link name="{name}"/>'


def joint(name, parent, child):
    return f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'


BAD = {
    "two roots": (urdf(more=link("lost")), 7),
    "cycle": (urdf(more=link("a") + link("b") + joint("x", "a", "b") + joint("y", "b", "a")), 7),
    "two parents": (urdf(more=joint("again", "base", "tool")), 7),
    "unknown parent": (urdf(more=link("a") + joint("x", "nobody", "a")), 7),
    "two links of a name": (urdf(more=link("arm")), 7),
    "not a number": (urdf(joint=JOINT.replace("0 0 0.03", "0 nan 0.03")), 5),
    "infinity": (urdf(joint=JOINT.replace("0 0 0.03", "0 0 1e999")), 5),
    "two numbers": (urdf(joint=JOINT.replace("0 0 0.03", "0 0.03")), 5),
    "zero axis": (urdf(joint=JOINT.replace("0 0 2", "0 0 0")), 5),
    "zero scale": (urdf(base=BASE.replace("0.001 0.001 0.001", "1 0 1")), 2),
    "unknown type": (urdf(kind="revolut"), 5),
    "no child": (urdf(joint=JOINT.replace('<child link="arm"/>', "")), 5),
    "missing package": (urdf(base=BASE.replace("package://arm/base", "package://other/no")), 2),
    "missing mesh": (urdf(base=BASE.replace("package://arm/base.obj", "../bose.obj")), 2),
    "long name": (urdf(base=BASE.replace("package://arm/base.obj", 300 * "x" + ".obj")), 2),
    "long name in a package": (
        urdf(base=BASE.replace("/base.obj", "/" + 99 * "/ü" + 256 * "ü")),
        2,
    ),
    "no geometry": (urdf(arm="<visual><geometry/></visual>"), 3),
    "negative size": (urdf(arm=ARM.replace('"0.06"', '"-0.06"')), 3),
    "mimics nobody": (urdf(joint=JOINT + '<mimic joint="tarn"/>'), 5),
    "mimic each other": (
        urdf(
            joint=JOINT + '<mimic joint="f"/>',
            more='<link name="f"/><joint name="f" type="continuous"><parent '
            'link="arm"/><child link="f"/><mimic joint="turn" multiplier="2"/></joint>',
        ),
        7,
    ),
    "underscore": (urdf(joint=JOINT.replace("0 0 0.03", "0 0 1_0")), 5),
    "two rotations": (urdf(joint=JOINT.replace("rpy=", 'quat_xyzw="0 0 0 1" rpy=')), 5),
    "no quaternion": (urdf(joint=JOINT.replace('rpy="0 0 0.5"', 'quat_xyzw="0 0 0 0"')), 5),
    "truncated": (urdf()[:400], None),
    "entity bomb": ('<!DOCTYPE r [<!ENTITY a "b"><!ENTITY c "&a;&a;">]>\n' + urdf(), 1),
    "external entity": ('<!DOCTYPE r [\n<!ENTITY a SYSTEM "file:///etc/hostname">]>\n' + urdf(), 2),
    "external type": ('<!DOCTYPE r SYSTEM "http://example.org/r.dtd">\n' + urdf(), 1),
    "empty": ("", None),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_told_with_file_line_and_remedy(tmp_path, case):
    text, line = BAD[case]
    problems = faults(write(tmp_path, text))
    assert problems[0].file == "arm.urdf"
    assert problems[0].remedy
    assert line is None or problems[0].line == line
    assert len(problems) == 1


@pytest.mark.parametrize(
    "data",
    [
        "<?xml version='1.0'?>\n<!-- \xe9 -->".encode("latin-1"),
        b"<?xml version='1.0' encoding='latin-one'?>\n",
        b"\n<?xml version='1.0'?>\n",
    ],
)
def test_what_stands_before_the_robot_is_refused(tmp_path, data):
    path = write(tmp_path, "")
    path.write_bytes(data + urdf().encode())
    assert faults(path)[0].remedy


def test_a_mimic_of_nobody_is_told_the_joints_there_are_or_that_there_is_none(tmp_path):
    mimic = JOINT + '<mimic joint="tarn"/>'
    alone = urdf(joint=mimic).replace(TOOL, "").replace('<link name="tool"/>\n', "")
    assert faults(write(tmp_path, alone))[0].remedy.count("tip") == 0
    assert faults(write(tmp_path, urdf(joint=mimic)))[0].remedy.count("tip") == 1


@pytest.mark.parametrize("file", [".", "./", "there.obj"])
def test_a_folder_in_the_place_of_a_mesh_is_told(tmp_path, monkeypatch, file):
    path = write(tmp_path, urdf(base=BASE.replace("package://arm/base.obj", file)))
    (path.parent / "there.obj").mkdir()
    monkeypatch.chdir(path.parent)
    (problem,) = faults(path.name)
    assert problem.line == 2 and problem.remedy


def test_packages_are_found_where_the_user_and_the_environment_say(tmp_path, monkeypatch):
    path = write(tmp_path, urdf(base=BASE.replace("package://arm/", "package://elsewhere/meshes/")))
    folder = tmp_path / "x" / "elsewhere" / "meshes"
    folder.mkdir(parents=True)
    (path.parent.parent / "base.obj").rename(folder / "base.obj")
    assert "--package elsewhere=FOLDER" in faults(path)[0].remedy
    stated = Reading(packages=(("elsewhere", str(folder.parent)),))
    meant = form.load(path, reading=stated).part("base.obj").mesh
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "x"))
    assert form.load(path).part("base.obj").mesh.digest == meant.digest
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    (tmp_path / "ament" / "share").mkdir(parents=True)
    folder.parent.rename(tmp_path / "ament" / "share" / "elsewhere")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "ament"))
    assert form.load(path).part("base.obj").mesh.digest == meant.digest


LAYOUTS = {
    "beside each other": ("ws/arm_repo/arm", "ws/arm_repo/elsewhere", "elsewhere"),
    "in two repositories": ("ws/src/arm_repo/arm", "ws/src/other_repo/elsewhere", "elsewhere"),
    "in a group of repositories": ("ws/src/mine/arm_repo/arm", "ws/src/theirs/other_repo/elsewhere", "elsewhere"),
    "in folders of other names": ("ws/src/arm", "ws/src/description", "elsewhere"),
    "without a workspace, in folders of other names": ("ws/mine", "ws/theirs", "elsewhere"),
    "as colcon installs them": ("install/arm/share/arm", "install/elsewhere/share/elsewhere", "elsewhere"),
    "as colcon installs them together": ("install/share/arm", "install/share/elsewhere", "elsewhere"),
}
"""Where the description's package lies, and the one of its mesh."""


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_package_is_found_in_the_workspace_of_the_description(tmp_path, layout):
    mine, theirs, name = LAYOUTS[layout]
    (tmp_path / ".git").mkdir()
    written = write(tmp_path, urdf(base=BASE.replace("package://arm/", f"package://{name}/meshes/")))
    for package, said in ((mine, "arm"), (theirs, name)):
        (tmp_path / package).mkdir(parents=True)
        (tmp_path / package / "package.xml").write_text(f"<package>\n<name> {said} </name></package>")
    for folder in {(tmp_path / package).parent for package in (mine, theirs)}:
        (folder / "loop").symlink_to("loop")  # a link to itself hides nothing
    (tmp_path / mine / "urdf").mkdir()
    (tmp_path / theirs / "meshes").mkdir()
    (tmp_path / "arm" / "base.obj").rename(tmp_path / theirs / "meshes" / "base.obj")
    path = written.rename(tmp_path / mine / "urdf" / "arm.urdf")
    assert form.load(path).part("base.obj").mesh is not None
    (tmp_path / theirs / "package.xml").write_text("<package><name>another</name></package>")
    if layout not in ("beside each other", "as colcon installs them", "as colcon installs them together"):
        assert f"--package {name}=FOLDER" in faults(path)[0].remedy


def test_a_package_is_where_the_user_says_though_a_folder_of_its_name_is_above(tmp_path):
    path = write(tmp_path, urdf())
    own = form.load(path).part("base.obj").mesh
    other = tmp_path / "other"
    other.mkdir()
    (other / "base.obj").write_text(ring(5.0, 20.0, 10.0))
    said = form.load(path, reading=Reading(packages=(("arm", str(other)),))).part("base.obj").mesh
    assert said.digest != own.digest and np.allclose(np.ptp(said.vertices, axis=0), [0.04, 0.04, 0.01])


def test_an_origin_may_be_turned_by_a_quaternion(tmp_path):
    half = 0.25
    turned = JOINT.replace('rpy="0 0 0.5"', f'quat_xyzw="0 0 {math.sin(half)!r} {math.cos(half)!r}"')
    one, other = (form.load(write(tmp_path, urdf(joint=said))) for said in (JOINT, turned))
    assert np.allclose(one.part("shaft").X_WP, other.part("shaft").X_WP, atol=1e-15)
    assert not np.allclose(one.part("shaft").X_WP[:3, :3], np.eye(3), atol=0.1)


def test_expressions_are_said_to_be_of_xacro(tmp_path):
    (problem,) = faults(write(tmp_path, urdf(joint=JOINT.replace("0 0 0.03", "0 0 ${height}"))))
    assert ".xacro" in problem.remedy


def test_a_prefix_that_nobody_declares_is_accepted(tmp_path):
    ball = '<link name="b"/><drake:joint name="b" type="ball"><parent link="arm"/><child link="b"/></drake:joint>'
    joints = form.load(write(tmp_path, urdf(more=ball))).function.joints
    assert [j.type for j in joints if j.name == "b"] == ["spherical"]


LIMITED = """<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="{type}"><parent link="a"/>
<child link="b"/>
<axis xyz="0 0 1"/><limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="2"/></joint></robot>"""


@pytest.mark.parametrize("type", ["revolute", "prismatic"])
@pytest.mark.parametrize(
    "lower,upper,range",
    [
        ("-1", "2", (-1.0, 2.0)),
        ("-1e9", "1e9", None),
        ("-1e16", "0.5", (-math.inf, 0.5)),
        ("0", "1e12", (0.0, math.inf)),
        ("-9e8", "1", (-9e8, 1.0)),
    ],
)
def test_a_limit_that_stands_for_none_is_none(tmp_path, type, lower, upper, range):
    text = LIMITED.format(type=type, lower=lower, upper=upper, effort="1e9" if range is None else "5")
    function = form.load(write(tmp_path, text)).function
    (joint,) = function.joints
    assert joint.range == (None if range is None else pytest.approx(range))
    limits = sorted(requirement.values["limit"] for requirement in function.requirements)
    assert limits == ([2.0] if range is None else [2.0, 5.0])
