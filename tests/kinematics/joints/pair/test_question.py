"""Pairs that are asked about together are decided as each is alone, to the last bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.diagonal import first
from support.patches import Z, cone, cylinder, plane, ring, sphere

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
