"""A complete function: what contact does not hold is taken as stated, what it forbids is told, nothing is silent."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.support.command_line import ran_here
from tests.support.diagonal import first_rows
from tests.support.robots import ARM, JOINT, urdf, write

from kinform import form, run, stages
from kinform.design import Design
from kinform.errors import InputError


def joints(path):
    design = stages.joints(stages.contacts(Design(form.load(path))))
    return design.kinematics


def findings(path):
    return {(f.code, f.subject[0]): f.severity for f in run(path).findings}


def test_a_shaft_without_shoulders_is_taken_as_stated_and_said(tmp_path):
    path = write(tmp_path, urdf())  # a shaft in a bore of its radius, 30 mm of it inside
    (joint,) = joints(path).joints
    assert (joint.type, joint.status) == ("revolute", "stated")
    assert np.allclose(np.abs(joint.axis), [0.0, 0.0, 1.0]) and "slides" in joint.motion
    assert joints(path).mobility.effective == 1
    assert findings(path)["KF414", "turn"] == "note"


def test_a_joint_across_a_gap_is_taken_as_stated_and_said(tmp_path):
    path = write(tmp_path, urdf(joint=JOINT.replace("0 0 0.03", "0 0 0.3")))
    (joint,) = joints(path).joints
    assert (joint.type, joint.status, joint.motion) == ("revolute", "stated", "")
    assert findings(path)["KF401", "turn"] == "note"


def test_what_contact_forbids_stays_and_is_an_error(tmp_path):
    slanted = JOINT.replace("0 0 2", "1 0 0")  # the shaft can turn about z and slide along it, not about x
    path = write(tmp_path, urdf(joint=slanted))
    (joint,) = joints(path).joints
    assert joint.type == "cylindrical" and joint.status == "determined"
    found = findings(path)
    assert found["KF402", "turn"] == "error" and ("KF414", "turn") not in found


BOXES = """<robot name="r"><link name="box"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
<link name="lid"><visual><origin xyz="{at} 0 0.005"/><geometry><box size="0.2 0.2 0.01"/></geometry></visual></link>
<joint name="k" type="{type}"><parent link="box"/><child link="lid"/><origin xyz="{back} 0 0.05"/><axis xyz="{axis}"/>
<limit lower="{lower}" upper="1" effort="1" velocity="1"/></joint></robot>
"""


@pytest.mark.parametrize(
    ("type", "axis", "at", "lower", "codes"),
    first_rows(3, [
        ("revolute", "0 -1 0", 0.1, -0.5, ["KF412", "KF414"]),  # a lid, drawn closed, that is to go into the box
        ("revolute", "0 -1 0", 0.0, 0.0, ["KF402", "KF904"]),  # about the middle of the face it would go in on one side
        ("prismatic", "0 0 1", 0.0, 0.0, ["KF414"]),  # a cylinder, drawn in
        ("revolute", "0 -1 0", 0.1, 0.0, ["KF414"]),  # about an edge of the box
        ("prismatic", "0 0 -1", 0.0, 0.0, ["KF412", "KF414"]),
        ("prismatic", "0 0 1", 0.0, -0.5, ["KF412", "KF414"]),
    ]),
)  # fmt: skip
def test_a_face_that_the_motion_only_leaves_is_an_end_stop_and_forbids_nothing(tmp_path, type, axis, at, lower, codes):
    (tmp_path / "r.urdf").write_text(BOXES.format(type=type, axis=axis, at=at, back=-at, lower=lower))
    assert sorted(code for code, _ in findings(tmp_path / "r.urdf")) == codes


def test_a_fixed_joint_makes_one_body_and_a_frame_weighs_nothing(tmp_path):
    heavy = ARM + '<inertial><mass value="1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial>'
    design = run(write(tmp_path, urdf(arm=heavy))).design
    bodies = {body.name: body.parts for body in design.kinematics.bodies}
    assert bodies == {"arm": ("shaft", "tool"), "base": ("base.obj",)}
    assert {body.name: body.mass for body in design.mass.bodies} == {"arm": 1.0, "base": 2.0}


def test_contact_of_links_that_no_joint_joins_constrains_nothing(tmp_path):
    third = (
        '<link name="third"><visual name="block"><origin xyz="0.04 0 0"/>'
        '<geometry><box size="0.02 0.02 0.02"/></geometry>'
        '</visual></link><joint name="turn2" type="revolute"><parent link="arm"/><child link="third"/>'
        '<origin xyz="0 0 0.02" rpy="0 0 -0.5"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>'
    )  # the block lies against the outside of the base
    names = {joint.name for joint in joints(write(tmp_path, urdf(more=third))).joints}
    assert names == {"arm~base", "arm~third"}


def test_a_design_is_judged_as_one(tmp_path):
    path = write(tmp_path, urdf())
    (path.parent / "m.toml").write_text(
        'schema = 1\n[assembly]\nname = "m"\nunits = "mm"\nfrom = "arm.urdf"\n[check]\nprofile = "design"\n'
    )
    assert findings(path.parent / "m.toml")["KF414", "turn"] == "error"


def test_tables_of_a_manifest_override_those_of_its_source_key_by_key(tmp_path):
    path = write(tmp_path, urdf())
    manifest = path.parent / "m.toml"
    manifest.write_text(
        'schema = 1\n[assembly]\nname = "m"\nunits = "mm"\nfrom = "arm.urdf"\n'
        '[[part]]\nname = "shaft"\nmaterial = "steel"\n[[function.joint]]\nname = "turn"\nrange = [-5, 5]\n'
    )
    plain, changed = form.load(path), form.load(manifest)
    assert changed.units == "mm" and changed.part("shaft").material == "steel"
    assert np.allclose(changed.part("shaft").X_WP, plain.part("shaft").X_WP, atol=1e-15)
    assert np.allclose(changed.part("shaft").mesh.vertices, plain.part("shaft").mesh.vertices, atol=1e-15)
    turn = next(joint for joint in changed.function.joints if joint.name == "turn")
    assert np.allclose(turn.range, np.radians([-5, 5])) and (turn.file, turn.line) == ("m.toml", 9)
    tip = next(joint for joint in changed.function.joints if joint.name == "tip")
    assert (tip.file, tip.line) == ("arm.urdf", 6)
    manifest.write_text(manifest.read_text() + '[[part]]\nname = "shift"\ndensity = 1.0\n')
    with pytest.raises(InputError):
        form.load(manifest)


def test_a_description_is_a_subassembly(tmp_path):
    path = write(tmp_path, urdf())
    top = path.parent / "top.toml"
    top.write_text(
        'schema = 1\n[assembly]\nname = "top"\nunits = "m"\n'
        '[[subassembly]]\nname = "left"\nfile = "arm.urdf"\nposition = [0, 0, 1]\n'
    )
    assembly = form.load(top)
    assert [group.name for group in assembly.groups] == ["left/arm", "left/base"]
    assert np.allclose(assembly.groups[1].override.centre_of_mass, [0.0, 0.0, 1.1])
    assert assembly.function.complete == ("left/",)


def test_init_writes_a_manifest_that_is_equivalent(tmp_path):
    path = write(tmp_path, urdf())
    done = ran_here("init", path, "-o", "full.toml", cwd=path.parent)
    assert done.returncode == 0, done.stderr
    a, b = form.load(path), form.load(path.parent / "full.toml", allow_outside=True)
    assert [(p.name, p.X_WP.tobytes(), p.mesh and p.mesh.digest) for p in a.parts] == [
        (p.name, p.X_WP.tobytes(), p.mesh and p.mesh.digest) for p in b.parts
    ]
    assert [(j.name, j.range) for j in a.function.joints] == [(j.name, j.range) for j in b.function.joints]
    assert json.dumps([r.values for r in a.function.requirements]) == json.dumps(
        [r.values for r in b.function.requirements]
    )


def test_how_many_joints_have_which_answer_is_in_json_and_unchanged_results_say_the_same(tmp_path):
    path = write(tmp_path, urdf())
    first = ran_here("run", str(path), "-o", str(tmp_path / "a.h5"), cwd=tmp_path)
    assert ran_here("run", str(path), "-o", str(tmp_path / "a.h5"), cwd=tmp_path).stdout == first.stdout  # unchanged
    data = json.loads(ran_here("show", "a.h5", "joints", "--format", "json", cwd=tmp_path).stdout)
    assert data["answers"] == {"agrees": 1, "not held": 1, "share_undecided": 0.0}
