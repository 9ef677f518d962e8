"""Colours: of materials of every format, in results, back in exports; they decide nothing."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh
from support.sealing import editing
from tests.support.places import FIXTURES
from tests.support.robots import urdf, write
from tests.support.scenes import BOX, MM, dae, of_mesh, scene_of, threemf

import kinform
from kinform import exports, form, results
from kinform.errors import InputError
from kinform.foundation.colours import hexed, light, of_light, shares

pytestmark = pytest.mark.usefixtures("small_pictures")

COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"
RED, BLUE = "#c81e28", "#1450b4"


def colours(path):
    return {str(part.name): part.own_colour for part in form.load(path).parts}


def test_srgb_and_light_are_inverse_to_each_other():
    for k in range(256):
        colour = f"#{k:02x}{255 - k:02x}80"
        assert hexed(shares(colour)) == of_light([round(v, 6) for v in light(shares(colour))]) == colour
    assert of_light([0.2158605, 0.0, 1.0]) == "#8000ff"  # IEC 61966-2-1


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_materials_of_gltf(tmp_path, suffix):
    assembly = form.load(COLLARS)
    scene = scene_of(assembly)
    given = {}
    for (name, mesh), colour in zip(sorted(scene.geometry.items()), (RED, BLUE), strict=False):
        factor = [*light(shares(colour)), 1.0]
        material = trimesh.visual.material.PBRMaterial(baseColorFactor=factor)
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        given[name] = (colour, np.asarray(material.baseColorFactor)[:3] / 255.0)  # trimesh rounds it
    path = tmp_path / f"a{suffix}"
    files = scene.export(file_type=suffix[1:])
    if suffix == ".glb":
        path.write_bytes(files)
    else:
        for name, data in files.items():
            (tmp_path / (path.name if name == "model.gltf" else name)).write_bytes(data)
    read = colours(path)
    for name, (colour, rounded) in given.items():
        assert read[name] == of_light(rounded)
        assert np.allclose(shares(read[name]), shares(colour), atol=0.03)


def test_the_colour_of_most_of_the_area_is_that_of_the_part(tmp_path):
    from tests.support.scenes import glb

    def change(header):
        first = {"attributes": {"POSITION": 0}, "indices": 1, "material": 0}
        header["accessors"][1]["count"] = 6  # one side in one colour, all others in another
        header["accessors"].append(
            {"bufferView": 1, "byteOffset": 12, "componentType": 5123, "count": 30, "type": "SCALAR"}
        )
        second = {"attributes": {"POSITION": 0}, "indices": 2, "material": 1}
        header["meshes"][0]["primitives"] = [first, second]
        header["materials"] = [
            {"pbrMetallicRoughness": {"baseColorFactor": [*light(shares(c)), 1.0]}} for c in (RED, BLUE)
        ]

    assert colours(glb(tmp_path, change)) == {"box": BLUE}


def test_what_is_no_colour_is_none_and_no_fault(tmp_path):
    from tests.support.scenes import glb

    def change(header):
        header["meshes"][0]["primitives"][0]["material"] = 7
        header["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": ["red", None, 1e999, 1]}}]

    assert colours(glb(tmp_path, change)) == {"box": None}
    arm = '<visual><geometry><box size="1 1 1"/></geometry><material name="m"><color rgba="red"/></material></visual>'
    assert set(colours(write(tmp_path, urdf(arm=arm))).values()) == {None}


def test_materials_and_colour_groups_of_3mf(tmp_path):
    body = of_mesh(BOX.vertices, BOX.faces)
    triangles = body.replace("<triangle ", '<triangle pid="8" p1="1" ')
    resources = (
        '<basematerials id="9"><base name="a" displaycolor="#C81E28FF"/></basematerials>'
        '<m:colorgroup xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" id="8">'
        '<m:color color="#000000"/><m:color color="#1450B4"/></m:colorgroup>'
        f'<object id="1" name="red" pid="9" pindex="0">{body}</object>'
        f'<object id="2" name="blue">{triangles}</object><object id="3" name="plain" pid="9" pindex="5">{body}</object>'
    )
    path = threemf(tmp_path / "a.3mf", resources, "".join(f'<item objectid="{k}"/>' for k in (1, 2, 3)))
    assert colours(path) == {"red": RED, "blue": BLUE, "plain": None}


def test_a_dae_gives_its_materials_to_scenes_and_to_links_without_one(tmp_path):
    effect = (
        '<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>'
        f"{' '.join(map(repr, shares(RED)))} 1</color></diffuse></lambert></technique></profile_COMMON></effect>"
        '</library_effects><library_materials><material id="m"><instance_effect url="#e"/></material>'
        "</library_materials>"
    )
    node = (
        '<node name="box"><instance_geometry url="#gbox"><bind_material><technique_common>'
        '<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node>'
    )
    text = dae({"box": BOX}, MM, nodes=node).replace("<library_geometries>", effect + "<library_geometries>")
    text = text.replace("<triangles ", '<triangles material="s" ')
    (tmp_path / "box.dae").write_text(text)
    assert colours(tmp_path / "box.dae") == {"box": RED}
    (tmp_path / "arm" / "urdf").mkdir(parents=True)
    (tmp_path / "arm" / "urdf" / "box.dae").write_text(text)
    mesh = '<geometry><mesh filename="box.dae"/></geometry>'
    path = write(tmp_path, urdf(base=f'<visual name="seen">{mesh}</visual>'))
    assert colours(path)["seen"] == RED
    told = f'<visual name="seen">{mesh}<material name=""><color rgba="0 0 1 1"/></material></visual>'
    assert colours(write(tmp_path, urdf(base=told)))["seen"] == "#0000ff"


def test_faces_of_a_ply(tmp_path):
    mesh = BOX.copy()
    mesh.visual.face_colors = [*(int(RED[k : k + 2], 16) for k in (1, 3, 5)), 255]
    mesh.visual.face_colors[0] = [0, 0, 0, 255]
    (tmp_path / "m.toml").write_text('schema = 1\n[assembly]\nname = "m"\nunits = "cm"\nfrom = "a.ply"\n')
    mesh.export(tmp_path / "a.ply")
    assert colours(tmp_path / "m.toml") == {"a": RED}
    BOX.export(tmp_path / "a.ply")
    assert colours(tmp_path / "m.toml") == {"a": None}


def test_solids_of_a_step_file(tmp_path):
    pytest.importorskip("cascadio")
    from tests.support.scenes import step_copy as copy

    stated = colours(copy(tmp_path, "names"))
    assert {name for name, colour in stated.items() if colour == "#ff0000"} == {"a_b"}, stated


URDF_COLOURS = (
    '<material name="red"><color rgba="0.784313725 0.117647059 0.156862745 1"/></material>\n<material name="plain"/>'
)
ROUND = '<geometry><cylinder radius="0.01" length="0.06"/></geometry>'


def test_materials_of_a_urdf_named_own_and_unknown(tmp_path):
    arm = (
        f'<visual name="named">{ROUND}<material name="red"/></visual>'
        f'<visual name="own">{ROUND}<material name="red"><color rgba="0 0 1 1"/></material></visual>'
        f'<visual name="none">{ROUND}<material name="plain"/></visual><visual name="bare">{ROUND}</visual>'
    )
    path = write(tmp_path, urdf(base="", arm=arm, more=URDF_COLOURS))
    read = colours(path)
    assert [read[name] for name in ("named", "own", "none", "bare")] == [RED, "#0000ff", None, None]


def test_materials_of_an_sdf_and_of_an_mjcf(tmp_path):
    sdf = (
        '<sdf version="1.9"><model name="m"><link name="a"><visual name="v"><geometry><box><size>1 1 1</size></box>'
        "</geometry><material><ambient>1 1 1 1</ambient><diffuse>0 0 1 1</diffuse></material></visual>"
        '<visual name="w"><geometry><box><size>1 1 1</size></box></geometry></visual></link></model></sdf>'
    )
    (tmp_path / "a.sdf").write_text(sdf)
    assert colours(tmp_path / "a.sdf") == {"v": "#0000ff", "w": None}
    mjcf = (
        '<mujoco><default><default class="b"><geom rgba="0 0 1 1"/></default></default><asset>'
        '<material name="r" rgba="1 0 0 1"/></asset><worldbody><body name="a">'
        '<geom name="own" type="sphere" size="1" rgba="0 1 0 1" material="r"/>'
        '<geom name="made" type="sphere" size="1" rgba=".5 .5 .5 1" material="r"/>'
        '<geom name="class" type="sphere" size="1" class="b"/><geom name="none" type="sphere" size="1"/>'
        "</body></worldbody></mujoco>"
    )
    (tmp_path / "a.xml").write_text(mjcf)
    assert colours(tmp_path / "a.xml") == {"own": "#00ff00", "made": "#ff0000", "class": "#0000ff", "none": None}


def coloured(tmp_path, colour):
    text = COLLARS.read_text().replace("[[part]]", f'[[part]]\ncolour = "{colour}"')
    for mesh in COLLARS.parent.glob("*.stl"):
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    path = tmp_path / "a.toml"
    path.write_text(text)
    return path


def test_a_colour_is_kept_in_results_and_changes_nothing_else(tmp_path):
    path, out = coloured(tmp_path, RED.upper()), tmp_path / "a.h5"
    kinform.run(path, out, ranges=False)
    first = results.read(out)
    assert {part.own_colour for part in first.assembly.parts} == {RED}
    kinform.run(coloured(tmp_path, BLUE), out, ranges=False)
    assert {part.own_colour for part in results.read(out).assembly.parts} == {BLUE}
    stages = results.read(out).fingerprints.stages
    assert {name for name, mark in stages.items() if first.fingerprints.stages[name] != mark} == {
        "assembly",
        "findings",
    }


def test_a_file_from_before_there_were_colours_is_read(tmp_path):
    out = tmp_path / "a.h5"
    kinform.run(COLLARS, out)
    with editing(out) as file:
        for name in ("parts", "meshes"):
            old = file["assembly"][name]
            kept = [field for field in old.dtype.names if field != "colour"]
            rows, attributes = old[()][kept], dict(old.attrs)
            del file["assembly"][name]
            new = file["assembly"].create_dataset(name, data=rows)
            new.attrs.update(attributes)
    assert {part.own_colour for part in results.read(out).assembly.parts} == {None}


def test_a_colour_of_a_manifest_is_one_as_in_style_sheets(tmp_path):
    with pytest.raises(InputError):
        form.load(coloured(tmp_path, "red"))


@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf", "glb"])
def test_exports_have_the_colours_of_parts(tmp_path, format):
    design = kinform.run(coloured(tmp_path, RED), ranges=False).design
    files = exports.export(design, format).files
    for name, data in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    path = tmp_path / next(name for name in files if not name.startswith("meshes/"))
    assert {colour for name, colour in colours(path).items() if name != "axis"} == {RED}


def test_init_of_a_description_says_its_colours(tmp_path):
    from kinform.form.write_manifest import init_from_source

    arm = f'<visual name="named">{ROUND}<material name="red"/></visual>'
    path = write(tmp_path, urdf(base="", arm=arm, more=URDF_COLOURS))
    assert f'colour = "{RED}"' in init_from_source(path, relative_to=tmp_path)


def test_the_page_has_them(tmp_path):
    from kinform.reports.page.html import page_html

    text = page_html(kinform.run(coloured(tmp_path, RED), ranges=False).design)
    scene = json.loads(text.split('id="scene">')[1].split("</script>")[0])
    assert {part["colour"] for part in scene["parts"]} == {RED} and 'data-layer="own"' in text
    assert 'data-layer="own"' not in page_html(kinform.run(COLLARS, ranges=False).design)
