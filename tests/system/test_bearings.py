"""Bearings whose rolling elements are parts of their own: the joint of ring and shaft is told, or that it is not known;
never an error of a function that is right, nor one agreed with that is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support import bearings
from support.bearings import KINDS, Bearing, Size, answers_of
from support.diagonal import some
from support.solids import random_pose

SIZES = [
    Size(3, 9.0, 1.6, 10.0, 0.0, 72, 36, 11.0),
    Size(5, 8.0, 2.2, 12.0, 0.0, 96, 40, 70.0),
    Size(9, 11.0, 1.8, 8.0, 0.0, 54, 29, 3.0),
]
SCALES = (0.1, 1e-4, 1e-3)
UNDECIDED = ("tapers", "self-aligning balls")
"""Without a rib tapered rollers are wedged out; a ball in a bowl is held to second order, which nobody works out."""
CAGED = ("needles, cage", "needles, flanges and cage")
"""What a thin cage touches is in doubt in some tessellations."""


def each_with_one(kinds, values, often):
    """Each kind with one of the values, which take turns: every so many each time, the others as slow tests; the other
    combinations are of the sweep. `often` has no factor in common with the number of values, so that each of these is
    tried."""
    return [
        pytest.param(
            kind, value, marks=pytest.mark.sweep if k % len(values) != i else () if k % often == 0 else pytest.mark.slow
        )
        for k, kind in enumerate(kinds)
        for i, value in enumerate(values)
    ]


@pytest.mark.parametrize(("kind", "k"), each_with_one(KINDS, range(3), often=5))
def test_the_joint_of_a_bearing_is_told(kind, k):
    found = answers_of(KINDS[kind](SIZES[k]), np.random.default_rng(k), SCALES[k])
    outcome, why = found.outcome()
    allowed = ("undecided",) if kind in UNDECIDED else ("agrees", "undecided") if kind in CAGED else ("agrees",)
    assert outcome in allowed, why


@pytest.mark.parametrize(("kind", "play"), each_with_one(KINDS, [0.035, 0.002], often=9))
def test_play_makes_nothing_certain_that_is_wrong(kind, play):
    """Elements that keep farther apart from their races than parts that touch do are not in contact with these, and may
    carry them all the same."""
    size = replace(SIZES[1], play=play * SIZES[1].element)
    found = answers_of(KINDS[kind](size), np.random.default_rng(7))
    outcome, why = found.outcome()
    assert outcome in ("agrees", "undecided"), why


def shifted(bearing: Bearing, by: float) -> Bearing:
    """The bearing with all its elements moved at random by so much (mm)."""
    rng = np.random.default_rng(1)
    moved = {
        name: solid.translate(tuple(by * rng.normal(size=3))) if name[:4] in ("roll", "ball") else solid
        for name, solid in bearing.solids.items()
    }
    return replace(bearing, solids=moved)


@pytest.mark.parametrize(("kind", "by"), each_with_one(KINDS, [2e-3, 1e-4, 2e-2], often=7))
def test_elements_that_are_not_quite_in_their_place_make_nothing_certain_that_is_wrong(kind, by):
    outcome, why = answers_of(shifted(KINDS[kind](SIZES[1]), by), np.random.default_rng(2)).outcome()
    assert outcome in ("agrees", "undecided"), why


@pytest.mark.parametrize(
    "kind", some(5, ["balls", "needles", "needles, flanges and collars", "tapers, rib", "thrust rollers"])
)
def test_one_or_two_elements_bear_no_shaft(kind):
    for count in (1, 2):
        found = answers_of(KINDS[kind](replace(SIZES[0], count=count)), np.random.default_rng(count))
        assert found.right.answer != "agrees"
        assert not [one.type for one in found.others if one.answer == "agrees"]


def test_a_shaft_that_slides_out_of_its_needles_is_no_revolute_joint():
    """Slides along lines of contact are certain: this is an error of the function, and is told as one."""
    found = answers_of(KINDS["needles, flanges"](SIZES[1]), np.random.default_rng(0))
    revolute = next(one for one in found.others if one.type == "revolute")
    assert (revolute.answer, revolute.free) == ("not held", "cylindrical, 2 freedoms by contact")


def test_of_wedged_elements_nothing_is_certain():
    found = answers_of(KINDS["tapers"](SIZES[1]), np.random.default_rng(0))
    assert found.right.answer == "undecided"


def test_what_a_bowl_holds_to_second_order_is_not_said_to_be_free():
    found = answers_of(KINDS["self-aligning balls"](SIZES[1]), np.random.default_rng(0))
    assert found.right.answer == "undecided"


@pytest.mark.parametrize("kind", some(2, ["needles, flanges and collars", "balls"]))
def test_the_order_of_the_parts_does_not_matter(kind):
    bearing = KINDS[kind](SIZES[0])
    names = {name: f"{'zyx'[int(name[-1]) % 3]}{name}" for name in bearing.solids if name[-1].isdigit()}
    renamed = replace(bearing, solids={names.get(name, name): solid for name, solid in bearing.solids.items()})
    for one in (bearing, renamed):
        assert answers_of(one, np.random.default_rng(4)).outcome()[0] == "agrees"


@pytest.mark.slow
def test_a_pose_far_away_does_not_matter(monkeypatch):
    def far(rng, reach):
        X = random_pose(rng, reach)
        X[:3, 3] += 20.0 * rng.normal(size=3)
        return X

    monkeypatch.setattr(bearings, "random_pose", far)
    found = answers_of(KINDS["needles, flanges and collars"](SIZES[1]), np.random.default_rng(5))
    assert found.outcome()[0] == "agrees"


@pytest.mark.parametrize("kind", some(20, [kind for kind in KINDS if kind != "tapers"]))
def test_a_function_that_states_all_joints_of_a_bearing_is_not_denied(kind):
    """Balls go with the shaft then, and bear it in the bowl of the ring together."""
    found = answers_of(KINDS[kind](SIZES[1]), np.random.default_rng(3), complete=True)
    assert found.right.answer in ("agrees", "undecided")
