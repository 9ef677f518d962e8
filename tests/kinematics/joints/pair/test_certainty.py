"""What makes an answer doubtful: then it is ambiguous, says why, and fuses nothing."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.patches import Z, cylinder, patch, plane, ring, sphere

from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import gather
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.uncertainty import disagreement, joint_uncertainty
from kinform.model.tolerances import Tolerances

X, Y = np.eye(3)[0], np.eye(3)[1]


@cache
def collars():
    return [ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)]


def decision(patches, size=0.0):
    evidence = gather([(k, p, False) for k, p in enumerate(patches)], Tolerances(), 5e-4, size)
    return decide(evidence, Tolerances())


def flank(at, normal):
    """A tooth's flank that touches another along a strip."""
    return replace(plane(at, normal, (0.0005, 0.006)), kind="freeform", one_sided=True, axis=np.zeros(3))


def test_teeth_that_hold_each_other_are_no_slider():
    flanks = [flank((0.01, s * 0.0007, 0), (0.34, s * 0.94, 0)) for s in (1, -1)]
    flanks += [flank((0.0095, s * 0.002, 0), (0.3, s * 0.95, 0)) for s in (1, -1)]
    found = decision(flanks)
    assert found.status == "ambiguous"


def test_bodies_that_only_unknown_facets_hold_are_not_sure_to_be_one():
    box = [plane((0.01, 0, 0), X), plane((-0.01, 0, 0), -X), plane((0, 0, -0.01), -Z), plane((0, 0, 0.01), Z)]
    walls = [plane((0, s * 0.01, 0), s * Y) for s in (1, -1)]
    assert (decision(box + walls).form.type, decision(box + walls).status) == ("fixed", "determined")
    loose = [replace(p, one_sided=True) for p in walls]
    assert decision(box + loose).status != "determined"


@pytest.mark.parametrize("apart", [1.2e-4, 2e-4])
def test_bearings_that_nearly_agree_do_not_make_one_body(apart):
    bearings = [cylinder(length=0.005, point=(0, 0, -0.006)), cylinder(length=0.005, point=(apart, 0, 0.006))]
    found = decision([*bearings, *collars()])
    assert found.form.type == "fixed"
    assert found.status == "ambiguous"


def test_a_dowel_beside_a_pilot_is_no_bearing_that_nearly_agrees():
    found = decision([plane(size=(0.04, 0.04)), cylinder(0.01, 0.005), cylinder(0.0015, 0.005, point=(0.015, 0, 0))])
    assert (found.form.type, found.status) == ("fixed", "determined")


@pytest.mark.parametrize(
    ("side", "gap", "status"),
    [(0.02, 0.0, "determined"), (0.02, 3e-4, "determined"), (0.001, 0.0, "ambiguous"), (0.004, 3e-4, "ambiguous")],
)
def test_a_small_touch_on_one_side_may_be_a_stray(side, gap, status):
    found = decision([plane(size=(side, side), gap=gap)], size=0.06)
    assert (found.form.type, found.status) == ("planar", status)


def test_a_table_on_four_small_feet_is_no_stray():
    feet = [plane((x, y, 0), Z, (0.001, 0.001)) for x in (-0.02, 0.02) for y in (-0.02, 0.02)]
    found = decision(feet, size=0.08)
    assert (found.form.type, found.status) == ("planar", "determined")


def test_a_small_sandwich_is_no_stray():
    faces = [plane((0, 0, s * 0.001), s * Z, (0.002, 0.002)) for s in (1, -1)]
    assert decision(faces, size=0.06).status == "determined"


def test_a_ball_on_a_table_is_what_it_is():
    point = patch([[0, 0, 0]], Z, "point", area=1e-8)
    found = decision([point], size=0.05)
    assert (found.form.type, found.basis.shape[1], found.status) == ("general", 5, "determined")


def test_planes_that_differ_within_their_uncertainties_leave_a_plane_motion():
    tilts = [(0.0, 0.0), (0.006, -0.003), (-0.004, 0.006), (0.003, 0.007)]
    places = [(0, 0, 0), (0.05, 0.01, 0), (0.02, 0.06, 0), (-0.04, 0.02, 0)]
    faces = [
        plane(at, np.array([*tilt, 1.0]) / np.linalg.norm([*tilt, 1.0]), uncertainty=(0.003, 1e-5))
        for at, tilt in zip(places, tilts, strict=True)
    ]
    found = decision(faces)
    assert (found.form.type, found.basis.shape[1]) == ("planar", 3)


def test_a_journal_with_much_clearance_does_not_add_turns_about_other_axes():
    journal = cylinder(0.011, 0.0001, gap=4e-4, area=1e-6, arc=(-0.4, 0.4))
    faces = [plane((0, 0.00128, s * 0.0185), s * Z, (0.015, 0.015)) for s in (1, -1)]
    assert decision([journal, *faces]).form.type == "revolute"


def test_the_gaps_of_unknown_facets_say_how_far_off_their_axis_may_be():
    journal, other = cylinder(0.01, 0.002), cylinder(0.0027, 0.002, point=(8e-5, 0, 0.003), one_sided=True, area=6e-6)
    uneven = replace(other, gaps=8e-5 * (other.points - other.point)[:, 0] / 0.0027)
    face = ring((0, 0, 0.004), inner=0.003, outer=0.009)
    assert decision([journal, face, uneven]).form.type == "revolute"


def test_a_ball_in_a_socket_stays_sure():
    assert decision([sphere(cap=0.3)], size=0.05).status == "determined"


def test_an_axis_is_known_no_better_than_patches_that_disagree_say():
    """A small ring that is said to be exact, and journals that lie 0.02 rad off it: the axis is not known to 1e-6."""
    tilted = np.array([np.sin(0.02), 0.0, np.cos(0.02)])
    small = replace(ring((0, 0, 0.01), inner=0.0049, outer=0.005), uncertainty=(1e-6, 1e-6))
    journals = [replace(cylinder(axis=tilted), uncertainty=(0.05, 1e-5))]
    evidence = gather([(k, p, False) for k, p in enumerate([small, *journals])], Tolerances(), 5e-4, 0.0)
    for axis, least in ((tilted, 0.0199), (Z, 0.9e-6)):
        form = JointForm("revolute", axis, np.zeros(3))
        assert joint_uncertainty(evidence.items, form)[0] == pytest.approx(1e-6)
        assert least <= disagreement(evidence.items, form) <= max(1.02 * least, 1.2e-6)


@pytest.mark.parametrize(
    ("sides", "share", "status"), [(8, 0.96, "ambiguous"), (8, 0.7, "determined"), (0, 0.96, "determined")]
)
def test_a_flat_where_those_of_a_coarse_cylinder_are_may_be_one_of_them(sides, share, status):
    """A D-shaft's lies deeper."""
    radius = 0.01
    bore = replace(
        cylinder(radius=radius, length=0.04), sides=sides, chord=radius * (1 - np.cos(np.pi / 8)) * bool(sides)
    )
    flat = plane((share * radius, 0, 0), normal=X, size=(0.006, 0.03))
    found = decision([bore, flat])
    assert (found.form.type, found.status) == ("prismatic", status)
