"""The subgroups of rigid motions by name, and spaces of motions in words."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinform.foundation.algebra.screws import Frame, rotation, span, translation
from kinform.kinematics.screws.wording import group_of, motions_in_words

X, Y, Z = np.eye(3)
P = np.array([0.1, -0.02, 0.03])
FRAME = Frame(np.array([0.01, 0.02, 0.03]), 0.05)


def turn(axis, point=P, pitch=0.0):
    return lambda R: rotation(R @ axis, R @ point, FRAME, pitch)


def slide(axis):
    return lambda R: translation(R @ axis)


EVERY = [turn(X), turn(Y), turn(Z)]
GROUPS = {
    "identity": [],
    "revolute": [turn(Z)],
    "prismatic": [slide(X)],
    "screw": [turn(Z, pitch=0.004)],
    "cylindrical": [turn(Z), slide(Z)],
    "planar translation": [slide(X), slide(Y)],
    "planar": [turn(Z), slide(X), slide(Y)],
    "planar screw": [turn(Z, pitch=0.004), slide(X), slide(Y)],
    "spherical": EVERY,
    "spatial translation": [slide(X), slide(Y), slide(Z)],
    "Schoenflies": [turn(Z), slide(X), slide(Y), slide(Z)],
    "all rigid motions": [*EVERY, slide(X), slide(Y), slide(Z)],
}
NO_GROUPS = {
    "two crossing turns": [turn(X), turn(Z)],
    "two parallel turns": [turn(Z), turn(Z, P + 0.1 * X)],
    "a turn and a slide askew": [turn(Z), slide((X + Z) / np.sqrt(2))],
    "two skew turns": [turn(Z), turn(X, P + 0.1 * Y)],
    "ball on a plane": [*EVERY, slide(X), slide(Y)],
    "three turns without a common point": [turn(X), turn(Y), turn(Z, P + 0.05 * X)],
    "two turns and a slide": [turn(X), turn(Z), slide(Y)],
}


def space(motions, R, mix=0):
    """Orthonormal basis of the span, in another mixture for each `mix`."""
    if not motions:
        return np.zeros((6, 0))
    basis = span(np.array([motion(R) for motion in motions]).T)
    turned = np.linalg.qr(np.random.default_rng(mix).normal(size=(basis.shape[1],) * 2))[0]
    return basis @ turned


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("name", GROUPS)
def test_a_subgroup_has_its_name_in_any_pose_and_basis(name, seed):
    R = Rotation.random(random_state=seed).as_matrix()
    assert group_of(space(GROUPS[name], R, seed), FRAME) == name


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("name", NO_GROUPS)
def test_what_is_no_subgroup_has_no_name(name, seed):
    R = Rotation.random(random_state=seed).as_matrix()
    assert group_of(space(NO_GROUPS[name], R, seed), FRAME) == ""


def numbers(text):
    return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", text)]


def test_the_numbers_are_those_of_axis_point_and_lead():
    still = np.eye(3)
    assert numbers(motions_in_words(space([turn(Z)], still), FRAME)) == [0, 0, 1, 100, -20, 30]
    assert numbers(motions_in_words(space([turn(Z, pitch=0.004)], still, 1), FRAME)) == [0, 0, 1, 100, -20, 30, 4]
    assert numbers(motions_in_words(space([slide(Y)], still), FRAME)) == [0, 1, 0]
    assert numbers(motions_in_words(space([turn(X), turn(Z)], still, 2), FRAME))[-3:] == [100, -20, 30]
    assert numbers(motions_in_words(np.zeros((6, 0)), FRAME)) == []
