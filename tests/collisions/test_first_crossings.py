"""The earliest crossings of many pairs, by a search that is told beforehand what each pair would meet."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from support.diagonal import first

from kinform.collisions import first_crossings
from kinform.collisions.pair.advancement import First


@pytest.mark.parametrize("seed", first(10, range(30)))
def test_all_up_to_the_time_of_so_many_and_nothing_twice(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 60))
    free = np.round(rng.uniform(0.0, 1.0, count), 1)
    hits = np.where(rng.uniform(size=count) < 0.7, np.minimum(free + rng.uniform(0.0, 0.3, count), 1.0), np.inf)
    asked = []

    def crossing(test, _, end, fine, start):
        asked.append(test)
        assert (start, fine) == (free[test], 0.01)
        return First(None, float(hits[test]), None) if hits[test] <= end else First(None, None, None)

    monkeypatch.setattr(first_crossings, "first_crossing", crossing)
    pairs = [SimpleNamespace(test=k, course=None, free=float(free[k])) for k in range(count)]
    met, given = first_crossings.FirstCrossings(pairs, 1.0, 0.01), {}
    for most in (5, 10, 20, 80):
        fresh = dict(met.up_to(most))
        assert not fresh.keys() & given.keys()
        given |= fresh
        crossed = {k for k, first in given.items() if first.hit is not None}
        assert crossed == set(np.flatnonzero(hits <= met.end))
        if met.end < 1.0:
            assert len(crossed) >= most
            assert np.count_nonzero(hits < met.end) < most
        else:
            assert given.keys() == set(range(count))
        assert sorted(met.left_out) == sorted(set(range(count)) - given.keys())
    assert met.end == 1.0
    assert len(asked) <= 4 * count


def test_few_of_many_that_cross_early_are_asked(monkeypatch):
    asked = []

    def crossing(test, _course, end, _fine, start):
        asked.append(test)
        return First(None, start, None) if start <= end else First(None, None, None)

    monkeypatch.setattr(first_crossings, "first_crossing", crossing)
    pairs = [SimpleNamespace(test=k, course=None, free=k / 5000) for k in range(5000)]
    met = first_crossings.FirstCrossings(pairs, 1.0, 0.01)
    assert [k for k, _ in met.up_to(100)] == list(range(100))
    assert len(asked) == 100
