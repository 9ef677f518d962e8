"""SDF: places, axes and masses as Drake has them, the assembly of the URDF twin, and what is wrong in a line."""

from __future__ import annotations

import time

import numpy as np
import pytest
from tests.support.robots import ring, urdf, write
from tests.support.validators import package

import kinform
from kinform import form
from kinform.errors import InputError
from kinform.form.sources import Reading
from kinform.formats.description.poses import rpy

BOX = "<geometry><box><size>0.1 0.2 0.3</size></box></geometry>"
INERTIA = "<inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz><ixy>0.001</ixy></inertia>"


def link(name, pose="", more=""):
    return (
        f'<link name="{name}">{pose}<inertial><pose>0.01 0 0.02 0.1 0.2 0.3</pose><mass>2</mass>{INERTIA}</inertial>'
        f'<visual name="seen"><pose>0 0 0.1 0 0 0.5</pose>{BOX}</visual>{more}</link>'
    )


def joint(name, parent, child, kind="revolute", axis="<axis><xyz>0 0.6 0.8</xyz></axis>", more=""):
    return f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{axis}{more}</joint>'


FRAMES = f"""<sdf version="1.9">
<model name="top" canonical_link="base">
  <pose>1 2 3 0.1 0.2 0.3</pose>
  {link("base", "<pose>0.1 0 0 0 0 0.2</pose>")}
  <frame name="f" attached_to="base"><pose degrees="true">0 0.5 0 90 0 45</pose></frame>
  <frame name="g"><pose relative_to="f" rotation_format="quat_xyzw">0 0 1 0.5 0.5 0.5 0.5</pose></frame>
  {link("arm", '<pose relative_to="g">0.3 0 0 0.4 0 0</pose>')}
  {joint("one", "f", "arm", axis='<axis><xyz expressed_in="g">0 0.6 0.8</xyz></axis>')}
  <model name="hand" placement_frame="grip">
    <pose relative_to="one">0 0 0.2 0 0.3 0</pose>
    {link("palm", "<pose>0 0 0.05 0 0 0.7</pose>")}
    {link("finger", '<pose relative_to="palm">0.1 0 0 0 0 0</pose>')}
    <frame name="grip" attached_to="finger"><pose>0 0.02 0 0 0 0.1</pose></frame>
    {joint("slide", "palm", "finger", "prismatic", more="<pose>0 0 0 0.2 0 0</pose>")}
  </model>
  {joint("wrist", "arm", "hand", "fixed", "")}
  {joint("screw", "base", "nut", "screw", more="<screw_thread_pitch>0.003</screw_thread_pitch>")}
  {link("nut", '<pose relative_to="hand::finger">0 0 0.4 0 0 0</pose>')}
</model>
</sdf>
"""


def load(folder, text, name="a.sdf", **settings):
    path = folder / name
    path.write_text(text)
    return form.load(path, **settings)


def drake(path, packages=None):
    plants = package("pydrake.multibody.plant")
    from pydrake.multibody.parsing import Parser

    plant = plants.MultibodyPlant(0.0)
    parser = Parser(plant)
    for name, folder in (packages or {}).items():
        parser.package_map().Add(name, str(folder))
    parser.AddModels(str(path))
    plant.Finalize()
    return plant, plant.CreateDefaultContext()


