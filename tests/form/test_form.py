"""Input of absurd size, depth and numbers: refused at its place, before it costs memory or reaches native code."""

from __future__ import annotations

import struct
import tracemalloc

import numpy as np
import pytest

from kinform.changes import read_lock
from kinform.consistency import read_baseline
from kinform.errors import InputError
from kinform.form import load, load_meshes
from kinform.form.meshes import blocks
from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.obj import parse_obj
from kinform.form.meshes.raw import MeshError, RawMesh
from kinform.form.meshes.stl import parse_ascii, parse_binary, read_stl
from kinform.form.problems import PROBLEMS_MOST
from kinform.foundation.processes import in_own_process

HEAD = 'schema = 1\n[assembly]\nname = "x"\nunits = "mm"\n'
PART = '[[part]]\nname = "a"\n'


def problems_of(folder, text, **files):
    """What is wrong with a manifest, as (line, message)."""
    for name, content in files.items():
        (folder / name.replace("_", ".")).write_bytes(content)
    (folder / "m.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        load(folder / "m.toml")
    return [(problem.line, problem.message) for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (HEAD + f"[{'.'.join('a' * 20_000)}]\n", 5),
        (HEAD + f"{'.'.join('a' * 20_000)} = 1\n", 5),
        (HEAD + "\nx = " + "[" * 50_000 + "]" * 50_000 + "\n", 6),
        (HEAD + "x = " + "{a = " * 5000 + "1" + "}" * 5000 + "\n", 5),
        (HEAD + "x = " + "9" * 5000 + "\n", 5),
        (HEAD + "x" * 300 + " = 1\n", 5),
        (HEAD + PART + f"[function]\nmobility = {10**20}\n", 8),
        (HEAD + PART + "position = [1e200, 0, 0]\n", 7),
        (HEAD + PART + "position = [1e308, 0, -1e308]\n", 7),
        (HEAD + PART + f"position = [{10**40}, 0, 0]\n", 7),
        (HEAD + f'[[part]]\nname = "{"n" * 300}"\n', 6),
        (HEAD + '[[part]]\nname = "a\\u0000b"\n', 6),
        (HEAD + PART + 'mesh = "a.stl\\u0000"\n', 7),
        (HEAD + PART + f'mesh = "{"a/" * 200}b.stl"\n', 7),
        (HEAD + PART + f'mesh = "{"a" * 400}.stl"\n', 7),
        (HEAD + PART + 'material = "steel\\u0000"\n', 7),
    ],
)
def test_each_excess_of_a_manifest_is_told_with_its_line(tmp_path, text, line):
    assert line in [at for at, _ in problems_of(tmp_path, text)]


def test_strings_and_comments_may_hold_what_keys_may_not(tmp_path):
    text = HEAD.replace('"x"', f'"{"[" * 40}{".".join("a" * 60)}"') + PART + "# " + "[" * 99 + "a." * 99 + "a\n"
    text += f"[function]\nmobility = 0 # {'9' * 999}\n" + "[[assume]]\nreason = '''" + "[" * 99 + "'''\n"
    told = problems_of(tmp_path, text)
    table = text.count("\n", 0, text.index("[[assume]]")) + 1
    assert told and all(line >= table for line, _ in told)


def test_deep_keys_take_no_memory_to_refuse(tmp_path):
    text = HEAD + f"[{'.'.join('a' * 20_000)}]\n"
    tracemalloc.start()
    try:
        problems_of(tmp_path, text)
        assert tracemalloc.get_traced_memory()[1] < 6 * len(text) + 5e6
    finally:
        tracemalloc.stop()


def test_a_manifest_as_large_as_no_manifest_is(tmp_path):
    told = problems_of(tmp_path, HEAD.encode() + b"#" * (5 << 20))
    assert [line for line, _ in told] == [None]


def test_very_many_problems_are_counted(tmp_path):
    told = problems_of(tmp_path, HEAD + "".join(f"x{k} = 1\n" for k in range(PROBLEMS_MOST + 50)))
    assert len(told) == PROBLEMS_MOST + 1
    assert told[-1][0] is None


