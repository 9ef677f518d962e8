"""Where two outlines come closest, against all of their samples compared with each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.higher.closest_places import CURVES_OPPOSED, closest_places
from kinform.contacts.higher.outlines import CURVE_SAMPLES, Curve


def curve(points, near=None):
    count = len(points) - 1
    near = np.ones(count, bool) if near is None else near
    return Curve(points, np.zeros(count, np.int64), np.zeros(count), np.ones(count), False, near)


def lobes(rng, centre, radius, count, turns=1.0):
    """A closed or open outline with a few lobes, its material to the left."""
    t = 2.0 * np.pi * turns * np.arange(count + 1) / count + rng.uniform(0.0, 6.0)
    r = radius * (1.0 + 0.15 * np.cos(rng.integers(2, 6) * t + rng.uniform(0.0, 6.0)))
    return np.stack([centre[0] + r * np.cos(t), centre[1] + r * np.sin(t)], axis=1)


def all_compared(first, second, tolerance):
    (s, p, u), (t, q, w) = first.samples, second.samples
    apart = p[:, None] - q[None]
    square = np.where(u @ w.T < CURVES_OPPOSED, (apart**2).sum(axis=2), np.inf)
    nearest = square.argmin(axis=1)
    away = np.sqrt(square[np.arange(len(s)), nearest])
    outward = np.stack([w[nearest, 1], -w[nearest, 0]], axis=1)
    gap = np.where(np.isfinite(away), ((p - q[nearest]) * outward).sum(axis=1), np.inf)
    step = max(np.diff(first.knots).max(), np.diff(second.knots).max()) / CURVE_SAMPLES
    out = []
    for k in np.flatnonzero(np.isfinite(gap) & (away <= MATING_REACH * tolerance + 2.0 * step)):
        before = gap[k - 1] if k else np.inf
        after = gap[k + 1] if k + 1 < len(gap) else np.inf
        if gap[k] <= before and gap[k] < after:
            out.append((s[k], t[nearest[k]]))
    return out


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-4, 1e-3, 1e-2]))
def test_they_are_those_of_all_samples(seed, tolerance):
    rng = np.random.default_rng(seed)
    counts, radii = rng.integers(6, 90, 2), rng.uniform(0.5, 1.0, 2)
    # beside each other, or one in the other with its material outside
    inside = rng.random() < 0.3
    away = 0.1 * rng.normal() if inside else radii.sum() + rng.uniform(-0.25, 0.1)
    first = curve(lobes(rng, (0.0, 0.0), radii[0], counts[0], rng.uniform(0.3, 1.0)))
    other = lobes(rng, (away, 0.0), radii[0] * rng.uniform(1.0, 1.2) if inside else radii[1], counts[1])
    second = curve(other[::-1] if inside else other)
    found = closest_places(first, second, tolerance)
    assert np.array(found) == pytest.approx(np.array(all_compared(first, second, tolerance)), rel=1e-12)


def test_it_finds_where_two_circles_touch_and_nothing_of_those_apart():
    rng = np.random.default_rng(1)
    t = 2.0 * np.pi * np.arange(49) / 48
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    turn = rng.uniform(0.0, 1.0)
    ray = np.array([np.cos(turn), np.sin(turn)])
    for apart, many in ((2.0, 1), (2.5, 0)):
        places = closest_places(curve(circle), curve(circle + apart * ray), 1e-3)
        assert len(places) == many
        for s, _ in places:
            (point,), _, _ = curve(circle).at(np.array([s]))
            assert point @ ray > np.cos(0.05)
