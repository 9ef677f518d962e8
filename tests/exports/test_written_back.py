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
    assert made.lost == ("joint right_knee: its axis as the manifest over it says",)


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


def test_the_command_finds_the_description_and_refuses_to_fix_what_is_none(tmp_path):
    written(tmp_path, walker(torso={"inertia_factor": 2.0}).text())
    assert ran_here("import", "walker.urdf", "-o", "w.h5", cwd=tmp_path).returncode == 0
    done = ran_here("export", "w.h5", "--to", "urdf", "--fix", "inertia", "-o", "out", cwd=tmp_path)
    assert done.returncode == 0 and "5 inertias" in done.stderr
    refused = ran_here("export", "w.h5", "--to", "mjcf", "--fix", "inertia", "-o", "out", cwd=tmp_path)
    assert refused.returncode == 2 and "no description of the format mjcf" in refused.stderr
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
