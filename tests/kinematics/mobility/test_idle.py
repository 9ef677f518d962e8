"""Turns that nobody sees, of small assemblies: what counts as idle and what does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.diagonal import diagonal
from support.solids import ball, block, box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform.kinematics import Motions, derive

POSES = [(0, 1e-3), (None, 1e-3), (1, 1.0)]


def found(solids, ground, pose=(None, 1e-3), joints=()):
    """The kinematics of solids under one pose, with joints (name, between, type) about its z axis."""
    seed, scale = pose
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground=ground)
    wanted = tuple(intended(name, *between, kind, X[:3, 2], X[:3, 3]) for name, between, kind in joints)
    made = replace(made, function=replace(made.function, joints=wanted))
    return derive(made, *touching_of(made))


def counts(kinematics):
    """All, idle and effective freedoms, and the idle bodies."""
    mobility = kinematics.mobility
    named = [freedom for freedom in mobility.named if freedom.idle]
    assert len(named) == mobility.idle and {freedom.body for freedom in named} == set(mobility.idle_bodies)
    return mobility.instantaneous, mobility.idle, mobility.effective, mobility.idle_bodies


def butt_hinge(pin=2.0, knuckles=3):
    """A hinge with a headed pin, knuckle by knuckle on the one leaf and the other."""
    leaf = {"leaf_a": box(9, 40, -1, 1, 0, 10 * knuckles), "leaf_b": box(-40, -9, -1, 1, 0, 10 * knuckles)}
    for k in range(knuckles):
        side, sign = ("leaf_b", -1) if k % 2 == 0 else ("leaf_a", 1)
        arm = sorted((sign * 3, sign * 10))
        leaf[side] += rod(6, 10 * k, 10 * k + 10) + box(*arm, -1, 1, 10 * k, 10 * k + 10)
    shank, high = rod(pin, 0, 10 * knuckles), 10 * knuckles
    leaf = {name: solid - rod(pin, -1, high + 1) for name, solid in leaf.items()}
    return leaf | {"pin": shank + rod(pin + 2, -2, 0) + rod(pin + 2, high, high + 2)}


@diagonal(pose=POSES, ground=["leaf_b", "leaf_a", None], knuckles=[3, 2, 5])
def test_the_leaf_of_a_hinge_counts_and_its_pin_does_not(pose, ground, knuckles):
    assert counts(found(butt_hinge(knuckles=knuckles), ground, pose)) == (2, 1, 1, ("pin",))


def test_a_pin_is_idle_until_the_function_names_it():
    swing, spin = ("swing", ("leaf_a", "leaf_b"), "revolute"), ("spin", ("leaf_b", "pin"), "revolute")
    assert counts(found(butt_hinge(), "leaf_b", joints=[swing])) == (2, 1, 1, ("pin",))
    assert counts(found(butt_hinge(), "leaf_b", joints=[swing, spin])) == (2, 0, 2, ())


def test_a_pin_that_is_taken_as_ground_turns_idly_in_the_rest():
    """The leaves turn together about it, where no ground is stated, as it turns alone, where one of them is ground."""
    heavy = butt_hinge(pin=2.0) | {"pin": butt_hinge()["pin"] + rod(30, -30, -2) + rod(30, 32, 60)}
    K = found(heavy, None)
    assert next(body.name for body in K.bodies if body.ground) == "pin"
    assert counts(K) == (2, 1, 1, ("pin",))
    (spin,) = (freedom for freedom in K.mobility.named if freedom.idle)
    assert set(Motions.of(K).twists(spin)) == {"leaf_a", "leaf_b"}
    assert counts(found(heavy, "pin")) == (2, 0, 2, ())


AXLE = rod(4, -5, 8) + rod(8, -8, 0) + rod(8, 6, 8)
WHEEL = rod(20, 0, 6) - rod(4, -1, 7)


def wheel(shape=WHEEL, width=30.0):
    return {"base": box(-width, width, -width, width, -20, -8) + AXLE, "wheel": shape}


@diagonal(pose=POSES, width=[30.0, 9.0, 60.0], ground=["base", None, None])
def test_a_smooth_wheel_is_idle_whichever_is_ground(pose, width, ground):
    """Where no ground is stated it is the heavier one."""
    K = found(wheel(width=width), ground, pose)
    assert counts(K)[:3] == (1, 1, 0)


@pytest.mark.parametrize(
    "feature",
    [
        box(19, 23, -2, 2, 0, 6) + box(-23, -19, -2, 2, 0, 6),
        rod(3, 5, 15).translate((14, 0, 0)),
        rod(20.4, 0, 6).translate((1, 0, 0)) - rod(4, -1, 7),
    ],
    ids=["lugs", "crank pin", "eccentric"],
)
def test_a_wheel_that_is_seen_to_turn_counts(feature):
    assert counts(found(wheel(WHEEL + feature), "base")) == (1, 0, 1, ())


def test_a_wheel_with_holes_counts():
    shape = WHEEL - rod(2, -1, 7).translate((12, 0, 0))
    assert counts(found(wheel(shape), "base")) == (1, 0, 1, ())


def test_a_turn_that_is_stated_is_not_idle():
    assert counts(found(wheel(), "base", joints=[("spin", ("base", "wheel"), "revolute")])) == (1, 0, 1, ())


def test_a_ram_turns_idly_and_its_slide_counts():
    barrel = block(30, 30, 60) - rod(8, -99, 99)
    assert counts(found({"barrel": barrel, "ram": rod(8, -20, 90)}, "barrel")) == (2, 1, 1, ("ram",))


def test_a_puck_on_a_table_turns_idly_and_a_block_does_not():
    table = box(-50, 50, -50, 50, -5, 0)
    assert counts(found({"puck": rod(10, 0, 4), "table": table}, "table")) == (3, 1, 2, ("puck",))
    assert counts(found({"puck": block(20, 20, 4).translate((0, 0, 2)), "table": table}, "table")) == (3, 0, 3, ())


SHANK = rod(3, 0, 40)


@pytest.mark.parametrize(
    ("shape", "idle"), [(ball(10), 3), (ball(10) + SHANK, 1), (ball(10) + SHANK + box(-3, 9, -3, 3, 30, 40), 0)]
)
def test_a_ball_in_its_socket_is_idle_as_far_as_its_shank_lets(shape, idle):
    socket = block(40, 40, 24) - ball(10) - rod(7, 0, 30)
    assert counts(found({"ball": shape, "socket": socket}, "socket"))[:3] == (3, idle, 3 - idle)


@pytest.mark.parametrize(
    ("head", "idle"),
    [(rod(6 / np.cos(np.pi / 6), 10, 14, 6), 1), (rod(6, 10, 14), 1), (box(-6, 6, -6, 6, 10, 14), 0)],
    ids=["hexagon", "round", "square"],
)
def test_the_head_of_a_bolt_says_whether_it_is_idle(head, idle):
    plate = box(-30, 30, -30, 30, 0, 10) - rod(3, -1, 11)
    bolt = rod(3, -6, 10) + rod(5, -6, 0) + head
    assert counts(found({"bolt": bolt, "plate": plate}, "plate"))[:3] == (1, idle, 1 - idle)


def test_both_turns_of_a_universal_joint_count():
    """The cross is round about either axis and about neither as a whole."""
    bars = rod(3, -14, 14)
    along, across = bars.rotate((0, 90, 0)), bars.rotate((90, 0, 0))
    fork = box(10, 14, -5, 5, -5, 30) + box(-14, -10, -5, 5, -5, 30) + box(-14, 14, -5, 5, 22, 30)
    solids = {
        "input": fork - along,
        "cross": block(20, 20, 20) + along + across,
        "output": fork.rotate((180, 0, 90)) - across,
    }
    assert counts(found(solids, "input")) == (2, 0, 2, ())
    assert counts(found(solids, None))[1:3] == (0, 2)


def test_a_ball_that_lies_on_one_body_rolls():
    table = box(-50, 50, -50, 50, -5, 0)
    assert counts(found({"ball": ball(10).translate((0, 0, 10)), "table": table}, "table"))[1] == 0


def test_a_coarse_wheel_is_a_wheel():
    shape = rod(20, 0, 6, 9) - rod(4, -1, 7)
    assert counts(found(wheel(shape), "base")) == (1, 1, 0, ("wheel",))
