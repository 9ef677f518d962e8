"""Boxes of placed meshes, and sizes of what is left without a part, as brute force has them."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from support.places import FIXTURES

from kinform import form
from kinform.consistency.comparisons.plausibility import _rests


@cache
def coupler():
    return form.load(FIXTURES / "mechanisms/four_bar/four_bar.toml").part("coupler").mesh


def pose(turn, place):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = turn, place
    return X


@pytest.mark.parametrize(
    "turn",
    [np.eye(3), np.eye(3)[[1, 2, 0]], np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]],
    ids=["none", "quarter", "any"],
)
def test_the_box_of_a_placed_mesh_is_that_of_its_placed_vertices(turn):
    assert coupler() is not None
    X = pose(turn, [0.3, -1e-7, 12.5])
    placed = coupler().vertices @ X[:3, :3].T + X[:3, 3]
    low, high = coupler().placed_box(X)
    assert (low == placed.min(axis=0)).all()
    assert (high == placed.max(axis=0)).all()
    moved = pose(turn, [0.4, -1e-7, 12.5])
    assert coupler().placed_box(moved)[0][0] != low[0]
    assert (coupler().bare.placed_box(X)[0] == low).all()


def test_what_is_left_without_each_box():
    boxes = np.sort(np.random.default_rng(4).normal(size=(7, 2, 3)), axis=1)
    for k, rest in enumerate(_rests(boxes)):
        others = np.delete(boxes, k, axis=0).reshape(-1, 3)
        assert (rest == np.ptp(others, axis=0)).all()


def test_the_largest_part_is_the_one_with_the_greatest_diagonal():
    for name in (
        "mechanisms/four_bar/four_bar",
        "mechanisms/stewart_platform/stewart_platform",
        "seekers/seeker_2dof/seeker_2dof",
    ):
        assembly = form.load(FIXTURES / f"{name}.toml")
        assert assembly.largest == max(part.mesh.diagonal for part in assembly.parts if part.mesh is not None)
    assert form.load(FIXTURES / "functional/stick_four_bar/stick_four_bar.toml").largest == 0.0
