"""A joint that the function states between two bodies, and a bush or a pin carries that it does not name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import HERE, assembly
from support.solids import block, part, random_pose, rod

from kinform import contacts, kinematics, surfaces
from kinform.consistency.comparisons.answers import answer_of
from kinform.consistency.comparisons.intended_joints import compare_joints
from kinform.model.function import Function, IntendedJoint

BASE = block(60, 60, 20) - rod(14, -20, 20, 48)
BUSH = (rod(14, -10, 10, 48) + rod(18, 10, 13, 48) + rod(18, -13, -10, 48)) - rod(8, -20, 20, 48)
SHAFT = rod(8, -16, 16, 48)
COLLARS = rod(12, 13, 16, 48) + rod(12, -16, -13, 48)


def derived(type_, shaft, X=None, scale=1e-3):
    """Kinematics, and the comparison and the answer of the stated joint."""
    X = np.eye(4) if X is None else X
    solids = {"base": BASE, "bush": BUSH, "shaft": shaft}
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground="base")
    at = X[:3, 3]
    joint = IntendedJoint("spin", ("base", "shaft"), type_, X[:3, 2], None, at, None, None, HERE.file, None)
    made = replace(made, function=Function(joints=(joint,)))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    K = kinematics.derive(made, found, touching)
    (comparison,) = compare_joints(made, touching, K, [joint])
    return K, comparison, answer_of(made, comparison).answer


POSES = [(None, 1e-3), (0, 1e-3), (1, 1.0)]


@pytest.fixture(params=POSES, ids=["as drawn", "turned", "large"])
def placed(request):
    seed, scale = request.param
    return {"X": np.eye(4) if seed is None else random_pose(np.random.default_rng(seed)), "scale": scale}


def test_the_spin_that_is_stated_is_not_idle_and_that_of_the_bush_is(placed):
    K, _, answer = derived("revolute", SHAFT + COLLARS, **placed)
    assert {joint.bodies for joint in K.joints} == {("base", "bush"), ("bush", "shaft")}
    assert (K.mobility.instantaneous, K.mobility.idle, K.mobility.effective) == (2, 1, 1)
    assert K.mobility.idle_bodies == ("bush",)
    assert answer == "agrees"


@pytest.mark.parametrize("off", [0.0, 3.0])
def test_a_shaft_that_may_slide_in_its_bush_may_turn_too(placed, off):
    """Where the middles of all joints are one place, rounding is not the size of what moves."""
    K, comparison, answer = derived("cylindrical", SHAFT.translate((0, 0, off)), **placed)
    assert (comparison.type, comparison.through, answer) == ("cylindrical", ("bush",), "agrees")
    assert (K.mobility.idle, K.mobility.effective) == (1, 2)
    _, comparison, answer = derived("revolute", SHAFT.translate((0, 0, off)), **placed)
    assert (comparison.type, answer) == ("cylindrical", "not held")
    _, comparison, answer = derived("prismatic", SHAFT.translate((0, 0, off)), **placed)
    assert (comparison.type, answer) == ("cylindrical", "not held")
