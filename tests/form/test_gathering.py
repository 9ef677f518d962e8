"""What hangs together and what lies near: the same as scipy says, however many there are."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, cKDTree

from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.near_points import Near
from kinform.kinematics.joints.pair.extremes import hull


def _links(kind: str, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    if kind == "random":
        return rng.integers(0, count, count // 2), rng.integers(0, count, count // 2)
    if kind == "path":
        order = rng.permutation(count)
        keep = rng.random(count - 1) < 0.99
        return order[:-1][keep], order[1:][keep]
    hub = rng.integers(0, count, 5)
    return rng.choice(hub, count), rng.integers(0, count, count)


@pytest.mark.parametrize("kind", ["random", "path", "hubs"])
@pytest.mark.parametrize("count", [1, 2, 50, 3000])
def test_components_are_those_of_scipy_numbered_by_their_first_node(kind: str, count: int) -> None:
    a, b = _links(kind, count, np.random.default_rng(count))
    expected = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(count, count)), directed=False)[1]
    found = components(a, b, count)
    assert np.array_equal(found, expected)
    first = [int(np.flatnonzero(found == k)[0]) for k in range(found.max() + 1)]
    assert first == sorted(first)


def test_without_links_every_node_is_alone() -> None:
    none = np.zeros(0, dtype=np.int64)
    assert components(none, none, 4).tolist() == [0, 1, 2, 3]
    assert components(none, none, 0).tolist() == []


@pytest.mark.parametrize(("count", "distance"), [(0, 0.1), (1, 0.1), (400, 0.05), (4000, 1e-3), (4000, 0.06)])
@pytest.mark.parametrize("width", [2, 3, 4])
def test_near_points_are_those_of_a_tree(count: int, distance: float, width: int) -> None:
    rng = np.random.default_rng(count + width)
    points = rng.random((count, width))
    points = np.concatenate([points, points[: count // 3] + 0.3 * distance * rng.standard_normal((count // 3, width))])
    near = Near(points, distance)
    tree = cKDTree(points) if len(points) else None
    expected = sorted(tree.query_pairs(distance)) if tree is not None else []
    assert list(map(tuple, near.pairs.tolist())) == expected
    if tree is not None:
        some = np.arange(0, len(points), 7)
        assert np.array_equal(near.about(some), tree.query_ball_point(points[some], distance, return_length=True))


@pytest.mark.parametrize("shape", ["cloud", "grid", "ring", "sliver"])
@pytest.mark.parametrize("count", [3, 30, 900])
def test_the_corners_of_a_hull_are_those_of_qhull(shape: str, count: int) -> None:
    rng = np.random.default_rng(count)
    turn = 2 * np.pi * np.round(64 * rng.random(count)) / 64
    flat = {
        "cloud": rng.random((count, 2)),
        "grid": np.stack(np.divmod(np.arange(count), max(count // 20, 2)), axis=1).astype(float),
        "ring": np.stack([np.cos(turn), np.sin(turn)], axis=1) * rng.choice([0.5, 1.0], count)[:, None],
        "sliver": np.stack([rng.random(count), 1e-4 * rng.random(count)], axis=1),
    }[shape]
    points = np.column_stack([flat, np.full(count, 0.3)])
    chosen = flat[hull(points, np.array([0.0, 0.0, 1.0]))]
    corners = flat[ConvexHull(flat, qhull_options="QJ Pp" if shape == "sliver" else "").vertices]
    size = np.ptp(flat, axis=0).max()
    # every corner of either is within rounding of the outline of the other: equal areas, and none outside
    assert ConvexHull(chosen).volume == pytest.approx(ConvexHull(corners).volume, rel=1e-5)
    equations = ConvexHull(chosen).equations
    assert (flat @ equations[:, :2].T + equations[:, 2]).max() < 1e-5 * size
