"""Meshes far from the origin of their files, and how finely files write numbers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.form import load
from kinform.form.meshes.digits import written_step
from kinform.form.meshes.health import build_mesh, far_origin
from kinform.form.meshes.obj import parse_obj
from kinform.form.meshes.raw import RawMesh

WEDGE = np.array([[0.1, 0.2, 0.3], [1.3, 0.25, 0.35], [0.15, 1.7, 0.4], [0.2, 0.3, 2.1]])


SIDES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def built(vertices, metres=1e-3):
    return build_mesh(RawMesh(vertices, SIDES), metres, None, path="m", body=None, solid=True)


def obj(rows, form):
    lines = ["v " + " ".join(form % x for x in row) for row in rows]
    return "\n".join([*lines, *("f {} {} {}".format(*(face + 1)) for face in SIDES)])


@settings(max_examples=30)
@given(st.tuples(*[st.integers(-(2**24), 2**24)] * 3))
def test_a_far_mesh_is_the_same_to_the_last_bit(place):
    offset = 4.0 * np.array(place, dtype=float)
    near = WEDGE.astype(np.float32).astype(float)
    far = near + offset
    origin = far_origin(far)
    assert np.array_equal(far - origin + origin, far)
    if (np.abs(offset) > 40.0).all():
        mesh, at_home = built(far), built(near)
        moved = mesh.vertices + (mesh.origin - 1e-3 * offset)
        np.testing.assert_allclose(moved, at_home.vertices, atol=1e-15 * float(np.abs(offset).max()))
        assert np.abs(mesh.vertices).max() < 10e-3


def test_a_mesh_near_the_origin_stays_where_it_is():
    for offset in (0.0, 5.0, -15.0):
        assert not built(WEDGE + offset).origin.any()


def test_the_resolution_of_binary_numbers_is_a_step_of_the_largest():
    far = (WEDGE + 1000.0).astype(np.float32)
    mesh = built(far)
    assert mesh.resolution == pytest.approx(1002.1 * 2.0**-23 * 1e-3)
    assert mesh.health.weld == pytest.approx(2.0 * mesh.resolution)
    assert built(WEDGE + 1000.0).resolution < 1e-9
    assert built(far).digest != built(far.astype(float)).digest


def step_of(tokens, values):
    """In blocks of a few, as in a file."""
    texts = [token.encode() for token in tokens]
    return written_step((texts[k : k + 7] for k in range(0, len(texts), 7)), values)


@pytest.mark.parametrize(
    ("form", "offset", "step"),
    [
        ("%.6g", 1000.0, 1e-2),
        ("%.6g", 1e6, 10.0),
        ("%.6f", 1e6, 1e-6),
        ("%.3f", 10.0, 1e-3),
        ("%.5e", 300.0, 1e-3),
    ],
)
def test_the_resolution_of_a_text_is_that_of_its_digits(form, offset, step):
    rng = np.random.default_rng(1)
    values = rng.uniform(0, 5 if step < 1 else 90, 60) + offset
    assert step_of([form % v for v in values], values) == pytest.approx(step)
    assert parse_obj(obj(values[:12].reshape(4, 3), form).encode()).resolution == pytest.approx(step)


def test_round_numbers_are_not_rounded_ones():
    values = [1000000.0, 1000010.0, 1000020.0, 1000030.0, 1000000.5]
    assert step_of([repr(v) for v in values], np.array(values)) == 0.0


@pytest.mark.parametrize("form, step", [("%.17g", 0.0), ("%.5f", 0.0), ("%.5g", 1.0)])
def test_whole_numbers_of_a_box_are_rounded_only_if_its_bore_is(form, step):
    """A plate of 13.7 by 14.1 m with a bore of 3 mm: its large coordinates say nothing by themselves."""
    bore = 3.0 * np.cos(np.arange(40) / 7.0)
    values = np.concatenate([[13701.0, -13701.0, 14103.0, -14103.0], bore])
    assert step_of([form % v for v in values], values) == step


def test_a_box_of_whole_numbers_is_no_coarse_file(tmp_path):
    box = np.array([[x, y, z] for x in (14.0, 190.0) for y in (-8.0, 8.0) for z in (10.0, 310.0)])
    assert parse_obj(obj(box, "%.12g").encode()).resolution < 1e-9
    assert parse_obj(obj(box * 1e-3, "%.12g").encode()).resolution < 1e-9


def test_whole_millimetres_of_a_frame_are_no_rounded_numbers():
    frame = [0, 40, 1210, 1250, 600, 640, 980, 1000, 35, 1215, 1245, 605, 635, 985, 25, 15, 1225]
    assert step_of([str(v) for v in frame], np.array(frame, dtype=float)) == 0.0
    assert step_of(["0", "1"] * 12, np.array([0.0, 1.0] * 12)) == 0.0


def test_doubles_are_written_finer_than_can_be_told():
    values = np.random.default_rng(2).uniform(1e6, 1e6 + 10, 50)
    assert step_of([repr(float(v)) for v in values], values) < 1e-8


def test_a_mesh_far_away_lies_in_the_world_where_the_file_puts_it(tmp_path):
    (tmp_path / "m.obj").write_text(obj(WEDGE + [0.0, 1e6, 0.0], "%.17g"))
    (tmp_path / "m.toml").write_text(
        'schema = 1\n[assembly]\nname = "far"\nunits = "mm"\n[[part]]\nname = "a"\nmesh = "m.obj"\n'
        "position = [0, 0, 7]\nrpy = [90, 0, 0]\nmass = 1.0\ncentre_of_mass = [0, 1000000.5, 0]\n"
        "inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
    )
    part = load(tmp_path / "m.toml").part("a")
    low, high = part.mesh.placed_box(part.X_WP)
    np.testing.assert_allclose(low, [0.1e-3, -2.1e-3, 1000.0 + 0.2e-3 + 7e-3], atol=1e-9)
    np.testing.assert_allclose(high, [1.3e-3, -0.3e-3, 1000.0 + 1.7e-3 + 7e-3], atol=1e-9)
    centre = part.X_WP[:3, :3] @ part.override.centre_of_mass + part.X_WP[:3, 3]
    np.testing.assert_allclose(centre, [0, 0, 1000.0005 + 7e-3], atol=1e-9)
