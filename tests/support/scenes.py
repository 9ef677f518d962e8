"""Scenes of the parts of a fixture, what shows that they have its joints, and small files of each format."""

from __future__ import annotations

import json
import re
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh


def scene_of(assembly, groups=None, factor=1.0):
    """A trimesh scene of the parts where they stand; `groups` gives the node that a part hangs below."""
    scene = trimesh.Scene(base_frame="world")
    for group in sorted(set((groups or {}).values())):
        X = trimesh.transformations.translation_matrix([0.1, 0.2, 0.3])
        scene.graph.update(frame_from="world", frame_to=group, matrix=X)
    for part in assembly.parts:
        parent = (groups or {}).get(part.name, "world")
        X = np.linalg.inv(scene.graph.get(parent)[0]) @ part.X_WP
        X[:3, 3] *= factor
        mesh = trimesh.Trimesh(part.mesh.vertices * factor, part.mesh.faces, process=False)
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name, parent_node_name=parent, transform=X)
    return scene


def joints(results):
    return {frozenset(body.rpartition("/")[2] for body in joint.bodies): joint for joint in results.joints.values()}


def over(manifest, path):
    """The manifest without meshes and poses, which the scene beside it gives."""
    meshes = re.compile(r"^(mesh|position|quaternion|rpy|units) = .*\n", re.MULTILINE)
    text = meshes.sub("", manifest.read_text()).replace("[assembly]", f'[assembly]\nunits = "mm"\nfrom = "{path.name}"')
    out = path.with_suffix(".toml")
    out.write_text(text)
    return out


def assert_same_joints(one, other):
    a, b = joints(one), joints(other)
    assert a.keys() == b.keys() and a
    for pair, joint in a.items():
        assert (joint.type, joint.status) == (b[pair].type, b[pair].status)
        if joint.axis is not None:
            assert abs(joint.axis @ b[pair].axis) == pytest.approx(1.0, abs=1e-6)
            assert np.linalg.norm(np.cross(joint.axis, joint.point - b[pair].point)) < 2e-6
    assert one.mobility.effective == other.mobility.effective


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


def glb(tmp_path, change=lambda header: None, cut=0):
    """A GLB of a box (5 × 4 × 3 m), whose header is changed before it is written."""
    box = trimesh.creation.box((5.0, 4.0, 3.0))
    points = box.vertices.astype("<f4").tobytes()
    corners = box.faces.astype("<u2").tobytes()
    header = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "box", "mesh": 0}],
        "meshes": [{"name": "box", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(points + corners)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(points)},
            {"buffer": 0, "byteOffset": len(points), "byteLength": len(corners)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
    }  # fmt: skip
    change(header)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    binary = points + corners
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    path = tmp_path / "box.glb"
    data = struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body
    path.write_bytes(data[: len(data) - cut])
    return path


def nodes(*tables, roots=None):
    def change(header):
        header["nodes"] = list(tables)
        header["scenes"] = [{"nodes": list(range(len(tables))) if roots is None else roots}]

    return change


STEP_FILES = Path(__file__).parents[1] / "form" / "scenes" / "step"


def step_copy(folder: Path, name: str, change=lambda text: text) -> Path:
    path = folder / f"{name}.step"
    path.write_text(change((STEP_FILES / path.name).read_text()))
    return path
