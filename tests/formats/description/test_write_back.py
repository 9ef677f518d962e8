"""A robot that was read from a description is written back as that: other programs find the same robot in it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from lxml import etree
from support.places import FIXTURES
from support.scenes import scene_of
from support.validators import package
from tests.support.command_line import ran_here
from tests.support.walkers import DENSITY, Walker

import kinform
from kinform import form
from kinform.design import Design
from kinform.exports import ExportError, export

EXTRA = (
    '<!-- wired at the works -->\n<transmission name="t"><type>simple</type></transmission>\n'
    '<gazebo reference="torso"><mu1>0.3</mu1></gazebo>\n'
)


def walker(**links):
    out = Walker(extra=EXTRA)
    for name, changes in links.items():
        for key, value in changes.items():
            setattr(out.links[name], key, value)
    return out


def written(folder, text, name="walker.urdf"):
    path = folder / name
    path.write_text(text)
    return path


def back(path, format="urdf", **asked):
    return export(Design(form.load(path)), format, **asked)


MJCF = """<!-- by hand -->
<mujoco model="arm">
  <compiler angle="degree" meshdir="parts" eulerseq="zyx"/>
  <default><default class="j"><joint axis="0 1 0" damping="0.1"/></default></default>
  <asset><mesh name="bar" file="bar.stl" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <body name="base" pos="0.1 0 0.2" euler="30 0 10"><geom type="box" size="0.05 0.05 0.05"/>
      <body name="arm" pos="0 0 0.1" quat="0.9 0.1 0 0.2" childclass="j">
        <inertial pos="0 0 0.1" mass="0.5" diaginertia="1e-3 1e-3 2e-4" quat="0.8 0.6 0 0"/>
        <joint name="lift" range="-60 80" pos="0 0.01 0"/>
        <geom type="mesh" mesh="bar"/>
        <body name="hand" pos="0 0 0.2"><joint name="push" type="slide" axis="1 0 1" range="0 0.05"/>
          <geom type="capsule" fromto="0 0 0 0 0 0.05" size="0.01"/></body>
      </body>
    </body>
  </worldbody>
  <sensor><jointpos joint="lift"/></sensor>
