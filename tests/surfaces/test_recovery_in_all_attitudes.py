"""What is recovered of a mesh does not depend on how its file is turned: neither are tolerances shares of its box."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.diagonal import first
from support.meshes import kinds, mesh_of
from support.solids import block, centred_rod

from kinform import surfaces
from kinform.model.tolerances import Tolerances
from kinform.surfaces.recovery import _Start

ATTITUDES = {
    "as it is": np.eye(3),
    "on its edge": Rotation.from_euler("z", 45, degrees=True).as_matrix(),
    "on its corner": Rotation.align_vectors([[0, 0, 1]], [[1, 1, 1]])[0].as_matrix(),
    **{f"turned {seed}": Rotation.random(random_state=seed).as_matrix() for seed in range(4)},
}


def uneven(off, turn):
    """A square plate with a bore, every second generator of which lies further out, by a share of the plate's span. At
    4e-5 half of that is the tolerance of the fit, and rounding decides."""
    mesh = (block(0.1, 0.1, 0.005) - centred_rod(0.02, 0.01, 24)).to_mesh64()
    vertices = np.array(mesh.vert_properties[:, :3])
    angle = np.arctan2(vertices[:, 1], vertices[:, 0])
    radius = np.hypot(vertices[:, 0], vertices[:, 1])
    odd = (radius < 0.03) & (np.rint(angle / (2 * np.pi / 24)).astype(int) % 2 == 1)
    span = np.linalg.norm([0.1, 0.1, 0.005])
    vertices[odd, :2] *= 1.0 + off * span / radius[odd, None]
    return mesh_of(vertices @ turn.T, mesh.tri_verts)


@pytest.mark.parametrize("off", first(2, [3.8e-5, 4.2e-5, 1e-5, 8e-5, 2e-5, 3e-5, 5e-5, 6e-5]))
def test_a_bore_is_one_in_all_attitudes_or_in_none(off):
    found = [kinds(surfaces.recover(uneven(off, turn), Tolerances())) for turn in ATTITUDES.values()]
    whole = [one == {"plane": 6, "cylinder": 1} for one in found]
    assert len(set(whole)) == 1


def test_tolerances_are_those_of_the_shape():
    scales = [_Start.of(uneven(0.0, turn), Tolerances()) for turn in ATTITUDES.values()]
    assert np.ptp([start.span for start in scales]) < 1e-12
    assert np.ptp([start.scale.fit for start in scales]) < 1e-12
