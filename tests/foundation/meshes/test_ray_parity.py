"""Solid angles: how often facets go round points, whatever else is asked at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.solids import ball, box, part

from kinform.foundation.constants import ROWS
from kinform.foundation.meshes.ray_parity import winding

FINE = part("ball", ball(10, 128), np.eye(4)).mesh
"""Of 10 mm radius, and of more facets than are had at once."""


def test_points_are_inside_once_or_not_at_all():
    assert len(FINE.faces) > ROWS
    rng = np.random.default_rng(1)
    away = rng.normal(size=(100, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    share = rng.uniform(0.0, 2.0, 100)
    share = share[np.abs(share - 1.0) > 0.01]
    found = winding(FINE, 0.01 * share[:, None] * away[: len(share)])
    assert found == pytest.approx((share < 1.0).astype(float), abs=1e-9)


def test_a_point_is_answered_as_alone():
    points = np.random.default_rng(2).uniform(-0.02, 0.02, (12, 3))
    for mesh in (FINE, part("box", box(-10, 10, -10, 10, -10, 10), np.eye(4)).mesh):
        together = winding(mesh, points)
        assert (together == np.concatenate([winding(mesh, point[None]) for point in points])).all()


def test_half_is_seen_in_a_gap():
    cube = part("box", box(-10, 10, -10, 10, -10, 10), np.eye(4)).mesh
    top = (cube.vertices[cube.faces][:, :, 2] > 0.0099).all(axis=1)
    opened = replace(cube, faces=cube.faces[~top])
    middle, centre, below = [0.0, 0.0, 0.01], [0.0, 0.0, 0.0], [0.0, 0.0, -0.1]
    found = winding(opened, np.array([middle, centre, below]))
    assert found[0] == pytest.approx(0.5, abs=1e-9)
    assert found[1] == pytest.approx(5.0 / 6.0, abs=1e-9)
    assert 0.0 < abs(found[2]) < 0.01
