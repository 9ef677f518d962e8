"""Bodies from function: what only touches, at a point or by the teeth of gears, is not one by that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.assemblies import HERE, assembly
from support.diagonal import diagonal
from support.gear_trains import WIDTH, gear_pair
from support.solids import ball, box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.model.function import Function, IntendedJoint


def joint(name, between, type_, point, axis, X, scale):
    at = X[:3, :3] @ (scale * np.asarray(point, float)) + X[:3, 3]
    along = None if axis is None else X[:3, :3] @ np.asarray(axis, float)
    return IntendedJoint(name, between, type_, along, None, at, None, None, HERE.file, None)


def derived(solids, joints, X, scale):
    """Bodies and joints of solids in mm, drawn in any order; the function states all joints."""
    whole = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()))
    stated = Function(joints=tuple(joint(*one, X, scale) for one in joints), complete=("",))
    whole = replace(whole, function=stated)
    found, near = touching_of(whole)
    return kinematics.derive(whole, found, near)


def bodies(K):
    return sorted(body.parts for body in K.bodies)


POSES = [(None, 1e-3), (0, 1e-3), (1, 1.0)]


def at(seed, scale):
    return np.eye(4) if seed is None else random_pose(np.random.default_rng(seed)), scale


@diagonal(2, posed=POSES, thin=[-0.05, 0.0], backwards=[False, True, True])
def test_a_wheel_in_mesh_belongs_to_the_arm_that_is_screwed_to_it(posed, thin, backwards):
    """The teeth overlap, as they are often drawn, or touch: no joint alone may part them."""
    solids = gear_pair(thin=thin)
    place = 25.0
    solids["arm"] = box(place - 3, place + 40, -3, 3, WIDTH, WIDTH + 4) - rod(5.5, 0, 20, 48).translate((place, 0, 0))
    solids["arm"] += (rod(9, WIDTH, WIDTH + 4, 48) - rod(5.5, 0, 20, 48)).translate((place, 0, 0))
    if backwards:
        solids = dict(reversed(solids.items()))
    joints = [
        ("in", ("housing", "gear0"), "revolute", (0, 0, 0), (0, 0, 1)),
        ("out", ("housing", "arm"), "revolute", (place, 0, 0), (0, 0, 1)),
    ]
    K = derived(solids, joints, *at(*posed))
    assert bodies(K) == [("arm", "gear1"), ("gear0",), ("housing",)]
    assert {(one.bodies, one.type) for one in K.joints} >= {(("gear0", "housing"), "revolute")}
    assert all(one.type == "revolute" for one in K.joints)


@diagonal(2, posed=POSES, backwards=[False, True])
def test_a_rod_that_touches_a_ball_at_a_point_belongs_to_the_body_that_guides_it(posed, backwards):
    """The joint of the two turns about another centre than the ball's: it would press the rod into the ball."""
    solids = {
        "hip": box(-20, 20, -20, 20, 30, 40) + ball(8, 48).translate((0, 0, 26)),
        "motor": rod(8, -30, 0, 48) - rod(4, -40, 10, 48) + box(-2, 2, 8, 30, -10, 0),
        "rod": rod(4, -25, 18, 48),
        "foot": box(-10, 10, -10, 10, -60, -50),
    }
    if backwards:
        solids = dict(reversed(solids.items()))
    joints = [
        ("ball", ("hip", "motor"), "spherical", (6, 5, 12), None),
        ("slide", ("motor", "foot"), "prismatic", (0, 0, 0), (0, 0, 1)),
    ]
    K = derived(solids, joints, *at(*posed))
    assert ("motor", "rod") in bodies(K)
    assert ("hip",) in bodies(K)
    (of_ball,) = [one for one in K.joints if one.bodies == ("hip", "motor")]
    assert (of_ball.type, of_ball.status) == ("spherical", "stated")
    assert [(one.cause, one.freedoms) for one in of_ball.readings] == [("end", 5)]  # the point is left in one sense


@diagonal(2, posed=POSES, kind=["planar", "spherical"])
def test_a_cradle_that_a_pin_can_leave_sideways_forbids_what_it_does_not_turn_about(posed, kind):
    """An arc of less than half a bore, between collars: that the pin may be lifted out of it makes it no plane."""
    cradle = box(-20, 20, -20, -4, 0, 10) - rod(8, -1, 11, 64)
    pin = rod(8, -4, 14, 64) + rod(12, -4, 0, 64) + rod(12, 10, 14, 64)
    K = derived({"cradle": cradle, "pin": pin}, [("turn", ("cradle", "pin"), kind, (0, 0, 5), (0, 0, 1))], *at(*posed))
    (found,) = K.joints
    assert (found.type, found.status) == ("revolute", "determined")
