"""Facets that face each other, against FCL and against lengths that are known."""

from __future__ import annotations

import fcl
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinform.foundation.meshes.facing_facets import facing, triangles_apart
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model


def square(height, side=2.0, *, up=True):
    """(2, 3, 3): two facets of a square about the z axis, that face up or down."""
    a, b, c, d = (np.array([x, y, height]) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    corners = np.array([[a, b, c], [a, c, d]]) * [0.5 * side, 0.5 * side, 1.0]
    return corners if up else corners[:, ::-1]


def test_distances_of_triangles_are_those_of_fcl():
    rng = np.random.default_rng(3)
    first, second = rng.normal(size=(2, 400, 3, 3))
    second += 4.0 * rng.normal(size=(400, 1, 3))
    face = np.array([[0, 1, 2]])
    exact = [
        fcl_distance(*(fcl.CollisionObject(fcl_model(corners, face)) for corners in pair))
        for pair in zip(first, second, strict=True)
    ]
    apart = np.array(exact) > 0.0
    assert apart.sum() > 200
    assert triangles_apart(first, second)[apart] == pytest.approx(np.array(exact)[apart], abs=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_squares_face_each_other_within_their_distance_at_any_pose(seed):
    rng = np.random.default_rng(seed)
    turn, place = Rotation.random(random_state=seed).as_matrix(), 50.0 * rng.normal(size=3)
    low, high = square(0.0) @ turn.T + place, square(0.3, 5.0, up=False) @ turn.T + place
    found = facing(low, high, 0.31, -0.93)
    assert found.gaps == pytest.approx(np.full(4, 0.3))
    assert found.normals == pytest.approx(np.tile(turn[:, 2], (4, 1)))
    assert found.others == pytest.approx(np.tile(-turn[:, 2], (4, 1)))
    assert sorted(found.facets.tolist()) == [0, 0, 1, 1]
    assert not len(facing(low, high, 0.29, -0.93).gaps)


def test_what_is_behind_or_turned_away_faces_nothing():
    low = square(0.0)
    assert not len(facing(low, square(0.3), 1.0, -0.93).gaps)
    assert not len(facing(low, square(-0.3, up=False), 1.0, -0.93).gaps)
    for lean, faces in ((20.0, True), (23.0, False)):
        turned = square(0.0, up=False) @ Rotation.from_euler("x", lean, degrees=True).as_matrix().T + [0, 0, 0.8]
        assert bool(len(facing(low, turned, 1.0, -0.93).gaps)) == faces
    assert not len(facing(low, np.zeros((0, 3, 3)), 1.0, -0.93).gaps)
    assert not len(facing(low, square(0.3, up=False) + [9, 0, 0], 1.0, -0.93).gaps)


def test_which_facets_it_is_and_how_far_does_not_hang_on_how_many_there_are():
    """Of many strips, those over a block face it."""
    strips = np.concatenate([square(0.0, 0.02) + [0.03 * k, 0, 0] for k in range(-400, 401)])
    found = facing(strips, square(0.05, 1.0, up=False), 0.06, -0.93)
    over = {2 * (k + 400) + j for k in range(-400, 401) for j in range(2) if abs(0.03 * k) - 0.01 < 0.5}
    assert over <= set(found.facets.tolist())
    near = {2 * (k + 400) + j for k in range(-400, 401) for j in range(2) if abs(0.03 * k) - 0.01 < 0.54}
    assert set(found.facets.tolist()) <= near
    assert found.gaps.min() == pytest.approx(0.05)
