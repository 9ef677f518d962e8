"""A joint that only points and lines hold, as the balls of a bearing do: a function that states it is right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.assemblies import HERE, assembly
from support.diagonal import diagonal
from support.solids import ball, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import consistency, kinematics
from kinform.consistency.comparisons.answers import answer_of
from kinform.consistency.comparisons.intended_joints import compare_joints
from kinform.consistency.context import Context
from kinform.design import Design
from kinform.model.function import Function, IntendedJoint

RADIUS, BALL = 15.0, 3.0
"""mm: of the ring of balls, and of each."""


def bearing(groove):
    """Two rings with grooves of a radius (mm), and six balls."""
    turn = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    outline = np.stack([RADIUS + groove * np.cos(turn), groove * np.sin(turn)], axis=1)
    torus = Manifold.revolve(CrossSection([outline]), 64)
    inner = rod(13.8, -5, 5, 64) - rod(8, -6, 6, 64) - torus
    outer = rod(22, -5, 5, 64) - rod(16.2, -6, 6, 64) - torus
    at = [RADIUS * np.array([np.cos(a), np.sin(a), 0.0]) for a in np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False)]
    return {"inner": inner, "outer": outer} | {f"ball{k}": ball(BALL, 32).translate(p) for k, p in enumerate(at)}


def derived(groove, type_, X=None, scale=1e-3):
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in bearing(groove).items()))
    joint = IntendedJoint(
        "spin", ("outer", "inner"), type_, X[:3, 2], None, X[:3, 3], None, None, HERE.file, None
    )  # fmt: skip
    made = replace(made, function=Function(joints=(joint,), complete=("",)))
    found, touching = touching_of(made)
    K = kinematics.derive(made, found, touching)
    answer = answer_of(Context(Design(made, found, touching, K)), *compare_joints(made, touching, K, [joint])).answer
    codes = {f.code for f in consistency.check(Design(made, found, touching, K)).findings}
    return K, answer, codes & {"KF401", "KF402", "KF414"}


@diagonal(groove=[BALL + 0.05, BALL], seed=[None, 0])
def test_balls_hold_the_rings_of_a_bearing(groove, seed):
    X = None if seed is None else random_pose(np.random.default_rng(seed))
    K, answer, codes = derived(groove, "revolute", X)
    (joint,) = K.joints
    assert (joint.type, joint.status) == ("revolute", "inferred")
    assert "function" in joint.evidence
    assert joint.patches
    assert (answer, codes) == ("agrees", set())


@pytest.mark.parametrize("type_", ["prismatic", "cylindrical"])
def test_balls_hold_no_other_motion(type_):
    _, answer, codes = derived(BALL + 0.05, type_)
    assert answer == "contradicts"
    assert codes == {"KF402"}
