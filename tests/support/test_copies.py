"""The copies are what they claim to be: vertices in the world, stated joints, numbers of the files."""

from __future__ import annotations

import numpy as np
import pytest

from kinform import form
from support.copies import Change, answers, axis_errors, copy_of, derived, turned
from support.places import FIXTURES

SCREW = FIXTURES / "pairs" / "screw_right" / "screw_right.toml"
COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"


def corners(assembly, originals):
    """World corners (m) of each part, sorted, by the name in the original."""
    out = {}
    for part in assembly.parts:
        world = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
        out[originals[part.name]] = world
    return out


def same_shape(first, second, atol):
    """Whether two sets of vertices are the same, in any order."""
    return len(first) == len(second) and all(np.abs(second - v).max(axis=1).min() <= atol for v in first)


@pytest.mark.parametrize(
    "change, precision",
    [
        (Change(), 1e-15),
        (Change(files="stl"), 1e-8),
        (Change(scale=1e3, rotation=turned(3), offset=(5.0, -3.0, 2.0)), 1e-11),
        (Change(scale=1e-3, rotation=turned(4), baked=True, shuffled=True), 1e-15),
        (Change(offset=(1e5, 0.0, -1e5), baked=True), 1e-10),
    ],
    ids=["same", "stl", "larger and turned", "smaller, baked and shuffled", "far"],
)
def test_vertices_and_stated_joints_are_where_the_change_puts_them(change, precision, tmp_path):
    made = copy_of(SCREW, tmp_path, change)
    original, copied = form.load(SCREW), form.load(made.path)
    names = {part.name: part.name for part in original.parts}
    theirs = corners(copied, made.originals)
    for name, world in corners(original, names).items():
        assert same_shape(world @ change.X[:3, :3].T + change.X[:3, 3], theirs[name], precision)
    (stated,), (moved,) = original.function.joints, copied.function.joints
    assert [made.originals[name] for name in moved.between] == list(stated.between)
    assert moved.axis == pytest.approx(change.rotation @ stated.axis)
    assert moved.point == pytest.approx(change.X[:3, :3] @ stated.point + change.X[:3, 3], rel=1e-12)
    assert moved.pitch == pytest.approx(change.scale * stated.pitch)
    assert copied.ground is not None
    assert made.originals[copied.ground] == original.ground


def test_noise_moves_each_vertex_by_about_what_is_asked(tmp_path):
    quiet = form.load(copy_of(COLLARS, tmp_path / "quiet", Change()).path)
    noisy = form.load(copy_of(COLLARS, tmp_path / "noisy", Change(noise=2e-6, seed=5)).path)
    for before, after in zip(quiet.parts, noisy.parts, strict=True):
        assert np.std(after.mesh.vertices - before.mesh.vertices) == pytest.approx(2e-6, rel=0.2)
        assert np.array_equal(before.mesh.faces, after.mesh.faces)


def test_shuffled_names_sort_the_other_way(tmp_path):
    made = copy_of(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml", tmp_path, Change(shuffled=True))
    parts = [part.name for part in form.load(made.path).parts]
    assert [made.originals[name] for name in parts] == sorted((made.originals[name] for name in parts), reverse=True)


def test_answers_tell_a_joint_that_is_lost(tmp_path):
    """The oracle of the metamorphic tests sees what it is for."""
    whole = derived(copy_of(COLLARS, tmp_path / "whole", Change()).path)
    names = {part.name: part.name for part in whole.assembly.parts}
    broken = derived(copy_of(COLLARS, tmp_path / "torn", Change(noise=5e-4)).path)
    assert answers(whole, names)["joints"] != answers(broken, names)["joints"]


def test_axes_are_compared_where_the_change_puts_them(tmp_path):
    change = Change(rotation=turned(7), offset=(0.1, 0.2, 0.3))
    whole = derived(copy_of(COLLARS, tmp_path / "whole", Change()).path)
    made = copy_of(COLLARS, tmp_path / "moved", change)
    moved = derived(made.path)
    ((tilt, far),) = axis_errors(whole, moved, made, change).values()
    assert tilt < 1e-12 and far < 1e-10
    ((tilt, far),) = axis_errors(whole, moved, made, Change(rotation=turned(7), offset=(0.1, 0.2, 0.31))).values()
    assert tilt < 1e-12 and far > 1e-3
