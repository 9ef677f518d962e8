"""What is drawn into the other part, where nothing mates, may hold what the found contact leaves: it is in doubt."""

from __future__ import annotations

import numpy as np
from manifold3d import Manifold
from support.diagonal import diagonal
from support.solids import derived, random_pose

POSES = [np.eye(4), random_pose(np.random.default_rng(7))]


def joint(pin, block, X=None, scale=1e-3, swapped=False):
    names = ("b", "a") if swapped else ("a", "b")
    found, _ = derived(X, scale, **dict(sorted(zip(names, (pin, block), strict=True))))
    (only,) = found.joints
    return only


def bored():
    return Manifold.cube((40.0, 40.0, 30.0)).translate((-20.0, -20.0, 0.0)) - Manifold.cylinder(30.0, 8.0, 8.0, 96)


@diagonal(scale=[1e-5, 1e-3, 1.0], X=POSES, swapped=[False, True, True])
def test_a_pin_whose_tip_interpenetrates_the_bottom_is_ambiguous(scale, X, swapped):
    pin = Manifold.cylinder(30.0, 8.0, 8.0, 96).translate((0.0, 0.0, 10.0))
    tip = Manifold.cylinder(9.0, 3.0, 5.0, 7).translate((0.0, 0.0, 3.0))
    block = bored() + Manifold.cube((40.0, 40.0, 4.0)).translate((-20.0, -20.0, 0.0))
    clear = joint(pin, block, X, scale, swapped)
    assert (clear.type, clear.status) == ("cylindrical", "determined")
    drawn = joint(pin + tip, block, X, scale, swapped)
    assert (drawn.type, drawn.status) == ("cylindrical", "ambiguous")


def test_a_revolute_joint_stays_determined_despite_an_overlap():
    """A collar on either side, and a key of the pin that is drawn into the bore."""
    pin = Manifold.cylinder(50.0, 8.0, 8.0, 96).translate((0.0, 0.0, -10.0))
    pin += Manifold.cylinder(5.0, 12.0, 12.0, 96).translate((0.0, 0.0, 30.0))
    pin += Manifold.cylinder(5.0, 12.0, 12.0, 96).translate((0.0, 0.0, -5.0))
    key = Manifold.cube((4.0, 4.0, 6.0), True).translate((8.0, 0.0, 15.0))
    found = joint(pin + key, bored())
    assert (found.type, found.status) == ("revolute", "determined")
