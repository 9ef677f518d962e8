"""The cone of motions that contacts allow: held or not, and its extreme directions; known by reasoning."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import first

from kinform.kinematics.separation.cone import extreme_rays, held_for_certain, opening, unit_rows

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def plane_rows(points, normals):
    """Rows of contacts in the plane z = 0, of a body that moves in it."""
    points, normals = np.array(points, float), np.array(normals, float)
    return unit_rows(np.stack([points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0], *normals.T], axis=1))


WALLS = [((1, 0.3), (-1, 0)), ((-1, -0.3), (1, 0))]
"""Two points that press on a body from the right and the left, and turn it to the left."""


def in_plane(*lines):
    return np.pad(plane_rows(*zip(*lines, strict=True)), ((0, 0), (0, 3)))


def test_form_closure_in_the_plane_takes_four_points():
    rows = in_plane(*WALLS, ((0.3, 1), (0, -1)), ((-0.3, -1), (0, 1)))
    assert held_for_certain([rows])[0]
    assert opening(rows).held
    for k in range(4):
        three = np.delete(rows, k, axis=0)
        assert not held_for_certain([three])[0]
        found = opening(three)
        assert found.held is False
        assert (three @ found.motion).min() > -1e-7
        assert (three @ found.motion).max() > 0.1


def test_four_points_that_all_turn_a_body_one_way_do_not_hold_it():
    rows = in_plane(*WALLS, ((-0.3, 1), (0, -1)), ((0.3, -1), (0, 1)))
    assert not held_for_certain([rows])[0]
    found = opening(rows)
    assert found.held is False
    assert found.motion[0] > 0.9


def test_a_vee_too_flat_to_be_sure_of_is_neither_held_nor_free():
    def vee(lean):
        return unit_rows(np.array([[0, 0, 0, 0, -1, lean], [0, 0, 0, 0, 1, lean]]))

    assert opening(vee(5e-4)).held is None
    assert opening(vee(5e-3)).held is False
    assert opening(vee(0.0)).held is True
    assert not held_for_certain([vee(5e-4)])[0]


@pytest.mark.parametrize("seed", first(8, range(20)))
def test_the_certificate_and_the_linear_program_agree(seed):
    rng = np.random.default_rng(seed)
    pairs = []
    for _ in range(10):
        rows = rng.normal(size=(rng.integers(2, 14), 6))
        rows[:, rng.permutation(6)[: rng.integers(0, 4)]] = 0.0
        pairs.append(unit_rows(rows))
    certain = held_for_certain(pairs)
    for rows, held in zip(pairs, certain, strict=True):
        found = opening(rows)
        if held:
            assert found.held is True
        elif found.held is False:
            assert (rows @ found.motion).min() > -1e-7


@pytest.mark.parametrize("seed", range(10))
def test_extreme_rays_span_the_cone_and_are_tight_enough(seed):
    rng = np.random.default_rng(seed)
    size, count = 3 + seed % 3, 8
    inside = rng.normal(size=size)
    rows = rng.normal(size=(count, size))
    rows = unit_rows(rows * np.sign(rows @ inside)[:, None])
    rays = extreme_rays(rows)
    assert rays is not None
    assert len(rays) >= size
    assert (rays @ rows.T).min() > -1e-6
    # each ray is the only direction that its tight rows leave
    for ray in rays:
        tight = rows[np.abs(rows @ ray) < 1e-6]
        assert np.linalg.matrix_rank(tight, tol=1e-6) == size - 1
    # and points of the cone are their sums
    from scipy.optimize import nnls

    for _ in range(5):
        point = inside + 0.1 * rng.normal(size=size)
        if (rows @ point).min() > 0:
            assert nnls(rays.T, point)[1] < 1e-6
