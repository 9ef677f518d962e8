"""One pair gets one answer: how it is turned, where it is, and what else is in the assembly does not change it."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest
from generators.threads import Thread, threaded
from manifold3d import Manifold
from scipy.spatial.transform import Rotation
from support.assemblies import assembly
from support.diagonal import some
from support.solids import ball, box, part, rod
from support.touching import touching

from kinform import kinematics

MOTIONS = 20


def screw_in_nut():
    gap, lean = 0.1, math.radians(15.0)
    hollow = Thread(8.0 + gap, 10.0 + gap, 4.0, 1, 15.0, 2 * gap * (1 - math.sin(lean)) / math.cos(lean))
    nut = Manifold.cylinder(8.0, 16.0, 16.0, 6, True) - threaded(hollow, -5.0, 5.0, 20, 7.0).manifold
    return {"nut": nut, "screw": threaded(Thread(8.0, 10.0, 4.0), -7.0, 6.0, 24).manifold}


def pin_in_slot():
    ends = [rod(4.05, -1, 7, 48).translate((x, 0, 0)) for x in (-12, 12)]
    plate = box(-30, 30, -15, 15, 0, 6) - (box(-12, 12, -4.05, 4.05, -1, 7) + ends[0] + ends[1])
    return {"plate": plate, "pin": (rod(4.0, -4, 6, 36, 3.0) + rod(9.0, -8, 0, 30, 5.0)).translate((3, 0, 0))}


def ball_in_socket():
    socket = box(-15, 15, -15, 15, -16, 4) - ball(10.05, 40)
    return {"socket": socket, "stud": ball(10.0, 36, 4.0) + rod(4.0, 8, 30, 24)}


def coarse_shaft_in_bore():
    return {"housing": box(-20, 20, -20, 20, -8, 8) - rod(6.1, -9, 9, 14, 11.0), "shaft": rod(6.0, -20, 20, 10, 3.0)}


def block_in_pocket():
    slot = box(-30, 30, -20, 20, -10, 5) - box(-31, 31, -7.05, 7.05, 0, 6)
    return {"base": slot, "block": box(-10, 12, -7, 7, 0, 9)}


PAIRS = [screw_in_nut, pin_in_slot, ball_in_socket, coarse_shaft_in_bore, block_in_pocket]


def motion(seed):
    X = np.eye(4)
    if seed is not None:
        rng = np.random.default_rng(seed)
        X[:3, :3], X[:3, 3] = Rotation.random(random_state=rng).as_matrix(), 0.1 * rng.normal(size=3)
    return X


@functools.cache
def joint(make, seed, baked):
    """The joint of a pair that is moved, in the coordinates of its files or by its pose, beside another block."""
    X, still = motion(seed), np.eye(4)
    other = part("other", box(300, 340, 300, 350, 300, 360), still)
    pair = [part(name, solid, X if baked else still) for name, solid in make().items()]
    if not baked:
        for one in pair:
            object.__setattr__(one, "X_WP", X)
    made = assembly(*pair, other)
    found, contacts = touching(made)
    (only,) = kinematics.derive(made, found, contacts).joints
    return only


@pytest.mark.parametrize("baked", [True, False])
@pytest.mark.parametrize("seed", some(7, range(MOTIONS)))
@pytest.mark.parametrize("make", PAIRS)
def test_a_pair_is_judged_alike_wherever_it_is(make, seed, baked):
    here, there = joint(make, None, True), joint(make, seed, baked)
    assert (there.type, there.freedoms, there.status) == (here.type, here.freedoms, here.status)
    assert there.status == "determined"
    np.testing.assert_allclose(there.singular_values, here.singular_values, atol=1e-6)
    X = motion(seed)
    for direction in ("axis", "axis2"):
        one, two = getattr(here, direction), getattr(there, direction)
        assert (one is None) == (two is None)
        if one is not None:
            assert np.linalg.norm(np.cross(X[:3, :3] @ one, two)) < 1e-6
