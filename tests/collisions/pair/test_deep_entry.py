"""Points that come to be inside of another part, and those that only seem to."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from kinform.collisions.pair.course import Course
from kinform.collisions.pair.deep_entry import Inside
from kinform.foundation.rounding import SOLVED


def inside(depth):
    """Of one point that is `depth(s)` inside at s, as it goes by 1 m a unit of s."""
    test = SimpleNamespace(
        probes=[SimpleNamespace(points=np.zeros((1, 3)))],
        size=1.0,
        loose=1e-3,
        solid_about=np.ones(1, dtype=bool),
        going_deeper=lambda before: 1.25 * before + 5e-3,
        heights=lambda s, chosen, away: np.full(len(chosen), depth(s)),
        places=lambda s: np.zeros((1, 3)),
    )
    return Inside(test, Course(lambda s: s, lambda s: s), 0.0)


@pytest.mark.parametrize("entry", [0.2, 0.5, 0.77])
def test_a_point_comes_in_where_it_is_on_the_surface(entry):
    found = inside(lambda s: s - entry).met(1.0, 1.0, 1e-6, every=True)
    assert found.at - 1.01 * SOLVED <= entry <= found.hit
    assert found.hit - found.at <= 1e-8


@pytest.mark.parametrize("deep", [0.002, 0.1])
def test_a_point_that_is_deep_inside_at_once_is_not_taken_to_be_inside(deep):
    """As it seems where the ray from it finds the hole in a mesh that is not closed."""
    known = inside(lambda s: deep if s > 0.5 else -deep)
    assert known.met(1.0, 1.0, 1e-6, every=True) is None


def test_what_only_seemed_to_be_inside_counts_once_it_has_been_out():
    known = inside(lambda s: 0.1 if 0.3 < s < 0.5 else s - 0.9)
    assert known.met(0.4, 1.0, 1e-6, every=True) is None
    assert known.met(0.6, 1.0, 1e-6, every=True) is None
    found = known.met(1.0, 1.0, 1e-6, every=True)
    assert found.at - 1.01 * SOLVED <= 0.9 <= found.hit
