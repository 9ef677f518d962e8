"""Bodies that move as one, and boxes of all their parts, at once, against one pair after the other."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.diagonal import first

from kinform.collisions.pair import posed_pairs
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.meshes.boxes import box_corners


def boxes(rng, count, reach=1.0):
    low = rng.uniform(-reach, reach, (count, 3))
    return np.array([box_corners(a, a + rng.uniform(0.01, 0.4, 3), np.eye(4)) for a in low])


def turned(rng, count):
    """(count, 4, 4) displacements of a screw, from rest."""
    axis, turns = rng.normal(size=3), np.linspace(0.0, rng.uniform(0.1, 1.5), count)
    out = np.tile(np.eye(4), (count, 1, 1))
    out[:, :3, :3] = Rotation.from_rotvec(turns[:, None] * axis / np.linalg.norm(axis)).as_matrix()
    out[:, :3, 3] = turns[:, None] * rng.normal(size=3)
    return out


@pytest.mark.parametrize("seed", first(2, range(8)))
def test_boxes_that_meet_on_the_way_are_those_of_each_pair(seed):
    rng = np.random.default_rng(seed)
    relative = turned(rng, 25)
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


@pytest.mark.parametrize("seed", first(2, range(8)))
def test_parts_of_bodies_that_move_as_one_meet_those_that_each_of_them_meets(seed):
    rng = np.random.default_rng(seed)
    motions = [np.tile(np.eye(4), (15, 1, 1)), turned(rng, 15), turned(rng, 15)]
    displacements = np.stack([motions[k] for k in rng.permutation([0, 0, 0, 1, 1, 1, 2, 2])], axis=1)
    corners = {f"{body}{k}": box for body in range(8) for k, box in enumerate(boxes(rng, 4, 0.6))}
    parts = [[f"{body}{k}" for k in range(1 + body % 4)] for body in range(8)]
    shapes = SimpleNamespace(
        size=1.0,
        mesh=lambda name: SimpleNamespace(vertices=corners[name]),
        part=lambda _: SimpleNamespace(X_WP=np.eye(4)),
    )
    near = posed_pairs._Near(shapes, parts, displacements)
    count = 0
    for a, b in combinations(range(8), 2):
        relative = inverse(displacements[:, a]) @ displacements[:, b]
        still = np.array_equal(displacements[:, a], displacements[:, b])
        each = [
            (one, other)
            for one, other in product(parts[a], parts[b])
            if not still and posed_pairs._steps(relative, corners[one], corners[other]) is not None
        ]
        assert near.among(a, b) == each
        assert b in near.after(a) or not each
        assert (near.relative(a, b) is None) == still
        count += len(each)
    assert count > 10


def test_bodies_that_stay_away_from_each_other_are_not_looked_at():
    rng = np.random.default_rng(4)
    displacements = np.stack([turned(rng, 15) for _ in range(6)], axis=1)
    displacements[:, 3:, 0, 3] += 9.0
    corners = {f"{body}": box_corners(np.full(3, -0.5), np.full(3, 0.5), np.eye(4)) for body in range(6)}
    shapes = SimpleNamespace(
        size=1.0,
        mesh=lambda name: SimpleNamespace(vertices=corners[name]),
        part=lambda _: SimpleNamespace(X_WP=np.eye(4)),
    )
    near = posed_pairs._Near(shapes, [[f"{body}"] for body in range(6)], displacements)
    assert [near.after(body) for body in range(6)] == [[1, 2], [2], [], [4, 5], [5], []]


@pytest.mark.parametrize("seed", first(2, range(8)))
def test_a_box_that_stays_out_of_another_between_two_poses_is_in_it_nowhere_between(seed):
    rng = np.random.default_rng(seed)
    fine = turned(rng, 24 * 20 + 1)
    relative = fine[::20]
    share = rng.uniform(size=(150, 3))
    told = meets = 0
    for fixed, moved in zip(boxes(rng, 40, 0.3), boxes(rng, 40, 0.3), strict=True):
        low, high = moved.min(axis=0), moved.max(axis=0)
        points = np.concatenate([moved, low + share * (high - low)])
        way = np.einsum("tij,nj->tni", fine[:, :3, :3], points) + fine[:, None, :3, 3]
        within = ((way >= fixed.min(axis=0)) & (way <= fixed.max(axis=0))).all(axis=2).any(axis=1)
        inside = np.array([within[20 * n : 20 * n + 21].any() for n in range(24)])
        apart = posed_pairs._apart(*posed_pairs._moved(relative, moved), fixed)
        assert not (apart & inside).any()
        told, meets = told + apart.sum(), meets + inside.sum()
    assert told > 300
    assert meets > 10


@pytest.mark.parametrize("seed", first(8, range(20)))
def test_how_far_a_course_goes_is_told_as_by_halving(seed):
    rng = np.random.default_rng(seed)
    nodes = np.cumsum(rng.uniform(0.2, 1.5, 12))
    steps = rng.uniform(0.0, 0.3, 11) * (rng.uniform(size=11) > 0.2)
    course = posed_pairs._course((0, 1), posed_pairs.Nodes(nodes, np.zeros((12, 2, 4, 4)), np.zeros), steps)
    halved = replace(course, ways=None)
    for _ in range(50):
        low, high = np.sort(rng.uniform(nodes[0], nodes[-1], 2))
        travel = course.travel(low) + rng.uniform(0.0, 1.2) * (course.travel(high) - course.travel(low))
        assert course.when(travel, low, high) == pytest.approx(halved.when(travel, low, high), abs=1e-9)