def test_sub_assemblies_that_place_each_other_twice(tmp_path):
    twice = "".join(f'[[subassembly]]\nname = "{k}"\nfile = "%d.toml"\n' for k in "ab")
    for k in range(40):
        (tmp_path / f"{k}.toml").write_text(HEAD + twice.replace("%d", str(k + 1)))
    (tmp_path / "40.toml").write_text(HEAD + PART)
    (tmp_path / "m.toml").write_text(HEAD + twice.replace("%d", "0"))
    with pytest.raises(InputError) as caught:
        load(tmp_path / "m.toml")
    (problem,) = caught.value.problems
    assert problem.file == "31.toml"


DRIVE = (
    '[[part]]\nname = "b"\n[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\ntype = "revolute"\n'
    "axis = [0, 0, 1]\npoint = [0, 0, 0]\n[[function.drive]]\n"
    'joint = "j"\nkind = "motion"\nlaw = {type = "table", file = "t.csv"}\n'
)  # fmt: skip


@pytest.mark.parametrize(
    "table",
    [
        b"0,0\n1,\xff\n",
        b"0,0\n1," + b"7" * 200_000 + b"\n",
        b"0,0\n1,1e300\n",
        b"0," * (5 << 20),
        b"0,0\n1,\x00\n",
    ],
)
def test_tables_that_are_none(tmp_path, table):
    assert problems_of(tmp_path, HEAD + PART + DRIVE, t_csv=table)


@pytest.mark.parametrize("read", [read_baseline, read_lock])
@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        '{"a":' * 100_000,
        "9" * 5000,
        '{"schema": NaN}',
        '{"schema": 1e999}',
        '"\ud800"',
        "[" * 31 + "]" * 31,
    ],
    ids=["brackets", "objects", "digits", "nan", "inf", "surrogate", "no object"],
)
def test_json_that_no_kinform_wrote(read, text):
    with pytest.raises(InputError):
        read(text, "b.json")


@pytest.mark.parametrize("value", [1e19, 3e38, float("inf")])
def test_coordinates_that_are_no_lengths(value):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, value, 0]], "<f4")
    binary = bytes(80) + struct.pack("<I", 1) + bytes(12) + corners.tobytes() + bytes(2)
    with pytest.raises(MeshError):
        parse_binary(binary)
    with pytest.raises(MeshError):
        parse_obj(f"v 0 0 0\nv 1 0 0\nv 0 {value} 0\nf 1 2 3\n".encode())
    with pytest.raises(MeshError):
        read_stl(
            b"solid x\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
            b"vertex 0 %r 0\nendloop\nendfacet\nendsolid x\n".replace(b"%r", repr(value).encode())
        )


@pytest.mark.parametrize("token", [b"1_0", b"0x1p3", "١".encode()])
def test_what_only_python_takes_for_a_number(token):
    with pytest.raises(MeshError):
        parse_obj(b"v 0 0 0\nv 1 0 0\nv 0 " + token + b" 0\nf 1 2 3\n")
    with pytest.raises(MeshError):
        parse_obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 " + token + b"\n")


def test_a_mesh_smaller_than_an_atom():
    with pytest.raises(MeshError):
        build_mesh(RawMesh(1e-200 * np.eye(3), np.array([[0, 1, 2]])), 1.0, None, path="m", body=None, solid=False)


def prism_with(*faces):
    """A prism of eight sides less one side, with more facets."""
    turn = np.arange(8) * np.pi / 4
    vertices = np.array([[np.cos(t), np.sin(t), z] for z in (0.0, 2.0) for t in turn])
    caps = [[0, k + 1, k] for k in range(1, 7)] + [[8, k + 8, k + 9] for k in range(1, 7)]
    sides = [side for k in range(7) for side in ([k, k + 1, k + 9], [k, k + 9, k + 8])]
    return vertices, np.array([*caps, *sides, *faces])


