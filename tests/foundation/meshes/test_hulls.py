"""Hulls: how far points are outside of many of them."""

import numpy as np
import pytest

from kinform.foundation.meshes import hulls


def _balls(count: int, corners: int, rng: np.random.Generator) -> list[hulls.Hull]:
    made = []
    for place in rng.uniform(-1.0, 1.0, (count, 3)):
        points = rng.normal(size=(corners, 3))
        made.append(hulls.hull_of(0.1 * points / np.linalg.norm(points, axis=1)[:, None] + place))
    return made


@pytest.mark.parametrize(("count", "corners"), [(1, 50), (2, 4), (9, 300)])
def test_least_distance_is_that_of_every_plane_of_every_hull(count, corners):
    rng = np.random.default_rng(1)
    balls, points = _balls(count, corners, rng), rng.uniform(-1.2, 1.2, (400, 3))
    every = np.min([(points @ h.planes[:, :3].T + h.planes[:, 3]).max(axis=1) for h in balls], axis=0)
    assert hulls.outside_of_all(balls, points) == pytest.approx(every, rel=1e-12, abs=1e-15)


def test_no_points_are_nowhere():
    balls = _balls(2, 10, np.random.default_rng(2))
    assert hulls.outside_of_all(balls, np.zeros((0, 3))).shape == (0,)


def test_of_many_hulls_only_near_ones_are_asked(monkeypatch):
    """The time of a link with n pieces of geometry grows with n, not with its square."""
    rng = np.random.default_rng(3)
    balls, points = _balls(40, 300, rng), rng.uniform(-1.2, 1.2, (400, 3))
    work, outright = [], hulls.beyond
    monkeypatch.setattr(hulls, "beyond", lambda planes, p: work.append(len(planes) * len(p)) or outright(planes, p))
    hulls.outside_of_all(balls, points)
    assert sum(work) < 0.2 * len(points) * sum(len(ball.planes) for ball in balls)


def test_blocks_are_bounded_in_entries(monkeypatch):
    rng = np.random.default_rng(4)
    (ball,), points = _balls(1, 100, rng), rng.uniform(-1.0, 1.0, (50, 3))
    whole = ball.outside(points)
    monkeypatch.setattr(hulls, "ENTRIES", 300)
    assert ball.outside(points) == pytest.approx(whole, rel=1e-12)
