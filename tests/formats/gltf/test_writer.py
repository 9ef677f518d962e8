"""GLB: read back with a reader of our own, and validated by the Khronos validator."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.export_models import known
from support.other_programs import judged
from support.places import FIXTURES, manifests

from kinform.exports import export


def opened(data):
    """(JSON part, accessors as arrays)."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON" and size % 4 == 0
    document = json.loads(data[20 : 20 + size])
    size_of_rest, kind = struct.unpack_from("<I4s", data, 20 + size)
    assert kind == b"BIN\0" and 28 + size + size_of_rest == len(data)
    binary = data[28 + size :]
    widths = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
    arrays = []
    for accessor in document.get("accessors", []):
        view = document["bufferViews"][accessor["bufferView"]]
        dtype = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        count = accessor["count"] * widths[accessor["type"]]
        arrays.append(
            np.frombuffer(binary, dtype, count, view["byteOffset"]).reshape(accessor["count"], -1).astype(float)
        )
    return document, arrays


def local(node):
    X = np.eye(4)
    X[:3, 3] = node.get("translation", [0, 0, 0])
    X[:3, :3] = Rotation.from_quat(node.get("rotation", [0, 0, 0, 1])).as_matrix()
    return X


def made(name, derive_design):
    (manifest,) = FIXTURES.glob(f"*/{name}/{name}.toml")
    found = derive_design(manifest)
    (data,) = export(found, "glb").files.values()
    return found, *opened(data)


VALIDATED = {"seeker_2dof", "slider_crank", "four_bar", "stick_four_bar"}
"""Of the fixtures, those that every run validates: sub-assemblies, a slide, a loop, no meshes."""


@pytest.mark.parametrize("name", ["seeker_2dof", "slider_crank"])
def test_bodies_move_as_in_our_run_and_parts_have_their_facets(name, derive_design):
    found, document, arrays = made(name, derive_design)
    run, nodes = found.simulation, document["nodes"]
    (animation,) = document["animations"]
    moved = {}
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        np.testing.assert_allclose(arrays[sampler["input"]][:, 0], run.time, atol=1e-6)
        moved.setdefault(channel["target"]["node"], {})[channel["target"]["path"]] = arrays[sampler["output"]]
    seen = 0
    for b, body_name in enumerate(run.body_names):
        (index,) = (
            k for k, n in enumerate(nodes) if n["name"] == body_name and n.get("extras", {}).get("kind") == "body"
        )
        tracks = moved.get(index, {})
        still = np.tile([0.0, 0.0, 0.0, 1.0], (len(run.time), 1))
        np.testing.assert_allclose(tracks.get("translation", np.zeros((len(run.time), 3))), run.p_WB[:, b], atol=1e-6)
        np.testing.assert_allclose(tracks.get("rotation", still), run.q_WB[:, b][:, [1, 2, 3, 0]], atol=1e-6)
        for child in nodes[index].get("children", []):
            if nodes[child]["extras"]["kind"] != "part":
                continue
            part = found.assembly.part(nodes[child]["name"])
            (primitive,) = document["meshes"][nodes[child]["mesh"]]["primitives"]
            corners = arrays[primitive["attributes"]["POSITION"]][arrays[primitive["indices"]][:, 0].astype(int)]
            X = local(nodes[child])
            expected = part.mesh.vertices[part.mesh.faces].reshape(-1, 3) @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
            np.testing.assert_allclose(corners @ X[:3, :3].T + X[:3, 3], expected, atol=1e-7)
            seen += 1
    assert seen == len(found.assembly.parts)


def test_axes_of_joints_are_nodes_whose_z_is_the_axis(derive_design):
    found, document, _ = made("seeker_2dof", derive_design)
    nodes = {node["name"]: node for node in document["nodes"] if node.get("extras", {}).get("kind") == "joint"}
    assert len(nodes) == len(found.kinematics.joints) == 2
    for joint in found.kinematics.joints:
        X = local(nodes[joint.name])
        np.testing.assert_allclose(X[:3, 2], joint.axis, atol=1e-12)
        np.testing.assert_allclose(X[:3, 3], joint.point, atol=1e-12)


def test_materials_are_dull_so_that_parts_are_not_black(derive_design):
    _, document, _ = made("seeker_2dof", derive_design)
    assert {m["pbrMetallicRoughness"]["metallicFactor"] for m in document["materials"]} == {0.0}
    assert {"steel", "aluminium", "camera"} <= {m["name"] for m in document["materials"]}


def test_equal_meshes_are_stored_once(derive_design):
    found, document, _ = made("seeker_2dof", derive_design)
    shapes = {part.mesh.digest for part in found.assembly.parts}
    assert len(shapes) < len(found.assembly.parts)
    assert sum("indices" in mesh["primitives"][0] for mesh in document["meshes"]) == len(shapes)


def test_sticks_move_without_meshes():
    (data,) = export(known("gimbal"), "glb").files.values()
    document, _ = opened(data)
    assert len(document["animations"][0]["channels"]) >= 5


@pytest.mark.parametrize(
    "manifest",
    [
        pytest.param(m, id=m.stem, marks=[pytest.mark.sweep] * (m.stem not in VALIDATED))
        for m in manifests()
        if m.parent.parent.name in ("seekers", "mechanisms", "functional")
    ],
)
def test_the_khronos_validator_finds_nothing(manifest, tmp_path, derive_design):
    (data,) = export(derive_design(manifest), "glb").files.values()
    issues = judged(data, tmp_path)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


@pytest.mark.parametrize("name", ["every_joint", "four_bar"])
def test_the_khronos_validator_finds_nothing_in_sticks(name, tmp_path):
    (data,) = export(known(name), "glb").files.values()
    issues = judged(data, tmp_path)
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


def test_the_khronos_validator_finds_a_broken_twin(tmp_path):
    (data,) = export(known("gimbal"), "glb").files.values()
    assert judged(data.replace(b'"VEC4"', b'"VEC3"'), tmp_path)["numErrors"] > 0
