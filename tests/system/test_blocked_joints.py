"""Stray patches on meshes block a joint and do not hide it; locators on meshes hold, however small they are."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import diagonal
from support.solids import ball, box, derived, extrusion, random_pose, rod

SHARES = [0.02, 0.1, 0.2]


def revolute(rng):
    """A shaft between collars in a block; area of its contact 870 mm²."""
    block = box(-20, 20, -20, 20, -10, 10) - rod(5.02, -11, 11, 36, rng.uniform(0, 9))
    shaft = rod(5.0, -10.02, 10.02, 40, rng.uniform(0, 9))
    for side in (-1, 1):
        low, high = sorted((side * 10.02, side * 14.0))
        shaft += rod(8.0, low, high, 48, rng.uniform(0, 9))
    return block, shaft, 870.0


def prismatic(rng):
    """A square bar in a square hole, area 800 mm²."""
    block = box(-20, 20, -20, 20, -10, 10) - box(-5.02, 5.02, -5.02, 5.02, -11, 11)
    return block, box(-5, 5, -5, 5, -30, 30), 800.0


def spherical(rng):
    """A ball in a socket that holds more than half of it, area 553 mm²."""
    block = box(-20, 20, -20, 20, -12, 3) - ball(8.02, 48, rng.uniform(0, 7))
    return block, ball(8.0, 44, rng.uniform(0, 7)) + rod(2.5, 7, 20, 24), 553.0


def strayed(kind, rng, share, overlap):
    """The pair with a post on the block and an arm on the other body, whose faces meet over the share of the area."""
    make, name, top, reach = {
        "revolute": (revolute, "revolute", 10.0, 14.0),
        "prismatic": (prismatic, "prismatic", 10.0, 30.0),
        "spherical": (spherical, "spherical", 3.0, 20.0),
    }[kind]
    block, body, area = make(rng)
    side = np.sqrt(share * area)
    if kind == "prismatic":
        lug = box(4, 6 + side, -side / 2, side / 2, top - overlap, top + 6)
        return block, body + lug - box(5.0, 5.02, -50, 50, top - 2 * overlap, top), name
    post = box(9.5, 9.5 + side, -8, 0, top, top + 3 + side)
    arm = box(9.5, 9.5 + side, -overlap, 4, top + 3, reach + side + 3)
    bridge = box(-2, 9.5 + side, 1, 4, reach - 1, reach + side + 3)
    return block + post, body + arm + bridge, name


@diagonal(kind=["revolute", "prismatic", "spherical"], overlap=[0.0, 0.2], share=SHARES)
def test_a_patch_beside_a_joint_ends_its_motion(kind, overlap, share):
    rng = np.random.default_rng([int(1000 * share), int(10 * overlap), len(kind)])
    block, body, expected = strayed(kind, rng, share, overlap)
    scale = 1e-3 * 10 ** rng.uniform(-0.3, 0.3)
    found, touching = derived(random_pose(rng), scale, block=block, body=body)
    (joint,) = found.joints
    if expected == "prismatic":  # an overlap blocks it; else the slide is the reading that the stop leaves
        found = joint.type, joint.status, [(reading.type, reading.cause) for reading in joint.readings]
        open_to = ("fixed", "ambiguous", [("prismatic", "stop")])
        assert found == open_to or (overlap and found == ("prismatic", "blocked", []))
        return
    assert (joint.type, joint.status) == (expected, "determined")
    assert {touching.patches[one.patch].kind for one in joint.at_stop} == {"plane"}
    assert sum(one.area for one in joint.at_stop) == pytest.approx(share * 870e-6 * (scale / 1e-3) ** 2, rel=0.7)
    assert found.mobility.low < found.mobility.instantaneous


def flat_shaft(radius, flat, segments):
    half = np.arccos(flat / radius)
    angles = np.linspace(half, 2 * np.pi - half, segments)
    return np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)


def keyed(share, gap):
    """A key on the shaft in a keyway: two flanks that make up the share of the area, along the whole bore."""
    depth = max(0.6, share * 870.0 / 2.0 / 20.0)
    return box(0.0, 5.0 + depth - gap, -1.5 + gap, 1.5 - gap, -10, 10), box(0.0, 5.6 + depth, -1.5, 1.5, -11, 11)


LOCATORS = ["key", "flat", "spline", "dowel"]


def located(kind, rng, share, gap=0.01):
    """A shaft between collars, and a locator against its rotation."""
    block, shaft, area = revolute(rng)
    if kind == "key":
        key, way = keyed(share, gap)
        return block - way, shaft + key
    if kind == "dowel":
        # a dowel on the collar's flange, in a hole of the block
        radius, length = 1.5, share * area / (2 * np.pi * 1.5)
        pin = rod(radius, 10.0 - length, 12.0, 20).translate((12.0, 3.0, 0.0))
        hole = rod(radius + gap, 9.0 - length, 10.0, 24).translate((12.0, 3.0, 0.0))
        return block - hole, shaft + rod(16.0, 10.02, 14.0, 60) + pin
    if kind == "flat":
        flat = np.sqrt(5.0**2 - (share * area / 20.0 / 2.0) ** 2)
        bar = extrusion(flat_shaft(5.0, flat, 36), -10.02, 10.02)
        hole = extrusion(flat_shaft(5.0 + gap, flat + gap, 30), -11, 11)
        collars = rod(8.0, -14.0, -10.02, 48) + rod(8.0, 10.02, 14.0, 48)
        return box(-20, 20, -20, 20, -10, 10) - hole, bar + collars
    teeth, high = 8, max(0.5, share * area / (2 * 8 * 20.0))
    tooth, gap_of = box(0, 5.0 + high, -0.7 + gap, 0.7 - gap, -10, 10), box(0, 5.5 + high, -0.7, 0.7, -11, 11)
    for k in range(teeth):
        shaft, block = shaft + tooth.rotate((0, 0, 45.0 * k)), block - gap_of.rotate((0, 0, 45.0 * k))
    return block, shaft


# narrow flats are no deeper than their play, or than the facets beside them
HELD = [
    pytest.param(kind, share, marks=() if k % 3 == at % 3 else pytest.mark.sweep)
    for at, kind in enumerate(LOCATORS)
    for k, share in enumerate((0.15, 0.2, 0.2) if kind == "flat" else (0.01, 0.05, 0.2))
]
"""Every locator and every share; the other combinations nightly."""


@pytest.mark.parametrize(("kind", "share"), HELD)
def test_a_locator_holds_however_small_it_is(kind, share):
    rng = np.random.default_rng([int(1000 * share), len(kind)])
    block, shaft = located(kind, rng, share)
    found, _ = derived(random_pose(rng), 1e-3 * 10 ** rng.uniform(-0.3, 0.3), block=block, shaft=shaft)
    assert [b.parts for b in found.bodies] == [("block", "shaft")]


@diagonal(kind=["key", "flat", "spline", "dowel"], press=[0.005, 0.03])
def test_a_pressed_locator_is_no_stray(kind, press):
    rng = np.random.default_rng(len(kind))
    block, shaft = located(kind, rng, 0.15 if kind == "flat" else 0.05, gap=-press)
    found, _ = derived(random_pose(rng), 1e-3, block=block, shaft=shaft)
    assert [b.parts for b in found.bodies] == [("block", "shaft")]


def test_a_pressed_key_on_a_loose_shaft_is_no_stray():
    rng = np.random.default_rng(3)
    block, _, _ = revolute(rng)
    loose = rod(4.9, -10.02, 10.02, 40) + rod(8.0, -14.0, -10.02, 48) + rod(8.0, 10.02, 14.0, 48)
    key, way = keyed(0.04, -0.02)
    found, _ = derived(random_pose(rng), 1e-3, block=block - way, shaft=loose + key)
    assert [b.parts for b in found.bodies] == [("block", "shaft")]


@pytest.mark.parametrize("wide", [10.0, 40.0])
def test_a_closed_gripper_keeps_its_hinge(wide):
    lugs = box(-8, 8, -8, 8, -16, -6) + box(-8, 8, -8, 8, 6, 16) + box(-8, 8, 8, 14, -16, 16)
    fixed = lugs - rod(4.05, -17, 17, 36) + box(-2, 4, -10 - wide, -8.5, -5, 5) + box(-2, 4, -10, -7, -8, 8)
    jaw = rod(7, -5.95, 5.95, 48) + rod(4, -15, 15, 44) + box(-6, -2, -60, -5, -4, 4)
    found, _ = derived(fixed=fixed - rod(7.2, -6.2, 6.2, 60), jaw=jaw)
    assert [(j.type, j.status, len(j.at_stop) > 0) for j in found.joints] == [("revolute", "determined", True)]
