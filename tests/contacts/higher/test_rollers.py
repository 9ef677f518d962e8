"""Rollers between flanges: their lines on the races count beside the planes of their ends."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold
from support.bearings import KINDS, Size
from support.diagonal import diagonal
from support.solids import box, derived, random_pose, rod

SIZE = Size(1)


def contact(kind, first, second, X=None, scale=1e-3, **changed):
    solids = KINDS[kind](Size(**{**vars(SIZE), **changed})).solids
    found, touching = derived(X, scale, **{first: solids[first], second: solids[second]})
    (joint,) = found.joints
    return joint, touching.patches


@diagonal(scale=[1e-4, 1e-3, 0.1], other=["ring", "shaft"])
def test_a_roller_between_flanges_keeps_its_line(other, scale):
    X = random_pose(np.random.default_rng(1), 100 * scale)
    joint, patches = contact("needles, flanges and collars", "roller0", other, X, scale)
    assert sorted(patch.kind for patch in patches) == ["line", "plane", "plane"]
    (line,) = (patch for patch in patches if patch.kind == "line")
    assert (line.bends, line.one_sided) == (other == "ring", False)
    # it goes along the race, and turns about its axis: the flanges hold it along that, and from leaning
    assert (joint.type, joint.freedoms, joint.status) == ("general", 2, "determined")
    axis, middle = X[:3, 2], X[:3, 3]
    about_axis = np.concatenate([axis, np.cross(middle, axis)])
    rest = about_axis - joint.twists.T @ np.linalg.lstsq(joint.twists.T, about_axis, rcond=None)[0]
    assert np.linalg.norm(rest) < 1e-6


def test_a_roller_in_a_ring_turns_less_than_its_line_says():
    joint, (line,) = contact("needles", "ring", "roller0")
    assert (line.kind, line.bends, line.one_sided) == ("line", True, False)
    assert (joint.status, joint.freedoms) == ("ambiguous", 4)
    assert [(one.cause, one.freedoms) for one in joint.readings] == [("bend", 3)]


def test_a_tapered_roller_slides_on_the_ball_of_its_end():
    joint, patches = contact("tapers, rib", "roller0", "shaft")
    assert sorted(patch.kind for patch in patches) == ["line", "sphere"]
    assert (joint.type, joint.freedoms, joint.status) == ("general", 2, "determined")


@pytest.mark.parametrize("play", [0.06, 0.1])
def test_with_much_play_it_is_not_known_where_a_roller_touches(play):
    joint, patches = contact("needles, flanges", "ring", "roller0", play=play)
    assert [patch.one_sided for patch in patches if patch.kind == "line"] == [True]
    assert joint.status == "ambiguous"


def test_what_is_not_round_all_over_does_not_roll():
    """A lever's round end against the boss of a disc on which it lies is at a stop."""
    disc = Manifold.cylinder(4, 20, 20, 96) + Manifold.cylinder(8, 6, 6, 96)
    lever = rod(3, 4, 8, 48).translate((9, 0, 0)) + box(9, 40, -2, 2, 4, 8)
    _, touching = derived(random_pose(np.random.default_rng(3)), a=disc, b=lever)
    assert {patch.kind for patch in touching.patches} == {"plane"}
    roller = rod(3, 4, 8, 48).translate((9, 0, 0))
    _, touching = derived(random_pose(np.random.default_rng(3)), a=disc, b=roller)
    assert {patch.kind for patch in touching.patches} == {"plane", "line"}
