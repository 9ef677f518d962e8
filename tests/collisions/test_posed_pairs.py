"""Boxes of all parts of two motions at once, against one pair after the other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinform.collisions.pair import posed_pairs
from kinform.foundation.meshes.boxes import box_corners


def boxes(rng, count):
    low = rng.uniform(-1.0, 1.0, (count, 3))
    return np.array([box_corners(a, a + rng.uniform(0.01, 0.4, 3), np.eye(4)) for a in low])


@pytest.mark.parametrize("seed", range(8))
def test_boxes_that_meet_on_the_way_are_those_of_each_pair(seed):
    rng = np.random.default_rng(seed)
    axis, count = rng.normal(size=3), 25
    relative = np.tile(np.eye(4), (count, 1, 1))
    turns = np.linspace(0.0, rng.uniform(0.1, 1.5), count)
    relative[:, :3, :3] = Rotation.from_rotvec(turns[:, None] * axis / np.linalg.norm(axis)).as_matrix()
    relative[:, :3, 3] = turns[:, None] * rng.normal(size=3)
    fixed, moved = boxes(rng, 30), boxes(rng, 25)
    found = {(int(row), column) for rows, column in posed_pairs._meeting(relative, fixed, moved, 1e-12) for row in rows}
    each = {
        (row, column)
        for row, one in enumerate(fixed)
        for column, other in enumerate(moved)
        if posed_pairs._steps(relative, one, other) is not None
    }
    assert found == each
    assert 0 < len(each) < len(fixed) * len(moved)
