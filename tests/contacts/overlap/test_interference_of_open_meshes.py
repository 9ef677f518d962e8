"""Meshes with gaps, or with facets twice: what overlaps is told, and what does not is not."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from generators.solids import bore, box, cut, join, rod
from support.diagonal import diagonal
from support.manifests import manifest

from kinform import stages
from kinform.foundation.meshes.ray_parity import once, winding

BLOCK = cut(box(-20, 20, -20, 20, 0, 30), bore(5.05, 0, 30, 24))
SHAFT = join(rod(5.0, -0.05, 30.05, 16), rod(8.0, -5, -0.05, 16), rod(8.0, 30.05, 35, 16))


class Facets:
    """The facets of a solid that are kept, or taken twice."""

    def __init__(self, solid, chosen):
        self._solid, self._chosen = solid, chosen

    def arrays(self):
        vertices, faces = self._solid.arrays()
        return vertices, faces[self._chosen(len(faces))]


def some(seed):
    return lambda count: np.flatnonzero(np.random.default_rng(seed).random(count) > 0.08)


def twice(count):
    return np.concatenate([np.arange(count), np.arange(40)])


def overlaps(folder, block, shaft):
    design = stages.contacts(stages.import_(manifest(folder, {"block": block, "shaft": shaft}, "")))
    return [(item.parts, item.depth) for item in design.contacts.interferences]


@diagonal(chosen=[twice, some(0), some(1), some(3)], which=["block", "shaft"])
def test_parts_with_clearance_do_not_overlap_for_gaps_or_facets_that_are_there_twice(tmp_path, which, chosen):
    parts = {"block": BLOCK, "shaft": SHAFT}
    parts[which] = Facets(parts[which], chosen)
    assert overlaps(tmp_path, **parts) == []


@pytest.mark.parametrize("chosen", [twice, some(0), some(1)], ids=["twice", "some", "others"])
def test_parts_that_overlap_by_a_millimetre_do_so_with_gaps_too(tmp_path, chosen):
    ((parts, depth),) = overlaps(tmp_path, BLOCK, Facets(SHAFT.at(1.0, 0.0, 0.0), chosen))
    assert parts == ("block", "shaft") and 0.5e-3 < depth < 1.1e-3


def test_how_often_facets_go_round_a_point():
    cube = trimesh.creation.box((2.0, 2.0, 2.0))
    lidless = cube.copy()
    lidless.update_faces(cube.face_normals[:, 2] < 0.5)
    points = np.array([[0.0, 0, 0], [0.9, 0.9, 0.9], [1.1, 0, 0], [5, 5, 5]])
    assert winding(_Mesh(cube), points) == pytest.approx([1, 1, 0, 0], abs=1e-12)
    assert winding(_Mesh(lidless), points[:1]) == pytest.approx([5 / 6])
    assert winding(_Mesh(lidless), np.array([[0.0, 0.0, 1.0]])) == pytest.approx([0.5])
    faces = np.array([[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 1, 3]])
    assert once(faces).tolist() == [[0, 1, 2], [2, 1, 0], [0, 1, 3]]


class _Mesh:
    def __init__(self, mesh):
        self.vertices, self.faces = np.array(mesh.vertices), np.array(mesh.faces)
