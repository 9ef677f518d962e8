"""A screw in its nut: patches that leave the common screw motion exactly free, and none where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from generators.threads import Thread, threaded
from manifold3d import CrossSection, Manifold
from support.diagonal import diagonal, first
from support.solids import box, derived, random_pose


def screw(lead=4.0, segments=24):
    return threaded(Thread(8.0, 10.0, lead), -14.0, 11.0, segments).manifold


def nut(gap, lead=4.0, segments=20, half=8.0):
    play = 2 * gap * (1 - math.sin(math.radians(15.0))) / math.cos(math.radians(15.0))
    tool = threaded(Thread(8.0 + gap, 10.0 + gap, lead, 1, 15.0, play), -half - 1.0, half + 1.0, segments, 7.0)
    return Manifold.cylinder(2 * half, 16.0, 16.0, 6, True) - tool.manifold


def helicoids(contacts):
    return [patch for patch in contacts.patches if patch.kind == "helicoid"]


@diagonal(gap=[0.0, 0.1, 0.45, -0.05], lead=[4.0, -4.0])
def test_flanks_mate_with_their_gap(gap, lead):
    X = random_pose(np.random.default_rng(7))
    _, contacts = derived(X, nut=nut(gap, lead), screw=screw(lead))
    (patch,) = helicoids(contacts)
    assert patch.pitch == pytest.approx(1e-3 * lead, rel=1e-6)
    assert patch.gap == pytest.approx(1e-3 * gap, abs=5e-6)
    # a strip of flank for each side, as wide as both threads have in common, all along the nut
    turns = 16.0 / 4.0
    flank = 2 * math.pi * 9.0 * (2.0 - abs(gap)) / math.cos(math.radians(15.0))
    assert patch.area == pytest.approx(1e-6 * 2 * turns * flank, rel=0.15)


@pytest.mark.parametrize("segments", first(2, [(12, 16), (24, 20), (48, 64)]))
def test_the_common_screw_motion_is_exactly_free(segments):
    X = random_pose(np.random.default_rng(3))
    _, contacts = derived(X, nut=nut(0.1, segments=segments[1]), screw=screw(segments=segments[0]))
    (patch,) = helicoids(contacts)
    velocity = np.cross(patch.axis, patch.points - patch.point) + patch.pitch / (2 * np.pi) * patch.axis
    assert np.abs(np.einsum("ij,ij->i", patch.normals, velocity)).max() < 1e-12
    assert np.allclose(np.linalg.norm(patch.normals, axis=1), 1.0)
    # out of the nut, the alphabetically first: both flanks push along the axis, either way
    along = patch.normals @ patch.axis
    assert along.min() < -0.8 and along.max() > 0.8
    assert np.linalg.norm(np.cross(patch.axis, X[:3, 2])) < 1e-9


@pytest.mark.parametrize("lead", first(2, [4.1, -4.0, 5.0]))
def test_threads_of_other_pitch_or_hand_do_not_mate(lead):
    kinematics, contacts = derived(random_pose(np.random.default_rng(2)), nut=nut(0.1), screw=screw(lead))
    assert not helicoids(contacts)
    (joint,) = kinematics.joints
    assert (joint.type == "screw", joint.status) != (True, "determined")
    assert joint.status == "ambiguous"


def lobed(gap, count, phase=0.0):
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False) + phase
    radius = 10.0 + gap + 1.2 * np.sin(6 * angle)
    return CrossSection([np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)])


@pytest.mark.parametrize("gap", first(2, [0.2, -0.02, 0.0, 0.05]))
def test_a_spline_in_its_hub_slides_and_does_nothing_else(gap):
    X = random_pose(np.random.default_rng(4))
    shaft = Manifold.extrude(lobed(0.0, 120), 60.0).translate((0, 0, -30))
    bore = Manifold.extrude(lobed(gap, 96, 0.01), 60.0).translate((0, 0, -30))
    kinematics, contacts = derived(X, hub=box(-20, 20, -20, 20, -10, 10) - bore, shaft=shaft)
    (patch,) = contacts.patches
    assert patch.kind == "extrusion"
    assert np.abs(patch.normals @ patch.axis).max() < 1e-12
    (joint,) = kinematics.joints
    assert (joint.type, joint.status) == ("prismatic", "determined")
    assert np.linalg.norm(np.cross(joint.axis, X[:3, 2])) < 1e-6
