"""Small files that place, unpack to, or list far more than they hold are refused at little cost."""

from __future__ import annotations

import io
import json
import struct
import time
import zipfile

import pytest
from support.costs import cost_of

from kinform import form
from kinform.errors import InputError

SECONDS, MEGABYTES = 15.0, 500.0
"""What the refusal of a file of at most 1 MB may take, of processor on a busy machine (on a quiet one 2 s; before
it grew to minutes), and memory."""
HEAD = 'schema = 1\n[assembly]\nname = "w"\nunits = "mm"\n'
TETRAHEDRON = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
SIDES = (0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3)


def _glb(nodes, roots, **changes) -> bytes:
    binary = TETRAHEDRON + struct.pack("<12H", *SIDES)
    header = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": roots}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "buffers": [{"byteLength": 72}], **changes,
    }  # fmt: skip
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def _doubling(levels: int) -> bytes:
    return _glb([*({"children": [k + 1, k + 1]} for k in range(levels)), {"mesh": 0}], [0])


def _decoded_again() -> bytes:
    vertices = b"\0\0\x80\x3f" * 3 * 10_000
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}] * 3
    primitives = [{"attributes": {"POSITION": 0}, "indices": 1}] * 5000
    accessors[1] = {"bufferView": 1, "componentType": 5123, "count": 199_998, "type": "SCALAR"}
    data = vertices + bytes(400_000)
    views = [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 120_000, "byteLength": 400_000}]
    whole = _glb([{"mesh": 0}], [0], meshes=[{"primitives": primitives}], accessors=accessors, bufferViews=views,
                 buffers=[{"byteLength": len(data)}])  # fmt: skip
    head, _, _ = whole.rpartition(struct.pack("<I4s", 72, b"BIN\0"))
    grown = head + struct.pack("<I4s", len(data), b"BIN\0") + data
    return grown[:8] + struct.pack("<I", len(grown)) + grown[12:]


MESH = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>'
    '<vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>'
)
OBJECT = f'<object id="1">{MESH}</object>'


def _3mf(resources: str, build: str = '<item objectid="1"/>', extra: str = "", method=zipfile.ZIP_DEFLATED) -> bytes:
    space = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as packed:
        text = (
            f'<model unit="millimeter" xmlns="{space}"><resources>{resources}</resources><build>{build}</build>{extra}'
        )
        packed.writestr("3D/3dmodel.model", text + "</model>")
    return out.getvalue()


def _component_levels(levels: int, each: int) -> bytes:
    objects = [
        f'<object id="{k + 2}"><components>' + f'<component objectid="{k + 1}"/>' * each + "</components></object>"
        for k in range(levels)
    ]
    return _3mf(OBJECT + "".join(objects), f'<item objectid="{levels + 1}"/>')


def _dae(levels: int) -> bytes:
    leaf = '<node id="n0"><instance_geometry url="#g"/></node>'
    nodes = [f'<node id="n{k + 1}">' + f'<instance_node url="#n{k}"/>' * 2 + "</node>" for k in range(levels)]
    numbers = "0 0 0 1 0 0 0 1 0 0 0 1"
    corners = " ".join(map(str, SIDES))
    params = "".join(f'<param name="{axis}" type="float"/>' for axis in "XYZ")
    return f"""<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>
<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="s">
<float_array id="f" count="12">{numbers}</float_array><technique_common><accessor source="#f" count="4" stride="3">
{params}</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p></triangles></mesh>
</geometry></library_geometries><library_nodes>{leaf}{"".join(nodes)}</library_nodes><library_visual_scenes>
<visual_scene id="x"><node><instance_node url="#n{levels}"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#x"/></scene></COLLADA>""".encode()


def _circle(links: int) -> str:
    joints = [
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{(k + 1) % links}"/></joint>'
        for k in range(links)
    ]
    return '<robot name="a">' + "".join(f'<link name="l{k}"/>' for k in range(links)) + "".join(joints) + "</robot>"


def _unknown_members(members: int) -> str:
    parts = "".join(f'[[part]]\nname = "p{k}"\n' for k in range(4000))
    return HEAD + parts + '[[group]]\nname = "g"\nparts = [' + ",".join(f'"q{k}"' for k in range(members)) + "]\n"


def _attributes(root: str, inside: str = "") -> str:
    return f"<{root} " + " ".join(f'a{k}="1"' for k in range(80_000)) + f">{inside}</{root}>"


def _classes() -> str:
    classes = "".join(f'<default class="c{k}"><geom size="1"/></default>' for k in range(14_000))
    kinds = "".join(f'<k{k} a="1"/>' for k in range(8_000))
    return f'<mujoco><default>{kinds}{classes}</default><worldbody><geom class="x"/></worldbody></mujoco>'


def _repeated(head: str, each: str, count: int, tail: str = "") -> str:
    return head + "".join(each.format(k) for k in range(count)) + tail


MESH_OF = '<visual><geometry><mesh filename="{}"/></geometry></visual>'

