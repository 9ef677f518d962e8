"""What is known of an extrusion whose normals stand exactly across it hangs on its rounding, and on no last bits."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation
from support.diagonal import first
from support.meshes import mesh_of

from kinform import surfaces
from kinform.model.tolerances import Tolerances


def cam():
    """Vertices and facets of a smooth outline of three lobes, extruded."""
    t = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    radius = 10.0 * (1.0 + 0.06 * np.cos(3.0 * t))
    outline = CrossSection([np.stack([radius * np.cos(t), radius * np.sin(t)], axis=1)])
    mesh = Manifold.extrude(outline, 6.0).to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)


def known_of(vertices, faces):
    every = surfaces.recover(mesh_of(vertices, faces), Tolerances()).surfaces
    (found,) = [surface for surface in every if surface.kind == "extrusion"]
    return np.array([found.axis_uncertainty, found.point_uncertainty])


@pytest.mark.parametrize("seed", first(3, range(12)))
def test_which_coordinate_is_called_x_changes_nothing(seed):
    vertices, faces = cam()
    vertices = vertices @ Rotation.random(random_state=seed).as_matrix().T
    assert known_of(np.roll(vertices, 1, axis=1), faces) == pytest.approx(known_of(vertices, faces), rel=1e-6)
