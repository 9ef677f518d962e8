"""Near points are those that a tree of scipy finds."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from kinform.foundation.meshes.near_points import Near


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
