"""Teeth and cams couple joints in the ratio that their construction has, at any pose and tessellation."""

from __future__ import annotations

import numpy as np
import pytest
from support.assemblies import assembly
from support.assemblies import part as stick
from support.diagonal import first
from support.gear_trains import cam_and_follower, gear_pair, pinion_in_a_ring, rack_and_pinion
from support.solids import derived, part, random_pose, rod

from kinform.kinematics import functional
from kinform.kinematics.mobility.couplings import convex_turns
from kinform.model.function import IntendedJoint


def only(kinematics):
    assert kinematics.mobility.instantaneous == 1
    (coupling,) = kinematics.couplings
    assert coupling.status == "determined"
    return coupling


@pytest.mark.parametrize(("teeth", "points"), [((20, 30), 6), pytest.param((17, 40), 12, marks=pytest.mark.sweep)])
def test_a_gear_pair_has_one_freedom_and_the_ratio_of_its_teeth(teeth, points):
    errors = []
    for k, turn in enumerate(2 * np.pi / teeth[0] * (np.arange(3) + 0.15) / 3):
        coupling = only(derived(random_pose(np.random.default_rng(k)), **gear_pair(*teeth, turn, points))[0])
        assert coupling.kind == "gear"
        assert coupling.joints == ("gear0~housing", "gear1~housing")
        errors.append(coupling.ratio / (-teeth[1] / teeth[0]) - 1)
        assert abs(errors[-1]) < max(0.01, 3 * coupling.uncertainty)
    assert abs(np.mean(errors)) < 1e-3


BACKLASH = [(0.04, 0.04, 0.0), (0.1, 0.0, 0.094)]
MORE_BACKLASH = [pytest.param(*one, marks=pytest.mark.sweep) for one in ((0.04, 0.0, 0.0376), (0.02, -0.02, 0.0))]


@pytest.mark.parametrize(("thin", "lag", "touching"), BACKLASH + MORE_BACKLASH)
def test_with_backlash_the_flanks_that_are_nearest_count(thin, lag, touching):
    kinematics, contacts = derived(**gear_pair(20, 30, 0.13, 10, thin, lag))
    assert only(kinematics).ratio == pytest.approx(-1.5, rel=5e-3)
    lines = [patch for patch in contacts.patches if patch.kind == "line"]
    assert all(patch.parts == ("gear0", "gear1") for patch in lines)
    assert [patch.gap * 1e3 for patch in lines] == pytest.approx([touching] * len(lines), abs=2e-3)
    sides = {np.sign(patch.normals[0][1]) for patch in lines}
    assert len(sides) == (1 if lag else 2)


def test_an_idler_turns_the_sense_and_keeps_the_ratio():
    kinematics, _ = derived(random_pose(np.random.default_rng(5)), **gear_pair(20, 30, 0.1, 10, idler=24))
    assert kinematics.mobility.instantaneous == 1
    ratios = {coupling.joints: coupling.ratio for coupling in kinematics.couplings}
    total = ratios["gear0~housing", "gear1~housing"] * ratios["gear1~housing", "gear2~housing"]
    assert total == pytest.approx(1.5, rel=2e-3)
    teeth = sorted(coupling.meshing.ratio for coupling in kinematics.couplings)
    assert teeth == pytest.approx([-1.25, -1.2])


def test_a_rack_moves_by_the_pitch_radius_a_radian():
    ratios = []
    for k, turn in enumerate((0.1, 0.2, 0.3)):
        X = random_pose(np.random.default_rng(k))
        kinematics, _ = derived(X, **rack_and_pinion(turn=turn))
        coupling = only(kinematics)
        assert coupling.kind == "rack"
        assert coupling.joints == ("frame~pinion", "frame~rack")
        turns, slides = (next(j for j in kinematics.joints if j.name == name) for name in coupling.joints)
        # a turn about +z moves the top of the rack, below the pinion, along +x
        sense = np.sign(turns.axis @ X[:3, 2]) * np.sign(slides.axis @ X[:3, 0])
        ratios.append(coupling.ratio * sense * 0.01)
    assert ratios == pytest.approx([1.0] * 3, rel=0.01)
    assert np.mean(ratios) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("turn", first(1, [0.3, 1.2]))
def test_a_cam_lifts_its_follower_by_its_lever_at_this_pose(turn):
    solids, reach = cam_and_follower(turn)
    coupling = only(derived(random_pose(np.random.default_rng(1)), **solids)[0])
    assert coupling.kind == "cam"
    assert abs(coupling.ratio) == pytest.approx(1e3 / abs(reach), rel=1e-3)


def test_gears_out_of_reach_of_each_other_are_not_coupled():
    solids = gear_pair(20, 30)
    solids["gear0"] = gear_pair(16, 30)["gear0"]
    kinematics, contacts = derived(**solids)
    assert kinematics.couplings == ()
    assert kinematics.mobility.instantaneous == 2
    assert not [patch for patch in contacts.patches if patch.parts == ("gear0", "gear1")]


def test_teeth_turn_where_a_disc_does_not():
    gear, disc = (part(n, s, np.eye(4)) for n, s in (("g", gear_pair(12, 20)["gear0"]), ("d", rod(5, 0, 8))))
    axis, point = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 0.004])
    assert convex_turns(disc.mesh, disc.X_WP, axis, point) == pytest.approx(1.0)
    assert convex_turns(gear.mesh, gear.X_WP, axis, point) > 4.0


def test_a_screw_couples_its_turn_to_the_slide_of_its_nut():
    z, at = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    screw = IntendedJoint("screw", ("nut", "spindle"), "screw", z, None, at, 0.004, None, "m.toml", 1)
    turn = IntendedJoint("turn", ("frame", "spindle"), "revolute", z, None, at, None, None, "m.toml", 2)
    slide = IntendedJoint("slide", ("frame", "nut"), "prismatic", z, None, None, None, None, "m.toml", 3)
    names = ("frame", "nut", "spindle")
    made = assembly(*(stick(n, stick=True) for n in names), ground="frame", joints=(screw, turn, slide))
    (coupling,) = functional(made).couplings
    assert coupling.kind == "screw"
    assert coupling.joints == ("frame~nut", "frame~spindle")
    # the spindle turns right-handed and stays: relative to the nut it moves along +z, so the nut goes along -z
    assert coupling.ratio == pytest.approx(-0.004 / (2 * np.pi))


def test_a_pinion_in_a_ring_has_the_ratio_of_its_teeth():
    kinematics, _ = derived(**pinion_in_a_ring(20, 50, points=30))
    (found,) = kinematics.couplings
    assert kinematics.mobility.effective == 1
    assert (found.status, found.meshing.teeth) == ("determined", (20, 50))
    assert found.meshing.ratio == pytest.approx(2.5)


@pytest.mark.parametrize("X", [None, pytest.param(random_pose(np.random.default_rng(5)), marks=pytest.mark.sweep)])
def test_teeth_whose_tips_lean_leave_open_whether_they_turn(X):
    """The chamfers of the tips touch before the flanks do, and miss the one motion that is left by a little."""
    kinematics, _ = derived(X, **pinion_in_a_ring(18, 61, points=12))
    (teeth,) = (joint for joint in kinematics.joints if "frame" not in joint.bodies)
    assert teeth.status == "ambiguous"
    assert kinematics.mobility.uncertain == (teeth.name,)
