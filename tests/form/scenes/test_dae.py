"""DAE: unit, axis that points up, hierarchy and instances, and what is refused."""

from __future__ import annotations

import time

import numpy as np
import pytest
import trimesh
from tests.support.places import FIXTURES
from tests.support.robots import ARM, urdf, write
from tests.support.scenes import BOX, MM, assert_same_joints, dae, over

import kinform
from kinform import form
from kinform.errors import InputError

COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"


def test_a_dae_has_the_joints_of_its_parts(tmp_path):
    meshes, nodes = {}, ""
    for part in form.load(COLLARS).parts:
        meshes[part.name] = trimesh.Trimesh(part.mesh.vertices * 1e3, part.mesh.faces, process=False)
        X = part.X_WP.copy()
        X[:3, 3] *= 1e3
        matrix = " ".join(map(repr, X.reshape(-1).tolist()))
        nodes += f'<node name="{part.name}"><matrix>{matrix}</matrix><instance_geometry url="#g{part.name}"/></node>'
    path = tmp_path / "pair.dae"
    path.write_text(dae(meshes, MM, nodes=nodes))
    assert_same_joints(kinform.run(over(COLLARS, path)), kinform.run(COLLARS))


def test_a_dae_is_placed_in_its_unit_with_z_up_and_in_its_hierarchy(tmp_path):
    nodes = (
        '<node name="arm"><translate>10 0 0</translate><node name="left"><instance_geometry url="#gbox"/></node>'
        '<node name="right"><translate>0 20 0</translate><instance_geometry url="#gbox"/></node></node>'
        '<node name="base"><instance_geometry url="#gbox"/></node>'
    )
    (tmp_path / "a.dae").write_text(dae({"box": BOX}, MM, "Y_UP", nodes))
    assembly = form.load(tmp_path / "a.dae")
    assert [p.name for p in assembly.parts] == ["arm/left", "arm/right", "base"]
    right = assembly.part("arm/right").X_WP
    assert np.allclose(right[:3, 3], [0.01, 0.0, 0.02], atol=1e-9)
    assert np.allclose(right[:3, :3] @ [0, 1, 0], [0, 0, 1])
    assert np.allclose(np.ptp(assembly.part("base").mesh.vertices, axis=0), [0.001, 0.002, 0.003])


@pytest.mark.parametrize(("axis", "angle"), [("0.577 0.577 0.577", 120), ("0 0 2", 90), ("0 0 0", 0), ("1 2 3", -20)])
def test_the_axis_of_a_turn_in_a_dae_needs_no_length_of_one(tmp_path, axis, angle):
    nodes = f'<node name="box"><rotate>{axis} {angle}</rotate><instance_geometry url="#gbox"/></node>'
    (tmp_path / "a.dae").write_text(dae({"box": BOX}, MM, nodes=nodes))
    vector = np.array(axis.split(), dtype=float) if angle else [0, 0, 1]
    meant = trimesh.transformations.rotation_matrix(np.radians(angle), vector)
    part = form.load(tmp_path / "a.dae").part("box")
    assert np.allclose(part.X_WP, meant, atol=1e-7)
    assert np.allclose(np.ptp(part.mesh.vertices, axis=0), [0.001, 0.002, 0.003])


@pytest.mark.parametrize(("unit", "metres"), [("", 1.0), (MM, 0.001)])
def test_the_unit_of_a_dae_holds_for_the_meshes_of_a_robot_and_its_up_axis_does_not(tmp_path, unit, metres):
    mesh = '<visual><geometry><mesh filename="box.dae"/></geometry></visual>'
    path = write(tmp_path, urdf(arm=mesh))
    path.with_name("box.dae").write_text(dae({"box": BOX}, unit, "Y_UP"))
    (found,) = (p for p in form.load(path).parts if "box" in p.name)
    assert np.allclose(np.ptp(found.mesh.vertices, axis=0), metres * np.array([1, 2, 3]))
    assert ARM not in path.read_text()


BAD_DAE = {
    "entity": dae({"box": BOX}).replace("<COLLADA", '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA', 1),
    "wide entity": dae({"box": BOX}).replace("<COLLADA", '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA', 1).encode("utf-16"),
    "archive": "PK\x03\x04",
    "cut short": dae({"box": BOX})[:900],
    "corner": dae({"box": trimesh.Trimesh(BOX.vertices, BOX.faces + 5, process=False)}),
    "nothing": dae({}),
    "no axis": dae({"box": BOX}, nodes='<node><rotate>0 0 0 9</rotate><instance_geometry url="#gbox"/></node>'),
    "unit": dae({"box": BOX}, '<unit name="x" meter="-1"/>'),
}  # fmt: skip


@pytest.mark.parametrize("text", BAD_DAE.values(), ids=BAD_DAE)
def test_what_is_wrong_with_a_dae_is_one_problem(tmp_path, text):
    (tmp_path / "a.dae").write_bytes(text.encode() if isinstance(text, str) else text)
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.dae")
    (problem,) = caught.value.problems
    assert problem.file == "a.dae" and problem.remedy


def chain(count: int, named: str) -> str:
    """Nodes of a library that name each other, the last one the box."""
    nodes = [f'<node id="n{k}"><instance_node url="#n{k + 1}"/></node>' for k in range(count)]
    nodes.append(f'<node id="n{count}"><instance_geometry url="#gbox"/></node>')
    nodes = nodes[::-1] if named == "before" else nodes
    text = dae({"box": BOX}, MM, nodes='<node name="box"><instance_node url="#n0"/></node>')
    assert "<library_visual_scenes>" in text
    return text.replace(
        "<library_visual_scenes>", f"<library_nodes>{''.join(nodes)}</library_nodes><library_visual_scenes>"
    )


@pytest.mark.parametrize("named", ["before", "after"])
def test_nodes_of_a_library_are_read_in_any_order(tmp_path, named):
    (tmp_path / "a.dae").write_text(chain(20, named))
    assert len(form.load(tmp_path / "a.dae").parts) == 1


def test_a_long_chain_of_nodes_is_refused_at_once(tmp_path):
    (tmp_path / "a.dae").write_text(chain(2000, "after"))
    begun = time.process_time()
    with pytest.raises(InputError):
        form.load(tmp_path / "a.dae")
    assert time.process_time() - begun < 5.0  # 0.2 s on a quiet machine; 10 s where each is tried again for each


def test_a_circle_of_nodes_of_a_library_ends(tmp_path):
    (tmp_path / "a.dae").write_text(
        chain(3, "after").replace("#gbox", "#n0").replace("instance_geometry", "instance_node")
    )
    with pytest.raises(InputError):
        form.load(tmp_path / "a.dae")
