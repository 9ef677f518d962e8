"""Assemblies of meshes that a program holds, in place of files."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from tests.support.diagonal import first
from tests.support.places import FIXTURES
from tests.support.scenes import assert_same_joints, scene_of

import kinform
from kinform import form
from kinform.errors import InputError

COLLARS = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"
BOX = trimesh.creation.box((1, 2, 3))


class Vector:
    """As a CAD kernel gives its points."""

    def __init__(self, *xyz):
        self.xyz = xyz

    def __iter__(self):
        return iter(self.xyz)


class Box:
    def __init__(self, diagonal):
        self.diagonal = diagonal


class Solid:
    """As build123d's: vertices and faces are methods there."""

    def __init__(self, mesh):
        self.mesh, self.asked = mesh, []

    def vertices(self):
        return []

    def faces(self):
        return []

    def bounding_box(self):
        return Box(float(np.linalg.norm(self.mesh.extents)))

    def tessellate(self, tolerance, angular_tolerance):
        self.asked.append((tolerance, angular_tolerance))
        return [Vector(*v) for v in self.mesh.vertices.tolist()], [tuple(f) for f in self.mesh.faces.tolist()]


def parts(factor=1e3):
    """Of the fixture, in mm: meshes and poses."""
    out = {}
    for part in form.load(COLLARS).parts:
        X = part.X_WP.copy()
        X[:3, 3] *= factor
        out[part.name] = trimesh.Trimesh(part.mesh.vertices * factor, part.mesh.faces, process=False), X
    return out


def ways():
    """The same assembly, in every way in which a program may hold it."""
    posed = parts()
    yield "meshes", posed
    yield "arrays", {name: ((mesh.vertices, mesh.faces), X) for name, (mesh, X) in posed.items()}
    yield (
        "lists",
        {name: ((mesh.vertices.tolist(), mesh.faces.tolist()), X.tolist()) for name, (mesh, X) in posed.items()},
    )
    yield "solids", {name: (Solid(mesh), X) for name, (mesh, X) in posed.items()}
    yield "moved", {name: mesh.copy().apply_transform(X) for name, (mesh, X) in posed.items()}
    yield "scene", scene_of(form.load(COLLARS), factor=1e3)


@pytest.fixture(scope="module")
def of_the_files():
    return kinform.run(COLLARS)


@pytest.mark.parametrize(
    "way",
    first(2, ["solids", "scene", "meshes", "arrays", "lists", "moved"]),
)
def test_what_a_program_holds_has_the_joints_of_the_files(way, of_the_files, tmp_path):
    results = kinform.run(dict(ways())[way], tmp_path / "r.h5", units="mm")
    assert [part.name for part in results.assembly.parts] == ["block", "shaft"]
    ours, theirs = results.joints["block~shaft"], of_the_files.joints["block~shaft"]
    assert (ours.type, ours.status) == (theirs.type, theirs.status) == ("revolute", "determined")
    assert abs(ours.axis @ theirs.axis) == pytest.approx(1.0, abs=1e-9)
    assert kinform.open(tmp_path / "r.h5").joints["block~shaft"].type == "revolute"


def test_an_assembly_is_run_like_its_meshes(of_the_files):
    assembly = kinform.Assembly.from_meshes(parts(), units="mm", name="pair", density=7850.0)
    results = kinform.run(assembly)
    assert results.assembly.name == "pair" and results.assembly.units == "mm"
    assert results.mass["block"].mass == pytest.approx(of_the_files.mass["block"].mass * 7850 / 2700, rel=1e-6)
    assert_same_joints(results, kinform.run(parts(), units="mm"))


def test_nodes_of_a_scene_are_sub_assemblies_and_its_own_unit_holds():
    scene = scene_of(form.load(COLLARS), {"shaft": "inner"})
    scene.units = "m"
    assembly = kinform.Assembly.from_meshes(scene)
    assert [part.name for part in assembly.parts] == ["block", "inner/shaft"]
    assert [sub.name for sub in assembly.subassemblies] == ["inner"]
    for part in form.load(COLLARS).parts:
        there = next(p for p in assembly.parts if p.name.endswith(part.name))
        assert np.allclose(there.X_WP, part.X_WP, atol=1e-12)


def test_a_solid_is_tessellated_as_finely_as_is_stated():
    solid = Solid(BOX)
    kinform.Assembly.from_meshes({"a": solid}, units="mm", deviation=0.25)
    assert solid.asked == [(0.25, 0.1)]
    again = Solid(BOX)
    kinform.Assembly.from_meshes({"a": again}, units="mm")
    assert again.asked == [(pytest.approx(1e-3 * np.sqrt(14)), 0.1)]


def test_names_with_a_slash_and_mirrored_poses_are_as_in_files():
    mirror = np.diag([1.0, 1.0, -1.0, 1.0])
    assembly = kinform.Assembly.from_meshes({"a/b": BOX, "a_b": (BOX, mirror)}, units="m")
    assert [part.name for part in assembly.parts] == ["a_b", "a_b#2"]
    assert assembly.part("a_b#2").mesh.health.volume > 0.0


SHEAR = np.array([[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
BAD = {
    "no unit": ({"a": BOX}, {}, ""),
    "another unit": ({"a": BOX}, {"units": "ell"}, "ell"),
    "nothing": ({}, {"units": "mm"}, ""),
    "a list": ([BOX], {"units": "mm"}, "list"),
    "a number": ({"a": 3}, {"units": "mm"}, "a"),
    "a pose": ({"a": (BOX, np.eye(3))}, {"units": "mm"}, "a"),
    "a shear": ({"a": (BOX, SHEAR)}, {"units": "mm"}, "a"),
    "corner": ({"a": (BOX.vertices, BOX.faces + 1)}, {"units": "mm"}, "a"),
    "nan": ({"a": (BOX.vertices * np.nan, BOX.faces)}, {"units": "mm"}, "a"),
    "quads": ({"a": (BOX.vertices, [[0, 1, 2, 3]])}, {"units": "mm"}, "a"),
    "name": ({3: BOX}, {"units": "mm"}, "3"),
}  # fmt: skip


@pytest.mark.parametrize(("meshes", "settings", "named"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_one_problem_with_a_remedy(meshes, settings, named):
    with pytest.raises(InputError) as caught:
        kinform.Assembly.from_meshes(meshes, **settings)
    (problem,) = caught.value.problems
    assert named in problem.message and problem.remedy
