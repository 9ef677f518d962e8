"""3MF: units, components and instances, and what is refused."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest
import trimesh
from tests.support.places import FIXTURES
from tests.support.scenes import PLATE, assert_same_joints, of_mesh, over, scene_of, threemf, transform

import kinform
from kinform import form
from kinform.errors import InputError

COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"


def test_a_3mf_has_the_joints_of_its_parts(tmp_path):
    parts = form.load(COLLARS).parts
    resources = "".join(
        f'<object id="{k}" name="{p.name}">{of_mesh(p.mesh.vertices * 1e3, p.mesh.faces)}</object>'
        for k, p in enumerate(parts, start=1)
    )
    X = [p.X_WP.copy() for p in parts]
    for pose in X:
        pose[:3, 3] *= 1e3
    build = "".join(f'<item objectid="{k}" transform="{transform(pose)}"/>' for k, pose in enumerate(X, start=1))
    path = threemf(tmp_path / "pair.3mf", resources, build)
    assert form.load(path).units == "mm"
    assert_same_joints(kinform.run(over(COLLARS, path)), kinform.run(COLLARS))


@pytest.mark.parametrize(("unit", "metres"), [("micron", 1e-6), ("inch", 0.0254), ("meter", 1.0)])
def test_components_are_instances_below_their_object_in_the_unit_of_the_file(tmp_path, unit, metres):
    shift, turn = np.eye(4), trimesh.transformations.rotation_matrix(0.3, [0, 0, 1])
    shift[:3, 3] = 10, 20, 30
    resources = (
        f'{PLATE}<object id="2" name="a/b"><components><component objectid="1"/>'
        f'<component objectid="1" transform="{transform(shift)}"/></components></object>'
        '<object id="3" type="support"><mesh/></object>'
    )
    build = f'<item objectid="2" transform="{transform(turn)}"/><item objectid="1"/><item objectid="3"/>'
    assembly = form.load(threemf(tmp_path / "a.3mf", resources, build, unit))
    assert [p.name for p in assembly.parts] == ["a_b/plate", "a_b/plate#2", "plate"]
    assert [s.name for s in assembly.subassemblies] == ["a_b"]
    assert len({p.mesh.digest for p in assembly.parts}) == 1
    assert np.allclose(
        assembly.part("a_b/plate#2").X_WP, turn @ np.block([[np.eye(3), metres * shift[:3, 3:]], [0, 0, 0, 1]])
    )
    assert np.allclose(np.ptp(assembly.part("plate").mesh.vertices, axis=0), metres * np.array([1, 2, 3]))
    assert assembly.notes


@pytest.mark.parametrize("order", [1, -1])
def test_the_model_of_a_3mf_is_found_behind_its_thumbnail(tmp_path, order):
    path = threemf(tmp_path / "a.3mf", PLATE, '<item objectid="1"/>')
    kinds = {
        "/3D/m.model": "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel",
        "/Metadata/thumbnail.png": "http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail",
    }
    relations = [f'<Relationship Id="r{k}" Target="{to}" Type="{kind}"/>' for k, (to, kind) in enumerate(kinds.items())]
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(tmp_path / "b.3mf", "w") as new:
        new.writestr("_rels/.rels", f"<Relationships>{''.join(relations[::order])}</Relationships>")
        new.writestr("3D/m.model", old.read("3D/m.model"))
    assert [part.name for part in form.load(tmp_path / "b.3mf").parts] == ["plate"]


BAD_3MF = {
    "no zip": lambda p: p.write_bytes(b"PK\x03\x04 no"),
    "cut short": lambda p: p.write_bytes(threemf(p, PLATE, '<item objectid="1"/>').read_bytes()[:300]),
    "no object": lambda p: threemf(p, PLATE, '<item objectid="9"/>'),
    "in itself": lambda p: threemf(p, '<object id="1"><components><component objectid="1"/></components></object>',
                                    '<item objectid="1"/>'),
    "unit": lambda p: threemf(p, PLATE, '<item objectid="1"/>', unit="ell"),
    "corner": lambda p: threemf(p, PLATE.replace('v1="0"', 'v1="99"'), '<item objectid="1"/>'),
    "nan": lambda p: threemf(p, PLATE.replace('x="0.5"', 'x="nan"'), '<item objectid="1"/>'),
    "eleven numbers": lambda p: threemf(p, PLATE, '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0"/>'),
    "entity": lambda p: threemf(p, PLATE, "", more='<!DOCTYPE m [<!ENTITY a "b">]>'),
    "nothing": lambda p: threemf(p, PLATE, ""),
    "bomb": lambda p: threemf(p, PLATE, '<item objectid="1"/>' + " " * (1 << 22)),
}  # fmt: skip


@pytest.mark.parametrize("write_bad", BAD_3MF.values(), ids=BAD_3MF)
def test_what_is_wrong_with_a_3mf_is_one_problem(tmp_path, monkeypatch, write_bad):
    monkeypatch.setattr("kinform.form.scenes.threemf.UNPACKED_BYTES", 1 << 22)
    write_bad(tmp_path / "a.3mf")
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.3mf")
    (problem,) = caught.value.problems
    assert problem.file == "a.3mf" and problem.remedy


def test_trimesh_reads_a_3mf_as_we_do(tmp_path):
    pytest.importorskip("networkx", reason="trimesh reads 3MF with networkx")
    path = tmp_path / "a.3mf"
    scene_of(form.load(COLLARS), factor=1e3).export(path)
    theirs = trimesh.load_scene(io.BytesIO(path.read_bytes()), file_type="3mf")
    assert np.allclose(
        theirs.bounds * 1e-3,
        [np.min([p.mesh.placed_box(p.X_WP)[0] for p in form.load(path).parts], axis=0),
         np.max([p.mesh.placed_box(p.X_WP)[1] for p in form.load(path).parts], axis=0)],
    )  # fmt: skip
