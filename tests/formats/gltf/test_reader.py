"""Scene files in place of a manifest: the joints of the STL versions, with names, hierarchy and instances kept."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
import trimesh
from tests.support.places import FIXTURES
from tests.support.scenes import assert_same_joints, glb, nodes, over, scene_of

import kinform
from kinform import form
from kinform.errors import InputError
from kinform.form.meshes.raw import MeshError
from kinform.formats.gltf.reading.reader import read_gltf

FOUR_BAR = FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml"
COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"


@pytest.mark.parametrize(
    ("manifest", "suffix"),
    [
        (COLLARS, ".glb"),
        (COLLARS, ".gltf"),
        pytest.param(FOUR_BAR, ".glb", marks=pytest.mark.sweep),
        pytest.param(FOUR_BAR, ".gltf", marks=pytest.mark.sweep),
    ],
)
def test_a_scene_has_the_joints_of_its_parts(tmp_path, manifest, suffix):
    path = tmp_path / f"scene{suffix}"
    scene = scene_of(form.load(manifest))
    if suffix == ".gltf":
        for name, data in trimesh.exchange.gltf.export_gltf(scene).items():
            (tmp_path / ("scene.gltf" if name == "model.gltf" else name)).write_bytes(data)
    else:
        scene.export(path)
    alone = form.load(path)
    assert {part.name for part in alone.parts} == {part.name for part in form.load(manifest).parts}
    results = kinform.run(over(manifest, path))
    assert [part.name for part in results.assembly.parts] == [part.name for part in form.load(manifest).parts]
    assert_same_joints(results, kinform.run(manifest))


def test_groups_are_sub_assemblies_and_a_manifest_says_more_of_their_parts(tmp_path):
    plain = form.load(FOUR_BAR)
    scene_of(plain, {"pin_a": "pins", "pin_b": "pins"}).export(tmp_path / "bar.glb")
    (tmp_path / "bar.toml").write_text(
        'schema = 1\n[assembly]\nname = "bar"\nunits = "mm"\nfrom = "bar.glb"\nground = "base"\n'
        '[[part]]\nname = "pins/pin_a"\nmaterial = "steel"\n'
    )
    for name in ("bar.glb", "bar.toml"):
        assembly = form.load(tmp_path / name)
        assert {part.name for part in assembly.parts} == {
            "base", "coupler", "crank", "pins/pin_a", "pins/pin_b", "pin_c", "pin_d", "rocker",
        }  # fmt: skip
        assert [sub.name for sub in assembly.subassemblies] == ["pins"]
        for part in plain.parts:
            there = next(p for p in assembly.parts if p.name.rpartition("/")[2] == part.name)
            assert np.allclose(there.X_WP, part.X_WP, atol=1e-7)
    assert form.load(tmp_path / "bar.toml").part("pins/pin_a").material == "steel"


def test_a_scene_is_a_subassembly_and_init_says_the_same(tmp_path):
    scene_of(form.load(FOUR_BAR), {"pin_a": "pins"}).export(tmp_path / "bar.glb")
    (tmp_path / "top.toml").write_text(
        'schema = 1\n[assembly]\nname = "top"\nunits = "mm"\n'
        '[[subassembly]]\nname = "left"\nfile = "bar.glb"\nposition = [500, 0, 0]\n'
    )
    from kinform.form.write_manifest import init_from_source

    (tmp_path / "full.toml").write_text(init_from_source(tmp_path / "bar.glb", relative_to=tmp_path))
    alone = form.load(tmp_path / "bar.glb")
    full, top = form.load(tmp_path / "full.toml"), form.load(tmp_path / "top.toml")
    assert [s.name for s in top.subassemblies] == ["left", "left/pins"]
    for a, b, c in zip(alone.parts, full.parts, top.parts, strict=True):
        assert a.name == b.name and "left/" + a.name == c.name
        assert np.array_equal(a.X_WP, b.X_WP) and a.mesh.digest == b.mesh.digest == c.mesh.digest
        assert np.allclose(c.X_WP[:3, 3], a.X_WP[:3, 3] + [0.5, 0.0, 0.0])
    assert alone.check.profile == full.check.profile == "design"


def test_instances_share_a_mesh_and_repeated_names_are_numbered(tmp_path):
    one, two = {"name": "a/b", "mesh": 0}, {"name": "a/b", "mesh": 0, "translation": [9, 0, 0]}
    assembly = form.load(glb(tmp_path, nodes(one, two, {"mesh": 0, "translation": [0, 9, 0]})))
    assert [part.name for part in assembly.parts] == ["a_b", "a_b#2", "box"]
    assert len({id(part.mesh) for part in assembly.parts}) == 1
    assert any('"a/b"' in note and '"a_b#2"' in note for note in assembly.notes)


def test_a_node_with_a_mesh_and_a_group_of_its_name_below_it_are_told_apart(tmp_path):
    inner = {"name": "n", "children": [2, 3]}, {"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b"}
    path = glb(
        tmp_path, nodes({"name": "n", "mesh": 0, "children": [1]}, *inner, {"mesh": 0, "name": "c"}, roots=[0, 4])
    )
    assert [part.name for part in form.load(path).parts] == ["c", "n/n#2", "n/n/a", "n/n/b"]


def test_scales_mirror_and_enlarge(tmp_path):
    mirrored = {"name": "m", "mesh": 0, "scale": [-1, 2, 1], "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)]}
    part = form.load(glb(tmp_path, nodes(mirrored))).part("m")
    low, high = part.mesh.box
    assert np.allclose(high - low, [5.0, 8.0, 3.0]) and part.mesh.health.volume == pytest.approx(120.0)
    assert np.linalg.det(part.X_WP[:3, :3]) == pytest.approx(1.0)
    corners = part.mesh.vertices @ part.X_WP[:3, :3].T
    assert np.allclose(np.ptp(corners, axis=0), [8.0, 5.0, 3.0], atol=1e-6)


def test_quantised_positions_and_strides_are_read(tmp_path):
    def quantise(header):
        header["accessors"][0].update(componentType=5122, normalized=True)
        header["bufferViews"][0]["byteStride"] = 12

    with pytest.raises(InputError):  # of bytes that are no short integers comes a mesh, but none of a solid
        form.load(glb(tmp_path, lambda header: header["accessors"][0].update(count=80)))
    from kinform.form.scenes.reading import read_scene

    path = glb(tmp_path, quantise)
    vertices = read_scene(path.read_bytes(), path).meshes[0][1].vertices
    box = trimesh.creation.box((5.0, 4.0, 3.0)).vertices.astype("<f4")
    assert np.array_equal(vertices, np.maximum(box.view("<i2").reshape(8, 6)[:, :3] / 32767.0, -1.0))


CIRCLE = nodes({"name": "a", "children": [1]}, {"name": "b", "children": [0], "mesh": 0}, roots=[0])
ASKEW = nodes({"children": [1], "scale": [1, 3, 1]}, {"mesh": 0, "rotation": [0, 0, 0.38268343, 0.92387953]}, roots=[0])
BAD = {
    "circle": CIRCLE,
    "askew": ASKEW,
    "no such mesh": nodes({"mesh": 7}),
    "nothing in the scene": nodes({"name": "empty"}),
    "negative child": nodes({"children": [-1]}),
    "buffer missing": lambda h: h["buffers"][0].update(uri="gone.bin"),
    "buffer outside": lambda h: h["buffers"][0].update(uri="../x.bin"),
    "buffer short": lambda h: h["buffers"][0].update(byteLength=10**6),
    "huge count": lambda h: h["accessors"][0].update(count=10**12),
    "no view": lambda h: h["accessors"][0].pop("bufferView"),
    "compressed": lambda h: h.update(extensionsRequired=["KHR_draco_mesh_compression"]),
    "list in place of a table": lambda h: h.update(meshes=[[]]),
    "corner beyond": lambda h: h["accessors"][0].update(count=7),
    "matrix of text": nodes({"mesh": 0, "matrix": ["x"] * 16}),
}


@pytest.mark.parametrize("change", BAD.values(), ids=BAD)
def test_what_is_wrong_with_a_scene_is_one_problem(tmp_path, change):
    with pytest.raises(InputError) as caught:
        form.load(glb(tmp_path, change))
    (problem,) = caught.value.problems
    assert problem.file == "box.glb" and problem.remedy


def test_a_scene_that_is_cut_short_or_given_units_is_refused(tmp_path):
    with pytest.raises(InputError):
        form.load(glb(tmp_path, cut=20))
    with pytest.raises(InputError):
        kinform.run(glb(tmp_path), units="mm")


def test_a_buffer_in_the_git_folder_of_the_repository_is_refused(tmp_path):
    secret = bytes(range(48))
    (tmp_path / ".git").mkdir()
    (tmp_path / "plain").write_bytes(secret)
    (tmp_path / ".git" / "config").write_bytes(secret)
    (tmp_path / "link.bin").symlink_to(".git/config")
    points = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    for uri, read in (("plain", True), (".git/config", False), ("a/../.git/config", False), ("link.bin", False)):
        header = {
            "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "accessors": [points],
            "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": uri, "byteLength": 36}],
        }  # fmt: skip
        path = tmp_path / "a.gltf"
        path.write_text(json.dumps(header))
        if read:
            assert read_gltf(path.read_bytes(), path).files == (tmp_path / "plain",)
        else:
            with pytest.raises(MeshError):
                read_gltf(path.read_bytes(), path)


def test_what_moved_in_a_scene_is_read_again(tmp_path):
    path, output = glb(tmp_path, nodes({"name": "a", "mesh": 0}, {"name": "b", "mesh": 0})), tmp_path / "r.h5"
    kinform.run(path, output)
    glb(tmp_path, nodes({"name": "a", "mesh": 0}, {"name": "b", "mesh": 0, "translation": [5, 0, 0]}))
    again = kinform.run(path, output)
    assert again.assembly.part("b").X_WP[0, 3] == 5.0
    kinform.run(path, tmp_path / "fresh.h5")
    assert output.read_bytes() == (tmp_path / "fresh.h5").read_bytes()


def test_a_manifest_of_meshes_imports_nothing_of_this():
    code = (
        "import sys, kinform; from kinform import form; form.load(sys.argv[1]); "
        "print([m for m in sys.modules if m.split('.')[0] in ('trimesh', 'collada', 'cascadio', 'lxml') "
        "or m.startswith(('kinform.form.scenes', 'kinform.formats.description.'))])"
    )
    out = subprocess.run([sys.executable, "-c", code, str(FOUR_BAR)], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_morph_targets_that_move_vertices_are_said_to_be_left_out(tmp_path):
    def morphed(header):
        header["meshes"][0]["weights"] = [0.5]
        header["nodes"] = [{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "weights": [0.0]}]
        header["scenes"] = [{"nodes": [0, 1]}]

    notes = form.load(glb(tmp_path, morphed)).notes
    assert [('"a"' in note, '"b"' in note) for note in notes] == [(True, False)]


def test_a_buffer_that_becomes_a_link_after_it_was_looked_at_is_not_followed(tmp_path, monkeypatch):
    outside, folder = tmp_path / "outside.bin", tmp_path / "design"
    folder.mkdir()
    outside.write_bytes(bytes(72))
    (folder / "b.bin").write_bytes(bytes(72))

    def exchanged(path):
        path.unlink()
        path.symlink_to(outside)

    monkeypatch.setattr("kinform.formats.gltf.reading.reader.not_a_file", exchanged)
    header = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": 72, "uri": "b.bin"}],
              "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
              "bufferViews": [{"buffer": 0, "byteLength": 72}],
              "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]}  # fmt: skip
    with pytest.raises(MeshError) as caught:
        read_gltf(json.dumps(header).encode(), folder / "a.gltf")
    assert "b.bin" in caught.value.faults[0].message
