"""MJCF: a primitive that is fitted to a mesh is the one that MuJoCo makes, in size and in place."""

from __future__ import annotations

import os

import numpy as np
import pytest
from support.diagonal import diagonal
from tests.support.robots import ring

from kinform import form
from kinform.errors import InputError
from kinform.form.readers.assembly import load_with_contents

BOX = """v -1 -2 -3\nv 1 -2 -3\nv 1 2 -3\nv -1 2 -3\nv -1 -2 3\nv 1 -2 3\nv 1 2 3\nv -1 2 3
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""
WEDGE = """v 0 0 0\nv 4 0 0\nv 0 3 0\nv 0 0 2\nv 4 0 1\nv 0 3 2
f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6\nf 2 6 5\nf 3 1 4 6
"""
KINDS = ("sphere", "capsule", "cylinder", "ellipsoid", "box")


def write(folder, geom, mesh=BOX, compiler="", asset=""):
    (folder / "m.obj").write_text(mesh)
    path = folder / "robot.xml"
    path.write_text(
        f'<mujoco><compiler {compiler}/>\n<asset><mesh name="m" file="m.obj" scale="0.1 0.1 0.1" {asset}/></asset>\n'
        f'<worldbody><body name="arm" pos="0.1 0.2 0.3" euler="0 0 40"><geom mesh="m" {geom}/></body></worldbody>'
        "</mujoco>\n"
    )
    return path


def part_of(path):
    return form.load(path).parts[0]


def span(part):
    low, high = part.mesh.box
    return high - low


def test_a_box_fitted_to_a_box_is_that_box_however_it_lies(tmp_path):
    part = part_of(write(tmp_path, 'type="box"', asset='refpos="5 0 0" refquat="1 2 3 4"'))
    plain = part_of(write(tmp_path, 'type="mesh"', asset='refpos="5 0 0" refquat="1 2 3 4"'))
    placed = [np.sort(p.mesh.vertices @ p.X_WP[:3, :3].T + p.X_WP[:3, 3], axis=0) for p in (part, plain)]
    assert np.allclose(placed[0], placed[1], atol=1e-9)


@pytest.mark.parametrize("around", ["false", "true"])
def test_sizes_of_what_is_fitted_to_a_box(tmp_path, around):
    x, y, z = 0.1, 0.2, 0.3
    wanted = {
        ("sphere", "false"): [2 * (x + y + z) / 3] * 3,
        ("sphere", "true"): [2 * z] * 3,
        ("cylinder", "false"): [x + y, x + y, 2 * z],
        ("cylinder", "true"): [2 * y, 2 * y, 2 * z],
        ("capsule", "false"): [x + y, x + y, 2 * z - (x + y) / 2 + (x + y)],
        ("capsule", "true"): [2 * y, 2 * y, 2 * z],
        ("ellipsoid", "false"): [2 * x, 2 * y, 2 * z],
        ("ellipsoid", "true"): [2 * x, 2 * y, 2 * z],
    }
    for (kind, how), sizes in wanted.items():
        if how == around:
            part = part_of(write(tmp_path, f'type="{kind}"', compiler=f'fitaabb="{around}"'))
            assert np.allclose(span(part), sizes, rtol=1e-2), kind  # of a round of facets


def test_a_geom_with_a_mesh_and_no_type_is_a_sphere_and_fitscale_scales_it(tmp_path):
    assert np.allclose(span(part_of(write(tmp_path, ""))), [0.4] * 3, rtol=1e-2)
    assert np.allclose(span(part_of(write(tmp_path, 'fitscale="2"'))), [0.8] * 3, rtol=1e-2)


def test_a_fitted_primitive_is_made_again_when_its_mesh_changes(tmp_path):
    _, contents = load_with_contents(write(tmp_path, 'type="box"'))
    assert set(contents) >= {"robot.xml", "m.obj"}


@pytest.mark.parametrize(
    ("geom", "mesh", "compiler", "asset"),
    [
        ('type="box"', "v 0 0 0\nv 1 0 0\nf 1 2 9\n", "", ""),
        ('type="box" fitscale="0"', BOX, "", ""),
        ('type="box"', BOX, "", 'inertia="exakt"'),
    ],
)
def test_what_cannot_be_fitted_is_told(tmp_path, geom, mesh, compiler, asset):
    with pytest.raises(InputError) as caught:
        form.load(write(tmp_path, geom, mesh, compiler, asset))
    assert all(problem.line in (2, 3) for problem in caught.value.problems)


def test_a_mesh_outside_of_the_folder_is_not_read_for_a_fit(tmp_path):
    inner = tmp_path / "a" / "b" / "c"
    inner.mkdir(parents=True)
    path = write(inner, 'type="box"')
    os.replace(inner / "m.obj", tmp_path / "m.obj")
    path.write_text(path.read_text().replace("m.obj", "../../../m.obj"))
    with pytest.raises(InputError):
        form.load(path)


@diagonal(
    mesh=[BOX, WEDGE, ring(0.2, 0.5, 0.4)], kind=KINDS, around=["false", "true"],
    inertia=["", "exact", "legacy", "convex", "shell"],
)  # fmt: skip
def test_fits_are_those_of_mujoco(tmp_path, mesh, kind, around, inertia):
    mujoco = pytest.importorskip("mujoco")
    asset = f'inertia="{inertia}"' if inertia else ""
    path = write(tmp_path, f'type="{kind}" euler="10 20 30"', mesh, f'fitaabb="{around}"', asset)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:  # a capsule of nothing but its caps, which is a sphere here
        assert "size 1 must be positive" in str(error) and kind == "capsule"
        return
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    part = part_of(path)
    size, R = model.geom_size[0], data.geom_xmat[0].reshape(3, 3)
    radius, half = size[0], size[1]
    wanted = {
        "sphere": [radius] * 3,
        "capsule": [radius, radius, radius + half],
        "cylinder": [radius, radius, half],
    }.get(kind, list(size))
    if around == "true" and "0.5" in mesh and kind in ("box", "ellipsoid"):
        wanted = None  # across a ring the axes are any
    if wanted is not None:
        assert np.allclose(span(part), 2.0 * np.array(wanted), rtol=1e-2)
    assert np.allclose(part.X_WP[:3, 3], data.geom_xpos[0], atol=1e-6)
    distinct = np.flatnonzero(np.abs(np.diff(size[:3])) > 1e-3 * size.max()) if kind == "box" else []
    for k in {0, 1, 2} if len(distinct) == 2 else ():
        assert abs(R[:, k] @ part.X_WP[:3, k]) == pytest.approx(1.0, abs=1e-5)