def assert_as_drake(assembly, plant, context):
    """Links, masses, axes and points are where Drake has them."""
    groups = {group.name: group for group in assembly.groups}
    seen = 0
    for index in range(plant.num_bodies()):
        from pydrake.multibody.tree import BodyIndex

        body = plant.get_body(BodyIndex(index))
        scope = plant.GetModelInstanceName(body.model_instance()).partition("::")[2]
        name = f"{scope}::{body.name()}" if scope else body.name()
        if name == "world":
            continue
        X = body.EvalPoseInWorld(context).GetAsMatrix4()
        group = groups[name]
        box = assembly.part(group.parts[0]).X_WP
        turned = np.eye(4)
        turned[:3, :3] = [[np.cos(0.5), -np.sin(0.5), 0], [np.sin(0.5), np.cos(0.5), 0], [0, 0, 1]]
        turned[2, 3] = 0.1
        assert np.allclose(box, X @ turned, atol=1e-12), name
        inertia = body.default_spatial_inertia()
        assert group.override.mass == pytest.approx(inertia.get_mass())
        centre = X[:3, :3] @ inertia.get_com() + X[:3, 3]
        assert np.allclose(group.override.centre_of_mass, centre, atol=1e-12)
        about = inertia.Shift(inertia.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
        assert np.allclose(group.override.inertia, X[:3, :3] @ about @ X[:3, :3].T, atol=1e-12)
        seen += 1
    assert seen == len(groups)
    for index in plant.GetJointIndices():
        theirs = plant.get_joint(index)
        if theirs.num_velocities() != 1:
            continue
        ours = next(j for j in assembly.function.joints if j.name.rpartition("::")[2] == theirs.name())
        X = theirs.frame_on_parent().CalcPoseInWorld(context).GetAsMatrix4()
        kind = theirs.type_name()
        axis = {"revolute": "revolute_axis", "prismatic": "translation_axis"}.get(kind)
        assert ours.type == kind
        assert axis is None or np.allclose(ours.axis, X[:3, :3] @ getattr(theirs, axis)(), atol=1e-12)
        if kind != "prismatic":
            assert np.linalg.norm(np.cross(ours.axis, ours.point - X[:3, 3])) < 1e-12
        if kind == "screw":
            assert ours.pitch == pytest.approx(theirs.screw_pitch())


def test_frames_and_nested_models_are_where_drake_has_them(tmp_path):
    assembly = load(tmp_path, FRAMES)
    assert {group.name for group in assembly.groups} == {"base", "arm", "nut", "hand::palm", "hand::finger"}
    assert {j.name: j.between for j in assembly.function.joints} == {
        "one": ("base", "arm"), "wrist": ("arm", "hand::palm"), "screw": ("base", "nut"),
        "hand::slide": ("hand::palm", "hand::finger"),
    }  # fmt: skip
    assert_as_drake(assembly, *drake(tmp_path / "a.sdf"))


def test_includes_are_read_from_packages_and_files(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "models" / "tool").mkdir(parents=True)
    (tmp_path / "models" / "tool" / "model.config").write_text("<model><sdf version='1.7'>tool.sdf</sdf></model>")
    inner = f'<sdf version="1.7"><model name="tool"><pose>5 5 5 0 0 0</pose>{link("tip")}</model></sdf>'
    (tmp_path / "models" / "tool" / "tool.sdf").write_text(inner)
    include = (
        "<include><uri>{}</uri><name>{}</name><pose relative_to='arm'>0 0 {} 0 0.1 0</pose></include>"
        '<joint name="j{}" type="fixed"><parent>arm</parent><child>{}::tip</child></joint>'
    )
    text = (
        f'<sdf version="1.8"><model name="top">{link("arm", "<pose>0 0 1 0.3 0 0</pose>")}'
        + include.format("package://tool/tool.sdf", "a", 0.1, 1, "a")
        + include.format("package://tool", "b", 0.2, 2, "b").replace("package:", "model:")
        + "</model></sdf>"
    )
    (tmp_path / "models" / "top").mkdir()
    assembly = load(tmp_path / "models" / "top", text)
    assert {group.name for group in assembly.groups} == {"arm", "a::tip", "b::tip"}
    path = tmp_path / "models" / "top" / "drake.sdf"
    path.write_text(text.replace("model://tool", "package://tool/tool.sdf"))
    assert_as_drake(assembly, *drake(path, {"tool": tmp_path / "models" / "tool"}))
    assert any(name.endswith("tool/tool.sdf") for name in assembly.files)


@pytest.mark.parametrize(
    ("version", "more", "frame"),
    [("1.4", "", "model"), ("1.5", "", "joint"), ("1.6", "<use>", "model"), ("1.7", "", "joint")],
)
def test_the_axis_is_in_the_frame_that_its_version_says(tmp_path, version, more, frame):
    axis = "<axis><xyz>1 0 0</xyz></axis>"
    if more:
        axis = axis.replace("</axis>", "<use_parent_model_frame>1</use_parent_model_frame></axis>")
    text = (
        f'<sdf version="{version}"><model name="m"><pose>0 0 0 0 0 1.5707963267948966</pose>{link("a")}'
        f"{link('b', '<pose>1 0 0 0 0 1.5707963267948966</pose>')}{joint('j', 'a', 'b', axis=axis)}</model></sdf>"
    )
    (found,) = load(tmp_path, text).function.joints
    assert np.allclose(found.axis, [0, 1, 0] if frame == "model" else [-1, 0, 0], atol=1e-12)
    assert np.allclose(found.point, [0, 1, 0], atol=1e-12)


def test_thread_pitch_is_radians_a_metre_and_left_handed(tmp_path):
    text = FRAMES.replace("screw_thread_pitch>", "thread_pitch>").replace(">0.003<", ">-2094.3951023931954<")
    screw = next(j for j in load(tmp_path, text).function.joints if j.name == "screw")
    assert screw.pitch == pytest.approx(0.003)


TWIN = """<sdf version="1.11">
<model name="arm">
<link name="base">
<inertial><pose>0 0 0.1 0 0 0</pose><mass>2</mass>
<inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz><ixy>0.001</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
<visual name="v"><geometry><mesh><uri>package://arm/base.obj</uri><scale>0.001 0.001 0.001</scale></mesh></geometry>
</visual>
</link>
<link name="arm"><pose>0 0 0.03 0 0 0.5</pose>
<visual name="shaft"><geometry><cylinder><radius>0.01</radius><length>0.06</length></cylinder></geometry></visual>
<collision name="c"><geometry><box><size>0.02 0.02 0.06</size></box></geometry></collision>
</link>
<link name="tool"><pose relative_to="arm">0 0 0.05 0 0 0</pose></link>
<joint name="turn" type="revolute"><parent>base</parent><child>arm</child>
<axis><xyz>0 0 2</xyz><limit><lower>-1</lower><upper>2</upper><effort>3</effort><velocity>4</velocity></limit>
<dynamics><damping>0.25</damping><friction>0.1</friction></dynamics></axis></joint>
<joint name="tip" type="fixed"><parent>arm</parent><child>tool</child></joint>
</model>
</sdf>
"""


@pytest.mark.parametrize("geometry", ["visual", "collision"])
def test_a_urdf_and_the_same_robot_as_sdf_are_the_same_assembly(tmp_path, geometry):
    write(tmp_path, urdf())
    path = tmp_path / "arm" / "urdf" / "twin.sdf"
    path.write_text(TWIN.replace('name="v"', 'name="base.obj"'))
    from kinform.form.readers.assembly import load

    one, other = (load(path.with_name(n), reading=Reading(geometry)) for n in ("arm.urdf", "twin.sdf"))
    assert [p.name for p in one.parts if p.mesh is None] == [p.name for p in other.parts if p.mesh is None]
    assert [(p.mesh.digest, p.X_WP.tolist()) for p in one.parts if p.mesh] == [
        (p.mesh.digest, p.X_WP.tolist()) for p in other.parts if p.mesh
    ]
    for a, b in zip(one.function.joints, other.function.joints, strict=True):
        assert (a.name, a.type, a.between, a.range) == (b.name, b.type, b.between, b.range)
        for x, y in ((a.axis, b.axis), (a.point, b.point)):
            assert (x is None) == (y is None) and (x is None or np.allclose(x, y, atol=1e-15))
    for key in ("drives", "requirements"):
        first, second = getattr(one.function, key), getattr(other.function, key)
        assert (
            [(x.kind, x.joint) for x in first] == [(y.kind, y.joint) for y in second]
            if key == "drives"
            else ([(x.name, x.kind, x.values) for x in first] == [(y.name, y.kind, y.values) for y in second])
        )
    for a, b in zip(one.groups, other.groups, strict=True):
        assert a.name == b.name and (a.override is None) == (b.override is None)
        if a.override is not None:
            assert a.override.mass == b.override.mass and np.allclose(a.override.inertia, b.override.inertia)
    assert one.function.complete == other.function.complete == ("",)


def test_a_mimic_is_a_coupling_and_the_world_is_a_link_only_where_it_is_needed(tmp_path):
    follows = '<axis><xyz>0 0 1</xyz><mimic joint="one" axis="axis"><multiplier>-2.5</multiplier></mimic></axis>'
    text = (
        f'<sdf version="1.11"><model name="m">{link("a")}{link("b")}{link("c")}'
        f"{joint('hold', 'world', 'a', 'fixed', '')}"
        f"{joint('one', 'a', 'b')}{joint('two', 'b', 'c', axis=follows)}</model></sdf>"
    )
    assembly = load(tmp_path, text)
    (coupling,) = assembly.function.couplings
    assert (coupling.joints, coupling.ratio) == (("two", "one"), pytest.approx(-2.5))
    assert assembly.ground == "a" and {g.name for g in assembly.groups} == {"a", "b", "c"}
    turning = load(tmp_path, text.replace('"hold" type="fixed"><parent>world</parent><child>a</child>',
                                          '"hold" type="revolute"><parent>world</parent><child>a</child>'
                                          "<axis><xyz>0 0 1</xyz></axis>"))  # fmt: skip
    assert next(j for j in turning.function.joints if j.name == "hold").between == ("world", "a")


def test_joints_that_mimic_each_other_are_refused(tmp_path):
    axes = (f'<axis><xyz>0 0 1</xyz><mimic joint="{name}" axis="axis"><multiplier>2</multiplier></mimic></axis>'
            for name in ("two", "one"))  # fmt: skip
    text = (
        f'<sdf version="1.11"><model name="m">{link("a")}{link("b")}{link("c")}'
        f"{joint('one', 'a', 'b', axis=next(axes))}{joint('two', 'b', 'c', axis=next(axes))}</model></sdf>"
    )
    with pytest.raises(InputError):
        load(tmp_path, text)


def test_several_models_of_a_world_keep_their_names_apart(tmp_path):
    model = '<model name="{}"><static>{}</static><pose>{} 0 0 0 0 0</pose>' + link("a") + "</model>"
    models = model.format("m", 1, 1) + model.format("n", 0, 2)
    text = f'<sdf version="1.6"><world name="w"><gravity>0 0 -9.8</gravity>{models}</world></sdf>'
    assembly = load(tmp_path, text)
    assert {g.name for g in assembly.groups} == {"m::a", "n::a"}
    assert assembly.ground == "m::a"
    assert {round(p.X_WP[0, 3], 9) for p in assembly.parts} == {1.0, 2.0}


def test_a_limit_that_stands_for_none_is_none(tmp_path):
    axis = "<axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>{}</upper></limit></axis>"
    text = '<sdf version="1.6"><model name="m">' + link("a") + link("b") + "{}</model></sdf>"
    for upper, expected in (("1e16", None), ("1.5", (-np.inf, 1.5))):
        (found,) = load(tmp_path, text.format(joint("j", "a", "b", axis=axis.format(upper)))).function.joints
        assert found.range == expected


def test_joints_of_a_world_join_its_models(tmp_path):
    model = '<model name="{}"><pose>{} 0.2 0 0.1 0.2 0.3</pose>' + link("a") + "</model>"
    between = (
        '<joint name="hinge" type="revolute"><pose relative_to="m">0 0 0.1 0 0.4 0</pose><parent>m::a</parent>'
        '<child>n::a</child><axis><xyz expressed_in="n::__model__">0 1 0</xyz></axis></joint><state world_name="w"/>'
    )
    text = f'<sdf version="1.11"><world name="w">{model.format("m", 1)}{model.format("n", 2)}{between}</world></sdf>'
    assembly = load(tmp_path, text)
    assert {joint.name: joint.between for joint in assembly.function.joints} == {"hinge": ("m::a", "n::a")}
    assert any("<state>" in note for note in assembly.notes)
    R = rpy((0.1, 0.2, 0.3))
    (hinge,) = assembly.function.joints
    assert np.allclose(hinge.axis, R[:, 1]) and np.allclose(hinge.point, [1.0, 0.2, 0.0] + 0.1 * R[:, 2])
    fixed = text.replace('"revolute"', '"fixed"').partition("<axis>")[0] + text.partition("</axis>")[2]
    assert [joint.type for joint in load(tmp_path, fixed).function.joints] == ["fixed"]
    drake(tmp_path / "a.sdf")  # it takes no other type there
    bad = text.replace("<child>n::a</child>", "<child>n::b</child>")
    with pytest.raises(InputError) as error:
        load(tmp_path, bad)
    assert '"n::b"' in str(error.value)


def test_what_is_not_carried_is_listed_once(tmp_path):
    text = FRAMES.replace("</visual>", "</visual><sensor name='s' type='imu'/>")
    text = text.replace("</model>\n</sdf>", "<plugin/></model>\n</sdf>")
    (note,) = load(tmp_path, text).notes
    assert "<plugin>" in note and "<sensor>" in note and "(5)" in note


def test_a_robot_of_sdf_runs(tmp_path):
    (tmp_path / "base.obj").write_text(ring(10.02, 30.0, 60.0))
    (tmp_path / "a.sdf").write_text(TWIN.replace("package://arm/base.obj", "base.obj"))
    results = kinform.run(tmp_path / "a.sdf")
    assert {i["name"]: i["answer"] for i in results.summary("joints")["intended"]} == {
        "turn": "not held", "tip": "agrees",
    }  # fmt: skip


def including(uri):
    return FRAMES.replace("<frame ", f"<include><uri>{uri}</uri></include><frame ", 1)


CIRCLE = FRAMES.replace('attached_to="base"><pose degrees="true">', '><pose relative_to="g">')
BAD = {
    "no link": ('<sdf version="1.7"><model name="m"/></sdf>', 1),
    "another root": ("<robot/>", 1),
    "unknown parent": (FRAMES.replace("<parent>f<", "<parent>ff<"), 8),
    "unknown frame": (FRAMES.replace('relative_to="g"', 'relative_to="gg"'), 7),
    "circle of poses": (CIRCLE, 0),
    "to itself": (FRAMES.replace("<parent>f<", "<parent>arm<"), 8),
    "two of a name": (FRAMES.replace('name="nut"', 'name="arm"'), 18),
    "nan": (FRAMES.replace("<pose>1 2 3", "<pose>nan 2 3"), 3),
    "five numbers": (FRAMES.replace("<pose>1 2 3 0.1 0.2 0.3<", "<pose>1 2 3 0.1 0.2<"), 3),
    "zero axis": (FRAMES.replace('expressed_in="g">0 0.6 0.8', 'expressed_in="g">0 0 0'), 8),
    "unknown type": (FRAMES.replace('"one" type="revolute"', '"one" type="hinge"'), 8),
    "no pitch": (FRAMES.replace("<screw_thread_pitch>0.003", "<screw_thread_pitch>0"), 17),
    "missing mesh": (FRAMES.replace(BOX, "<geometry><mesh><uri>no.stl</uri></mesh></geometry>", 1), 4),
    "include outside": (including("../../../etc/x.sdf"), 5),
    "include of a parent": (including("model://../x.sdf"), 5),
    "include missing": (including("no.sdf"), 5),
    "include itself": (including("a.sdf"), 5),
    "include from a network": (including("https://x.org/m"), 5),
    "entities": ('<!DOCTYPE s [<!ENTITY a "b">]>' + FRAMES, 1),
}  # fmt: skip


@pytest.mark.parametrize(("text", "line"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_told_with_line_and_remedy(tmp_path, text, line):
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    (problem,) = caught.value.problems
    assert problem.file == "a.sdf" and problem.remedy
    assert line in (0, problem.line)


def test_includes_that_double_are_refused_at_a_number_of_models(tmp_path, monkeypatch):
    monkeypatch.setattr("kinform.formats.sdf.reading.models.SDF_MODELS", 200)
    link = f'<link name="a"><visual name="v">{BOX}</visual></link>'
    (tmp_path / "d0.sdf").write_text(f'<sdf version="1.9"><model name="m">{link}</model></sdf>')
    for k in range(1, 26):
        twice = "".join(f"<include><uri>d{k - 1}.sdf</uri><name>{name}</name></include>" for name in "xy")
        (tmp_path / f"d{k}.sdf").write_text(f'<sdf version="1.9"><model name="m">{link}{twice}</model></sdf>')
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "d25.sdf")
    (problem,) = caught.value.problems
    assert problem.line and problem.remedy


WORLD = (
    '<sdf version="1.9"><world name="w">{}<include><uri>model://tool</uri></include>'
    '<model name="a"><link name="l"><visual name="v"><geometry><mesh><uri>model://tool/m.obj</uri></mesh></geometry>'
    "</visual></link></model></world></sdf>"
)
TOOL = f'<sdf version="1.9"><model name="tool"><link name="t"><visual name="v">{BOX}</visual></link></model></sdf>'


def a_world(folder, models, more=""):
    """A world, and a model in another folder."""
    (folder / ".git").mkdir()
    (folder / models / "tool").mkdir(parents=True)
    (folder / models / "tool" / "model.config").write_text("<model><sdf>model.sdf</sdf></model>")
    (folder / models / "tool" / "model.sdf").write_text(TOOL)
    (folder / models / "tool" / "m.obj").write_text(ring(0.1, 0.3, 0.6))
    (folder / "sim" / "worlds").mkdir(parents=True, exist_ok=True)
    path = folder / "sim" / "worlds" / "w.sdf"
    path.write_text(WORLD.format(more))
    return path


@pytest.mark.parametrize("models", ["sim/worlds/models", "sim/models", "models", "sim/worlds", "sim"])
def test_models_are_found_beside_worlds_and_above_them(tmp_path, models):
    assert len(form.load(a_world(tmp_path, models)).parts) == 2


@pytest.mark.parametrize("variable", ["GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH"])
def test_models_are_found_where_the_environment_says(tmp_path, monkeypatch, variable):
    path = a_world(tmp_path, "far/off")
    with pytest.raises(InputError) as caught:
        form.load(path)
    assert "--package tool=FOLDER" in caught.value.problems[0].remedy
    monkeypatch.setenv(variable, str(tmp_path / "far" / "off"))
    assert len(form.load(path).parts) == 2


@pytest.mark.parametrize(
    "uri",
    ["model://sun", "model://ground_plane", "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground%20Plane"],
)
def test_the_light_and_the_plane_of_gazebo_are_left_out_where_they_are_not_there(tmp_path, uri):
    path = a_world(tmp_path, "sim/models", f"<include><uri>{uri}</uri></include>")
    assembly = form.load(path)
    assert len(assembly.parts) == 2 and any(uri in note for note in assembly.notes)
    own = tmp_path / "sim" / "models" / uri.rpartition("/")[2]
    own.mkdir()
    (own / "model.sdf").write_text(TOOL.replace('name="tool"', 'name="own"'))
    assert len(form.load(path).parts) == (3 if uri.startswith("model") else 2)


PLATFORM = (
    '<sdf version="1.9"><model name="platform"><pose>9 9 9 0 0 0</pose>'
    f"{link('base', '<pose>0.1 0 0 0 0 0.2</pose>')}"
    '<frame name="mount"><pose>0 0 0.5 0.3 0 0</pose></frame>'
    + link("mast", '<pose relative_to="mount">0 0.2 0 0 0.4 0</pose>')
    + f"{joint('turn', 'base', 'mast', axis='<axis><xyz>0 0 1</xyz></axis>')}"
    '<link name="foot"><visual name="m"><geometry><mesh><uri>meshes/m.obj</uri></mesh></geometry></visual></link>'
    f"{joint('stand', 'base', 'foot', 'fixed', '')}"
    "</model></sdf>"
)
"""What is merged; the frames of its own are named once."""


def merged(folder, how, uri="platform", platform=PLATFORM):
    """A model that takes the platform in: merged, or nested as `platform`."""
    (folder / ".git").mkdir(exist_ok=True)
    (folder / "platform" / "meshes").mkdir(parents=True, exist_ok=True)
    (folder / "platform" / "model.config").write_text("<model><sdf>model.sdf</sdf></model>")
    (folder / "platform" / "model.sdf").write_text(platform)
    (folder / "platform" / "meshes" / "m.obj").write_text(ring(0.1, 0.3, 0.6))
    scope = "" if how else "platform::"
    path = folder / "robot" / "model.sdf"
    path.parent.mkdir(exist_ok=True)
    path.write_text(
        f'<sdf version="1.9"><model name="robot"><pose>1 2 3 0.5 0.6 0.7</pose>\\n<include {how}><uri>{uri}</uri>'
        "<pose>0.2 0.3 0.4 0.1 0.2 0.3</pose></include>\\n"
        + link("arm", f'<pose relative_to="{scope}mast">0 0 0.3 0 0 0</pose>')
        + joint("lift", f"{scope}mast", "arm", "prismatic", more="<pose>0 0 0 0.1 0 0</pose>")
        + "</model></sdf>"
    )
    return path


def places(path):
    assembly = form.load(path)
    parts = [(p.name.rpartition("::")[2], p.X_WP) for p in assembly.parts]
    joints = [(j.name.rpartition("::")[2], j.axis) for j in assembly.function.joints]
    return assembly, dict(parts), dict(joints)


@pytest.mark.parametrize("uri", ["platform", "model://platform", "../platform/model.sdf"])
def test_what_is_merged_stands_where_it_would_if_it_were_nested_and_has_no_prefix(tmp_path, uri):
    flat, parts, joints = places(merged(tmp_path, 'merge="true"', uri))
    nested, others, axes = places(merged(tmp_path, "", uri))
    assert parts.keys() == others.keys() and joints.keys() == axes.keys() and len(parts) == 4
    assert all(np.allclose(parts[name], others[name], atol=1e-12) for name in parts)
    assert all(axes[name] is None or np.allclose(joints[name], axes[name], atol=1e-12) for name in joints)
    assert {g.name for g in flat.groups} == {"arm", "base", "mast", "foot"}
    assert "platform::base" in {g.name for g in nested.groups}
    assert flat.descriptions[0].text == "" and flat.descriptions[0].format == "sdf"


@pytest.mark.parametrize(
    "platform",
    [
        PLATFORM.replace('name="mast"', 'name="arm"').replace(">mast<", ">arm<"),
        PLATFORM.replace('"mount">0 0.2', '"__model__">0 0.2'),
        PLATFORM.replace('name="platform"', 'name="platform" placement_frame="mount"'),
    ],
)
def test_what_cannot_be_merged_is_told_and_not_placed_somewhere_else(tmp_path, platform):
    with pytest.raises(InputError) as caught:
        form.load(merged(tmp_path, 'merge="true"', platform=platform))
    assert all(problem.line and problem.remedy for problem in caught.value.problems)


@pytest.mark.parametrize("around", ["{}", '<world name="w">{}</world>'])
@pytest.mark.parametrize("frame", ["world", "out", "deep"])
def test_a_placement_frame_outside_of_its_model_is_told(tmp_path, frame, around):
    frames = (
        '<frame name="out"><pose relative_to="world">1 0 0 0 0 0</pose></frame><frame name="deep" attached_to="out"/>'
    )
    model = f'<model name="m" placement_frame="{frame}">{link("a")}{frames}</model>'
    with pytest.raises(InputError) as caught:
        load(tmp_path, f'<sdf version="1.9">{around.format(model)}</sdf>')
    assert all(problem.line and problem.remedy for problem in caught.value.problems)


@pytest.mark.parametrize("chained", ["attached_to", "relative_to", "both"])
def test_frames_may_hang_on_each_other_to_any_length(tmp_path, chained):
    """Chains are walked without recursion, and once: the time of n joints at the end of n frames grows with n."""
    count = 1500

    def frame(k):
        attached = f' attached_to="f{k + 1}"' if chained != "relative_to" else ""
        pose = f'<pose relative_to="f{k + 1}">0 0 1 0 0 0</pose>' if chained != "attached_to" else ""
        return f'<frame name="f{k}"{attached}>{pose}</frame>'

    frames = "".join(map(frame, range(count))) + f'<frame name="f{count}" attached_to="l"/>'
    joints = "".join(joint(f"j{k}", "f0", "k", "fixed", "") for k in range(count))
    links = f'<link name="l"/>{link("k", """<pose relative_to="f0">0 0 1 0 0 0</pose>""")}'
    begun = time.process_time()
    assembly = load(tmp_path, f'<sdf version="1.9"><model name="m">{links}{frames}{joints}</model></sdf>')
    assert time.process_time() - begun < 10.0  # 0.5 s on a quiet machine; 30 s where each joint walks the chain
    heights = [part.X_WP[2, 3] for part in assembly.parts if part.mesh is not None]
    assert heights == pytest.approx([1.0 + (0 if chained == "attached_to" else count) + 0.1])
