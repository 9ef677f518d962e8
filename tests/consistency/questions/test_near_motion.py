"""Loops that nearly move: which joint is out of place, and by how much, against what was displaced."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.assemblies import contacts as no_contacts
from support.devices import assembly, body, intended, joint, kinematics
from support.diagonal import diagonal

from kinform.consistency import check
from kinform.consistency.questions.near_motion import near_motions
from kinform.design import Design
from kinform.model.function import Function

Z, STRAIGHT = np.array([0.0, 0.0, 1.0]), np.eye(3)
CRANKS = {"k1": np.array([0.0, 0.0, 0.0]), "k2": np.array([0.1, 0.0, 0.0]), "k3": np.array([0.05, 0.035, 0.0])}
ARM = np.array([0.018, 0.036, 0.0])


def locomotive(off=None, turn=STRAIGHT, scale=1.0):
    """Three parallel cranks between a base and a coupler; `off` moves the points of hinges, by name (m)."""
    off = off or {}
    joints = []
    for name, foot in CRANKS.items():
        for other, place in (("base", foot), ("coupler", foot + ARM)):
            point = scale * (turn @ (place + off.get(f"{other}~{name}", 0.0)))
            joints.append(joint(other, name, "revolute", turn @ Z, point))
    return kinematics([body(n) for n in ("base", "coupler", *CRANKS)], joints)


def four_bar(tilts=None, turn=STRAIGHT):
    """Four hinges in a plane; `tilts` are turns (3,) of their axes, by number (rad)."""
    tilts = tilts or {}
    places = np.array([(0, 0, 0), (0.02, 0.06, 0), (0.12, 0.09, 0), (0.13, 0, 0.0)])
    names = ["base", "crank", "bar", "rocker", "base"]
    joints = []
    for k, place in enumerate(places):
        axis = Rotation.from_rotvec(tilts.get(k, np.zeros(3))).apply(Z)
        joints.append(joint(names[k], names[k + 1], "revolute", turn @ axis, turn @ place))
    return kinematics([body(n) for n in names[:4]], joints)


def test_what_moves_needs_no_correction():
    assert near_motions(locomotive()) == ()
    assert near_motions(four_bar()) == ()


@settings(max_examples=3, deadline=None)
@given(
    st.sampled_from(sorted(CRANKS)), st.sampled_from(["base", "coupler"]), st.floats(0.0, 6.28),
    st.floats(2e-6, 3e-4), st.integers(0, 10_000), st.sampled_from([0.01, 1.0, 100.0]),
)  # fmt: skip
def test_a_hinge_beside_its_place_is_named_with_the_other_end_of_its_crank(name, side, angle, far, seed, scale):
    """Moved back, or the other end moved along: nothing else brings the three cranks into one motion. Along the crank
    it is hardly out of place: to first order the cranks go on moving together, and nothing need be named."""
    assume(abs(np.sin(angle - np.arctan2(ARM[1], ARM[0]))) > 0.05)
    shift = far * np.array([np.cos(angle), np.sin(angle), 0.0])
    turn = Rotation.random(random_state=seed).as_matrix()
    found = near_motions(locomotive({f"{side}~{name}": shift}, turn, scale))
    assert len(found) == 1
    other = {"base": "coupler", "coupler": "base"}[side]
    by_name = {one.joint: one for one in found[0].corrections}
    assert set(by_name) == {f"{side}~{name}", f"{other}~{name}"}
    within = 1e-3 * far * scale
    np.testing.assert_allclose(by_name[f"{side}~{name}"].shift, -scale * (turn @ shift), atol=within)
    np.testing.assert_allclose(by_name[f"{other}~{name}"].shift, scale * (turn @ shift), atol=within)
    assert len(found[0].moves) == 6


@diagonal(k=range(4), tilt=[2e-4, 0.01])
def test_an_axis_askew_is_named_with_its_angle(k, tilt):
    turn = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
    (near,) = near_motions(four_bar({k: tilt * np.array([0.6, 0.8, 0.0])}, turn))
    assert near.corrections[0].joint == four_bar().joints[k].name
    assert near.corrections[0].tilt == pytest.approx(tilt, rel=1e-3)


def test_two_that_are_off_are_not_one_that_is():
    assert near_motions(four_bar({0: np.array([0.01, 0.0, 0.0]), 2: np.array([0.0, 0.01, 0.0])})) == ()


def test_what_is_far_off_is_another_design():
    assert near_motions(locomotive({"base~k3": np.array([0.01, 0.004, 0.0])})) == ()


def test_the_finding_names_the_joint_as_the_designer_does():
    made = locomotive({"coupler~k3": np.array([-8e-6, 0.0, 0.0])})
    wanted = intended("m", "k3", "coupler", "revolute", Z, CRANKS["k3"] + ARM)
    device = assembly([body(b.name, mass=None) for b in made.bodies], Function(mobility=1, joints=(wanted,)))
    found = check(Design(device, contacts=no_contacts(), kinematics=made))
    (finding,) = [one for one in found.findings if one.code == "KF301"]
    assert "'base~k3'" in finding.remedy and "'m'" in finding.remedy
