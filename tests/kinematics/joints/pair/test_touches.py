"""Contact that is there only because parts are drawn a little too large or too small: it tells no joint for sure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.diagonal import diagonal
from support.patches import Z, cylinder, ring
from support.solids import ball, box, derived, random_pose, rod

from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import gather
from kinform.model.tolerances import Tolerances

POSES = [None, 0, 1]


def joint(seed, scale=1e-3, **solids):
    X = None if seed is None else random_pose(np.random.default_rng(seed))
    kinematics, _ = derived(X, scale, **solids)
    return kinematics.joints[0]


def decision(patches):
    return decide(gather([(k, p, False) for k, p in enumerate(patches)], Tolerances(), 5e-4, 0.0), Tolerances())


def tube():
    return rod(19.0, -50.0, 0.0) - rod(15.0, -60.0, 10.0)


@diagonal(overlap=[(0.1, 0.1), (0.05, 0.05), (0.1, 0.25), (0.2, 0.1)], seed=POSES)
def test_a_rod_end_that_interpenetrates_the_mouth_of_its_bore_is_no_bearing(overlap, seed):
    radial, along = overlap
    found = joint(seed, tube=tube(), rod=rod(15.0 + radial, -along, 60.0))
    assert found.status == "ambiguous"


@pytest.mark.parametrize("seed", POSES)
def test_a_rod_that_is_pressed_into_a_counterbore_is_one(seed):
    seat = rod(19.0, -50.0, 0.0) - rod(15.0, -5.0, 10.0)
    found = joint(seed, seat=seat, rod=rod(15.02, -5.0, 60.0))
    assert (found.type, found.status) == ("revolute", "determined")


def test_faces_of_a_step_are_as_wide_as_the_other_is_deep():
    """A step 0.2 mm long and 0.1 mm wide, each face overlapping by the width of the other; and wider ones."""

    def step(wider):
        round_ = cylinder(0.015, 2e-4 * wider, point=(0, 0, -1e-4 * wider), gap=-1e-4)
        return [round_, ring((0, 0, 0), inner=0.015, outer=0.015 + 1e-4 * wider, gap=-2e-4)]

    assert decision(step(1.0)).status == "ambiguous"
    assert decision(step(4.0)).status == "determined"
    touching = [replace(p, gap=0.0, gaps=np.zeros(len(p.points))) for p in step(1.0)]
    assert decision(touching).status == "determined"


@diagonal(expected=[(0.0, "determined"), (0.05, "ambiguous"), (-0.05, "ambiguous")], seed=POSES)
def test_a_ball_beside_a_plate_touches_it_only_where_it_touches(expected, seed):
    """Surfaces that pass each other at a point hold nothing for sure, nor do those drawn into each other there."""
    gap, status = expected
    plate = box(-30.0, 30.0, -30.0, 30.0, -8.0, 0.0)
    found = joint(seed, ball=ball(10.0, 96).translate((0, 0, 10.0 + gap)), plate=plate)
    assert (found.type, found.freedoms, found.status) == ("general", 5, status)


@pytest.mark.parametrize("apart", [0.0, 0.3, 3.0])
def test_a_round_that_its_facets_leave_unknown_says_nothing_where_it_does_not_touch(apart):
    """Its axis, and so whether it mates at all, hangs on the last digits of the vertices, and so on the pose."""
    collars = [ring((0, 0, 0.01), outer=0.02), ring((0, 0, -0.01), normal=-Z, outer=0.02)]
    near = cylinder(0.03, 0.002, point=(0, 0.01, 0), arc=(0.2, 0.5), gap=1e-3 * apart)
    known = decision([*collars, replace(near, mismatch=(1e-4, 1e-5))])
    unknown = decision([*collars, replace(near, mismatch=(0.05, 0.01))])
    assert known.form.type != "planar"
    assert (unknown.form.type == "planar") == (apart > 0.0)
    if apart:
        assert unknown.status == "determined"
