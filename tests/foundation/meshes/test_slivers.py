"""Which triangles meet, against FCL, and where exact arithmetic tells."""

import fcl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.foundation.meshes import box_pairs, slivers
from kinform.foundation.meshes.boxes import facet_boxes
from kinform.foundation.meshes.fcl_adapter import fcl_model
from kinform.foundation.meshes.slivers import beside, crossing, meeting, met_among, near_swept


def told_by_fcl(first, second):
    """Pairs of triangles (n, 3, 3) and (m, 3, 3) that meet."""
    models = [fcl_model(t.reshape(-1, 3), np.arange(3 * len(t)).reshape(-1, 3)) for t in (first, second)]
    result = fcl.CollisionResult()
    request = fcl.CollisionRequest(num_max_contacts=100_000, enable_contact=False)
    fcl.collide(*(fcl.CollisionObject(model) for model in models), request, result)
    return sorted({(c.b1, c.b2) for c in result.contacts})


def pairs(first, second):
    return list(zip(*(found.tolist() for found in meeting(first, second)), strict=True))


def scene(seed, thin=0.3, size=1.0):
    rng = np.random.default_rng(seed)
    middles, arms = rng.uniform(-0.3, 0.3, (40, 1, 3)), rng.normal(size=(40, 3, 3))
    arms[:20, 2] = arms[:20, 1] + thin * 1e-2 * rng.normal(size=(20, 3))
    triangles = size * (middles + 0.4 * arms)
    return triangles[:20], triangles[20:]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-6, 1e-3, 1.0, 1e4]))
def test_triangles_meet_as_fcl_finds(seed, size):
    first, second = scene(seed, size=size)
    found = pairs(first, second)
    assert found == told_by_fcl(first, second)
    assert found


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_the_answer_of_a_pair_does_not_hang_on_the_others_nor_on_their_order(seed):
    first, second = scene(seed)
    rng = np.random.default_rng(seed + 1)
    rows, columns = rng.permutation(20)[:7], rng.permutation(20)[:9]
    every = set(pairs(first, second))
    some = pairs(first[rows], second[columns])
    assert some == sorted(some)
    assert {(rows[i], columns[j]) for i, j in some} == {(i, j) for i, j in every if i in rows and j in columns}


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-6, 1e-3, 1.0, 1e4]), st.booleans())
def test_none_that_meets_is_taken_for_clearly_apart(seed, size, on_a_lattice):
    """On a lattice most triangles touch, share edges or lie in one plane; slivers have hardly a normal."""
    rng = np.random.default_rng(seed)
    first, second = scene(seed)
    if on_a_lattice:
        first, second = rng.integers(0, 4, (2, 30, 3, 3)).astype(float) + rng.normal(size=3)
    with pytest.MonkeyPatch.context() as patched:
        answers = []
        for least in (0, 10**9):
            patched.setattr(slivers, "MET_MOST", 10**9)
            patched.setattr(slivers, "CULLED_LEAST", least)
            answers.append(pairs(size * first, size * second))
    assert answers[0] == answers[1]
    assert answers[0]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-6, 1.0, 1e4]), st.sampled_from([0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1.0]))
def test_what_clearly_meets_is_what_no_direction_parts(seed, size, off):
    """Near a lattice most triangles nearly touch, or are needles; a few of them pass through each other."""
    rng = np.random.default_rng(seed)
    first, second = rng.integers(0, 4, (2, 30, 3, 3)) + off * rng.normal(size=(2, 30, 3, 3)) + rng.normal(size=3)
    first[:15, 2] = first[:15, 1] + 1e-6 * rng.normal(size=(15, 3))
    answers, nothing = [], lambda first, second, one, two, size: (np.zeros(len(one), bool), np.zeros(len(one), bool))
    for told in (slivers._told, nothing):
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(slivers, "MET_MOST", 10**9)
            patched.setattr(slivers, "_told", told)
            answers.append(pairs(size * first, size * second))
    assert answers[0] == answers[1]
    assert answers[0]


FLAT = np.array([[[0, 0, 0], [4, 0, 0], [0, 4, 0]]], dtype=float)


@pytest.mark.parametrize(
    ("other", "met"),
    [
        ([[1, 1, 0], [1, 1, 3], [2, 1, 3]], True),  # a corner on the face
        ([[4, 0, 0], [4, 0, 3], [5, 0, 3]], True),  # a corner on a corner
        ([[1, 1, 1], [1, 1, 3], [2, 1, 3]], False),  # above it
        ([[3, 3, -1], [3, 3, 1], [4, 3, 0]], False),  # through its plane, beside it
        ([[1, 1, 0], [2, 1, 0], [1, 2, 0]], True),  # in its plane, within it
        ([[2, 2, 0], [4, 2, 0], [2, 4, 0]], True),  # in its plane, at its edge
        ([[3, 2, 0], [5, 2, 0], [3, 4, 0]], False),  # in its plane, its box in the other's
        ([[0, 4, 0], [4, 0, 0], [4, 4, 5]], True),  # along a whole edge
    ],
)
def test_what_touches_meets_and_nothing_else(other, met):
    triangle = np.array([other], dtype=float)
    for turn in range(3):
        assert bool(pairs(FLAT, np.roll(triangle, turn, axis=1))) == met
        assert bool(pairs(triangle[:, ::-1], np.roll(FLAT, turn, axis=1))) == met


