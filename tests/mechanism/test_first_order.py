"""Large blocks reduced loop by loop give what singular values of all their equations give."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from kinform.foundation.graphs.cycles import short_cycles
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.first_order import body_twists, close

Z = np.array([0.0, 0.0, 1.0])


def hinge(x, y, axis=Z):
    return twists_of("revolute", np.asarray(axis, float), np.array([x, y, 0.0]))


def lift(stages):
    """Scissor lift on body 0: 2 links a stage, crossed."""
    edges, spaces = [(0, 1)], [hinge(0.0, 0.0)]
    for k in range(stages):
        left, right = 2 * k + 1, 2 * k + 2
        edges.append((left, right))
        spaces.append(hinge(0.1, 0.1 * k + 0.05))
        if k:
            edges += [(left - 1, left), (left - 2, right)]
            spaces += [hinge(0.0, 0.1 * k), hinge(0.2, 0.1 * k)]
    return 2 * stages + 1, edges, spaces


def squares(side):
    """A net of squares hinged at their corners, alternately turned; body 0 is one of them."""
    edges, spaces = [], []
    for i in range(side):
        for j in range(side):
            shift = 0.01 * ((i + j) % 2)
            if i + 1 < side:
                edges.append((i * side + j, (i + 1) * side + j))
                spaces.append(hinge(0.1 * i + 0.05, 0.1 * j + shift))
            if j + 1 < side:
                edges.append((i * side + j, i * side + j + 1))
                spaces.append(hinge(0.1 * i + shift, 0.1 * j + 0.05))
    return side * side, edges, spaces


def polygon(count):
    """One loop of hinges."""
    angle = 2 * np.pi * np.arange(count) / count
    return count, [tuple(sorted((k, (k + 1) % count))) for k in range(count)], [
        hinge(np.cos(a), np.sin(a)) for a in angle
    ]  # fmt: skip


def mixed_loops(seed):
    """Random loops of hinges, sliders and balls that share bodies."""
    rng = np.random.default_rng(seed)
    nodes = 14
    edges = [(k, k + 1) for k in range(nodes - 1)] + [(0, 5), (3, 9), (7, 13)]
    spaces = []
    for _ in edges:
        kind = ("revolute", "spherical", "cylindrical")[rng.integers(3)]
        axis = rng.normal(size=3)
        spaces.append(twists_of(kind, axis / np.linalg.norm(axis), rng.normal(size=3)))
    return nodes, edges, spaces


CASES = ("lift", "net", "polygon", *(f"random {seed}" for seed in range(4)))


@cache
def case(name):
    """Nodes, edges and spaces of one of the cases."""
    kind, _, seed = name.partition(" ")
    return mixed_loops(int(seed)) if seed else {"lift": lift, "net": squares, "polygon": polygon}[kind](SIZES[kind])


SIZES = {"lift": 12, "net": 6, "polygon": 40}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 30.0])
def test_loop_by_loop_agrees_with_singular_values(name, scale):
    nodes, edges, spaces = case(name)
    scaled = [np.hstack([s[:, :3], scale * s[:, 3:]]) for s in spaces]
    dense = close(nodes, edges, scaled, 0, scale, few=10**9)
    sparse = close(nodes, edges, scaled, 0, scale, few=0)
    assert all(block.sure for block in sparse.blocks)
    assert sparse.mobility == dense.mobility
    both = np.vstack([dense.rates, sparse.rates])
    both /= np.linalg.norm(both, axis=1)[:, None]
    assert np.linalg.matrix_rank(both, tol=1e-6) == dense.mobility


@pytest.mark.parametrize(("name", "mobility"), [("lift", 2), ("net", 1), ("polygon", 37)])
def test_large_planar_blocks_have_the_mobility_of_the_plane(name, mobility):
    nodes, edges, spaces = case(name)
    assert close(nodes, edges, spaces, 0, few=0).mobility == mobility


def test_solutions_of_a_large_block_keep_every_joint():
    nodes, edges, spaces = case("lift")
    closure = close(nodes, edges, spaces, 0, few=0)
    twists = body_twists(closure, edges, spaces)
    for (a, b), space in zip(edges, spaces, strict=True):
        relative = twists[:, b] - twists[:, a]
        assert np.allclose(relative, relative @ np.linalg.pinv(space) @ space, atol=1e-9)


def test_every_solution_is_driven_by_a_rate_of_one_while_the_other_drivers_rest():
    for name in CASES:
        closure = close(case(name)[0], *case(name)[1:], 0)
        drivers = [solution.driver for solution in closure.solutions]
        assert np.allclose(closure.rates[:, drivers], np.eye(len(drivers)), atol=1e-12)


def test_a_long_loop_is_solved_sparsely():
    closure = close(*polygon(600), 0)
    assert closure.mobility == 597
    assert sum(len(solution.columns) for solution in closure.solutions) < 5 * 600


def test_short_cycles_of_a_grid_are_its_squares():
    nodes, edges, _ = squares(5)
    assert [len(cycle) for cycle in short_cycles(nodes, edges)] == [4] * 16


def test_short_cycles_walk_round_and_are_a_basis():
    rng = np.random.default_rng(5)
    for nodes, count in ((8, 14), (40, 90)):
        edges = [(k, k + 1) for k in range(nodes - 1)]
        while len(edges) < count:
            a, b = sorted(rng.choice(nodes, 2, replace=False).tolist())
            edges.append((a, b))
        cycles = short_cycles(nodes, edges)
        incidence = np.zeros((len(cycles), len(edges)))
        for row, cycle in enumerate(cycles):
            for (k, sign), (after, next_sign) in zip(cycle, [*cycle[1:], cycle[0]], strict=True):
                incidence[row, k] += sign
                assert edges[k][1 if sign > 0 else 0] == edges[after][0 if next_sign > 0 else 1]
        assert np.linalg.matrix_rank(incidence) == len(cycles) == count - nodes + 1


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("rounding", [0.0, 1e-8, 1e-6])
@pytest.mark.parametrize("mixed", [np.eye(2), np.array([[0.8, 0.6], [-0.6, 0.8]])])
def test_a_slide_that_turns_by_rounding_does_not_make_a_loop_look_large(scale, rounding, mixed):
    """Two wheels and their teeth, which leave a turn about the pitch point and a slide, whose axis is far away."""
    turns = [twist_at([0, 0, 1], np.array(point) * scale) for point in ([0, 0, 0], [5, 0, 0], [2, 0, 0])]
    slide = np.array([rounding / scale, 0, 0, 0, 0, 1.0])
    teeth = mixed @ np.array([turns[2] / scale, slide])
    spaces = [turns[0][None], turns[1][None], teeth]
    closure = close(3, [(0, 1), (0, 2), (1, 2)], spaces, 0, size=8.0 * scale, doubts=np.full((3, 2), 1e-3 * scale))
    (solution,) = closure.solutions
    assert closure.blocks[0].frame.length < 10.0 * scale
    rates = dict(zip(solution.columns.tolist(), solution.rates.tolist(), strict=True))
    assert rates[1] / rates[0] == pytest.approx(-2.0 / 3.0, rel=1e-6)


def twist_at(axis, point):
    """(6,) of a turn of 1 rad/s."""
    return np.array([*axis, *np.cross(point, axis)], dtype=float)
