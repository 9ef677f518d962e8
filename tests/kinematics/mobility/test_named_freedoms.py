"""Mobility of mechanisms whose freedom is known from the literature, from joint twists alone."""

from __future__ import annotations

import numpy as np
import pytest
from support.linkages import CLOSED, bennett

from kinform.foundation.graphs.graph import UnionFind, blocks, forest
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.first_order import body_twists, close

X, Y, Z = np.eye(3)


def revolute(axis, point):
    axis = np.asarray(axis, float)
    return twists_of("revolute", axis / np.linalg.norm(axis), np.asarray(point, float))


def ring_of(points, axes):
    """Closed chain: joint k between body k and body k+1 (mod n)."""
    n = len(points)
    edges = [tuple(sorted((k, (k + 1) % n))) for k in range(n)]
    return n, edges, [revolute(a, p) for p, a in zip(points, axes, strict=True)]


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 50.0])
def test_closed_chains_have_the_published_mobility(name, scale):
    points, axes, expected = CLOSED[name]
    shift = np.array([3.0, -2.0, 1.0]) * scale
    nodes, edges, spaces = ring_of([scale * np.asarray(p) + shift for p in points], axes)
    for ground in range(nodes):
        assert close(nodes, edges, spaces, ground, scale).mobility == expected


def test_bennett_moves_although_gruebler_says_minus_two():
    nodes, edges, spaces = ring_of(*bennett())
    assert close(nodes, edges, spaces, 0).mobility == 1


def test_body_twists_satisfy_every_joint():
    nodes, edges, spaces = ring_of(*CLOSED["five-bar"][:2])
    closure = close(nodes, edges, spaces, 0)
    twists = body_twists(closure, edges, spaces)
    assert np.allclose(twists[:, 0], 0.0)
    for (a, b), space in zip(edges, spaces, strict=True):
        relative = twists[:, b] - twists[:, a]
        inside = relative @ np.linalg.pinv(space) @ space
        assert np.allclose(relative, inside, atol=1e-9)


def test_open_chains_and_loose_bodies_add_up():
    edges = [(0, 1), (1, 2)]
    spaces = [revolute(Z, (0, 0, 0)), twists_of("spherical", None, np.array([1.0, 0, 0]))]
    assert close(4, edges, spaces, 0).mobility == 1 + 3 + 6


def test_two_loops_that_share_a_bridge_close_separately():
    first = [revolute(Z, p) for p in ([0, 0, 0], [0, 2, 0], [3, 3, 0], [4, 0, 0])]
    second = [revolute(X, p) for p in ([9, 0, 0], [9, 2, 0], [9, 3, 3], [9, 0, 4])]
    edges = [(0, 1), (1, 2), (2, 3), (0, 3), (3, 4), (4, 5), (5, 6), (6, 7), (4, 7)]
    assert close(8, edges, [*first, revolute(Y, (5, 5, 5)), *second], 0).mobility == 3


def test_parallel_edges_form_a_block():
    assert blocks(3, [(0, 1), (0, 1), (1, 2)]) == [[0, 1], [2]]


def test_a_forest_reaches_every_node_once():
    tree = forest(5, [(0, 1), (1, 2), (0, 2), (3, 4)], 2)
    assert sorted(tree.order) == [0, 1, 2, 3, 4]
    assert tree.root == (2, 2, 2, 3, 3)


def test_union_keeps_the_smallest_as_representative():
    sets = UnionFind(4)
    sets.union(3, 1)
    sets.union(2, 3)
    assert [sets.find(k) for k in range(4)] == [0, 1, 1, 1]
