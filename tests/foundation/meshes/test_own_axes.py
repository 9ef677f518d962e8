"""Axes of a mesh turn with it, whatever its shape."""

import numpy as np
import pytest
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from support.solids import ball, box, rod

from kinform.foundation.meshes.own_axes import own_axes

SHAPES = {
    "box": box(-1, 2, -3, 4, 0, 9),
    "cube": box(0, 1, 0, 1, 0, 1),
    "rod": rod(3.0, 0.0, 20.0, 36),
    "ball": ball(5.0, 24),
    "plate": box(-9, 9, -7, 7, 0, 1) - rod(2.0, -1, 2, 24).translate((3, 1, 0)),
    "fine": Manifold.sphere(4.0, 120),
}


def arrays(solid):
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties, float)[:, :3] * 1e-3, np.asarray(mesh.tri_verts, np.int64)


@pytest.mark.parametrize("name", SHAPES)
def test_axes_turn_with_the_mesh(name):
    vertices, faces = arrays(SHAPES[name])
    axes = own_axes(vertices, faces)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    for seed in range(10):
        turn = Rotation.random(random_state=seed).as_matrix()
        moved = own_axes(vertices @ turn.T + [0.3, -0.2, 0.1], faces)
        np.testing.assert_allclose(moved, axes @ turn.T, atol=1e-7)


def test_axes_of_a_part_drawn_along_those_of_its_file_are_these_to_the_last_bit():
    axes = own_axes(*arrays(SHAPES["plate"]))
    assert np.array_equal(axes, np.rint(axes))


@pytest.mark.parametrize("count", [0, 1])
def test_a_mesh_of_a_facet_or_none_has_axes_too(count):
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    axes = own_axes(vertices, np.array([[0, 1, 2]])[:count])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
