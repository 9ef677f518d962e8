"""Shafts in bores, however coarsely either is tessellated: what turns is never certain to do anything else."""

from __future__ import annotations

import math

import numpy as np
import pytest
from manifold3d import Manifold
from support.diagonal import first
from support.solids import box, derived, random_pose, rod

FACETS = (6, 7, 8, 9, 10, 11, 12, 16, 24, 64, 200)
PLAY = 0.02


def spool(facets, phase=0.0, radius=5.0, collar=8.0, half=12.0):
    """A shaft that fills ±half between two collars."""
    ends = rod(collar, half, half + 3, facets, phase) + rod(collar, -half - 3, -half, facets, phase)
    return rod(radius, -half, half, facets, phase) + ends


def sleeve(radius, facets, phase=0.0, half=12.0 - PLAY, size=10.0, tangent=False):
    """A block with a bore, its corners on the circle, or its flats."""
    corner = radius / math.cos(math.pi / facets) if tangent else radius
    return box(-size, size, -size, size, -half, half) - rod(corner, -half - 1, half + 1, facets, phase)


def joint_of(shaft, block, seed=0):
    kinematics, _ = derived(random_pose(np.random.default_rng(seed)), block=block, shaft=shaft)
    return kinematics.joints[0] if kinematics.joints else None


def prism(n, m, phase):
    """Whether flats lie on flats: then up to six sides are a prism, and up to eleven may be one."""
    return n == m <= 11 and phase == 0.0


PAIRS = sorted({(n, m) for n in FACETS for m in FACETS if n == m or 8 in (n, m) or 64 in (n, m) or (n + m) % 5 == 0})
# each with its like, flats on flats, and with what has three more or fewer
OFTEN = [*((n, n, 0.0) for n in FACETS), *((n, FACETS[k - 3], 7.0) for k, n in enumerate(FACETS))]
SELDOM = sorted({(*sides, phase) for sides in PAIRS for phase in (0.0, 7.0)} - set(OFTEN))


@pytest.mark.parametrize(("n", "m", "phase"), [*OFTEN, *(pytest.param(*s, marks=pytest.mark.sweep) for s in SELDOM)])
def test_a_shaft_between_collars_turns_or_is_in_doubt(n, m, phase):
    joint = joint_of(spool(n), sleeve(5.0 + PLAY, m, phase, tangent=m <= 6 < n), n + m)
    if prism(n, m, phase) and n <= 6:
        assert joint is None
        return
    assert joint.status == "ambiguous" or (joint.type, joint.status) == ("revolute", "determined")
    if min(n, m) >= 12:
        assert joint.status == "determined"
    if prism(n, m, phase):
        assert joint.status == "ambiguous"
        assert {joint.type, *(reading.type for reading in joint.readings)} == {"revolute", "fixed"}


@pytest.mark.parametrize("n", first(3, [7, 11, 24, 8, 9, 10, 12]))
def test_a_coarse_shaft_in_a_round_bore_turns_and_one_without_collars_slides_too(n):
    joint = joint_of(spool(n), sleeve(5.0 + PLAY, 64))
    assert (joint.type, joint.status) == ("revolute", "determined")
    joint = joint_of(rod(5.0, -20, 20, n), sleeve(5.0 + PLAY, 64))
    assert (joint.type, joint.status) == ("cylindrical", "determined")


@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_a_bar_of_few_sides_in_a_round_bore_is_never_certain_to_slide_across_it(n):
    assert joint_of(spool(n), sleeve(5.0 + PLAY, 64)).status == "ambiguous"


@pytest.mark.parametrize(("gap", "expected"), [(0.05, "prismatic"), (0.4, None)])
def test_a_hexagon_that_can_turn_in_its_socket_is_no_prism_for_sure(gap, expected):
    """Corner and flat of a hexagon of 2 mm differ by 0.27 mm."""
    flat = 2.0 * math.cos(math.pi / 6)
    hole = rod((flat + gap) / math.cos(math.pi / 6), -6, 6, 6)
    joint = joint_of(rod(2.0, -8, 8, 6), box(-6, 6, -6, 6, -5, 5) - hole)
    if expected is None:
        assert joint.status == "ambiguous"
    else:
        assert (joint.type, joint.status) == (expected, "determined")


def test_a_bore_tessellated_by_tangents_holds_its_shaft():
    """Its corners are 0.74 mm off, its flats 0.02 mm."""
    corner = 21.0 / math.cos(math.pi / 12)
    block = box(-30, 30, -30, 30, -20, 20) - rod(corner, -21, 21, 12, 11.0)
    joint = joint_of(rod(20.98, -30, 30, 100), block)
    assert (joint.type, joint.status) == ("cylindrical", "determined")


def test_a_square_bar_in_its_square_hole_beside_round_holes_stays_a_prism():
    block = box(-15, 15, -10, 10, -5, 5) - box(-3.05, 3.05, -3.05, 3.05, -6, 6) - rod(2, -6, 6, 32).translate((9, 0, 0))
    joint = joint_of(box(-3, 3, -3, 3, -10, 10), block)
    assert (joint.type, joint.status) == ("prismatic", "determined")


def test_a_neck_between_collars_is_no_socket_for_the_block_around_it():
    """Collars and a flat of an octagon meet in two corners, which lie on many circles."""
    shaft, block = spool(8, radius=2.54, collar=4.06, half=2.6), sleeve(2.7, 8, half=2.4, size=6.05)
    joint = joint_of(shaft, block, 5)
    assert joint.status == "ambiguous"


@pytest.mark.parametrize("seed", first(1, range(2)))
def test_what_encloses_a_crumpled_shaft_makes_its_joint_doubtful(seed):
    """Vertices of the shaft scatter by as much as its facets are wide: its collars are all that is left of it."""
    rng = np.random.default_rng(seed)
    shaft = spool(100, radius=2.2, collar=4.0, half=4.0).warp_batch(lambda v: v + 0.05 * rng.normal(size=v.shape))
    joint = joint_of(shaft, sleeve(2.3, 32, half=3.9, size=5.0), seed)
    assert joint.status == "ambiguous" or joint.type == "revolute"


@pytest.mark.parametrize(
    ("collar", "types", "status"),
    [
        (7.6, {"cylindrical"}, "determined"),
        (8.1, {"revolute", "cylindrical"}, "ambiguous"),
        (8.2, {"revolute", "cylindrical"}, "ambiguous"),
        (9.0, {"revolute"}, "determined"),
    ],
)
def test_a_shoulder_that_rests_on_less_than_its_outline_is_exact_to_may_not_rest_at_all(collar, types, status):
    """The bore is countersunk to 8 mm; the flats of twelve and 24 sides stand off their circle by 0.27 and 0.07 mm."""
    sink = Manifold.cylinder(2.0, 6.0, 8.0, 24).translate((0, 0, 3.0))
    block = box(-15, 15, -15, 15, -10, 5) - rod(6.0, -11, 6, 24) - sink
    joint = joint_of(rod(5.98, -20, 12, 12, 10.0) + rod(collar, 5.01, 12, 12, 10.0), block, 3)
    assert {joint.type, *(reading.type for reading in joint.readings)} == types
    assert joint.status == status
