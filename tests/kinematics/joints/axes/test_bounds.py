"""Nothing is moved by more than the alignment allows and by more than it is uncertain, whatever it is given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.patches import cylinder

from kinform.kinematics.joints.axes.bounds import MoveBounds, move_bounds
from kinform.kinematics.joints.axes.equal_lengths import equalise_lengths
from kinform.kinematics.joints.axes.misfit import misfit_of, moves_between
from kinform.kinematics.joints.axes.snapping import snap_axes
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.kinematics import FREEDOMS, Body, Joint

ALIGNMENT = np.radians(0.2)
KINDS = ("revolute", "cylindrical", "prismatic", "planar", "spherical")


def made(name, kind, axis, point, bodies=("a", "b")):
    axis = None if kind == "spherical" else np.asarray(axis, float) / np.linalg.norm(axis)
    point = np.asarray(point, float)
    return Joint(
        name, bodies, kind, axis, point, None, None, FREEDOMS[kind], twists_of(kind, axis, point), (), "determined",
        "", (), (), np.zeros(6),
    )  # fmt: skip


def loose_joints(rng, count):
    """Joints about a few directions and lines, each off by up to four of its uncertainties, of 1e-9 to 1 rad."""
    directions = np.vstack([np.eye(3), rng.normal(size=(2, 3))])
    places = rng.normal(size=(3, 3))
    sigma = 10.0 ** rng.uniform(-9.0, 0.0, (count, 2))
    joints = []
    for k in range(count):
        kind = KINDS[rng.integers(len(KINDS))]
        off = np.clip(rng.normal(size=(2, 3)), -4.0, 4.0) * sigma[k][:, None]
        axis = directions[rng.integers(len(directions))] + off[0]
        point = places[rng.integers(len(places))] + off[1]
        a, b = sorted(rng.choice(5, 2, replace=False))
        joints.append(made(f"j{k}", kind, axis, point, (f"b{a}", f"b{b}")))
    return joints, MoveBounds(sigma, np.full((count, 2), ALIGNMENT * np.array([1.0, 0.1])), np.zeros((count, 2)))


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**31), count=st.integers(2, 12))
def test_nothing_is_moved_beyond_its_bounds(seed, count):
    joints, bounds = loose_joints(np.random.default_rng(seed), count)
    moves = {move.joint: move for move in moves_between(joints, snap_axes(joints, bounds))}
    for joint, sigma, allowed in zip(joints, bounds.sigma, bounds.allowed, strict=True):
        if joint.name in moves:
            angle, distance = moves[joint.name].angle, moves[joint.name].distance
            assert angle <= min(3.0 * sigma[0], allowed[0]) * (1.0 + 1e-9) + 1e-12
            assert distance <= allowed[1] * (1.0 + 1e-9) + 1e-14
            # lines meet within a few metres here: their tilt has part in how uncertain they are there
            assert distance <= 3.0 * (sigma[1] + 100.0 * sigma[0])
            if joint.axis is None:
                assert distance <= 3.0 * sigma[1] * (1.0 + 1e-9) + 1e-14


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**31))
def test_pins_are_not_moved_beyond_their_bounds_and_sides_are_equal_or_untouched(seed):
    rng = np.random.default_rng(seed)
    sigma = np.repeat(10.0 ** rng.uniform(-9.0, -3.0, (4, 1)), 2, axis=1)
    joints = pins(rng.normal(size=(4, 2)) * sigma[:, :1])
    bounds = MoveBounds(sigma, np.full((4, 2), 1e-4), np.zeros((4, 2)))
    after = equalise_lengths(graph_of(joints), bounds, 1.0)
    moves = moves_between(joints, after)
    assert all(move.distance <= bounds.most[int(move.joint[1:]), 1] * (1.0 + 1e-9) for move in moves)
    unequal = np.linalg.norm(side(after, 1, 0) - side(after, 2, 3))
    assert unequal < 1e-14 if moves else unequal > 0.0


def pins(off, shape=((0.0, 0.0), (0.2, 0.3), (1.2, 0.3), (1.0, 0.0))):
    """Hinges about z at the corners of a four-bar, each moved by (x, y)."""
    bodies = (("base", "crank"), ("coupler", "crank"), ("coupler", "rocker"), ("base", "rocker"))
    return [
        made(f"j{k}", "revolute", (0, 0, 1), (*(np.array(corner) + off[k]), 0.01 * k), bodies[k])
        for k, corner in enumerate(shape)
    ]  # fmt: skip


def graph_of(joints):
    names = sorted({name for joint in joints for name in joint.bodies})
    return JointGraph(tuple(Body(name, (name,), name == "base") for name in names), tuple(joints))


def side(joints, a, b):
    return (joints[a].point - joints[b].point)[:2]


def lengths(joints):
    return [np.linalg.norm(side(joints, (k + 1) % 4, k)) for k in range(4)]


@pytest.mark.parametrize("turn", [0.0, 1.0])
@pytest.mark.parametrize("kind", ["parallelogram", "crossed", "kite", "rhomb"])
def test_four_bars_of_equal_sides_become_exact_and_the_moves_are_told(kind, turn):
    rng = np.random.default_rng(5)
    c, s = np.cos(0.7), np.sin(0.7)
    shapes = {
        "parallelogram": ((0, 0), (0.2, 0.3), (1.2, 0.3), (1, 0)),
        "crossed": crossed(0.4, 1.0, 0.9),
        "kite": kite(1.0, 0.6, 0.7),
        "rhomb": ((0, 0), (c, s), (1 + c, s), (1, 0)),
    }
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shape = [rotation @ np.array(corner, float) for corner in shapes[kind]]
    joints = pins(1e-9 * rng.normal(size=(4, 2)), shape)
    bounds = MoveBounds(np.full((4, 2), 1e-9), np.full((4, 2), 1.0), np.zeros((4, 2)))
    after = equalise_lengths(graph_of(joints), bounds, 1.0)
    a, b, c, d = lengths(after)
    pairs = {"kite": ((a, d), (b, c)), "rhomb": ((a, b), (b, c), (c, d))}.get(kind, ((a, c), (b, d)))
    assert all(abs(p - q) < 1e-14 for p, q in pairs)
    assert 1e-11 < misfit_of(moves_between(joints, after)).distance <= 3e-9


def crossed(crank, base, angle):
    """Corners of an antiparallelogram: the parallelogram's coupler reflected in the line of crank pin and base pin."""
    pin, foot = crank * np.array([np.cos(angle), np.sin(angle)]), np.array([base, 0.0])
    corner, along = pin + foot, (foot - pin) / np.linalg.norm(foot - pin)
    arm = corner - pin
    return (0.0, 0.0), pin, pin + 2.0 * along * (along @ arm) - arm, foot


