"""Play between opposite flanks is no freedom, as end play is none; a turn that is stated, or longer, stays one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.kinematics.joints.bodies.backlash import _flanks, _met


def splined(play, teeth=1, *, collars=True, bore=8.0, high=2.0, wide=4.0):
    """A hub and a shaft whose key, or teeth, have `play` (degrees) at half their height and rest on one flank."""
    half = 0.5 * math.radians(play)
    gap = half * (bore + 0.5 * high)
    hub, shaft = rod(20, 0, 30, 96) - rod(bore, -1, 31, 96), rod(bore, -6, 36, 96)
    for k in range(teeth):
        turn = (0, 0, 360.0 * k / teeth)
        hub -= box(0, bore + high + 0.5, -wide / 2 - gap, wide / 2 + gap, -1, 31).rotate(turn)
        shaft += box(bore - 2, bore + high, -wide / 2, wide / 2, 2, 28).rotate(turn)
    if collars:
        shaft += rod(14, -6, 0, 96) + rod(14, 30, 36, 96)
    return {"hub": hub, "shaft": shaft.rotate((0, 0, math.degrees(half)))}


def derived(solids, stated="", seed=1, scale=1e-3):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed), 100 * scale)
    parts = [part(name, solid, X, scale) for name, solid in solids.items()]
    joints = [intended("j", *solids, stated, X[:3, 2], X[:3, 3])] if stated else []
    made = assembly(*parts, ground=next(iter(solids)), joints=joints)
    return kinematics.derive(made, *touching_of(made))


@diagonal(play=[0.1, 1.0, 2.0], teeth=[1, 4], seed=[None, 1], scale=[1e-3, 1.0])
def test_a_shaft_with_backlash_and_collars_is_one_body_with_its_hub(play, teeth, seed, scale):
    K = derived(splined(play, teeth), seed=seed, scale=scale)
    assert len(K.bodies) == 1


@diagonal(play=[0.1, 2.0], teeth=[1, 4], seed=[None, 1])
def test_without_collars_it_slides(play, teeth, seed):
    (joint,) = derived(splined(play, teeth, collars=False), seed=seed).joints
    assert joint.type == "prismatic"
    assert (len(joint.at_rest), len(joint.closed), joint.at_stop) == (1, 1, ())


def test_a_turn_of_more_is_a_motion_that_its_flank_ends():
    (joint,) = derived(splined(4.0)).joints
    assert (joint.type, len(joint.at_stop)) == ("revolute", 1)


@pytest.mark.parametrize(("stated", "found"), [("revolute", "revolute"), ("prismatic", None), ("fixed", None)])
def test_a_turn_that_is_stated_is_one(stated, found):
    K = derived(splined(2.0), stated)
    assert [joint.type for joint in K.joints] == ([found] if found else [])


@pytest.mark.parametrize("sense", [1, -1])
def test_flanks_meet_where_they_have_turned_into_one_plane(sense):
    """Radial flanks at an angle: a rectangle in a plane through the axis."""
    corners = np.array([[[1.0, 0, 0], [2, 0, 0], [2, 0, 1]], [[1, 0, 0], [2, 0, 1], [1, 0, 1]]])
    cos, sin = math.cos(0.03), math.sin(0.03)
    turned = corners[:, ::-1] @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
    (lower, upper) = (corners, turned)
    assert len(_flanks(lower, -1)) == 2 == len(_flanks(upper, 1))
    moving, still = (lower, upper) if sense > 0 else (upper, lower)
    assert _met(moving, still, sense) == pytest.approx(0.03, abs=1e-9)
    assert _met(moving, still + np.array([0, 0, 5.0]), sense) == math.inf
