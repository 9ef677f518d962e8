"""A robot description through another format, which writes its parts in frames of its own."""

from __future__ import annotations

import numpy as np
import pytest
from generators.solids import bore, box, cut, join, rod
from support.manifests import manifest
from support.robots import LIMITED, write

import kinform
from kinform.changes import compare_designs
from kinform.exports import export
from kinform.exports import write as write_export


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return kinform.run(write(tmp_path_factory.mktemp("robot"), LIMITED), ranges=False).design


@pytest.mark.parametrize("format", ["sdf", "mjcf"])
def test_parts_whose_frames_alone_are_others_have_not_moved(robot, format, tmp_path):
    made = export(robot, format)
    write_export(made, tmp_path)
    (name,) = (name for name in made.files if name.endswith((".sdf", ".xml")))
    again = kinform.run(tmp_path / name, ranges=False).design
    assert {part.name for part in again.assembly.parts} == {part.name for part in robot.assembly.parts}
    assert compare_designs(robot, again).causes == ()
    assert compare_designs(again, robot).causes == ()


def test_a_part_that_was_moved_before_it_was_written_has_moved(robot, tmp_path):
    moved = kinform.run(write(tmp_path, LIMITED.replace('xyz="0 0 0.4"', 'xyz="0 0.01 0.4"')), ranges=False).design
    write_export(export(moved, "sdf"), tmp_path)
    again = kinform.run(tmp_path / "arm.sdf", ranges=False).design
    (cause,) = compare_designs(robot, again).causes
    assert (cause.kind, cause.part) == ("part-moved", "wheel sphere")
    np.testing.assert_allclose(cause.X[:3, 3], [0.0, 0.01, 0.0], atol=1e-7)


@pytest.mark.parametrize("format", ["sdf", "mjcf"])
def test_meshes_that_a_file_of_world_coordinates_rounds_have_neither_moved_nor_changed(tmp_path, format):
    (tmp_path / "far").mkdir()
    (tmp_path / "again").mkdir()
    shaft = "position = [1000, 2000, -500]\nrpy = [10, 20, 30]\n"
    held = join(rod(5.0, 0, 30, 24), rod(8.0, -5, 0, 24), rod(8.0, 30, 35, 24))
    parts = {"block": cut(box(-20, 20, -20, 20, 0, 30), bore(5.0, 0, 30, 24)), "shaft": held}
    far = kinform.run(manifest(tmp_path / "far", parts, "", more=shaft)).design
    made = export(far, format)
    write_export(made, tmp_path / "again")
    (name,) = (name for name in made.files if name.endswith((".sdf", ".xml")))
    again = kinform.run(tmp_path / "again" / name).design
    found = compare_designs(far, again)
    assert found.causes == ()
    kinds = {change.kind for change in found.changes}
    assert "part-renamed" in kinds and not [
        k for k in kinds if k.startswith(("joint", "axis", "body-new", "body-gone"))
    ]