CASES = {
    "attributes-urdf": ("a.urdf", lambda: _attributes("robot", '<link name="l"/>')),
    "attributes-xml": ("a.xml", lambda: _attributes("mujoco", "<worldbody/>")),
    "attributes-sdf": ("a.sdf", lambda: _attributes("sdf")),
    "elements-mjcf": ("a.mjcf", lambda: "<mujoco>" + "<a/>" * 240_000 + "</mujoco>"),
    "doctypes-urdf": ("a.urdf", lambda: "<!DOCTYPE " * 90_000),
    "classes-mjcf": ("a.xml", _classes),
    "unknown-meshes-mjcf": (
        "a.xml",
        lambda: _repeated("<mujoco><worldbody>", '<geom type="mesh" mesh="m{}"/>', 24_000, "</worldbody></mujoco>"),
    ),
    "deep-paths-urdf": (
        "a.urdf",
        lambda: '<robot name="a"><link name="l">' + MESH_OF.format("package://p/" + "a/" * 450_000 + "m.stl"),
    ),
    "packages-urdf": (
        "a.urdf",
        lambda: _repeated(
            '<robot name="a"><link name="l">',
            MESH_OF.replace("{}", "package://p{}/" + "a/" * 40 + "m.stl"),
            5_000,
            "</link></robot>",
        ),
    ),
    "unknown-links-sdf": (
        "a.sdf",
        lambda: _repeated(
            '<sdf version="1.9"><model name="m"><link name="l"/>',
            '<joint name="j{0}" type="fixed"><parent>l</parent><child>x{0}</child></joint>',
            12_000,
            "</model></sdf>",
        ),
    ),
    "one-unknown-key": ("m.toml", lambda: _repeated(HEAD, '[[part]]\nname = "p{}"\nz = 1\n', 900) + _parts(8_000)),
    "missing-meshes": ("m.toml", lambda: _repeated(HEAD, '[[part]]\nname = "p{0}"\nmesh = "m{0}.stl"\n', 10_000)),
    "row-of-vertices-obj": (
        "m.toml",
        lambda: HEAD + '[[part]]\nname = "p"\nmesh = "a.obj"\n',
        lambda: _repeated("", "v {0} 0 0\nv {0} 1 0\nv {0} 0 1\nf -1 -2 -3\n", 18_000),
    ),
    "copies-glb": ("a.glb", lambda: _doubling(41)),
    "copies-glb-beyond-all-numbers": ("a.glb", lambda: _doubling(63)),
    "too-many-parts-glb": ("a.glb", lambda: _doubling(17)),
    "wide-glb": ("a.glb", lambda: _glb([{"children": [1] * 90_000}, {"children": [2] * 90_000}, {"mesh": 0}], [0])),
    "circle-glb": ("a.glb", lambda: _glb([{"children": [1, 1]}, {"children": [0], "mesh": 0}], [0])),
    "long-names-glb": ("a.glb", lambda: _glb([{"children": [1] * 900}, {"name": "x" * 90_000, "mesh": 0}], [0])),
    "decoded-again-glb": ("a.glb", _decoded_again),
    "copies-3mf": ("a.3mf", lambda: _component_levels(40, 2)),
    "chain-3mf": ("a.3mf", lambda: _component_levels(2000, 1)),
    "wide-3mf": ("a.3mf", lambda: _component_levels(1, 200_000)),
    "elements-3mf": ("a.3mf", lambda: _3mf(OBJECT, extra="<a/>" * 8_000_000)),
    "few-bytes-many-elements-3mf": ("a.3mf", lambda: _3mf(OBJECT, extra="<a/>" * 3_000_000)),
    "blanks-3mf": ("a.3mf", lambda: _3mf(OBJECT, extra="<a>" + " " * 40_000_000 + "</a>")),
    "lzma-3mf": ("a.3mf", lambda: _3mf(OBJECT, extra="<a/>" * 1_000_000, method=zipfile.ZIP_LZMA)),
    "copies-dae": ("a.dae", lambda: _dae(40)),
    "circle-urdf": ("a.urdf", lambda: _circle(6000)),
    "include-itself-mjcf": ("a.xml", lambda: "<mujoco>" + '<include file="a.xml"/>' * 30_000 + "<worldbody/></mujoco>"),
    "values": ("m.toml", lambda: HEAD + "a = [" + "1," * 400_000 + "]"),
    "unknown-members": ("m.toml", lambda: _unknown_members(20_000)),
}


def _parts(count: int) -> str:
    return "".join(f'[[part]]\nname = "q{k}"\n' for k in range(count))


def _written(folder, name: str) -> str:
    file, make, *beside = CASES[name]
    for more in beside:
        (folder / "a.obj").write_text(more())
    data = make()
    data = data.encode() if isinstance(data, str) else data
    assert len(data) <= 1_000_000
    (folder / file).write_bytes(data)
    return file


@pytest.mark.parametrize("name", CASES)
def test_a_small_file_of_far_more_than_it_holds_is_refused_soon(tmp_path, name):
    file = _written(tmp_path, name)
    begun = time.process_time()
    with pytest.raises(InputError):
        form.load(tmp_path / file)
    assert time.process_time() - begun < SECONDS


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_refusal_takes_little_processor_and_memory(tmp_path, name):
    cost = cost_of(tmp_path, "run", _written(tmp_path, name))
    assert cost.code == 2
    assert "internal error" not in cost.said
    assert cost.seconds < SECONDS
    assert cost.megabytes < MEGABYTES


@pytest.mark.slow
def test_ten_thousand_links_joined_by_fixed_joints_take_half_a_gigabyte(tmp_path):
    links = 10_000
    joints = [
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/></joint>'
        for k in range(links - 1)
    ]
    text = '<robot name="a">' + "".join(f'<link name="l{k}"/>' for k in range(links)) + "".join(joints) + "</robot>"
    (tmp_path / "a.urdf").write_text(text)
    assert cost_of(tmp_path, "run", "a.urdf").megabytes < MEGABYTES


def test_nodes_of_a_dae_that_are_placed_twice_are_parts_twice(tmp_path):
    (tmp_path / "a.dae").write_bytes(_dae(2))
    assert len(form.load(tmp_path / "a.dae").parts) == 4