</mujoco>
"""


def mjcf(folder):
    (folder / "parts").mkdir()
    trimesh.creation.box((20.0, 30.0, 200.0)).export(folder / "parts" / "bar.stl")
    return written(folder, MJCF, "arm.xml")


def test_what_was_not_touched_is_given_byte_for_byte(tmp_path):
    path = written(tmp_path, walker().text())
    assert back(path).files == {"walker.urdf": path.read_bytes()}
    assert back(path).lost == ()
    other = mjcf(tmp_path)
    assert back(other, "mjcf").files == {"arm.xml": other.read_bytes()}


def placements(pin, path, values):
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    pin.framesForwardKinematics(model, data, values)
    inertias = {name: model.inertias[k] for k, name in enumerate(model.names)}
    return {frame.name: data.oMf[k].homogeneous for k, frame in enumerate(model.frames)}, inertias


def test_pinocchio_finds_the_same_places_in_a_urdf_whose_inertias_were_written_and_those_of_the_boxes(tmp_path):
    pin = package("pinocchio")
    right = walker()
    wrong = walker(torso={"inertia_factor": 1e6}, left_shin={"centre_shift": (0.0, 0.0, 1.0)})
    path = written(tmp_path, wrong.text())
    fixed = back(path, fix=["inertia"])
    out = tmp_path / "out.urdf"
    out.write_bytes(fixed.files["walker.urdf"])
    rng = np.random.default_rng(3)
    for _ in range(20):
        values = rng.uniform(-0.5, 0.5, 4)
        before, _ = placements(pin, path, values)
        after, inertias = placements(pin, out, values)
        assert set(before) == set(after)
        for name, X in before.items():
            np.testing.assert_allclose(after[name], X, atol=1e-12)
    _, true = placements(pin, written(tmp_path, right.text(), "right.urdf"), np.zeros(4))
    for name, inertia in true.items():
        np.testing.assert_allclose(inertias[name].inertia, inertia.inertia, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(inertias[name].lever, inertia.lever, atol=1e-9)
        assert inertias[name].mass == pytest.approx(inertia.mass, rel=1e-9)
    assert b"wired at the works" in out.read_bytes() and b"<mu1>0.3</mu1>" in out.read_bytes()


def test_a_density_of_the_manifest_gives_the_mass(tmp_path):
    written(tmp_path, walker().text())
    manifest = written(
        tmp_path,
        'schema = 1\n[assembly]\nname = "w"\nunits = "m"\nfrom = "walker.urdf"\n'
        '[[part]]\nname = "torso box"\ndensity = 500.0\n',
        "w.toml",
    )
    design = kinform.run(manifest).design
    root = etree.fromstring(export(design, "urdf", fix=["inertia"]).files["walker.urdf"])
    masses = {link.get("name"): float(link.find("inertial/mass").get("value")) for link in root.findall("link")}
    assert masses["torso"] == pytest.approx(0.5 * DENSITY * 0.1 * 0.2 * 0.2, rel=1e-12)
    assert masses["left_shin"] == pytest.approx(walker().links["left_shin"].inertial()[0], rel=1e-12)


def test_a_range_of_the_manifest_is_written_and_another_axis_is_named_as_lost(tmp_path):
    written(tmp_path, walker().text())
    over = (
        'schema = 1\n[assembly]\nname = "w"\nunits = "m"\nfrom = "walker.urdf"\n'
        '[[function.joint]]\nname = "left_knee"\nrange = [-20, 90]\n'
        '[[function.joint]]\nname = "right_knee"\naxis = [1, 0, 0]\n'
    )
    made = back(written(tmp_path, over, "w.toml"))
    root = etree.fromstring(made.files["walker.urdf"])
    limit = root.find("joint[@name='left_knee']/limit")
    assert float(limit.get("upper")) == pytest.approx(math.pi / 2.0, rel=1e-12) and limit.get("effort") == "5"
    assert [text.partition(":")[0] for text in made.lost] == ["joint right_knee"]


def test_mujoco_finds_the_same_places_and_masses_in_an_mjcf(tmp_path):
    mujoco = package("mujoco")
    path = mjcf(tmp_path)
    over = (
        'schema = 1\n[assembly]\nname = "a"\nunits = "m"\nfrom = "arm.xml"\n'
        '[[function.joint]]\nname = "lift"\nrange = [-60, 90]\n'
    )
    fixed = back(written(tmp_path, over, "a.toml"), "mjcf", fix=["inertia"], folder="..")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "arm.xml").write_bytes(fixed.files["arm.xml"])
    old, new = (mujoco.MjModel.from_xml_path(str(p)) for p in (path, tmp_path / "out" / "arm.xml"))
    rng = np.random.default_rng(5)
    for _ in range(20):
        places = []
        values = rng.uniform(-0.5, 0.5, old.nq)
        for model in (old, new):
            data = mujoco.MjData(model)
            data.qpos[:] = values
            mujoco.mj_kinematics(model, data)
            places.append((data.xpos.copy(), data.xmat.copy()))
        for before, after in zip(*places, strict=True):
            np.testing.assert_allclose(after, before, atol=1e-12)
    assert new.joint("lift").range == pytest.approx([-math.pi / 3.0, math.pi / 2.0], rel=1e-12)
    arm, (a, b, c) = new.body("arm"), np.square([0.02, 0.03, 0.2])
    assert arm.mass[0] == pytest.approx(0.5, rel=1e-12)
    assert sorted(arm.inertia) == pytest.approx(sorted(0.5 / 12.0 * np.array([b + c, a + c, a + b])), rel=1e-6)


def test_plain_paths_of_meshes_are_seen_from_the_new_place(tmp_path):
    made = walker()
    mesh = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    made.links["torso"].more = mesh.format("meshes/a.stl") + mesh.format("package://robot/meshes/a.stl")
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "meshes" / "a.stl")
    (tmp_path / "package.xml").write_text("<package/>")
    path = written(tmp_path, made.text())
    root = etree.fromstring(back(path, folder="../robot").files["walker.urdf"])
    assert [m.get("filename") for m in root.iter("mesh")] == ["../robot/meshes/a.stl", "package://robot/meshes/a.stl"]


def test_an_export_over_an_earlier_one_is_the_same_and_includes_leave_no_trace(tmp_path):
    (tmp_path / "parts").mkdir()
    trimesh.creation.box((20.0, 20.0, 200.0)).export(tmp_path / "parts" / "bar.stl")
    inside = MJCF[MJCF.index("<mujoco") :].replace('meshdir="parts" ', "")
    written(tmp_path / "parts", inside, "arm.xml")
    written(tmp_path, '<mujoco><include file="parts/arm.xml"/></mujoco>', "arm.xml")
    ran_here("run", "arm.xml", "-o", "arm.h5", "-q", cwd=tmp_path)
    texts = []
    for _ in range(2):
        ran_here("export", "arm.h5", "--to", "mjcf", "-o", "out", cwd=tmp_path)
        texts.append((tmp_path / "out" / "arm.xml").read_text())
    assert texts[0] == texts[1] and "xmlns" not in texts[0]
    mujoco = pytest.importorskip("mujoco")
    models = [mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("arm.xml", "out/arm.xml")]
    assert np.array_equal(models[0].body_mass, models[1].body_mass) and models[1].nmesh == 1


def test_the_command_finds_the_description_and_refuses_to_fix_what_is_none(tmp_path):
    written(tmp_path, walker(torso={"inertia_factor": 2.0}).text())
    assert ran_here("import", "walker.urdf", "-o", "w.h5", cwd=tmp_path).returncode == 0
    done = ran_here("export", "w.h5", "--to", "urdf", "--fix", "inertia", "-o", "out", cwd=tmp_path)
    assert done.returncode == 0
    refused = ran_here("export", "w.h5", "--to", "mjcf", "--fix", "inertia", "-o", "out", cwd=tmp_path)
    assert refused.returncode == 2
    with pytest.raises(ExportError):
        export(Design(form.load(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")), "urdf",
               fix=["inertia"])  # fmt: skip


def test_a_scene_with_a_function_becomes_a_urdf_that_three_programs_load(tmp_path):
    pin, mujoco, parsing, drake = map(package, ("pinocchio", "mujoco", "pydrake.multibody.parsing",
                                                "pydrake.multibody.plant"))  # fmt: skip
    plain = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"
    assembly = form.load(plain)
    scene_of(assembly).export(tmp_path / "pair.glb")
    first, second = (part.name for part in assembly.parts)
    found = kinform.run(plain).design.kinematics.joints[0]
    manifest = (
        'schema = 1\n[assembly]\nname = "pair"\nunits = "m"\nfrom = "pair.glb"\n'
        + "".join(f'[[part]]\nname = "{name}"\nmaterial = "steel"\n' for name in (first, second))
        + f'[[function.joint]]\nname = "turn"\nbetween = ["{first}", "{second}"]\ntype = "revolute"\n'
        f"axis = {list(map(float, found.axis))}\npoint = {list(map(float, found.point))}\nrange = [-30, 60]\n"
    )
    made = export(kinform.run(written(tmp_path, manifest, "pair.toml")).design, "urdf")
    for name, data in made.files.items():
        (tmp_path / "out" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "out" / name).write_bytes(data)
    path = next((tmp_path / "out").glob("*.urdf"))
    assert pin.buildModelFromUrdf(str(path)).nq == 1
    plant = drake.MultibodyPlant(0.0)
    parsing.Parser(plant).AddModels(str(path))
    plant.Finalize()
    assert plant.num_actuated_dofs() == 0 and plant.num_joints() == 2  # the turn, and the base that floats
    assert mujoco.MjModel.from_xml_path(str(path)).nq == 1


SDF_LINK = (
    '<link name="{name}">{pose}<inertial><pose degrees="true">0.01 0 0.02 10 0 0</pose><mass>{mass}</mass><inertia>'
    '<ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial><visual name="{name} seen"><geometry>'
    "{shape}</geometry></visual></link>"
)
SDF_BOX, SDF_MESH = "<box><size>0.1 0.2 0.3</size></box>", "<mesh><uri>parts/bar.stl</uri></mesh>"
SDF_LIMIT = "<limit><lower>-1</lower><upper>2</upper><effort>7</effort></limit>"


def sdf_link(name, pose="", mass=2.0, shape=SDF_BOX):
    return SDF_LINK.format(name=name, pose=pose, mass=mass, shape=shape)


def sdf_joint(name, parent, child, kind, axis, more=""):
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child><axis><xyz {axis}</xyz>'
        f"{SDF_LIMIT}</axis>{more}</joint>"
    )


HAND = f"""<sdf version="1.9"><model name="hand" placement_frame="palm">
  {sdf_link("palm", "<pose>0 0 0.05 0 0 0.7</pose>", shape=SDF_MESH)}
  {sdf_link("finger", '<pose relative_to="palm">0.1 0 0 0 0 0</pose>')}
  {sdf_joint("slide", "palm", "finger", "prismatic", ">1 0 0", "<pose>0 0 0 0.2 0 0</pose>")}
