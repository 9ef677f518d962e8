"""Pairs that are decided in step are decided as each is alone, to the last bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.diagonal import first
from support.patches import Z, cone, cylinder, plane, ring, sphere

from kinform.foundation.lockstep import run_in_lockstep
from kinform.kinematics.joints.pair.in_step import Remainder, remains
from kinform.kinematics.joints.pair.question import Question, answer_each
from kinform.model.tolerances import Tolerances
from kinform.reuse.packing import pack

X = np.eye(3)[0]
TABLE = {
    "hinge": [cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)],
    "on one shoulder": [cylinder(), ring((0, 0, 0.01))],
    "in a bore": [cylinder()],
    "at a stop": [cylinder(), ring((0, 0, 0.01)), plane((0.02, 0, 0), X, (0.001, 0.001))],
    "keyed": [cylinder(arc=(0.3, 6.0)), plane((0.004, 0, 0), X, (0.002, 0.01))],
    "ball": [sphere(cap=0.3)],
    "ball in a tube": [sphere(cap=0.9), cylinder(0.005, 0.02)],
    "table": [plane()],
    "slot": [plane(), plane((0.01, 0, 0.005), X), plane((-0.01, 0, 0.005), -X)],
    "taper": [cone(half_angle=np.radians(1))],
    "beside each other": [cylinder(0.002, 0.006, point=(-0.02, 0, 0)), cylinder(0.002, 0.006, point=(0.0, 1e-5, 0))],
    "nothing": [dataclasses.replace(plane(), area=0.0)],
    "a sliver": [cylinder(arc=(0.0, 0.2))],
}


def questions():
    """Every pair where it is, and moved and turned about: of the same shapes, with other numbers."""
    rng = np.random.default_rng(1)
    out = []
    for patches in TABLE.values():
        out.append(Question(tuple((patch, False) for patch in patches), Tolerances(), 5e-4, 0.1))
        for _ in range(2):
            R, shift = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3)
            moved = [
                dataclasses.replace(
                    patch, points=patch.points @ R.T + shift, normals=patch.normals @ R.T, axis=R @ patch.axis,
                    point=R @ patch.point + shift,
                )
                for patch in patches
            ]  # fmt: skip
            out.append(Question(tuple((patch, True) for patch in moved), Tolerances(), 5e-4, 0.1))
    return out


@pytest.mark.parametrize("seed", first(2, range(6)))
def test_an_answer_does_not_depend_on_what_is_asked_with_it(seed):
    rng = np.random.default_rng(seed)
    asked = questions()
    alone = [pack(answer_each([question])[0]) for question in asked]
    chosen = rng.permutation(len(asked))[: int(rng.integers(2, len(asked) + 1))].tolist()
    assert [pack(answer) for answer in answer_each([asked[k] for k in chosen])] == [alone[k] for k in chosen]


def test_answers_of_the_table_are_not_all_the_same():
    types = {None if answer.joint is None else answer.joint.type for answer in answer_each(questions())}
    assert {None, "revolute", "cylindrical", "prismatic", "spherical", "planar"} <= types


def remainder(rng, count, known):
    basis = np.linalg.qr(rng.normal(size=(6, known)))[0] if known else np.zeros((6, 0))
    return Remainder(rng.normal(size=(count, 6)), rng.random(count) + 0.1, basis, 1e-4)


def test_what_is_known_to_be_free_remains_and_few_rows_leave_the_rest():
    rng = np.random.default_rng(0)
    asked = [remainder(rng, count, known) for count in (1, 4, 6, 30) for known in (0, 1, 2, 5)]
    for question, (basis, values, (turns, right), _) in zip(asked, remains(asked), strict=True):
        held = question.rows - question.rows @ question.basis @ question.basis.T
        assert basis.shape[1] == 6 - np.linalg.matrix_rank(held)
        assert np.abs(held @ basis).max(initial=0.0) < 1e-12
        assert np.allclose(basis @ (basis.T @ question.basis), question.basis)
        assert (np.diff(values) >= 0.0).all()
        assert np.allclose(right.T @ right, np.eye(basis.shape[1]))
        assert np.allclose(np.linalg.norm(basis[:3] @ right.T, axis=0)[: len(turns)], turns)


def test_what_remains_beyond_freedoms_is_what_they_lack_of_it():
    rng = np.random.default_rng(0)
    asked = []
    for count in (1, 4, 6, 30):
        for known in (0, 1, 2, 5, 6):
            of_known = remainder(rng, count, known)
            asked += [dataclasses.replace(of_known, beyond=of_known.basis[:, :n]) for n in range(known + 1)]
    for question, (basis, *_, freed) in zip(asked, remains(asked), strict=True):
        assert freed.shape[1] == basis.shape[1] - question.beyond.shape[1]
        both = np.hstack([question.beyond, freed])
        assert np.allclose(both.T @ both, np.eye(both.shape[1]))
        assert np.allclose(both @ (both.T @ basis), basis)


def test_ways_of_different_lengths_each_get_their_own_answers():
    rng = np.random.default_rng(0)

    def way(length):
        asked = [remainder(rng, 8, k % 3) for k in range(length)]
        got = []
        for question in asked:
            basis, *_ = yield question
            got.append(basis.shape[1])
        return [question.basis.shape[1] for question in asked], got

    for wanted, got in run_in_lockstep([way(length) for length in (0, 3, 1, 5)], remains):
        assert got == wanted
