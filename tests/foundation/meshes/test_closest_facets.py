"""Which facets points are nearest to, against trimesh asked of every facet."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.foundation.meshes import box_pairs
from kinform.foundation.meshes import closest_facets as closest
from kinform.foundation.meshes.closest_facets import closest_facets


def measured(points, corners):
    """(n, m) distances, by trimesh."""
    every = [trimesh.triangles.closest_point(corners, np.tile(point, (len(corners), 1))) - point for point in points]
    return np.linalg.norm(every, axis=2)


def scene(seed, count=60):
    """Points near facets of all shapes: wide ones, slivers, and some without area."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1.0, 1.0, (count, 1, 3)) + 0.3 * rng.normal(size=(count, 3, 3))
    corners[:5, 2] = corners[:5, 1] + 1e-9 * rng.normal(size=(5, 3))
    corners[5, 2] = corners[5, 1]
    corners[6] = corners[6, :1]
    return rng.uniform(-1.5, 1.5, (40, 3)), corners


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-6, 1e-3, 1.0, 1e4]))
def test_distances_are_those_that_trimesh_measures(seed, size):
    points, corners = scene(seed)
    # which takes what is small for nothing
    every = size * measured(points, corners)
    distance, facet = closest_facets(size * points, size * corners)
    assert distance == pytest.approx(every.min(axis=1), rel=1e-9, abs=1e-12 * size)
    assert every[np.arange(len(points)), facet] == pytest.approx(distance, rel=1e-8, abs=1e-12 * size)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_the_answer_of_a_point_does_not_hang_on_the_others(seed):
    points, corners = scene(seed)
    distance, facet = closest_facets(points, corners)
    some = np.random.default_rng(seed + 1).permutation(len(points))[:11]
    again, facet_again = closest_facets(points[some], corners)
    assert again.tobytes() == distance[some].tobytes()
    assert facet_again.tolist() == facet[some].tolist()


@pytest.mark.parametrize("compared", [0, 10**9])
def test_few_and_many_are_answered_alike(compared, monkeypatch):
    points, corners = scene(3, count=2000)
    before = closest_facets(points, corners)
    monkeypatch.setattr(box_pairs, "BOXES_MATRIX", compared)
    monkeypatch.setattr(closest, "CLOSEST_SOME", 1000)
    for sifted in (0, closest.CLOSEST_SIFTED, 10**9):
        monkeypatch.setattr(closest, "CLOSEST_SIFTED", sifted)
        after = closest_facets(points, corners)
        assert [found.tobytes() for found in after] == [found.tobytes() for found in before]


def test_of_facets_as_near_as_each_other_it_is_the_first():
    """On the diagonal of a square, and over an edge of a cube, however the facets are turned."""
    cube = trimesh.creation.box((2.0, 2.0, 2.0))
    rng = np.random.default_rng(1)
    for _ in range(20):
        X = trimesh.transformations.random_rotation_matrix(rng.random(3))
        corners = trimesh.transform_points(cube.triangles.reshape(-1, 3), X).reshape(-1, 3, 3)
        points = trimesh.transform_points([[1.5, 1.5, 0.3], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]], X)
        distance, facet = closest_facets(points, corners)
        assert distance == pytest.approx([np.sqrt(0.5), 0.0, 1.0], abs=1e-12)
        every = measured(points, corners)
        assert facet.tolist() == [int(np.flatnonzero(row < row.min() + 1e-9)[0]) for row in every]


def test_too_many_near_ones_are_left_to_a_tree(monkeypatch):
    points, corners = scene(0)
    assert len(closest_facets(points[:0], corners)[0]) == 0
    monkeypatch.setattr(closest, "CLOSEST_MOST", 3)
    assert closest_facets(points, corners) is None
