"""Sets of triangles that keep a distance, and how far curves may stand off facets."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.foundation.algebra.splines import through
from kinform.foundation.meshes import separated_sets
from kinform.foundation.meshes.closest_facets import distances_from
from kinform.foundation.meshes.outline_bulges import BULGE
from kinform.foundation.meshes.separated_sets import surely_separated


def soup(rng, count, size, middle):
    return middle + rng.normal(size=(count, 1, 3)) * 3.0 + size * rng.normal(size=(count, 3, 3))


def sets(rng):
    """Triangles of all sizes, of which some come within a distance of each other, and some do not."""
    for _ in range(30):
        size, step = 10.0 ** rng.uniform(-1.5, 0.5), rng.normal(size=3)
        first = soup(rng, int(rng.integers(1, 20)), size, rng.normal(size=3))
        second = soup(rng, int(rng.integers(1, 20)), size, first[0, 0] + 10.0 ** rng.uniform(-1, 1) * step)
        yield first, second, float(10.0 ** rng.uniform(-2, 0.5))
    turn = np.linspace(0.0, 2 * np.pi, 25)
    for gap in (0.05, 0.2):
        rings = []
        for radius in (1.0, 1.0 + gap):
            low = np.stack([radius * np.cos(turn), radius * np.sin(turn), 0.0 * turn], axis=1)
            high = low + (0.0, 0.0, 5.0)
            halves = [np.stack([low[:-1], low[1:], high[1:]], 1), np.stack([low[:-1], high[1:], high[:-1]], 1)]
            rings.append(np.concatenate(halves))
        yield rings[0], rings[1], 0.06


def sampled(first, second):
    """A distance that some points of the first have from the second: no less than that of both."""
    shares = np.random.default_rng(1).dirichlet(np.ones(3), 12)
    return min(
        float(distances_from(p, second).min()) for p in np.concatenate([first.reshape(-1, 3), *(shares @ first)])
    )


def test_what_keeps_a_distance_has_no_point_nearer_and_does_not_hang_on_the_other_sets(monkeypatch):
    rng = np.random.default_rng(7)
    asked = list(sets(rng))
    told = surely_separated(asked)
    assert 5 < sum(told) < len(told) - 5
    for (first, second, distance), far in zip(asked, told, strict=True):
        apart = sampled(first, second)
        assert not far or apart > distance
        assert far or apart <= 40.0 * distance
    assert told[-1]
    assert not told[-2]
    order = rng.permutation(len(asked))
    assert surely_separated([asked[k] for k in order]) == [told[k] for k in order]
    assert [surely_separated([one])[0] for one in asked] == told
    monkeypatch.setattr(separated_sets, "ROWS", 7)
    monkeypatch.setattr(separated_sets, "APART_SOME", 3)
    assert surely_separated(asked) == told


@pytest.mark.parametrize("seed", range(4))
def test_smooth_curves_stand_off_their_chords_by_no_more_than_a_bulge(seed):
    rng = np.random.default_rng(seed)
    for _ in range(50):
        count = int(rng.integers(4, 20))
        length = np.exp(np.cumsum(rng.choice([-1.0, 0.0, 1.0], count)) * np.log(2.99))
        turn = np.cumsum(np.radians(32.0) * rng.uniform(-1.0, 1.0, count))
        steps = length[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        points = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
        knots = np.concatenate([[0.0], np.cumsum(length)])
        curve = through(knots, points)
        for share in np.linspace(0.0, 1.0, 9):
            chord = points[:-1] + share * steps
            off = np.linalg.norm(curve(knots[:-1] + share * length) - chord, axis=1)
            assert (off <= BULGE * length.max()).all()
