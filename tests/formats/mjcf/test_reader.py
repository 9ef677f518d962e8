"""MJCF: what MuJoCo itself makes of a description is what the assembly has; what is wrong is told with its place."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.robots import ring

from kinform import form
from kinform.errors import InputError

HEAD = """<mujoco model="arm">
<compiler angle="{angle}" eulerseq="{sequence}" meshdir="meshes"/>
<default>
<default class="seen"><geom contype="0" conaffinity="0"/><joint axis="0 1 0" damping="0.5"/>
<default class="thin"><geom type="capsule" size="0.01"/></default></default>
</default>
<asset><mesh name="ring" file="ring.obj" scale="0.001 0.001 -0.001"/></asset>
"""
WORLD = """<worldbody>
<body name="base" pos="0 0 0.1" euler="{a} {b} {c}">
<geom type="mesh" mesh="ring" pos="0.01 0 0"/>
<inertial pos="0 0 0.02" mass="2" diaginertia="0.04 0.03 0.02" euler="{a} 0 0"/>
<body name="arm" childclass="seen" pos="0.1 0 0" axisangle="1 2 3 {b}">
<joint name="turn" range="{low} {high}" pos="0 0 0.01"/>
<geom class="thin" fromto="0 0 0 0.05 0.02 0.1"/>
<geom type="box" size="0.01 0.02 0.03" xyaxes="0 1 0 -1 0 0" contype="1"/>
<frame pos="0 0.2 0" euler="0 {c} 0">
<body name="wrist" zaxis="0 1 1"><joint name="a" axis="1 0 0"/><joint name="b" type="slide" ref="0.1" range="0 1"/>
<geom type="sphere" size="0.02"/></body>
</frame>
</body>
</body>
</worldbody>
<equality><joint joint1="a" joint2="turn" polycoef="0 -2 0 0 0"/></equality>
<actuator><motor joint="turn" forcerange="-3 3" gear="2"/></actuator>
</mujoco>
"""


def text(angle="degree", sequence="xyz"):
    unit = 1.0 if angle == "degree" else np.pi / 180.0
    values = {"a": 30.0, "b": -50.0, "c": 70.0, "low": -90.0, "high": 45.0}
    scaled = {key: repr(value * unit) for key, value in values.items()}
    return HEAD.format(angle=angle, sequence=sequence) + WORLD.format(**scaled)


def write(folder, content):
    (folder / "meshes").mkdir(exist_ok=True)
    (folder / "meshes" / "ring.obj").write_text(ring(10.0, 30.0, 60.0))
    path = folder / "arm.xml"
    path.write_text(content)
    return path


@pytest.mark.parametrize("angle,sequence", [("degree", "xyz"), ("radian", "xyz"), ("degree", "ZYX"), ("radian", "zXy")])
def test_poses_axes_and_masses_are_those_of_mujoco(tmp_path, angle, sequence):
    mujoco = pytest.importorskip("mujoco")
    path = write(tmp_path, text(angle, sequence))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    assembly = form.load(path)
    for joint in assembly.function.joints:
        if joint.type == "fixed":
            continue
        k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
        assert np.allclose(joint.axis, data.xaxis[k], atol=1e-12)
        if joint.point is not None:
            assert np.allclose(joint.point, data.xanchor[k], atol=1e-12)
    base = next(group.override for group in assembly.groups if group.name == "base")
    k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "base")
    turned = data.ximat[k].reshape(3, 3)
    assert np.allclose(base.centre_of_mass, data.xipos[k], atol=1e-12)
    assert np.allclose(base.inertia, turned @ np.diag(model.body_inertia[k]) @ turned.T, atol=1e-12)
    for name, kind in (("arm capsule", mujoco.mjtGeom.mjGEOM_CAPSULE), ("wrist sphere", mujoco.mjtGeom.mjGEOM_SPHERE)):
        k = list(model.geom_type).index(int(kind))
        X = assembly.part(name).X_WP
        assert np.allclose(X[:3, 3], data.geom_xpos[k], atol=1e-12)
        assert np.allclose(np.abs(X[:3, 2] @ data.geom_xmat[k].reshape(3, 3)[:, 2]), 1.0, atol=1e-12)


FRAMES = """<mujoco><compiler angle="degree"/><default><default class="s"><joint type="slide" axis="1 0 0"/></default>
</default><worldbody><body name="a"><geom size="0.1"/><body name="b" pos="0 0 1">
<frame pos="1 0 0" euler="0 0 90"><frame pos="1 0 0" euler="90 20 0"><joint name="turn" pos="0 0.5 0"/></frame>
<frame childclass="s" euler="0 30 0"><joint name="slide"/></frame></frame><geom size="0.1"/></body></body>
</worldbody></mujoco>
"""


def test_joints_in_frames_of_a_body_stand_as_the_frames_are_nested(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    path = write(tmp_path, FRAMES)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    joints = {joint.name: joint for joint in form.load(path).function.joints}
    for k, (name, kind) in enumerate((("turn", "revolute"), ("slide", "prismatic"))):
        assert joints[name].type == kind
        assert np.allclose(joints[name].axis, data.xaxis[k], atol=1e-12)
    assert np.allclose(joints["turn"].point, data.xanchor[0], atol=1e-12)


def test_function_and_what_is_seen(tmp_path):
    assembly = form.load(write(tmp_path, text()))
    assert [group.name for group in assembly.groups] == ["arm", "base", "wrist"]
    assert [str(part.name) for part in assembly.parts] == ["arm capsule", "ring", "wrist 1", "wrist sphere"]
    joints = {joint.name: joint for joint in assembly.function.joints}
    assert joints["turn"].between == ("base", "arm") and joints["turn"].range == pytest.approx((-np.pi / 2, np.pi / 4))
    assert joints["a"].between == ("arm", "wrist 1") and joints["b"].between == ("wrist 1", "wrist")
    assert joints["b"].type == "prismatic" and joints["b"].range == pytest.approx((-0.1, 0.9))
    assert assembly.function.couplings[0].ratio == pytest.approx(-2.0)
    assert [r.values["limit"] for r in assembly.function.requirements] == [6.0]


def test_masses_of_geoms_and_of_the_whole_are_said_not_to_be_carried(tmp_path):
    geoms = '<geom size="0.1" mass="2"/><geom size="0.1" density="500"/><geom size="0.1" mass="0"/>'
    body = f'<worldbody><geom size="1" mass="9"/><body name="a">{{}}<joint/>{geoms}</body></worldbody></mujoco>'
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    every = {"settotalmass of <compiler>", "mass of geoms", "density of geoms"}
    for total, has, said in (("5", "", every), ("-1", inertial, set())):
        text = f'<mujoco><compiler settotalmass="{total}"/>' + body.format(has)
        notes = " ".join(note for note in form.load(write(tmp_path, text)).notes if note.startswith("arm.xml:"))
        assert {one for one in notes.rpartition(": ")[2].split(", ") if one} == said


def test_what_changes_inertias_and_dampers_unseen_is_said_not_to_be_carried(tmp_path):
    changed = text().replace("<compiler", '<compiler balanceinertia="true"').replace(
        'damping="0.5"', 'damping="0.5" springdamper="1 1" armature="0.0" frictionloss="00"')  # fmt: skip
    (said,) = (
        note.rpartition(": ")[2].split(", ")
        for note in form.load(write(tmp_path, changed)).notes
        if note.startswith("arm.xml:")
    )
    assert [word for word in said if "inertia" in word or "joints" in word] == [
        "balanceinertia of <compiler>", "springdamper of joints (3)",
    ]  # fmt: skip


def test_loops_are_joints(tmp_path):
    closing = '<equality><connect body1="arm" body2="base" anchor="0 0 0.1"/>'
    second = '<connect body1="arm" body2="base" anchor="0 0.1 0.1"/>'
    once = form.load(write(tmp_path, text().replace("<equality>", closing))).function.joints
    twice = form.load(write(tmp_path, text().replace("<equality>", closing + second))).function.joints
    assert [j.type for j in once if j.name.startswith("connect")] == ["spherical"]
    assert [j.type for j in twice if j.name.startswith("connect")] == ["revolute"]


BAD = {
    "unknown mesh": (text().replace('mesh="ring"', 'mesh="rung"'), 10),
    "missing mesh": (text().replace("ring.obj", "none.obj"), 10),
    "unknown class": (text().replace('class="thin"', 'class="thick"', 2).replace('"thick"><geom', '"thin"><geom'), 14),
    "unknown joint type": (text().replace('name="b" type="slide"', 'name="b" type="glide"'), 17),
    "include of itself": (text().replace("<worldbody>", '<include file="arm.xml"/><worldbody>'), 8),
    "include outside": (text().replace("<worldbody>", '<include file="/etc/hostname"/><worldbody>'), 8),
    "not a number": (text().replace('pos="0 0 0.1"', 'pos="0 0 nan"'), 9),
    "two bodies": (text().replace('body name="wrist"', 'body name="arm"'), 17),
    "no size": (text().replace('type="sphere" size="0.02"', 'type="sphere"'), 18),
    "another root": ("<robots/>", 1),
    "coordinates of the world": (text().replace('angle="degree"', 'coordinate="global" angle="degree"'), 2),
    "no quaternion": (text().replace('axisangle="1 2 3 -50.0"', 'quat="0 0 0 0"'), 12),
    "no axis of a turn": (text().replace('axisangle="1 2 3 -50.0"', 'axisangle="0 0 0 20"'), 12),
    "parallel axes": (text().replace('xyaxes="0 1 0 -1 0 0"', 'xyaxes="0 1 0 0 2 0"'), 15),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_told_with_file_line_and_remedy(tmp_path, case):
    content, line = BAD[case]
    with pytest.raises(InputError) as caught:
        form.load(write(tmp_path, content))
    problem = caught.value.problems[0]
    assert (problem.file, problem.line) == ("arm.xml", line)
    assert problem.remedy


def test_included_files_have_lines_of_their_own(tmp_path):
    path = write(tmp_path, text().replace("<worldbody>", '<include file="more.xml"/><worldbody>'))
    (tmp_path / "more.xml").write_text('<mujoco>\n<worldbody>\n<body name="x" pos="0 0 inf"/></worldbody></mujoco>')
    with pytest.raises(InputError) as caught:
        form.load(path)
    assert [(p.file, p.line) for p in caught.value.problems] == [("more.xml", 3)]
    (tmp_path / "more.xml").write_text('<mujoco>\n<include file="arm.xml"/></mujoco>')
    with pytest.raises(InputError):
        form.load(path)


def test_a_folder_beside_is_not_inside_though_its_name_begins_alike(tmp_path):
    """`robot2` is no folder of the package `robot`."""
    for name in ("robot", "robot2"):
        (tmp_path / name).mkdir()
    (tmp_path / "robot" / "package.xml").write_text("<package><name>robot</name></package>")
    path = write(tmp_path / "robot", text().replace("<worldbody>", '<include file="../robot2/more.xml"/><worldbody>'))
    (tmp_path / "robot2" / "more.xml").write_text("<mujoco/>")
    with pytest.raises(InputError):
        form.load(path)


REPLICAS = """<mujoco><compiler angle="{angle}" eulerseq="{sequence}"/><worldbody><body name="base">
<geom name="hub" size="0.1"/>
<replicate count="11" offset="0.1 0.02 0" euler="{a} {b} {c}" sep="-">
  <body name="arm" pos="0.3 0 0.1" euler="{a} 0 0"><joint name="turn" axis="0 1 1"/>
    <geom name="bar" size="0.01 0.2" type="capsule"/>
    <replicate count="2" offset="0 0 0.4"><body name="tip"><joint name="slide" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.1 0.2 0.3"/></body></replicate></body>
