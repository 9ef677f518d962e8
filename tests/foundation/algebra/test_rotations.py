"""Rotations in stacks against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from kinform.foundation.algebra import rotations
from kinform.foundation.meshes import near_points


@pytest.fixture(scope="module")
def vectors():
    """(n, 3) rad: of less than half a turn, down to 1e-12."""
    random = np.random.default_rng(5)
    v = random.normal(size=(4000, 3)) * 10.0 ** random.uniform(-12.0, 0.4, size=(4000, 1))
    return v[np.linalg.norm(v, axis=1) < 3.14]


def test_quaternions_of_any_length(vectors):
    random = np.random.default_rng(6)
    wxyz = random.normal(size=(40, 50, 4))
    expected = Rotation.from_quat(wxyz.reshape(-1, 4), scalar_first=True).as_matrix()
    found = rotations.matrices(wxyz)
    assert np.abs(found.reshape(-1, 3, 3) - expected).max() < 3e-15
    assert np.abs(rotations.matrices(rotations.quaternions(found)) - found).max() < 3e-15


def test_vectors_there_and_back(vectors):
    R = rotations.turned(vectors)
    assert np.abs(R - Rotation.from_rotvec(vectors).as_matrix()).max() < 3e-15
    back = rotations.rotation_vectors(R)
    assert (np.linalg.norm(back - vectors, axis=1) < 1e-14 * np.linalg.norm(vectors, axis=1)).all()


def test_half_a_turn_about_each_axis():
    halves = np.stack([np.diag(np.where(np.arange(3) == k, 1.0, -1.0)) for k in range(3)])
    assert np.array_equal(np.abs(rotations.rotation_vectors(halves)), np.pi * np.eye(3))


def test_nearest_is_the_same_measured_and_by_a_tree(monkeypatch):
    random = np.random.default_rng(7)
    points, places = random.normal(size=(300, 3)), random.normal(size=(900, 3))
    expected = cKDTree(points).query(places)[0]
    assert np.array_equal(near_points.Nearest(points).away(places), expected)
    monkeypatch.setattr(near_points, "MEASURED", 0)
    assert np.array_equal(near_points.Nearest(points).away(places), expected)
    assert near_points.Nearest(points).away(places[:0]).shape == (0,)
