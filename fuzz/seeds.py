"""Seeds: small valid files of every format, by our own writers."""

from __future__ import annotations

import functools
import sys
import tempfile
from pathlib import Path

import numpy as np

from descriptions import MACHINE

ROOT = Path(__file__).resolve().parents[1]
FIXTURES = ROOT / "fixtures"
sys.path[:0] = [str(ROOT / "pipeline"), str(ROOT / "fixtures")]

CUBE = np.array([[x, y, z] for x in (0.0, 10.0) for y in (0.0, 20.0) for z in (0.0, 30.0)])
SIDES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip
LARGEST_SEED = 6000
"""Bytes: what is longer is mutated where nothing depends on it."""


def prism(sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a prism."""
    turn = 2.0 * np.pi * np.arange(sides) / sides
    vertices = np.array([[np.cos(t), np.sin(t), z] for z in (0.0, 2.0) for t in turn])
    caps = [[0, k + 1, k] for k in range(1, sides - 1)]
    tops = [[sides, k + sides, k + sides + 1] for k in range(1, sides - 1)]
    walls = [
        side for k in range(sides) for n in [(k + 1) % sides] for side in ([k, n, n + sides], [k, n + sides, k + sides])
    ]
    return vertices, np.array([*caps, *tops, *walls])


def binary_stl(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    """A binary STL file."""
    record = np.zeros(len(faces), np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")]))
    record["c"] = vertices[faces]
    return b"seed".ljust(80) + len(faces).to_bytes(4, "little") + record.tobytes()


def ascii_stl(name: str, vertices: np.ndarray, faces: np.ndarray) -> bytes:
    """An ASCII STL file of one solid."""
    lines = [f"solid {name}"]
    for facet in vertices[faces].tolist():
        lines += [" facet normal 0 0 0", "  outer loop", *(f"   vertex {x!r} {y!r} {z!r}" for x, y, z in facet)]
        lines += ["  endloop", " endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""]).encode()


def stl() -> list[bytes]:
    """Both kinds, one and two bodies."""
    two = np.concatenate([CUBE, CUBE + 50.0]), np.concatenate([SIDES, SIDES + 8])
    return [
        binary_stl(CUBE, SIDES), binary_stl(*prism(6)), binary_stl(*two), ascii_stl("cube", CUBE, SIDES[:4]),
        ascii_stl("a", CUBE, SIDES) + ascii_stl("b", CUBE + 50.0, SIDES), ascii_stl("", *prism(3)),
    ]  # fmt: skip


def obj() -> list[bytes]:
    """Triangles and polygons, positive and negative indices, objects and groups."""
    vertices, faces = prism(5)
    body = "".join("v {} {} {}\n".format(*v) for v in vertices.tolist())
    triangles = body + "".join("f {} {} {}\n".format(*f) for f in (faces + 1).tolist())
    sides = "".join(f"f {k + 1}/1/1 {(k + 1) % 5 + 1}//1 {(k + 1) % 5 + 6} {k + 6}\n" for k in range(5))
    polygons = (
        f"# made\nmtllib x.mtl\no one\n{body}vt 0 0\nvn 0 0 1\ng cap\nf 5 4 3 2 1\nf -5 -4 -3 -2 -1\ng wall\n{sides}"
    )
    arrow = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 .5 0\nv 0 2 0\nf 1 2 3 4 \\\n5\n"
    return [triangles.encode(), polygons.encode(), arrow.encode(), (triangles + "o two\n" + triangles).encode()]


def manifests() -> list[bytes]:
    """Small manifests of the fixtures, their mesh files renamed to what lies beside the mutated one; and one of all."""
    import re

    out = []
    for path in sorted(FIXTURES.rglob("*.toml")):
        text = path.read_text(encoding="utf-8")
        if len(text) < LARGEST_SEED and "[[subassembly]]" not in text:
            out.append(re.sub(r'"[^"\n]*\.(stl|obj)"', r'"a.\1"', text).encode())
    return [*out, EVERYTHING.encode(), MACHINE.encode()]


EVERYTHING = """schema = 1
[assembly]
name = "all"
units = "mm"
ground = "a"
[materials.pla]
density = 1240.0
[[part]]
name = "a"
mesh = "a.stl"
material = "pla"
quaternion = [1, 0, 0, 0]
[[part]]
name = "b"
mesh = "a.obj"
body = "shell 1"
density = 2700
position = [0.5, 1e-3, -2]
rpy = [90, 0, 45]
solid = false
[[part]]
name = "c"
mass = 1.5
centre_of_mass = [0, 0, 1]
inertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]
[[group]]
name = "g"
parts = ["b", "c"]
[[subassembly]]
name = "s"
file = "below.toml"
position = [100, 0, 0]
[[assume]]
between = ["a", "s/p"]
ignore = true
reason = "apart"
[tolerances]
contact = 0.1
weld = 1e-6
alignment = 0.2
[fasteners]
infer = true
[function]
mobility = 1
[[function.joint]]
name = "j"
between = ["a", "g"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
range = [-90, inf]
[[function.joint]]
name = "k"
between = ["a", "s/p"]
type = "screw"
axis = [0, 0, 1]
point = [0, 0, 0]
pitch = 2
[[function.coupling]]
joints = ["j", "k"]
ratio = -2.5
[[function.drive]]
joint = "j"
kind = "dc_motor"
resistance = 1.0
constant = 0.1
law = {type = "sine", amplitude = 20, frequency = 0.5}
[[function.drive]]
joint = "k"
kind = "motion"
law = {type = "table", file = "t.csv"}
[[function.load]]
part = "b"
force = [0, 0, -9.81]
point = [1, 2, 3]
[[function.require]]
name = "r"
kind = "reach"
part = "b"
point = [1, 0, 0]
region = {type = "poses", points = [[1, 0, 0], [0, 1, 0]]}
tolerance = 0.1
[[function.require]]
name = "f"
kind = "follow"
part = "b"
point = [0, 0, 0]
path = "p.csv"
tolerance = 1
[[function.require]]
name = "h"
kind = "hold"
joint = "j"
limit = 2.0
poses = [{j = 30}]
[simulation]
level = "kinematic"
duration = 1.0
step = 0.01
gravity = [0, 0, -9.81]
[simulation.initial.j]
position = 5
velocity = 0
[check]
select = ["KF2"]
[check.severity]
KF303 = "note"
[[check.ignore]]
code = "KF204"
reason = "known"
"""
BELOW = 'schema = 1\n[assembly]\nname = "s"\nunits = "in"\n[[part]]\nname = "p"\nmesh = "a.stl"\n'
LAW = b"time,value\n0,0\n0.5,1.5\n1,-2e1\n"
PATH = b"t,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,1,2,3,0,1,0,0\n"


def scenes() -> list[bytes]:
    """PLY and OFF."""
    vertices, faces = "".join("{} {} {}\n".format(*v) for v in CUBE.tolist()), SIDES.tolist()
    triangles = "".join("3 {} {} {}\n".format(*f) for f in faces)
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    ply = f"{head}element face 12\nproperty list uchar int vertex_indices\nend_header\n{vertices}{triangles}"
    return [ply.encode(), f"OFF\n8 12 0\n{vertices}{triangles}".encode()]


def glb() -> list[bytes]:
    """Two instances of a mesh, one below another node, and a second mesh."""
    import trimesh

    scene = trimesh.Scene(base_frame="world")
    scene.add_geometry(trimesh.Trimesh(CUBE, SIDES), node_name="a", geom_name="cube")
    X = trimesh.transformations.translation_matrix([100.0, 0.0, 0.0])
    scene.graph.update(frame_from="world", frame_to="sub", matrix=X)
    scene.graph.update(frame_from="sub", frame_to="b/c", geometry="cube", matrix=X)
    scene.add_geometry(trimesh.Trimesh(*prism(3)), node_name="p", parent_node_name="sub")
    return [scene.export(file_type="glb")]


THREEMF = """<?xml version="1.0"?>
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
<object id="1" name="a"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1.5"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>
</object><object id="2"><components><component objectid="1"/><component objectid="1"
transform="0 1 0 -1 0 0 0 0 1 5 6 7"/></components></object></resources><build><item objectid="2"/>
<item objectid="1" partnumber="b"/></build></model>
"""


def archive(model: bytes) -> bytes:
    """A 3MF with this model."""
    import io
    import zipfile

    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as packed:
        packed.writestr("3D/3dmodel.model", model)
    return out.getvalue()


def threemf() -> list[bytes]:
    """A model with an object of components."""
    return [THREEMF.encode()]


def dae() -> list[bytes]:
    """By trimesh, and with a node in a node."""
    import re

    import trimesh

    text = trimesh.exchange.dae.export_collada(trimesh.Trimesh(CUBE, SIDES))
    for tag in (b"library_effects", b"library_materials", b"bind_material"):
        text = re.sub(rb"(?s)<%b>.*?</%b>" % (tag, tag), b"", text)
    nested = re.sub(rb"(?s)(<node .*</node>)", rb'<node name="o"><rotate>0 0 1 30</rotate>\1</node>', text)
    text = re.sub(rb"<(created|modified)>[^<]*</\1>", b"", text)  # in one of them: dates take long to read
    return [text, nested.replace(b"<up_axis>", b'<unit name="mm" meter="0.001"/><up_axis>')]


def step() -> list[bytes]:
    """Boxes and pins in a sub-assembly."""
    return [(ROOT / "tests" / "form" / "scenes" / "step" / "names.step").read_bytes()]


def csv() -> list[bytes]:
    """Laws and paths."""
    return [LAW, PATH, b"0,0,0,0\n1,1,1,1\n2,2,2,2\n"]


@functools.cache
def design(name: str = "pairs/revolute_collars"):
    """A fixture, derived and checked."""
    from kinform import stages

    manifest = FIXTURES / name / f"{Path(name).name}.toml"
    found = stages.mass(stages.joints(stages.contacts(stages.import_(manifest))))
    return stages.check(stages.simulate(found))


def baselines() -> list[bytes]:
    """Of a good design and of a broken one."""
    from kinform.consistency import adopt

    broken = next(iter(sorted(p.stem for p in FIXTURES.glob("broken/*"))))
    return [adopt(design().report).text().encode(), adopt(design(f"broken/{broken}").report).text().encode()]


def locks() -> list[bytes]:
    """Of two designs."""
    from kinform.changes import snapshot, write_lock

    return [write_lock(snapshot(design(name))).encode() for name in ("pairs/revolute_collars", "pairs/screw_right")]


def catalogs() -> list[bytes]:
    """Of two designs, and of none."""
    import contextlib
    import sqlite3

    from kinform.catalog import Catalog, entry_of, write

    out = []
    with tempfile.TemporaryDirectory() as folder:
        for entries in (
            (),
            (entry_of(design(), "a.h5", "0" * 64), entry_of(design("pairs/screw_right"), "b.h5", "1" * 64)),
        ):
            path = Path(folder) / "c.db"
            path.unlink(missing_ok=True)
            write(Catalog(("a.h5", "b.h5"), tuple(entries)), path)
            with contextlib.closing(sqlite3.connect(path)) as database:  # small pages: fewer bytes that say nothing
                database.execute("PRAGMA page_size = 512")
                database.execute("VACUUM")
            out.append(path.read_bytes())
    return out


@functools.cache
def results_designs() -> tuple:
    """Of an import, of its joints, and of everything."""
    from dataclasses import replace

    whole = design("pairs/revolute_collars")
    bare = {"mass": None, "behaviour": None, "simulation": None, "report": None}
    joints = replace(whole, **bare)
    imported = replace(joints, surfaces={}, contacts=None, kinematics=None)
    return (imported, joints, whole, design("functional/stick_four_bar"))


@functools.cache
def results_images() -> tuple[bytes, ...]:
    """Results files of these designs, of which edits are made."""
    from kinform.results.file import to_bytes

    return tuple(to_bytes(made) for made in results_designs())


def edits() -> list[bytes]:
    """Bytes that choose edits of a results file."""
    rng = np.random.default_rng(0)
    return [rng.bytes(8 * k) for k in (1, 1, 2, 3, 5, 8)]