def test_facets_without_area_meet_what_they_lie_on():
    line = np.array([[[1, 1, -1], [1, 1, 1], [1, 1, 0]]], dtype=float)
    assert pairs(FLAT, line) == [(0, 0)]
    assert pairs(FLAT, line + [4, 0, 0]) == []


def test_facets_beside_are_all_whose_boxes_meet_that_of_all():
    rng = np.random.default_rng(3)
    vertices, faces = rng.uniform(-1, 1, (200, 3)), rng.integers(0, 200, (300, 3))
    slivers = 0.1 * rng.normal(size=(5, 3, 3))
    low, high = slivers.min(axis=(0, 1)), slivers.max(axis=(0, 1))
    corners = vertices[faces]
    held = [(c.min(axis=0) <= high).all() and (c.max(axis=0) >= low).all() for c in corners]
    assert beside(slivers, *facet_boxes(vertices, faces)).tolist() == np.flatnonzero(held).tolist()


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-6, 1.0, 1e4]), st.sampled_from([0, 30, 10**9]))
def test_what_crosses_is_what_fcl_finds_however_few_are_asked_first(seed, size, few):
    first, second = scene(seed, size=size)
    apart = second + size * np.array([0.0, 0.0, 40.0])
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(slivers, "CROSSED_FEW", max(few, 1))
        for other in (second, apart, second + 0.7 * size):
            assert crossing(first, other) is bool(told_by_fcl(first, other))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_a_grid_finds_the_boxes_that_comparison_finds(seed):
    rng = np.random.default_rng(seed)
    kinds = []
    for count, largest in ((60, 0.3), (80, 1.5)):
        low = rng.uniform(-1, 1, (count, 3))
        kinds.append((low, low + largest * rng.uniform(0, 1, (count, 3)) ** 3))
    every = box_pairs.meeting_boxes(*kinds)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(box_pairs, "BOXES_MATRIX", 0)
        by_grid = box_pairs.meeting_boxes(*kinds)
    assert len(every[0])
    assert [found.tolist() for found in by_grid] == [found.tolist() for found in every]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1, 37, 400]), st.sampled_from([0.0, 1.5, 5.0]))
def test_slabs_find_the_boxes_that_comparison_finds(seed, at_once, away):
    rng = np.random.default_rng(seed)
    kinds = []
    for count, largest, shift in ((60, 0.3, 0.0), (80, 1.5, away)):
        low = rng.uniform(-1, 1, (count, 3)) + shift
        kinds.append((low, low + largest * rng.uniform(0, 1, (count, 3)) ** 3))
    every = box_pairs.meeting_boxes(*kinds)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(box_pairs, "BOXES_MATRIX", at_once)
        in_slabs = box_pairs.meeting_in_slabs(*kinds)
    assert bool(len(every[0])) or away
    assert [found.tolist() for found in in_slabs] == [found.tolist() for found in every]
    none = kinds[0][0][:0], kinds[0][1][:0]
    for pair in ((none, kinds[1]), (kinds[0], none)):
        assert [len(found) for found in box_pairs.meeting_in_slabs(*pair)] == [0, 0]


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.5, 2.0), st.sampled_from([0, 20_000]), st.sampled_from([0, 600_000]))
def test_of_more_boxes_than_are_wanted_it_is_told_that_they_are_too_many(seed, share, exact, matrix):
    rng = np.random.default_rng(seed)
    low = [rng.uniform(-1, 1, (count, 3)) for count in (70, 90)]
    kinds = [(one, one + rng.uniform(0, 1, one.shape)) for one in low]
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(box_pairs, "BOXES_EXACT", exact)
        patched.setattr(box_pairs, "BOXES_MATRIX", matrix)
        every = box_pairs.meeting_boxes(*kinds)
        most = share * len(every[0])
        some = box_pairs.meeting_boxes(*kinds, most)
    if len(every[0]) > most:
        assert some is None
    else:
        assert [found.tolist() for found in some] == [found.tolist() for found in every]


@pytest.mark.parametrize("most", [0, 10**9])
def test_directions_are_asked_together_or_in_turn_with_one_answer(most, monkeypatch):
    first, second = scene(5)
    expected = told_by_fcl(first, second)
    monkeypatch.setattr(slivers, "MANY", most)
    assert pairs(first, second) == expected


def test_what_a_grid_does_not_part_is_all_compared_while_it_is_little(monkeypatch):
    first, second = scene(6)
    expected = told_by_fcl(first, second)
    monkeypatch.setattr(box_pairs, "BOXES_MATRIX", 0)
    monkeypatch.setattr(box_pairs, "BESIDE_MOST", 0)
    assert pairs(first, second) == expected
    monkeypatch.setattr(box_pairs, "BOXES_COMPARED", 0)
    assert meeting(first, second) is None


def test_triangles_most_of_which_are_beside_each_other_are_left_to_trees(monkeypatch):
    monkeypatch.setattr(slivers, "MET_MOST", 1)
    assert meeting(*scene(7)) is None


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1e-3, 1.0, 1e4]), st.floats(0.0, 1.0))
def test_what_meets_triangles_on_their_way_is_among_those_near_it(seed, size, share):
    first, second = scene(seed, size=size)
    end = second + size * np.random.default_rng(seed).normal(scale=0.1, size=second.shape)
    there = second + share * (end - second)
    near = near_swept(first, second, end, 1e9)
    (met,) = met_among([(first, there)], [near])
    assert list(zip(*(found.tolist() for found in met), strict=True)) == pairs(first, there)
    assert near_swept(first, second, end, 1e-6) is None
