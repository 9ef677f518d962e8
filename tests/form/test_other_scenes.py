"""3MF, DAE, PLY and OFF: units, hierarchy and instances, as sources and as meshes, and what is refused."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest
import trimesh
from tests.support.places import FIXTURES
from tests.support.robots import ARM, urdf, write
from tests.support.scenes import assert_same_joints, over, scene_of

import kinform
from kinform import form
from kinform.errors import InputError

COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" '
    'Target="/3D/m.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def of_mesh(vertices, faces):
    points = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in np.asarray(vertices, float).tolist())
    corners = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in np.asarray(faces).tolist())
    return f"<mesh><vertices>{points}</vertices><triangles>{corners}</triangles></mesh>"


def transform(X):
    return " ".join(repr(float(v)) for v in np.asarray(X)[:3].T.reshape(-1))


def threemf(path, resources, build, unit="millimeter", more="", files=()):
    """A 3MF of these objects and items."""
    text = (
        f'<?xml version="1.0" encoding="UTF-8"?>{more}<model unit="{unit}" xmlns="{CORE}"><resources>'
        f"{resources}</resources><build>{build}</build></model>"
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr("3D/m.model", text)
        for name, content in files:
            archive.writestr(name, content)
    return path


BOX = trimesh.creation.box((1, 2, 3))
PLATE = f'<object id="1" name="plate">{of_mesh(BOX.vertices, BOX.faces)}</object>'


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
    assert any("1 object of other types" in note for note in assembly.notes)


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
    "no zip": (lambda p: p.write_bytes(b"PK\x03\x04 no"), "zip"),
    "cut short": (lambda p: p.write_bytes(threemf(p, PLATE, '<item objectid="1"/>').read_bytes()[:300]), "cut short"),
    "no object": (lambda p: threemf(p, PLATE, '<item objectid="9"/>'), "object"),
    "in itself": (lambda p: threemf(p, '<object id="1"><components><component objectid="1"/></components></object>',
                                    '<item objectid="1"/>'), "in itself"),
    "unit": (lambda p: threemf(p, PLATE, '<item objectid="1"/>', unit="ell"), "ell"),
    "corner": (lambda p: threemf(p, PLATE.replace('v1="0"', 'v1="99"'), '<item objectid="1"/>'), "not there"),
    "nan": (lambda p: threemf(p, PLATE.replace('x="0.5"', 'x="nan"'), '<item objectid="1"/>'), "not finite"),
    "eleven numbers": (lambda p: threemf(p, PLATE, '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0"/>'), "11"),
    "entity": (lambda p: threemf(p, PLATE, "", more='<!DOCTYPE m [<!ENTITY a "b">]>'), "entity"),
    "nothing": (lambda p: threemf(p, PLATE, ""), "no part"),
    "bomb": (lambda p: threemf(p, PLATE, '<item objectid="1"/>' + " " * (1 << 29)), "bytes of XML"),
}  # fmt: skip


@pytest.mark.parametrize(("write_bad", "words"), BAD_3MF.values(), ids=BAD_3MF)
def test_what_is_wrong_with_a_3mf_is_one_problem(tmp_path, write_bad, words):
    write_bad(tmp_path / "a.3mf")
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.3mf")
    (problem,) = caught.value.problems
    assert problem.file == "a.3mf" and words in problem.message and problem.remedy


def dae(parts, unit="", up="Z_UP", nodes=None):
    """A COLLADA of meshes by name, placed by nodes; without nodes each where it is."""
    geometries = ""
    for name, mesh in parts.items():
        points, corners = (
            " ".join(map(repr, mesh.vertices.reshape(-1).tolist())),
            " ".join(map(str, mesh.faces.reshape(-1))),
        )
        geometries += (
            f'<geometry id="g{name}" name="{name}"><mesh><source id="s{name}"><float_array id="f{name}" '
            f'count="{3 * len(mesh.vertices)}">{points}</float_array><technique_common><accessor source="#f{name}" '
            f'count="{len(mesh.vertices)}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
            f'<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v{name}"><input '
            f'semantic="POSITION" source="#s{name}"/></vertices><triangles count="{len(mesh.faces)}"><input '
            f'semantic="VERTEX" source="#v{name}" offset="0"/><p>{corners}</p></triangles></mesh></geometry>'
        )
    placed = nodes or "".join(f'<node name="{n}"><instance_geometry url="#g{n}"/></node>' for n in parts)
    return (
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>'
        f"<created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified>{unit}<up_axis>{up}</up_axis>"
        f"</asset><library_geometries>{geometries}</library_geometries><library_visual_scenes><visual_scene "
        f'id="scene">{placed}</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#scene"/>'
        "</scene></COLLADA>"
    )


MM = '<unit name="mm" meter="0.001"/>'


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
    "entity": (dae({"box": BOX}).replace("<COLLADA", '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA', 1), "entity"),
    "wide entity": (dae({"box": BOX}).replace("<COLLADA", '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA', 1).encode("utf-16"),
                    "entity"),
    "archive": ("PK\x03\x04", "archive"),
    "cut short": (dae({"box": BOX})[:900], "cannot be read as DAE"),
    "corner": (dae({"box": trimesh.Trimesh(BOX.vertices, BOX.faces + 5, process=False)}), ""),
    "nothing": (dae({}), "no part"),
    "no axis": (dae({"box": BOX}, nodes='<node><rotate>0 0 0 9</rotate><instance_geometry url="#gbox"/></node>'),
                "axis"),
    "unit": (dae({"box": BOX}, '<unit name="x" meter="-1"/>'), "unit"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "words"), BAD_DAE.values(), ids=BAD_DAE)
def test_what_is_wrong_with_a_dae_is_one_problem(tmp_path, text, words):
    (tmp_path / "a.dae").write_bytes(text.encode() if isinstance(text, str) else text)
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.dae")
    (problem,) = caught.value.problems
    assert problem.file == "a.dae" and words in problem.message and problem.remedy


@pytest.mark.parametrize("kind", ["ply", "off"])
def test_shells_of_a_file_without_names_are_parts_and_its_unit_is_asked_for(tmp_path, kind):
    two = trimesh.util.concatenate([BOX, BOX.copy().apply_translation([10, 0, 0])])
    path = tmp_path / f"two.{kind}"
    two.export(path)
    with pytest.raises(InputError, match="has no unit of length"):
        form.load(path)
    with pytest.raises(InputError, match="unit of these meshes is not stated"):
        kinform.run(path)
    assert [p.name for p in kinform.run(path, units="mm").assembly.parts] == ["shell 1", "shell 2"]
    (tmp_path / "m.toml").write_text(f'schema = 1\n[assembly]\nname = "m"\nunits = "cm"\nfrom = "two.{kind}"\n')
    assembly = form.load(tmp_path / "m.toml")
    assert [p.name for p in assembly.parts] == ["shell 1", "shell 2"]
    assert np.allclose(np.ptp(assembly.part("shell 2").mesh.vertices, axis=0), [0.01, 0.02, 0.03])


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


IN_A_MANIFEST = 'schema = 1\n[assembly]\nname = "x"\nunits = "{0}"\n[[part]]\nname = "a"\nmesh = "{1}"\n{2}\n'


@pytest.mark.parametrize("units", ["mm", "m", "in"])
@pytest.mark.parametrize(
    ("file", "metres"), [("box.glb", 1.0), ("box.dae", 1.0), ("box.3mf", 0.0254), ("box.stl", None)]
)
def test_a_mesh_whose_format_has_a_unit_is_in_that_unit_in_any_manifest(tmp_path, units, file, metres):
    if file.endswith(".3mf"):
        threemf(tmp_path / file, PLATE, '<item objectid="1"/>', unit="inch")
    else:
        BOX.export(tmp_path / file)
    in_one = {"mm": 1e-3, "m": 1.0, "in": 0.0254}
    path = tmp_path / "m.toml"
    for stated, factor in (("", metres or in_one[units]), ('units = "mm"', 1e-3)):
        path.write_text(IN_A_MANIFEST.format(units, file, stated))
        part = form.load(path).part("a")
        assert np.allclose(np.sort(np.ptp(part.mesh.vertices, axis=0)), factor * np.array([1.0, 2.0, 3.0]), rtol=1e-6)


@pytest.mark.parametrize("suffix", ["stl", "STL", "obj", "ply", "off", "dae", "glb", "3mf"])
def test_a_pointer_of_git_lfs_in_the_place_of_a_mesh_is_told(tmp_path, suffix):
    (tmp_path / f"box.{suffix}").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n")
    path = tmp_path / "m.toml"
    path.write_text(IN_A_MANIFEST.format("mm", f"box.{suffix}", ""))
    with pytest.raises(InputError, match="pointer of Git LFS") as caught:
        form.load(path)
    (problem,) = caught.value.problems
    assert problem.line == 7 and "git lfs pull" in problem.remedy
