"""Loops that stated joints would close: which can move, and legs that only touch."""

from __future__ import annotations

import numpy as np
import pytest
from kinematics.partition.test_bodies import joint
from support.assemblies import assembly
from support.solids import box, part, rod

from kinform import contacts, surfaces
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.partition import partition
from kinform.kinematics.partition.loops import Loops
from kinform.model.function import Function


def turn(x, y, axis=(0, 0, 1), z=0.0):
    return joint("", ("a", "b"), axis=axis, point=(x, y, z))


SLIDE = joint("", ("a", "b"), "prismatic", (1, 0, 0), None)
BALL = joint("", ("a", "b"), "spherical", (0, 0, 1), (0.5, 0.2, 0.0))
ROUND = ((0, 1), (1, 2), (2, 3), (0, 3))


@pytest.mark.parametrize(
    ("joints", "sides", "expected"),
    [
        ([turn(0, 0), turn(0, 1), turn(2, 1.5), turn(2, 0)], ROUND, True),
        ([turn(0, 0), turn(1, 0), turn(3, 0), SLIDE], ROUND, True),  # a crank at its dead centre: the slide stands
        ([turn(0, 0), turn(0, 1), turn(2, 1.5)], ((0, 1), (1, 2), (0, 2)), False),
        ([turn(0, 0), turn(0, 0, z=0.3)], ((0, 1), (0, 1)), True),  # two hinges of a door
        ([turn(0, 0), turn(0, 0.1)], ((0, 1), (0, 1)), False),
        ([turn(0, 0), turn(0, 1), turn(2, 1.5), turn(2, 0, (0, 0.6, 0.8))], ROUND, False),
        ([turn(0, 0), BALL, BALL, turn(2, 0, (0, 0.6, 0.8))], ROUND, True),
        ([turn(0, 0), turn(1, 0)], ((0, 1), (1, 1)), False),  # both sides one body
        ([turn(0, 0), turn(1, 0)], ((0, 1), (1, 2)), True),  # nothing closes
    ],
)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 30.0])
def test_a_loop_moves_if_each_of_its_joints_does(joints, sides, expected, scale):
    twists = [joint_twists(one if one.point is None else _scaled(one, scale)) for one in joints]
    assert Loops(twists, sides, 3.0 * scale, connected=False).move(range(4)) is expected


def _scaled(one, scale):
    return joint(one.name, one.between, one.type, one.axis, scale * one.point)


def test_a_joint_without_a_place_closes_no_loop():
    twists = [None, *(joint_twists(turn(k, k * k)) for k in range(3))]
    assert not Loops(twists, ROUND, 3.0, connected=False).move(range(4))


def legs():
    """A trunk with two legs of two links each on parallel axes; the feet touch between them, flat on flat."""
    solids = {"trunk": box(-60, 60, -10, 10, 0, 20)}
    joints = []
    for side, name in ((-1, "left"), (1, "right")):
        x = 50 * side
        hole = rod(4, -10, 10, 48).rotate((90, 0, 0))
        solids[f"thigh_{name}"] = (box(x - 8, x + 8, 10, 16, -60, 20) + hole.translate((x, 0, 10))).translate((0, 0, 0))
        solids["trunk"] -= rod(4.02, -10, 10, 48).rotate((90, 0, 0)).translate((x, 0, 10))
        shank = box(*sorted((0, x + 8 * side)), 16, 22, -60, -44)
        shank += rod(4, -22, -10, 48).rotate((90, 0, 0)).translate((x, 0, -52))
        solids[f"shank_{name}"] = shank
        solids[f"thigh_{name}"] -= rod(4.02, -30, 0, 48).rotate((90, 0, 0)).translate((x, 0, -52))
        joints += [
            joint(f"hip_{name}", ("trunk", f"thigh_{name}"), axis=(0, 1, 0), point=(1e-3 * x, 0, 0.01)),
            joint(f"knee_{name}", (f"thigh_{name}", f"shank_{name}"), axis=(0, 1, 0), point=(1e-3 * x, 0, -0.052)),
        ]
    return solids, tuple(joints)


def test_feet_that_touch_stay_two_bodies_though_the_loop_could_move():
    """Names alone connect all joints, and no joint needs the feet to be one."""
    solids, joints = legs()
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()))
    whole = type(whole)(
        **{f: getattr(whole, f) for f in whole.__dataclass_fields__}
        | {"function": Function(joints=joints, complete=("",))}
    )
    found = {p.mesh.digest: surfaces.recover(p.mesh, whole.tolerances) for p in whole.parts}
    touching = contacts.find(whole, found)
    assert ("shank_left", "shank_right") in {patch.parts for patch in touching.patches}
    parts = {frozenset(one) for one in partition(whole, touching, joints).parts}
    assert parts == {frozenset([name]) for name in solids}
