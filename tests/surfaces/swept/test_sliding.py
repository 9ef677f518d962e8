"""General revolutions, extrusions and threads, and what is none of them."""

from __future__ import annotations

import manifold3d as m3
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.diagonal import diagonal
from support.meshes import kinds, mesh_of, of_manifold

from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover


def posed(seed):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    pose[:3, 3] = 0.01 * np.arange(1, 4)
    return pose


def of_kind(found, kind):
    return [s for s in found.surfaces if s.kind == kind]


def off(surface, pose):
    """Angle and distance of an axis from z through the origin of the pose."""
    aside = surface.point - pose[:3, 3]
    return (
        np.linalg.norm(np.cross(surface.axis, pose[:3, 2])),
        np.linalg.norm(aside - (aside @ pose[:3, 2]) * pose[:3, 2]),
    )


def thread(pitch, root, crest, turns, segments, hand=1):
    """The open surface of a thread: root, flank, crest, flank, root, swept along a helix."""
    profile = [(root, -0.5), (root, -0.3), (crest, -0.1), (crest, 0.1), (root, 0.3), (root, 0.5)]
    angle = hand * 2 * np.pi * np.arange(turns * segments + 1) / segments
    rows = [
        np.stack([r * np.cos(angle), r * np.sin(angle), pitch * (np.abs(angle) / (2 * np.pi) + z)], axis=1)
        for r, z in profile
    ]
    vertices = np.stack(rows, axis=1).reshape(-1, 3)
    k = len(profile)
    i, j = np.meshgrid(np.arange(len(angle) - 1), np.arange(k - 1), indexing="ij")
    a, b, c, d = i * k + j, (i + 1) * k + j, (i + 1) * k + j + 1, i * k + j + 1
    faces = np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3), np.stack([a, c, d], axis=2).reshape(-1, 3)])
    return vertices, faces


@diagonal(2, segments=[24, 36, 64], hand=[1, -1])
def test_a_thread_is_a_helicoid_with_its_pitch_and_hand(segments, hand):
    pose = posed(segments)
    (screw,) = of_kind(
        recover(mesh_of(*thread(0.001, 0.004, 0.005, 4, segments, hand), pose=pose), Tolerances()), "helicoid"
    )
    sense = np.sign(screw.axis @ pose[:3, 2])
    assert sense != 0
    assert screw.pitch == pytest.approx(hand * 0.001, rel=1e-3)
    angle, distance = off(screw, pose)
    assert angle < 1e-4 and angle <= screw.axis_uncertainty
    assert distance < 1e-7 and distance <= screw.point_uncertainty


@pytest.mark.parametrize("seed", [1, 2])
def test_a_vase_is_a_revolution(seed):
    z = np.linspace(-0.01, 0.01, 24)
    rho = 0.012 + 0.003 * np.sin(z / 0.005) + 20 * z**2
    outline = np.concatenate([[[0, -0.01]], np.stack([rho, z], axis=1), [[0, 0.01]]])
    pose = posed(seed)
    found = recover(of_manifold(m3.Manifold.revolve(m3.CrossSection([outline]), 64), pose=pose), Tolerances())
    turned = of_kind(found, "revolution")
    assert turned
    for surface in turned:
        angle, distance = off(surface, pose)
        assert angle <= surface.axis_uncertainty and angle < 1e-6
        assert distance <= surface.point_uncertainty and distance < 1e-8


@pytest.mark.parametrize("seed", [1, 2])
def test_a_cam_is_an_extrusion(seed):
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)  # finer, short arcs pass for cylinders on some processors
    outline = np.stack([15 * np.cos(angle) + 2 * np.cos(3 * angle), 10 * np.sin(angle) + np.sin(2 * angle)], axis=1)
    pose = posed(seed)
    solid = m3.Manifold.extrude(m3.CrossSection([1e-3 * outline]), 0.013)
    found = recover(of_manifold(solid, pose=pose), Tolerances())
    assert kinds(found) == {"extrusion": 1, "plane": 2}
    (cam,) = of_kind(found, "extrusion")
    assert np.linalg.norm(np.cross(cam.axis, pose[:3, 2])) <= cam.axis_uncertainty
    assert cam.axis_uncertainty < 1e-4
    assert cam.extent[1] - cam.extent[0] == pytest.approx(0.013, rel=1e-6)


def test_a_dented_ball_is_none_of_them():
    solid = m3.Manifold.sphere(0.01, 48).warp_batch(
        lambda p: p * (1 + 0.1 * np.sin(300 * p[:, :1]) * np.cos(250 * p[:, 1:2] + 200 * p[:, 2:]))
    )
    found = recover(of_manifold(solid), Tolerances())
    assert not {"revolution", "extrusion", "helicoid", "torus"} & set(kinds(found))
