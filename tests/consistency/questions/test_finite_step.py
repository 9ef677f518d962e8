"""What steps prove, on parts of which it is known what blocks them, at several sizes and poses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.assemblies import assembly
from support.diagonal import diagonal
from support.solids import box, extrusion, part, random_pose, rod
from support.touching import touching

from kinform.consistency.questions.finite_step import FiniteSteps

Z = (0.0, 0.0, 1.0)
TURN, SLIDE_X, SLIDE_Z = (*Z, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, *Z)
ACROSS = (0.0, 0.0, 0.0, 0.8, -0.6, 0.0)
"""Into one of two walls of a corner, whichever way."""


def d_section(radius, flat, segments=64):
    half = math.acos(flat / radius)
    angles = np.linspace(half, 2.0 * math.pi - half, segments)
    return np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)


def keyed(radius, width, height):
    return rod(radius, 0, 30, 64) + box(0, height, -width / 2, width / 2, 0, 30)


def sleeve(bore, outer=12):
    return rod(outer, 0, 30, 64) - bore


DISC = rod(20, 0, 6, 64)
CASES = {
    # what rests, what moves, what lies between, motion of mm and rad, senses that are blocked
    "flat": (sleeve(extrusion(d_section(6.05, 4.55), -1, 31)), extrusion(d_section(6, 4.5), -2, 32), None, TURN, "+-"),
    "key": (sleeve(keyed(6.05, 4.1, 8.1)), keyed(6, 4, 8), None, TURN, "+-"),
    "hexagon": (sleeve(rod(6.1, -1, 31, 6)), rod(6, 0, 30, 6), None, TURN, "+-"),
    "loose key": (
        sleeve(rod(6.05, -1, 31, 64) + box(0, 8.1, -2.05, 2.05, -1, 31)),
        rod(6, 0, 30, 64) - box(3, 9, -2.05, 2.05, -1, 31),
        box(3.1, 8, -2, 2, 0, 30),
        TURN,
        "+-",
    ),
    "cross pin": (
        sleeve(rod(6.05, -1, 31, 64)) - rod(2.05, -20, 20, 32).rotate((90, 0, 0)).translate((0, 0, 15)),
        rod(6, -5, 35, 64) - rod(2.05, -20, 20, 32).rotate((90, 0, 0)).translate((0, 0, 15)),
        rod(2, -12, 12, 32).rotate((90, 0, 0)).translate((0, 0, 15)),
        SLIDE_Z,
        "+-",
    ),
    "collars with end play": (
        sleeve(rod(6.05, -1, 31, 64)),
        rod(6, -1, 31, 64) + rod(9, -6, -0.15, 64) + rod(9, 30.15, 36, 64),
        None,
        SLIDE_Z,
        "+-",
    ),
    "across a corner": (
        box(-20, 0, -20, 60, -20, 40) + box(-20, 60, -20, 0, -20, 40) + box(-20, 60, -20, 60, -20, 0),
        box(0, 30, 0, 25, 0, 20),
        None,
        ACROSS,
        "+-",
    ),
    "across a channel": (
        box(-40, 0, 0, 80, -10, 30) + box(20, 60, 0, 80, -10, 30) + box(-40, 60, 0, 80, -10, 0),
        box(0.05, 19.95, 10, 60, 0, 25),
        None,
        SLIDE_X,
        "+-",
    ),
    "into a corner": (
        box(-20, 0, -20, 60, -20, 40) + box(-20, 60, -20, 0, -20, 40) + box(-20, 60, -20, 60, -20, 0),
        box(0, 30, 0, 25, 0, 20),
        None,
        SLIDE_X,
        "-",
    ),
    "door on its jamb": (
        rod(4, -1, 41, 64)
        + box(-10, 10, -5, 5, -10, -1)
        + box(40, 60, -20, -4, -10, 40)
        + box(-5, 60, -20, -12, -10, 0),
        box(0, 58, -4, 4, 0, 40) + rod(7, 0, 40, 64) - rod(4.05, -1, 41, 64),
        None,
        TURN,
        "-",
    ),
    "lid": (box(-30, 30, -20, 20, -40, 0), box(-30, 30, -20, 20, 0, 4), None, SLIDE_Z, "-"),
    "ram at its bottom": (sleeve(rod(6.05, 5, 31, 64)), rod(6, 5, 50, 64), None, SLIDE_Z, "-"),
    "loose pin turns": (sleeve(rod(6.2, -1, 31, 48)), rod(6, -10, 40, 32), None, TURN, ""),
    "loose pin slides": (sleeve(rod(6.2, -1, 31, 48)), rod(6, -10, 40, 32), None, SLIDE_Z, ""),
    "coarse journal": (sleeve(rod(6.3, -1, 31, 12)), rod(6, -10, 40, 14), None, TURN, ""),
    "coarse journal without clearance": (sleeve(rod(6, -1, 31, 16)), rod(6, -10, 40, 24), None, TURN, ""),
    "pressed journal": (sleeve(rod(6, -1, 31, 64)), rod(6.02, -10, 40, 64), None, TURN, ""),
    "balls go with either": (
        sleeve(rod(9, -1, 31, 96)),
        rod(3, -1, 31, 96),
        rod(3, 5, 25, 48).translate((6, 0, 0)) + rod(3, 5, 25, 48).translate((-6, 0, 0)),
        TURN,
        "",
    ),
}


def steps_of(name, scale, seed):
    """The steps, the parts of either side, those between, and the motion."""
    still, moved, loose, motion, _ = CASES[name]
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed), 100 * scale)
    # names that sort either way
    names = ("a", "b") if seed is None else ("b", "a")
    parts = [part(names[0], still, X, scale), part(names[1], moved, X, scale)]
    parts += [] if loose is None else [part("c", loose, X, scale)]
    whole = assembly(*parts)
    surfaces, contacts = touching(whole)
    omega, v = X[:3, :3] @ np.array(motion[:3]), X[:3, :3] @ np.array(motion[3:])
    twist = np.r_[omega, v - np.cross(omega, X[:3, 3])]
    between = [] if loose is None else ["c"]
    return FiniteSteps(whole, surfaces, contacts), [names[0]], [names[1]], between, twist


@diagonal(len(CASES), name=list(CASES), scale=[1e-3, 1e-5, 1.0], seed=[None, 1, 2, 3])
def test_steps_are_blocked_in_the_senses_in_which_parts_are_in_the_way(name, scale, seed):
    steps, first, second, between, twist = steps_of(name, scale, seed)
    witness = steps.witness(first, second, twist, between)
    found = ("+" if witness.ahead else "") + ("-" if witness.back else "")
    assert found == CASES[name][-1]
    assert witness.blocked == (found == "+-")
    assert (witness.record is not None) == witness.blocked
    assert (witness.doubt("mm") == "") == witness.blocked


@pytest.mark.parametrize("name", ["flat", "across a channel"])
def test_the_record_is_replayed_by_the_pose_of_the_step(name):
    steps, first, second, between, twist = steps_of(name, 1e-3, 1)
    record = steps.witness(first, second, twist, between).record
    assert record.kind == "geometric"
    assert record.step[0] < 0.0 < record.step[1]
    assert np.allclose(record.twist, twist)
    assert set(record.parts_back) == set(record.parts_ahead) == {"a", "b"}
    assert record.parts_back[0] in first and record.parts_back[1] in second
    assert min(record.depth) > steps.counts(("a", "b"))


def test_the_depth_is_that_of_the_step_less_the_clearance():
    steps, first, second, between, twist = steps_of("across a channel", 1e-3, None)
    witness = steps.witness(first, second, twist, between)
    for step in (witness.ahead, witness.back):
        assert step.depth == pytest.approx(abs(step.size) - 0.05e-3, rel=1e-6)
        assert step.chain == ("a", "b")


def test_the_same_bodies_seen_from_the_other_give_the_same_proof():
    steps, first, second, between, twist = steps_of("loose key", 1e-3, 2)
    one, other = steps.witness(first, second, twist, between), steps.witness(second, first, -twist, between)
    assert one.blocked
    assert other.blocked
    assert one.ahead.chain == other.ahead.chain[::-1] == ("b", "c", "a")


def test_what_is_drawn_too_deep_already_counts_only_as_far_as_it_goes_deeper():
    still, moved = box(-30, 30, -30, 30, -20, 0), box(-10, 10, -10, 10, -2, 20)
    whole = assembly(part("a", still, np.eye(4)), part("b", moved, np.eye(4)))
    surfaces, contacts = touching(whole)
    (overlap,) = contacts.interferences
    steps = FiniteSteps(whole, surfaces, contacts)
    assert steps.counts(("a", "b")) > overlap.depth
    witness = steps.witness(["a"], ["b"], np.array(SLIDE_Z))
    assert witness.ahead is None
    assert witness.back.drawn == overlap.depth
    assert witness.back.depth > overlap.depth + contacts.tolerance["a", "b"]
    assert not steps.witness(["a"], ["b"], np.array(SLIDE_X)).blocked


def test_pairs_left_out_and_parts_without_contact_prove_nothing():
    steps, first, second, between, twist = steps_of("key", 1e-3, None)
    assert not steps.witness(first, second, twist, between, without=[("a", "b")]).blocked
    steps, first, second, _, twist = steps_of("loose key", 1e-3, None)
    assert not steps.witness(first, second, twist).blocked
