"""OBJ: polygons, indices, objects, and what is wrong at its line."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from kinform.form.constants import FAULTS_SHOWN
from kinform.form.meshes.obj import parse_obj, read_obj
from kinform.form.meshes.raw import MeshError


def test_obj_with_quads_negative_indices_slashes_and_two_objects():
    text = (
        "o first\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2/1/1 3//1 4\n"
        "o second\nv 0 0 1\nv 1 0 1\nv 1 1 1\nf -3 -2 \\\n-1\n"
    )
    raw = parse_obj(text.encode())
    assert len(raw.faces) == 3
    assert raw.faces[2].tolist() == [4, 5, 6]
    assert raw.labellings[0].names == ("first", "second")


def test_a_concave_polygon_keeps_its_area():
    arrow = [(0, 0), (2, 0), (2, 2), (1, 0.5), (0, 2)]
    text = "".join(f"v {x} {y} 0\n" for x, y in arrow) + "f 1 2 3 4 5\n"
    raw = parse_obj(text.encode())
    p = raw.vertices[raw.faces]
    area = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])[:, 2] / 2
    assert (area > 0).all()
    assert area.sum() == pytest.approx(2.5)


@pytest.mark.parametrize("index", ["9", "-9", "0", "x"])
def test_a_wrong_index_is_told_with_its_line(index):
    with pytest.raises(MeshError) as caught:
        parse_obj(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}\n".encode())
    assert [fault.line for fault in caught.value.faults] == [4]


TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def _star(corners: int) -> bytes:
    """A polygon of so many corners that is not convex."""
    turn = np.arange(corners) * 2 * np.pi / corners
    r = 1 + 0.5 * (np.arange(corners) % 2)
    lines = [f"v {x:.9f} {y:.9f} 0\n" for x, y in np.column_stack([r * np.cos(turn), r * np.sin(turn)]).tolist()]
    return ("".join(lines) + "f " + " ".join(map(str, range(1, corners + 1))) + "\n").encode()


def test_a_concave_polygon_is_cut_up_to_a_number_of_corners_and_refused_beyond(monkeypatch) -> None:
    monkeypatch.setattr("kinform.form.meshes.polygons.CUT_CORNERS", 200)
    monkeypatch.setattr("kinform.form.meshes.obj.CUT_CORNERS", 200)
    assert len(read_obj(_star(200)).faces) == 198
    with pytest.raises(MeshError):
        read_obj(_star(202))


def test_a_convex_polygon_may_have_any_number_of_corners(monkeypatch) -> None:
    monkeypatch.setattr("kinform.form.meshes.polygons.CUT_CORNERS", 10)
    turn = np.arange(1000) * 2 * np.pi / 1000
    text = "".join(f"v {np.cos(t):.17g} {np.sin(t):.17g} 0\n" for t in turn)
    assert len(read_obj((text + "f " + " ".join(map(str, range(1, 1001))) + "\n").encode()).faces) == 998


def test_of_many_polygons_that_cross_themselves_the_first_are_enough(monkeypatch) -> None:
    tried = []
    monkeypatch.setattr("kinform.form.meshes.polygons._cut", lambda vertices, polygon: tried.append(polygon))
    bow = b"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\n" + b"f 1 2 3 4\n" * 500
    with pytest.raises(MeshError):
        read_obj(bow)
    assert len(tried) == FAULTS_SHOWN


@pytest.mark.parametrize(
    "line", [b"f " + b"1 2 3 " * 200_000, b"f 1 2 3" + b" \\\n1" * 200_000, b"v 0 0 " + b"1" * 1_000_000]
)
def test_a_line_that_is_longer_than_any_is_refused_before_its_words_are_looked_at(monkeypatch, line: bytes) -> None:
    monkeypatch.setattr("kinform.form.meshes.obj.FACE_BYTES", 1 << 18)
    tracemalloc.start()
    try:
        with pytest.raises(MeshError) as caught:
            read_obj(TRIANGLE + line + b"\n")
        assert [fault.line for fault in caught.value.faults] == [5]
        assert tracemalloc.get_traced_memory()[1] < 20 * len(line)
    finally:
        tracemalloc.stop()