def kite(long, short, angle):
    """Corners with base and crank of one length, coupler and rocker of another."""
    pin, foot = long * np.array([np.cos(angle), np.sin(angle)]), np.array([long, 0.0])
    middle, half = 0.5 * (pin + foot), 0.5 * np.linalg.norm(pin - foot)
    out = middle / np.linalg.norm(middle)
    return (0.0, 0.0), pin, middle + np.sqrt(short**2 - half**2) * out, foot


@pytest.mark.parametrize("kind", ["parallelogram", "kite"])
def test_sides_that_differ_by_more_than_their_uncertainty_stay_as_they_are(kind):
    shape = kite(1.0, 0.6, 0.7) if kind == "kite" else ((0, 0), (0.2, 0.3), (1.2, 0.3), (1, 0))
    joints = pins(np.array([[0, 0], [0, 0], [1e-3, 0], [0, 0]]), shape)
    bounds = MoveBounds(np.full((4, 2), 1e-6), np.full((4, 2), 1.0), np.zeros((4, 2)))
    assert equalise_lengths(graph_of(joints), bounds, 1.0) == tuple(joints)


def test_a_badly_known_axis_is_not_turned_into_line():
    """Its uncertainty of a degree would allow it; the alignment of 0.2° does not."""
    tilted = (np.sin(np.radians(1.0)), 0.0, np.cos(np.radians(1.0)))
    joints = [made("good", "revolute", (0, 0, 1), (0, 0, 0)), made("poor", "revolute", tilted, (1, 0, 0))]
    journals = [cylinder(0.003, 0.001, axis=joint.axis, point=joint.point) for joint in joints]
    patches = [
        replace(patch, uncertainty=uncertainty)
        for patch, uncertainty in zip(journals, ((1e-6, 1e-8), (np.radians(1.0), 1e-8)), strict=True)
    ]
    joints = [replace(joint, patches=(k,)) for k, joint in enumerate(joints)]
    bounds = move_bounds(joints, patches, ALIGNMENT, 1.0)
    assert bounds.most[1, 0] == ALIGNMENT
    assert moves_between(joints, snap_axes(joints, bounds)) == ()
    wider = move_bounds(joints, patches, np.radians(1.5), 1.0)
    good, poor = moves_between(joints, snap_axes(joints, wider))
    assert good.angle < 1e-9 and poor.angle == pytest.approx(np.sin(np.radians(1.0)))
