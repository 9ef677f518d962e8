"""Joints whose values the function couples move along where the range of one of them is looked for."""

from __future__ import annotations

from dataclasses import replace
from math import acos, pi

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import collisions, kinematics
from kinform.model.function import Coupling

APART, WIDE = 30.0, 10.0


def ranges_of(solids, joints, couplings, seed=None, scale=1e-3):
    """The ranges, by the designer's name and in its sense, of joints (name, between, type, axis, point in mm)."""
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed), 100 * scale)
    wanted = [
        intended(name, *between, kind, X[:3, :3] @ np.array(axis, float), X[:3, :3] @ (scale * np.array(at)) + X[:3, 3])
        for name, between, kind, axis, at in joints
    ]
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground="base", joints=wanted)
    stated = tuple(Coupling(names, ratio, "m.toml", 1) for names, ratio in couplings)
    made = replace(made, function=replace(made.function, couplings=stated))
    known, touching = touching_of(made)
    derived = kinematics.derive(made, known, touching)
    found = {item.joint: item for item in collisions.ranges(made, known, touching, derived)}
    out = {}
    for one in wanted:
        (joint,) = derived.joints_between(*(derived.body_of(side).name for side in one.between))
        sense = float(np.sign(joint.axis @ one.axis)) * (1.0 if joint.bodies[0] == one.between[0] else -1.0)
        ends = (found[joint.name].lower, found[joint.name].upper)
        out[one.name] = [(end.status, end.value and sense * end.value) for end in ends[:: int(sense)]]
    return out


def levers():
    """Two bars side by side on collared pins of one base."""
    base = box(-20, APART + 20, -20, 20, -12, -6)
    solids = {}
    for name, x in (("left", 0.0), ("right", APART)):
        base += rod(3, -7, 5, 64).translate((x, 0, 0)) + rod(5, 4, 7, 64).translate((x, 0, 0))
        base += rod(5, -7, 0, 64).translate((x, 0, 0))
        bar = rod(WIDE / 2, 0, 4, 96) + box(-WIDE / 2, WIDE / 2, 0, 80, 0, 4)
        solids[name] = (bar - rod(3, -1, 5, 64)).translate((x, 0, 0))
    return {"base": base, **solids}


LEVERS = [
    ("a", ("base", "left"), "revolute", (0, 0, 1), (0.0, 0.0, 0.0)),
    ("b", ("base", "right"), "revolute", (0, 0, 1), (APART, 0.0, 0.0)),
]


@diagonal(seed=[None, 3], scale=[1e-3, 1.0])
def test_parallel_bars_that_move_together_lie_on_each_other_in_the_end(seed, scale):
    """Sides of bars at a distance d and w wide meet where both have turned by acos(w / d)."""
    found = ranges_of(levers(), LEVERS, [(("b", "a"), 1.0)], seed, scale)
    for name in ("a", "b"):
        (low, lower), (high, upper) = found[name]
        assert (low, high) == ("found", "found")
        assert (-lower, upper) == pytest.approx([acos(WIDE / APART)] * 2, abs=2e-3)


def test_alone_one_of_them_meets_the_other_at_once():
    found = ranges_of(levers(), LEVERS, [])
    assert min(abs(value) for _, value in found["a"]) < 0.5 * acos(WIDE / APART)


def test_bars_that_turn_away_from_each_other_meet_beyond_and_by_their_ratio():
    found = ranges_of(levers(), LEVERS, [(("b", "a"), -1.0)])
    for (_, own), (_, other) in zip(found["a"], found["b"][::-1], strict=True):
        assert own == pytest.approx(-other, abs=1e-4)
    # towards each other their sides meet in the middle, where each has turned by half of what one alone may
    assert 0.0 < -found["a"][0][1] < pi


def jaws():
    """Two jaws on one rail, 20 mm apart, that may slide off its ends."""
    rail = box(-100, 100, -5, 5, 0, 10)
    hole = box(-101, 101, -5, 5, 0, 10)
    jaw = box(-30, -10, -12, 12, -8, 18) - hole
    return {"base": rail, "left": jaw, "right": jaw.translate((40, 0, 0))}


@pytest.mark.parametrize("seed", [None, 5])
def test_jaws_that_close_together_meet_halfway(seed):
    joints = [(n, ("base", side), "prismatic", (1, 0, 0), (0, 0, 0)) for n, side in (("a", "left"), ("b", "right"))]
    found = ranges_of(jaws(), joints, [(("b", "a"), -1.0)], seed)
    assert found["a"][1][1] == pytest.approx(0.01, rel=1e-3)
    assert found["b"][0][1] == pytest.approx(-0.01, rel=1e-3)
    assert found["a"][0][0] == found["b"][1][0] == "unbounded"
    alone = ranges_of(jaws(), joints, [], seed)
    assert alone["a"][1][1] == pytest.approx(0.02, rel=1e-3)
