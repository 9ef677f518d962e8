"""STL: corners of every facet, names of solids, and other files named so."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.form.meshes.raw import MeshError
from kinform.form.meshes.stl import parse_ascii, parse_binary, read_stl

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


SIDES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip


def binary(corners, header=b"made by a test"):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel(facet), 0) for facet in corners)
    return header.ljust(80, b"\0") + struct.pack("<I", len(corners)) + records


def ascii_of(name, corners):
    lines = [f"solid {name}"]
    for facet in corners:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in facet.tolist())]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""])


@settings(max_examples=30)
@given(st.lists(st.lists(st.floats(-1e6, 1e6, width=32), min_size=9, max_size=9), min_size=1, max_size=20))
def test_binary_stl_gives_back_its_corners(facets):
    corners = np.array(facets, np.float32).reshape(-1, 3, 3)
    raw = parse_binary(binary(corners, b"solid although binary"))
    assert np.array_equal(raw.vertices[raw.faces], corners)


@settings(max_examples=30)
@given(st.lists(st.lists(st.floats(-1e6, 1e6), min_size=9, max_size=9), min_size=1, max_size=8))
def test_ascii_stl_gives_back_its_corners_and_names_its_solids(facets):
    corners = np.array(facets).reshape(-1, 3, 3)
    raw = parse_ascii((ascii_of("one", corners) + ascii_of("two", corners)).encode())
    assert np.array_equal(raw.vertices[raw.faces], np.concatenate([corners, corners]))
    assert raw.labellings[0].names == ("one", "two")


@pytest.mark.parametrize(
    "begins",
    [
        b"# made by a modeller\n\n# again\nmtllib a.mtl\n",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        b"ply\nformat binary_little_endian 1.0\n",
        b"COFF\n8 6 12\n",
        b"ISO-10303-21;\nHEADER;\n",
        b"glTF\x02\0\0\0",
        b"PK\x03\x04\x14\0",
        b"<html><body>not found</body></html>\n",
    ],
)
def test_a_file_of_another_kind_named_stl_is_refused(begins):
    for data in (begins, begins + b" " * 200 + begins * 20):
        with pytest.raises(MeshError):
            read_stl(data)


def test_binary_stl_whose_header_is_any_text_is_read():
    for head in (b"v 1 2 3\nf 1 2 3\n", b"ply\n", b"# exported by a modeller\n"):
        data = binary(CUBE[SIDES])
        assert read_stl(head.ljust(80) + data[80:]).faces.shape == (12, 3)
