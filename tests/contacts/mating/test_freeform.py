"""Grooves and barrels: contacts between surfaces that turn about one axis."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.diagonal import first
from support.solids import box, derived, random_pose


def ring(major, minor, segments=60, around=48):
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    outline = np.stack([major + minor * np.cos(angle), minor * np.sin(angle)], axis=1)
    return Manifold.revolve(CrossSection([outline]), around)


@pytest.mark.parametrize("seed", first(1, [1, 2]))
def test_a_ring_in_its_groove_turns_and_does_nothing_else(seed):
    X = random_pose(np.random.default_rng(seed))
    torus = ring(20, 5)
    kinematics, contacts = derived(X, ring=torus, seat=box(-30, 30, -30, 30, -10, 0.5) - torus)
    assert {patch.kind for patch in contacts.patches} == {"torus"}
    (joint,) = kinematics.joints
    assert joint.type == "revolute"
    assert np.linalg.norm(np.cross(joint.axis, X[:3, 2])) < 1e-9


def test_a_turned_knob_in_its_seat_is_revolute():
    z = np.linspace(-10, 10, 30)
    rho = 12 + 3 * np.sin(z / 5) + 0.02 * z**2
    outline = np.concatenate([[[0, -10]], np.stack([rho, z], axis=1), [[0, 10]]])
    knob = Manifold.revolve(CrossSection([outline]), 60)
    kinematics, contacts = derived(
        random_pose(np.random.default_rng(5)), knob=knob, seat=box(-25, 25, -25, 25, -8, 8) - knob
    )
    assert "revolution" in {patch.kind for patch in contacts.patches}
    (joint,) = kinematics.joints
    assert joint.type == "revolute"
