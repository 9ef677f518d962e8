"""A space of twists has one basis and one description, whichever basis it was computed in."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.foundation.algebra.screws import Frame, rotation, scaled, span, translation
from kinform.kinematics.screws.canonical_basis import canonical_twists
from kinform.kinematics.screws.wording import motions_in_words

X, Y, Z = np.eye(3)
FRAME = Frame(np.array([0.02, -0.01, 0.3]), 0.05)
NOWHERE, P = np.zeros(3), np.array([0.03, 0.0, 0.28])


def turn(axis, point=NOWHERE, lead=0.0):
    return rotation(np.asarray(axis, float), point, FRAME, lead)


def slide(axis):
    return translation(np.asarray(axis, float))


LEANING = np.array([0.6, 0.0, 0.8])
SPACES = {
    "ball on a table": [turn(X, P), turn(Y, P), turn(Z, P), slide(X), slide(Y)],
    "ball in a groove": [turn(X, P), turn(Y, P), turn(Z, P), slide(LEANING)],
    "roller on a table": [turn(Z, P), turn(X, P), slide(X), slide(Y)],
    "teeth": [turn(Z, P), turn(LEANING, P), slide(LEANING), slide(np.cross(LEANING, Z) / 0.6)],
    "two turns that miss": [turn(X, P), turn(Y, NOWHERE)],
    "screw and slide across": [turn(Z, P, 0.004), slide(X)],
    "about the diagonal": [turn(np.ones(3) / np.sqrt(3.0), P), slide(np.array([1, -1, 0]) / np.sqrt(2.0))],
    "free": [turn(X), turn(Y), turn(Z), slide(X), slide(Y), slide(Z)],
    "fixed": [],
}


def mixed(space, seed, noise=1e-16):
    """The same space in an orthonormal basis that is none in particular, with the rounding of another processor."""
    rng = np.random.default_rng(seed)
    basis = span(np.array(space).reshape(-1, 6).T)
    turned = np.linalg.qr(rng.normal(size=(basis.shape[1], basis.shape[1])))[0]
    return basis @ turned + noise * rng.normal(size=basis.shape)


@pytest.mark.parametrize("name", SPACES)
@settings(max_examples=10)
@given(seeds=st.tuples(st.integers(0, 10**6), st.integers(0, 10**6)))
def test_it_is_the_same_whatever_basis_it_was_made_from(name, seeds):
    one, other = (mixed(SPACES[name], seed) for seed in seeds)
    first, second = (canonical_twists(basis, FRAME) for basis in (one, other))
    np.testing.assert_allclose(first, second, atol=1e-13)
    np.testing.assert_array_equal(first == 0.0, second == 0.0)
    assert motions_in_words(one, FRAME) == motions_in_words(other, FRAME)


@pytest.mark.parametrize("name", SPACES)
def test_it_spans_the_space_with_unit_turns_before_unit_slides(name):
    space = mixed(SPACES[name], 7)
    twists = canonical_twists(space, FRAME)
    assert len(twists) == space.shape[1]
    again = scaled(twists.T, FRAME)
    assert np.abs(again - space @ (space.T @ again)).max(initial=0.0) < 1e-14
    turning = np.linalg.norm(twists[:, :3], axis=1)
    assert np.all(np.isclose(turning, 1.0, atol=1e-14) | (turning == 0.0))
    assert list(turning) == sorted(turning, reverse=True)
    np.testing.assert_allclose(np.linalg.norm(twists[turning == 0.0, 3:], axis=1), 1.0, atol=1e-14)


def test_a_ball_on_a_table_turns_about_the_axes_of_the_world_and_slides_along_two():
    twists = canonical_twists(mixed(SPACES["ball on a table"], 3), FRAME)
    np.testing.assert_array_equal(twists[:3, :3], np.eye(3))
    np.testing.assert_array_equal(np.abs(twists[3:]), [[0, 0, 0, 0, 1, 0], [0, 0, 0, 1, 0, 0]])


def test_what_hardly_turns_is_left_as_it_was_found():
    leaning = np.array([1e-7, 0, 0, 0, 0, 1.0])
    basis = span(np.array([slide(X), leaning / np.linalg.norm(leaning)]).T)
    np.testing.assert_allclose(scaled(canonical_twists(basis, FRAME).T, FRAME), basis, atol=1e-15)


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (3e-18, -1e-17, 0.0), (0.0, 2e-19, -4e-16)])
def test_rounding_beside_the_origin_is_not_shown(place):
    frame = Frame(np.zeros(3), 0.05)
    basis = rotation(Z, np.array(place), frame)[:, None]
    assert re.findall(r"-?\d[\d.e-]*", motions_in_words(basis, frame)) == ["0", "0", "1", "0", "0", "0"]