</replicate></body></worldbody></mujoco>
"""


@pytest.mark.parametrize(("angle", "sequence", "unit"), [("degree", "xyz", 1.0), ("radian", "ZYX", np.pi / 180.0)])
def test_replicas_are_where_mujoco_has_them_with_its_names(tmp_path, angle, sequence, unit):
    mujoco = pytest.importorskip("mujoco")
    angles = {"a": 10.0 * unit, "b": 20.0 * unit, "c": 30.0 * unit}
    path = write(tmp_path, REPLICAS.format(angle=angle, sequence=sequence, **angles))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    assembly = form.load(path)
    joints = {j.name: j for j in assembly.function.joints if j.type != "fixed"}
    assert sorted(joints) == sorted(mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, k) for k in range(model.njnt))
    for name, joint in joints.items():
        k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
        assert np.allclose(joint.axis, data.xaxis[k], atol=1e-12)
        assert joint.point is None or np.allclose(joint.point, data.xanchor[k], atol=1e-12)
    assert {g.name for g in assembly.groups} == {
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, k) for k in range(1, model.nbody)
    }  # fmt: skip


@pytest.mark.parametrize("count", ["0", "-3", "1e9", "nan"])
def test_counts_of_replicas_that_cannot_be_are_told(tmp_path, count):
    said = REPLICAS.format(angle="degree", sequence="xyz", a=1, b=2, c=3).replace('count="11"', f'count="{count}"')
    with pytest.raises(InputError) as caught:
        form.load(write(tmp_path, said))
    assert caught.value.problems[0].line == 3


TURNS = {"quat": ".3 .4 -.5 .6", "euler": "20 30 40", "axisangle": "1 2 3 50", "xyaxes": "1 .2 .3 0 1 -.3",
         "zaxis": "1 2 3"}  # fmt: skip


@pytest.mark.parametrize("over", TURNS)
@pytest.mark.parametrize("below", TURNS)
def test_the_orientation_that_is_stated_last_counts(tmp_path, below, over):
    mujoco = pytest.importorskip("mujoco")
    bar = '<geom type="box" size=".1 .2 .3"'
    first, last = (f'{turn}="{TURNS[turn]}"' for turn in (below, over))
    classes = f'<default><geom {first}/><default class="a"><geom {last}/></default></default>'
    bars = f'{bar} name="x" {last}/>{bar} name="y" class="a"/>{bar} name="z" class="a" {first}/>'
    text = f"<mujoco>{classes}<worldbody>{bars}</worldbody></mujoco>"
    path = write(tmp_path, text)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    assembly = form.load(path)
    for k, name in enumerate("xyz"):
        assert np.allclose(assembly.part(name).X_WP[:3, :3], data.geom_xmat[k].reshape(3, 3), atol=1e-12)


SCALES = [("2 3 -4", "1 0 0 0"), ("2 -2 2", ".5 .3 .2 .1"), ("2 3 -4", "1 1 0 0"), ("-2 3 4", "1 1 1 1"),
          ("2 3 4", "1 2 3 4")]  # fmt: skip


@pytest.mark.parametrize(("scale", "refquat"), SCALES)
def test_a_mesh_is_scaled_along_the_axes_of_its_reference_frame(tmp_path, scale, refquat):
    mujoco = pytest.importorskip("mujoco")
    mesh = f'<mesh name="ring" file="ring.obj" scale="{scale}" refpos="1 2 3" refquat="{refquat}"/>'
    text = (f'<mujoco><compiler meshdir="meshes"/><asset>{mesh}</asset><worldbody><geom size="1"/>'
            f'<geom type="mesh" mesh="ring" pos="4 5 6" quat="1 2 1 2"/></worldbody></mujoco>')  # fmt: skip
    path = write(tmp_path, text)
    assembly = form.load(path)
    if refquat == "1 2 3 4":  # no pose and scale along the axes of the file give a sheared mesh
        assert [str(part.name) for part in assembly.parts] == ["world sphere"]
        assert assembly.notes
        return
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    theirs = model.mesh_vert @ data.geom_xmat[1].reshape(3, 3).T + data.geom_xpos[1]
    part = assembly.part("ring")
    ours = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
    assert ours.shape == theirs.shape
    distances = np.linalg.norm(ours[:, None] - theirs[None], axis=2)
    assert distances.min(axis=0).max() < 1e-4 and distances.min(axis=1).max() < 1e-4
    assert part.mesh.health.volume > 0.0


def test_names_with_slashes_are_found(tmp_path):
    named = text().replace('name="turn"', 'name="r/turn"').replace('joint="turn"', 'joint="r/turn"')
    function = form.load(write(tmp_path, named.replace('joint2="turn"', 'joint2="r/turn"'))).function
    assert function.couplings[0].joints == ("a", "r_turn")
    assert [r.values["limit"] for r in function.requirements] == [6.0]


def test_all_worlds_are_seen(tmp_path):
    worlds = '<worldbody><geom name="{}" size="1"/></worldbody>'
    text = f"<mujoco>{worlds.format('a')}{worlds.format('b')}</mujoco>"
    assert [str(part.name) for part in form.load(write(tmp_path, text)).parts] == ["a", "b"]


PAIR = """<mujoco><default><equality active="{on}"/><general forcerange="-3 3"/></default><worldbody>
<body name="a"><geom size="0.1"/><site name="s" pos="0 0 0.1"/>
<body name="b" pos="0 0 0.5"><joint name="turn"/><geom size="0.1"/><site name="t" pos="{x} 0 -0.4" euler="0 {y} 0"/>
<body name="c"><joint name="ball" type="ball" range="0 30"/><geom size="0.1"/></body></body></body></worldbody>
<equality>{closing}</equality><actuator>{actuators}</actuator></mujoco>
"""


def paired(tmp_path, on="true", x=0.0, y=0.0, closing="", actuators=""):
    return form.load(write(tmp_path, PAIR.format(on=on, x=x, y=y, closing=closing, actuators=actuators)))


SITES = '<{} name="loop" site1="s" site2="t"/>'
RELATIVE = '<weld name="loop" body1="a" body2="b" relpose="0 0 {} {} 0 0 0"/>'


@pytest.mark.parametrize(
    "closing,x,y,type,gap",
    [
        (SITES.format("connect"), 0.0, 0.0, "spherical", None),
        (SITES.format("connect"), 0.0, 20.0, "spherical", None),
        (SITES.format("connect"), 0.00005, 0.0, "spherical", None),
        (SITES.format("connect"), 0.003, 0.0, None, "3 mm"),
        (SITES.format("weld"), 0.0, 0.0, "fixed", None),
        (SITES.format("weld"), 0.0, 2.0, None, "2°"),
        (RELATIVE.format(0.5, 1), 0.0, 0.0, "fixed", None),
        (RELATIVE.format(0.7, 1), 0.0, 0.0, None, "200 mm"),
        (RELATIVE.format(0.7, 0), 0.0, 0.0, "fixed", None),
    ],
)
def test_a_loop_that_is_open_in_the_pose_of_the_file_is_said_and_no_joint(tmp_path, closing, x, y, type, gap):
    assembly = paired(tmp_path, x=x, y=y, closing=closing)
    assert [joint.type for joint in assembly.function.joints if joint.name == "loop"] == [type][: type is not None]
    assert any(gap is not None and f" {gap}" in note for note in assembly.notes) == (gap is not None)


def test_a_loop_that_its_class_switches_off_is_none(tmp_path):
    weld = '<weld name="loop" body1="a" body2="b"/>'
    joints = {on: paired(tmp_path, on, closing=weld).function.joints for on in ("true", "false")}
    assert {on: any(j.name == "loop" for j in found) for on, found in joints.items()} == {"true": True, "false": False}


def test_what_is_stated_of_a_ball_is_said_not_to_be_carried(tmp_path):
    assert paired(tmp_path).notes


@pytest.mark.parametrize(
    "actuators,limit",
    [
        ('<motor joint="turn"/>', 3.0),
        ('<position joint="turn" forcerange="-5 4" gear="2"/>', 10.0),
        ('<position joint="turn"/><velocity joint="turn" forcerange="-1 1"/>', 4.0),
        ('<position joint="turn"/><motor joint="turn" forcelimited="false"/>', None),
    ],
)
def test_actuators_of_a_joint_add_up_and_share_the_defaults_of_all(tmp_path, actuators, limit):
    said = [r.values["limit"] for r in paired(tmp_path, actuators=actuators).function.requirements]
    assert said == ([] if limit is None else [limit])


def test_files_are_found_beside_the_file_that_includes_them_where_they_are_not_beside_the_first(tmp_path):
    below = tmp_path / "parts"
    (below / "deep").mkdir(parents=True)
    body = '<worldbody><body name="a"><geom type="mesh" mesh="{}"/></body></worldbody></mujoco>'
    top = write(tmp_path, '<mujoco><include file="parts/one.xml"/></mujoco>')
    (below / "one.xml").write_text('<mujoco><include file="deep/two.xml"/></mujoco>')
    (below / "deep" / "two.xml").write_text('<mujoco><asset><mesh file="own.obj"/></asset>' + body.format("own"))
    (below / "deep" / "own.obj").write_text(ring(10.0, 30.0, 60.0))
    part = form.load(top).part("own")
    assert np.ptp(part.mesh.vertices[:, 2]) == pytest.approx(60.0)
    (tmp_path / "own.obj").write_text(ring(10.0, 30.0, 20.0))  # as MuJoCo has it, this one comes first
    assert np.ptp(form.load(top).part("own").mesh.vertices[:, 2]) == pytest.approx(20.0)
    mujoco = pytest.importorskip("mujoco")
    first = mujoco.MjModel.from_xml_path(str(top)).body_mass[1]
    (tmp_path / "own.obj").unlink()
    assert mujoco.MjModel.from_xml_path(str(top)).body_mass[1] == pytest.approx(3.0 * first)


@pytest.mark.parametrize(("deep", "read"), [(250, True), (300, False)])
def test_a_chain_is_read_as_long_as_its_bodies_may_be_nested(tmp_path, deep, read):
    mass = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    bodies = f'<body pos="0 0 .1"><joint axis="0 1 0"/>{mass}' * deep + "</body>" * deep
    path = tmp_path / "chain.xml"
    path.write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    if read:
        assert len(form.load(path).function.joints) == deep
    else:
        with pytest.raises(InputError) as caught:
            form.load(path)
        problem = caught.value.problems[0]
        assert problem.remedy


def test_meshes_without_their_meshdir_are_told_where_they_are(tmp_path):
    folder = tmp_path / "package" / "mjcf"
    folder.mkdir(parents=True)
    path = write(folder, text().replace('meshdir="meshes"', ""))
    with pytest.raises(InputError) as caught:
        form.load(path)
    (problem,) = caught.value.problems
    assert '"meshes/ring.obj"' in problem.remedy
    (folder / "meshes" / "ring.obj").unlink()
    with pytest.raises(InputError) as caught:
        form.load(path)
    assert "ring.obj" not in caught.value.problems[0].remedy


def test_an_angle_in_no_known_unit_is_told(tmp_path):
    with pytest.raises(InputError) as caught:
        form.load(write(tmp_path, text().replace('angle="degree"', 'angle="Radian"')))
    assert caught.value.problems[0].line == 2


def test_a_mesh_that_is_scaled_to_nothing_is_left_out(tmp_path):
    mesh = '<mesh name="a" file="a.stl" scale="1e-320 1 1" refquat="1 1 0 0"/>'
    (tmp_path / "m.xml").write_text(
        f'<mujoco><asset>{mesh}</asset><worldbody><body><geom type="mesh" mesh="a"/></body></worldbody></mujoco>'
    )
    (tmp_path / "a.stl").write_bytes(b"")
    with np.errstate(all="raise", under="ignore"):
        assembly = form.load(tmp_path / "m.xml")
    assert [part.mesh for part in assembly.parts] == [None]
