"""A joint that the function states between two bodies, and a bush or a pin carries that it does not name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from generators.involute import Gear, mesh_angle
from support.assemblies import HERE, assembly
from support.diagonal import diagonal
from support.diagonal import first as first_of
from support.solids import ball, block, box, extrusion, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.consistency.comparisons.answers import answer_of
from kinform.consistency.comparisons.intended_joints import compare_joints
from kinform.consistency.context import Context
from kinform.design import Design
from kinform.model.function import Function, IntendedJoint

BASE = block(60, 60, 20) - rod(14, -20, 20, 48)
BUSH = (rod(14, -10, 10, 48) + rod(18, 10, 13, 48) + rod(18, -13, -10, 48)) - rod(8, -20, 20, 48)
SHAFT = rod(8, -16, 16, 48)
COLLARS = rod(12, 13, 16, 48) + rod(12, -16, -13, 48)


def derived(type_, shaft, X=None, scale=1e-3):
    """Kinematics, and the comparison and the answer of the stated joint."""
    return answered(type_, {"base": BASE, "bush": BUSH, "shaft": shaft}, X, scale)


def answered(type_, solids, X=None, scale=1e-3):
    """The same of a base and a shaft among these solids."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground="base")
    at = X[:3, 3]
    joint = IntendedJoint("spin", ("base", "shaft"), type_, X[:3, 2], None, at, None, None, HERE.file, None)
    made = replace(made, function=Function(joints=(joint,)))
    found, touching = touching_of(made)
    K = kinematics.derive(made, found, touching)
    (comparison,) = compare_joints(made, touching, K, [joint])
    return K, comparison, answer_of(Context(Design(made, found, touching, K)), comparison).answer


POSES = [(None, 1e-3), (0, 1e-3), (1, 1.0)]


def placed_at(seed, scale):
    return {"X": np.eye(4) if seed is None else random_pose(np.random.default_rng(seed)), "scale": scale}


@pytest.mark.parametrize("pose", first_of(2, POSES[::-1]))
def test_the_spin_that_is_stated_is_not_idle_and_that_of_the_bush_is(pose):
    K, _, answer = derived("revolute", SHAFT + COLLARS, **placed_at(*pose))
    assert {joint.bodies for joint in K.joints} == {("base", "bush"), ("bush", "shaft")}
    assert (K.mobility.instantaneous, K.mobility.idle, K.mobility.effective) == (2, 1, 1)
    assert K.mobility.idle_bodies == ("bush",)
    assert answer == "agrees"


@diagonal(2, pose=POSES, off=[0.0, 3.0])
def test_a_shaft_that_may_slide_in_its_bush_may_turn_too(pose, off):
    """Where the middles of all joints are one place, rounding is not the size of what moves."""
    placed = placed_at(*pose)
    K, comparison, answer = derived("cylindrical", SHAFT.translate((0, 0, off)), **placed)
    assert (comparison.type, comparison.through, answer) == ("cylindrical", ("bush",), "agrees")
    assert (K.mobility.idle, K.mobility.effective) == (1, 2)
    _, comparison, answer = derived("revolute", SHAFT.translate((0, 0, off)), **placed)
    assert (comparison.type, answer) == ("cylindrical", "not held")
    _, comparison, answer = derived("prismatic", SHAFT.translate((0, 0, off)), **placed)
    assert (comparison.type, answer) == ("cylindrical", "not held")


@diagonal(2, pose=POSES, count=[2, 3])
def test_what_only_idle_pins_move_is_fixed(pose, count):
    """Two plates on rivets that may spin: the rounding of their spins moves no plate."""
    solids = {"base": box(-30, 30, -10, 10, 0, 4), "shaft": box(-30, 30, -10, 10, 6, 10)}
    rivet = rod(3, 0, 10, 48) + rod(5, -2, 0, 48) + rod(5, 4, 6, 48) + rod(5, 10, 12, 48)
    for k in range(count):
        pin = rivet.translate((20.0 * k - 20.0, 0, 0))
        solids = {name: solid if name[:5] == "rivet" else solid - pin for name, solid in solids.items()}
        solids[f"rivet{k}"] = pin
    for type_, expected in (("fixed", "agrees"), ("prismatic", "contradicts")):
        _, comparison, answer = answered(type_, solids, **placed_at(*pose))
        assert (comparison.type, answer) == ("fixed", expected)


def train(stages, wide=7):
    """A wheel on a base, and gears that nobody names, each 50/12 times as fast as the one before."""
    large, small = Gear(50), Gear(12)
    gears, turn, apart = [extrusion(large.outline(0.1), 0, wide - 1)], 0.1, large.pitch_radius + small.pitch_radius
    for k in range(stages):
        low = k * wide
        pinion = extrusion(small.outline(mesh_angle(large, small, turn)), low, low + wide)
        turn = 0.37 * k
        gears.append(pinion + extrusion(large.outline(turn), low + wide, low + 2 * wide - 1))
    base, solids = box(-30, apart * stages + 30, -30, 30, -12, -6), {}
    for k, gear in enumerate(gears):
        low, high = (gear.bounding_box()[at] for at in (2, 5))
        base += (rod(2, -7, high + 2, 48) + rod(4, -7, low, 48) + rod(4, high, high + 2, 48)).translate(
            (apart * k, 0, 0)
        )
        solids[f"gear{k}" if k else "shaft"] = (gear - rod(2, -9, high + 9, 48)).translate((apart * k, 0, 0))
    return {"base": base, **solids}


@pytest.mark.parametrize("stages", first_of(1, [2, 1, 5]))
def test_gears_that_are_fast_are_not_wedged(stages):
    _, comparison, answer = answered("revolute", train(stages), random_pose(np.random.default_rng(0)))
    assert comparison.through == tuple(f"gear{k + 1}" for k in range(stages))
    assert answer == "agrees", comparison.reason


@pytest.mark.parametrize("pose", first_of(1, POSES[1:] + POSES[:1]))
def test_balls_in_grooves_that_meet_hold(pose):
    """Maxwell's coupling: each ball may go along its grooves, and together they let nothing move."""
    cylinder = lambda low: rod(30, low, low + 10, 96)
    half = 2.0 * np.sqrt(2.0)
    outline = [(0, -half), (half, 0), (0, half), (-half, 0)]
    solids = {"base": cylinder(-11), "shaft": cylinder(1)}
    for k in range(3):
        groove = extrusion(outline, -8, 8).rotate((0, 90, 0)).translate((20, 0, 0)).rotate((0, 0, 120 * k))
        solids = {name: solid if name[:4] == "ball" else solid - groove for name, solid in solids.items()}
        solids[f"ball{k}"] = ball(2, 32).translate((20, 0, 0)).rotate((0, 0, 120 * k))
    _, comparison, answer = answered("fixed", solids, **placed_at(*pose))
    assert (comparison.type, answer) == ("fixed", "agrees")
