"""What parts enclose together: volume, centroid and second moments of two cubes, by Steiner's theorem."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.solids import block

from kinform.api import Assembly
from kinform.mass.shapes import solid_of


def facets(size, inward=False):
    mesh = block(size, size, size).to_mesh64()
    faces = np.asarray(mesh.tri_verts, dtype=np.int64)
    return np.asarray(mesh.vert_properties)[:, :3], faces[:, ::-1] if inward else faces


def at(x, y, z, quarter=False):
    pose = np.eye(4)
    if quarter:
        pose[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    pose[:3, 3] = (x, y, z)
    return pose


@pytest.mark.parametrize("inward", [False, True])
def test_two_cubes_have_the_moments_of_steiner(inward):
    """Also where one of them is inside out: it counts as what it encloses."""
    meshes = {"a": (facets(1.0), at(0, 0, 0)), "b": (facets(2.0, inward), at(3, 1, 0, quarter=True))}
    found = solid_of(Assembly.from_meshes(meshes, units="m").parts)
    volumes, centres = np.array([1.0, 8.0]), np.array([[0.0, 0, 0], [3, 1, 0]])
    centroid = volumes @ centres / 9.0
    expected = np.zeros((3, 3))
    for volume, size, centre in zip(volumes, (1.0, 2.0), centres, strict=True):
        r = centre - centroid
        expected += volume * (size**2 / 6.0 * np.eye(3) + r @ r * np.eye(3) - np.outer(r, r))
    assert found.volume == pytest.approx(9.0)
    np.testing.assert_allclose(found.centroid, centroid, atol=1e-12)
    np.testing.assert_allclose(found.inertia, expected, atol=1e-9)
    assert found.open_parts == ()


def test_an_open_part_is_named_and_left_out():
    vertices, faces = facets(1.0)
    parts = Assembly.from_meshes({"a": (vertices, faces), "b": (vertices, faces[:-1])}, units="m").parts
    found = solid_of(parts)
    assert (found.volume, found.open_parts) == (pytest.approx(1.0), ("b",))
    assert solid_of([part for part in parts if part.name == "b"]) is None
