"""Boxes that come near each other, against every pair looked at."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.foundation.meshes.boxes import BOXES_AT_ONCE, FlatBoxes, boxes_within
from kinform.foundation.meshes.near_facets import near_boxes


def boxes(rng, count, spread, size):
    low = rng.uniform(-spread, spread, (count, 3))
    return low, low + rng.exponential(size, (count, 3))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.01, 0.3]), st.sampled_from([0.01, 0.2, 2.0]))
def test_none_that_is_near_is_missed(seed, margin, size):
    rng = np.random.default_rng(seed)
    low_a, high_a = boxes(rng, 60, 1.0, size)
    low_b, high_b = boxes(rng, 40, 1.0, size)
    apart = np.maximum(low_a[:, None] - high_b[None], low_b[None] - high_a[:, None]).max(axis=2)
    keep_a, keep_b = near_boxes(low_a, high_a, low_b, high_b, margin)
    assert keep_a[(apart <= margin).any(axis=1)].all()
    assert keep_b[(apart <= margin).any(axis=0)].all()


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.01, 0.3]), st.sampled_from([1e-3, 0.02, 0.5]), st.booleans())
def test_boxes_in_blocks_are_those_of_all_with_all(seed, margin, size, many):
    rng = np.random.default_rng(seed)
    counts = (700, 500) if many else (90, 70)
    assert (counts[0] * counts[1] > BOXES_AT_ONCE) == many
    # on a grid, so that some are apart by just the margin
    (low_a, high_a), (low_b, high_b) = (
        (np.round(low, 2), np.round(high, 2)) for low, high in (boxes(rng, count, 1.0, size) for count in counts)
    )
    apart = np.maximum(low_a[:, None] - high_b[None], low_b[None] - high_a[:, None]).max(axis=2)
    found = boxes_within((low_a, high_a), (low_b, high_b), margin)
    assert (found == (apart <= margin)).all()
    assert (boxes_within((low_b, high_b), (low_a, high_a), margin) == found.T).all()


def test_what_is_far_is_left_out():
    low = np.column_stack([np.linspace(0, 1, 101)[:-1], np.zeros(100), np.zeros(100)])
    keep_a, keep_b = near_boxes(low, low + 0.01, low[:10], low[:10] + 0.01, 0.0)
    assert keep_a.sum() < 20
    assert keep_b.all()


def test_boxes_on_grids_are_those_that_points_are_in():
    rng = np.random.default_rng(5)
    low = rng.uniform(-1.0, 1.0, (400, 2))
    high = low + 10.0 ** rng.uniform(-6, 0.3, (400, 1)) * rng.uniform(0.0, 1.0, (400, 2))
    points = np.concatenate([rng.uniform(-2.0, 3.0, (200, 2)), low[:40], high[40:80], 0.5 * (low + high)])
    which, boxes = FlatBoxes(low, high).around(points)
    inside = ((points[:, None] >= low) & (points[:, None] <= high)).all(axis=2)
    assert set(zip(which.tolist(), boxes.tolist(), strict=True)) == set(
        zip(*map(list, np.nonzero(inside)), strict=True)
    )
    assert (np.diff(which) >= 0).all()


def test_few_points_are_in_the_same_boxes_as_among_many():
    rng = np.random.default_rng(8)
    low = rng.uniform(-1.0, 1.0, (500, 2))
    boxes = FlatBoxes(low, low + 10.0 ** rng.uniform(-3, 0.0, (500, 2)))
    points = np.concatenate([rng.uniform(-2.0, 3.0, (300, 2)), low[:40]])
    few = [boxes.around(points[n : n + 1]) for n in range(0, len(points), 40)]
    for count in (0, 3, len(points), 3, 0):
        which, found = boxes.around(points[:count])
        assert len(which) == len(found)
        assert (which < count).all()
    which, found = boxes.around(points)
    for n, (_, those) in zip(range(0, len(points), 40), few, strict=True):
        assert those.tolist() == found[which == n].tolist()


def test_points_are_in_the_same_boxes_by_steps_as_exactly():
    rng = np.random.default_rng(11)
    for scale, place in ((1.0, 0.0), (1e-3, 7.0), (1e5, -3.0)):
        low = place + scale * rng.uniform(-1.0, 1.0, (900, 2))
        high = low + scale * 10.0 ** rng.uniform(-5, 0.0, (900, 2))
        points = np.concatenate([place + scale * rng.uniform(-1.0, 1.0, (30, 2)), low[:20], high[20:40]])
        boxes = FlatBoxes(low, high)
        which, found = boxes.around(points)
        assert boxes._left > 0
        inside = ((points[:, None] >= low) & (points[:, None] <= high)).all(axis=2)
        assert [which.tolist(), found.tolist()] == [column.tolist() for column in np.nonzero(inside)]