</model></sdf>
"""
SDF = f"""<?xml version="1.0"?>
<!-- by hand -->
<sdf version="1.9"><model name="top" canonical_link="base">
  <pose>1 2 3 0.1 0.2 0.3</pose>
  {sdf_link("base", "<pose>0.1 0 0 0 0 0.2</pose>")}
  <frame name="f" attached_to="base"><pose degrees="true">0 0.5 0 90 0 45</pose></frame>
  {sdf_link("arm", '<pose relative_to="f">0.3 0 0 0.4 0 0</pose>', shape="{arm}")}
  {sdf_joint("one", "f", "arm", "revolute", 'expressed_in="f">0 0.6 0.8')}
  {{hand}}
  <joint name="wrist" type="fixed"><parent>arm</parent><child>{{child}}</child></joint>
  <plugin name="p" filename="libp.so"><gain>3</gain></plugin>
</model></sdf>
"""


def sdf(folder, included):
    """A model with a nested one, in the file or included from a folder beside it."""
    (folder / "parts").mkdir()
    trimesh.creation.box((0.02, 0.03, 0.2)).export(folder / "parts" / "bar.stl")
    inner = HAND[HAND.index("<model") : HAND.index("</sdf>")]
    placed = '<pose relative_to="arm">0 0 0.2 0 0.3 0</pose>'
    if included:
        (folder / "hand" / "parts").mkdir(parents=True)
        trimesh.creation.box((0.02, 0.03, 0.2)).export(folder / "hand" / "parts" / "bar.stl")
        written(folder / "hand", HAND, "model.sdf")
        name = "left"
        hand = f"<include><uri>package://hand/model.sdf</uri><name>{name}</name>{placed}<placement_frame>finger</placement_frame></include>"
    else:
        name, hand = "hand", inner.replace('placement_frame="palm">', f'placement_frame="palm">{placed}')
    return written(folder, SDF.format(arm=SDF_MESH, hand=hand, child=name), "arm.sdf"), name


def drakes(path):
    plants, parsing = package("pydrake.multibody.plant"), package("pydrake.multibody.parsing")
    plant = plants.MultibodyPlant(0.0)
    parser = parsing.Parser(plant)
    if (path.parent / "hand").is_dir():
        parser.package_map().Add("hand", str(path.parent / "hand"))
    parser.AddModels(str(path))
    plant.Finalize()
    return plant, plant.CreateDefaultContext()


def drake_bodies(plant):
    indices = [k for model in range(2, plant.num_model_instances()) for k in plant.GetBodyIndices(_instance(model))]
    return {plant.get_body(k).scoped_name().get_full(): plant.get_body(k) for k in indices}


def _instance(number):
    return package("pydrake.multibody.tree").ModelInstanceIndex(number)


@pytest.mark.parametrize("included", [False, True])
def test_drake_finds_the_same_places_and_masses_in_an_sdf(tmp_path, included):
    path, hand = sdf(tmp_path, included)
    if not included:
        assert back(path, "sdf").files == {"arm.sdf": path.read_bytes()}
    over = (
        'schema = 1\n[assembly]\nname = "a"\nunits = "m"\nfrom = "arm.sdf"\n'
        f'[[function.joint]]\nname = "{hand}::slide"\nrange = [-0.5, 0.25]\n'
    )
    fixed = back(written(tmp_path, over, "a.toml"), "sdf", fix=["inertia"], folder="..")
    (tmp_path / "out").mkdir()
    out = written(tmp_path / "out", fixed.files["arm.sdf"].decode(), "arm.sdf")
    assert ("by hand" in out.read_text()) is not included  # comments go where includes are put in
    assert "<gain>3</gain>" in out.read_text() and fixed.lost == ()
    assert {part.name: part.mesh.digest for part in form.load(out, allow_outside=True).parts} == {
        part.name: part.mesh.digest for part in form.load(path).parts
    }
    (old, before), (new, after) = drakes(path), drakes(out)
    rng = np.random.default_rng(7)
    assert old.num_positions() == new.num_positions() == 7 + 2
    assert drake_bodies(old).keys() == drake_bodies(new).keys() and len(drake_bodies(old)) == 4
    for _ in range(20):
        values = rng.uniform(-0.5, 0.5, 2)
        places = []
        for plant, context in ((old, before), (new, after)):
            joints = {plant.get_joint(k).name(): plant.get_joint(k) for k in plant.GetJointIndices()}
            joints["one"].set_angle(context, values[0])
            joints["slide"].set_translation(context, values[1])
            places.append(
                {name: body.EvalPoseInWorld(context).GetAsMatrix4() for name, body in drake_bodies(plant).items()}
            )
        for name, X in places[0].items():
            np.testing.assert_allclose(places[1][name], X, atol=1e-12)
    slide = next(new.get_joint(k) for k in new.GetJointIndices() if new.get_joint(k).name() == "slide")
    assert [slide.position_lower_limits()[0], slide.position_upper_limits()[0]] == pytest.approx([-0.5, 0.25])
    for name, body in drake_bodies(new).items():
        inertia = body.default_spatial_inertia()
        sides = np.square([0.02, 0.03, 0.2] if name.endswith(("arm", "palm")) else [0.1, 0.2, 0.3])
        assert inertia.get_mass() == pytest.approx(2.0, rel=1e-9)
        np.testing.assert_allclose(inertia.get_com(), np.zeros(3), atol=1e-9)
        true = 2.0 / 12.0 * (sides.sum() - sides)
        np.testing.assert_allclose(inertia.CopyToFullMatrix6()[:3, :3], np.diag(true), rtol=1e-6, atol=1e-9)


def test_an_sdf_whose_includes_mean_something_else_in_place_is_made_anew(tmp_path):
    path, _ = sdf(tmp_path, included=True)
    inner = tmp_path / "hand" / "model.sdf"
    inner.write_text(inner.read_text().replace('version="1.9"', 'version="1.4"'))
    (description,) = form.load(path).descriptions
    assert description.format == "sdf" and description.text == ""
    with pytest.raises(ExportError):
        back(path, "sdf", fix=["inertia"])


def test_a_range_that_is_open_on_one_side_is_written_back_without_warning(tmp_path):
    limit = "<limit><lower>-1e16</lower><upper>1</upper></limit>"
    path = written(tmp_path, f"""<sdf version="1.9"><model name="r"><link name="a"/><link name="b"/>
<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz>{limit}</axis></joint></model>
</sdf>""", "r.sdf")  # fmt: skip
    with np.errstate(all="raise"):
        (text,) = export(Design(form.load(path)), "sdf").files.values()
    assert b"-1e16" in text