@pytest.mark.parametrize("faces", [[[14, 15, 4]], [[7, 8, 15], [7, 0, 8], [14, 15, 4]]])
def test_a_mesh_that_ends_manifold3d_is_told_to_be_no_manifold(faces):
    """manifold3d 3.5.4 reads beyond its tables where facets at an edge run the same way (signal 11)."""
    vertices, triangles = prism_with(*faces)
    raw = RawMesh(vertices, triangles)
    mesh = in_own_process(lambda: build_mesh(raw, 1.0, None, path="m", body=None, solid=False))
    assert mesh.health.manifold_status == "NotManifold"
    assert not mesh.health.watertight


def test_two_cubes_that_share_an_edge_are_asked_about_in_a_process_of_their_own():
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    sides = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6]]
    sides = np.array([*sides, [0, 6, 4], [1, 5, 7], [1, 7, 3]])
    raw = RawMesh(np.concatenate([cube, cube + [1, 1, 0]]), np.concatenate([sides, sides + 8]))
    health = build_mesh(raw, 1.0, None, path="m", body=None, solid=True).health
    assert health.overused_edges == 1
    assert health.manifold_status == "NoError"


@pytest.mark.parametrize("size", [1, 7, 64])
def test_texts_read_in_small_blocks_give_the_same_mesh(monkeypatch, size):
    corners = "vertex 0 0 {k}.25\r\n vertex 1 0 0\r\n vertex 0 1 0\r\n"
    facet = f"facet normal 0 0 0\r\n outer loop\r\n {corners} endloop\r\nendfacet\r\n"
    stl = ("solid à\n" + "".join(facet.format(k=k) for k in range(9)) + "endsolid à\n").encode()
    obj = b"o a # c\r\nv 0 0 0\rv 1 0 0\nv 0 1 \\\r\n 0.125\r\nf 1 2 3\n\ng b\nf -1 -2 -3\nf 2 3 \\\n1\nv 9 9 9"
    whole = parse_ascii(stl), parse_obj(obj)
    monkeypatch.setattr(blocks, "BLOCK_BYTES", size)
    for mesh, same in zip((parse_ascii(stl), parse_obj(obj)), whole, strict=True):
        assert np.array_equal(mesh.vertices, same.vertices)
        assert np.array_equal(mesh.faces, same.faces)
        assert [x.names for x in mesh.labellings] == [x.names for x in same.labellings]
        assert mesh.written == same.written
    with pytest.raises(MeshError) as caught:
        parse_ascii(stl.replace(b"4.25", b"4.2x"))
    assert [fault.line for fault in caught.value.faults] == [32]
    with pytest.raises(MeshError) as caught:
        parse_obj(obj.replace(b"f 1 2 3", b"f 1 2 5"))
    assert [fault.line for fault in caught.value.faults] == [6]


@pytest.mark.slow
def test_files_of_faults_take_no_more_memory_than_geometry():
    for text in (b"v\n" * 200_000, b"f 1 2\n" * 100_000, b"? \n" * 100_000):
        tracemalloc.start()
        try:
            with pytest.raises(MeshError) as caught:
                parse_obj(text)
            assert tracemalloc.get_traced_memory()[1] < 6 * len(text) + 60e6
        finally:
            tracemalloc.stop()
        assert len(caught.value.faults) == 11


def test_a_solid_without_facets_among_others_is_told_by_its_name(tmp_path):
    facet = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    (tmp_path / "m.stl").write_text(f"solid full\n{facet}endsolid full\nsolid bare\nendsolid bare\n")
    with pytest.raises(InputError) as caught:
        load_meshes([tmp_path / "m.stl"], units="mm")
    assert any('"bare"' in problem.message for problem in caught.value.problems)


def test_a_facet_without_area_at_a_crowded_edge_has_no_angle(recwarn):
    """Three facets and a needle at one edge: no division by its height of nothing."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1, 0], [0.5, 0, 1], [0.5, 0, -1], [0.5, 0, 0]])
    faces = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]])
    mesh = build_mesh(RawMesh(vertices, faces), 1.0, None, path="m", body=None, solid=False)
    assert mesh.health.overused_edges == 1
    assert not list(recwarn)
