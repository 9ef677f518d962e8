"""Tori: analytic rings and fillets, and what must not be taken for one."""

from __future__ import annotations

import manifold3d as m3
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.meshes import kinds, mesh_of, of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover


def ring(major, minor, around, rings, start=0.0, sweep=2 * np.pi):
    """Vertices and facets of a piece of a torus about z, open where the sweep is less than a turn."""
    whole = sweep >= 2 * np.pi - 1e-9
    u = np.linspace(0, 2 * np.pi, around, endpoint=False)
    v = start + np.linspace(0, sweep, rings, endpoint=not whole)
    rho, z = major + minor * np.cos(v), minor * np.sin(v)
    points = np.stack(
        [np.outer(np.cos(u), rho), np.outer(np.sin(u), rho), np.broadcast_to(z, (around, rings))], axis=2
    ).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(rings if whole else rings - 1), indexing="ij")
    a, b = i * rings + j, (i + 1) % around * rings + j
    c, d = (i + 1) % around * rings + (j + 1) % rings, i * rings + (j + 1) % rings
    return points, np.concatenate(
        [np.stack([a, b, c], axis=2).reshape(-1, 3), np.stack([a, c, d], axis=2).reshape(-1, 3)]
    )


def tori(found):
    return [s for s in found.surfaces if s.kind == "torus"]


@pytest.mark.parametrize(
    ("around", "rings", "start", "sweep"),
    [
        (32, 16, 0, 2 * np.pi),
        (64, 24, 0, 2 * np.pi),
        (32, 5, 0, np.pi / 2),
        (48, 9, np.pi, np.pi / 2),
        (32, 6, np.pi, np.pi / 2),
    ],
)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_ring_or_a_fillet_is_a_torus(around, rings, start, sweep, seed):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    pose[:3, 3] = [0.01, 0.02, 0.03]
    points, faces = ring(0.03, 0.01, around, rings, start, sweep)
    (torus,) = tori(recover(mesh_of(points, faces, pose=pose), Tolerances()))
    assert torus.radius == pytest.approx(0.03, rel=1e-6)
    assert torus.minor_radius == pytest.approx(0.01, rel=1e-6)
    assert np.linalg.norm(np.cross(torus.axis, pose[:3, 2])) < 1e-7
    assert np.linalg.norm(torus.point - pose[:3, 3]) < 1e-9
    assert torus.side == 1
    assert torus.sweep == pytest.approx(2 * np.pi)


def test_a_groove_is_concave():
    outline = 0.004 * np.stack([np.cos(a := np.linspace(0, 2 * np.pi, 24, endpoint=False)), np.sin(a)], axis=1)
    tube = m3.Manifold.revolve(m3.CrossSection([outline + [0.03, 0.0]]), 64)
    (groove,) = tori(recover(of_manifold(centred_rod(0.03, 0.03, 64) - tube), Tolerances()))
    assert groove.side == -1
    assert groove.radius == pytest.approx(0.03, rel=1e-5)
    assert groove.minor_radius == pytest.approx(0.004, rel=1e-5)


def test_single_precision_stays_within_the_stated_uncertainty():
    rng = np.random.default_rng(5)
    for _ in range(8):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        pose[:3, 3] = rng.normal(size=3)
        points, faces = ring(0.03, 0.01, 40, 14)
        mesh = mesh_of(points, faces, pose=pose, rounding=True)
        (torus,) = tori(recover(mesh, Tolerances()))
        assert np.linalg.norm(np.cross(torus.axis, pose[:3, 2])) <= torus.axis_uncertainty
        aside = torus.point + mesh.origin - pose[:3, 3]
        assert np.linalg.norm(aside - (aside @ pose[:3, 2]) * pose[:3, 2]) <= torus.point_uncertainty


def test_simpler_kinds_win():
    for solid in (m3.Manifold.sphere(0.01, 48), centred_rod(0.01, 0.03, 48), block(0.03, 0.02, 0.01)):
        assert not tori(recover(of_manifold(solid), Tolerances()))


def test_two_cones_and_a_cylinder_are_no_torus():
    outline = [(0.0, -0.02), (0.009, -0.02), (0.01, -0.017), (0.01, 0.017), (0.009, 0.02), (0.0, 0.02)]
    spool = m3.Manifold.revolve(m3.CrossSection([outline]), 48)
    found = recover(of_manifold(spool), Tolerances())
    assert kinds(found) == {"plane": 2, "cylinder": 1, "cone": 2}
