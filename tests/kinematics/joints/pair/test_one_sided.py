"""End stops, slivers and flanks: what contact may mean in two ways is ambiguous, names both, and fuses nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.patches import Z, cylinder, patch, plane, ring, sphere
from support.thresholds import changes_once

from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import gather
from kinform.model.tolerances import Tolerances

X, Y = np.eye(3)[0], np.eye(3)[1]


def decision(patches, contact=5e-4):
    evidence = gather([(k, p, False) for k, p in enumerate(patches)], Tolerances(), contact, 0.0)
    return decide(evidence, Tolerances())


def types(found):
    return found.form.type, found.status, None if found.other is None else found.other.form.type


def disc(at=(0, 0, -0.01), normal=-Z, outer=0.004, **keys):
    return ring(at, normal, inner=0.0005, outer=outer, **keys)


def moved(patch, turn, scale, shift):
    """The patch of the same contact at another attitude, size and place."""
    R = turn.as_matrix()
    return replace(
        patch,
        points=scale * patch.points @ R.T + shift,
        normals=patch.normals @ R.T,
        weights=scale**2 * patch.weights,
        area=scale**2 * patch.area,
        gaps=scale * patch.gaps,
        gap=scale * patch.gap,
        axis=R @ patch.axis,
        point=scale * R @ patch.point + shift,
        radii=tuple(scale * r for r in patch.radii),
        uncertainty=(patch.uncertainty[0], scale * patch.uncertainty[1]),
    )


def test_a_piston_at_the_bottom_of_its_bore_is_a_shaft_on_its_thrust_face():
    assert types(decision([cylinder(), disc()])) == ("revolute", "ambiguous", "cylindrical")


def test_a_shaft_on_its_collar_is_a_shaft():
    assert types(decision([cylinder(), ring((0, 0, -0.01), -Z)])) == ("revolute", "determined", None)


def test_a_collar_that_runs_round_half_of_the_shaft_still_holds_it_one_beside_it_may_not():
    pad = plane((0.009, 0, 0.01), Z, (0.004, 0.004))
    assert types(decision([cylinder(), pad])) == ("revolute", "ambiguous", "cylindrical")


def test_a_short_pivot_would_jam_and_a_long_one_may_be_a_piston():
    def answer(length):
        found = decision([cylinder(length=length), disc((0, 0, -length / 2))])
        return found.form.type, found.status

    changes_once(answer, 0.003, 0.02, ("revolute", "determined"), ("revolute", "ambiguous"))


@pytest.mark.parametrize("scale", [1e-2, 1.0, 1e2])
def test_a_ram_that_is_drawn_in_ends_at_its_collar_and_its_bottom_and_a_short_boss_is_a_pivot(scale):
    turn = Rotation.from_rotvec([0.3, -0.7, 0.4])

    def answer(length):
        ends = [disc((0, 0, -length / 2)), ring((0, 0, length / 2), -Z)]
        patches = [
            moved(one, turn, scale, np.array([0.1, 0.0, -0.2]) * scale) for one in (cylinder(length=length), *ends)
        ]
        return types(decision(patches, 5e-4 * scale))

    changes_once(answer, 0.01, 0.05, ("revolute", "determined", None), ("revolute", "ambiguous", "cylindrical"))


@pytest.mark.parametrize("scale", [1e-2, 1.0, 1e2])
@pytest.mark.parametrize("turned", [False, True])
def test_a_finger_between_cheeks_is_guided_by_a_long_floor_and_a_short_face_may_end_its_turn(scale, turned):
    turn = Rotation.from_rotvec([0.3, -0.7, 0.4] if turned else [0.0, 0.0, 0.0])

    def answer(length):
        cheeks = [plane(0.005 * n, n, (0.0072, 0.0086)) for n in (X, -X)]
        floor = plane((0, 0.001, -0.0036), -Z, (length, 0.01))
        patches = [moved(one, turn, scale, np.array([0.1, 0.0, -0.2]) * scale) for one in (*cheeks, floor)]
        return types(decision(patches, 5e-4 * scale))

    changes_once(answer, 0.0006, 0.02, ("prismatic", "ambiguous", "planar"), ("prismatic", "determined", None))


@pytest.mark.parametrize("scale", [1e-2, 1.0, 1e2])
def test_a_knee_flush_on_its_hip_is_guided_by_a_long_fence_and_a_short_one_may_end_its_turn(scale):
    turn = Rotation.from_rotvec([0.3, -0.7, 0.4])

    def answer(length):
        patches = [plane((0, 0, 0), Z, (0.05, 0.05)), plane((0, -0.03, 0.01), -Y, (0.02, length))]
        found = decision([moved(one, turn, scale, np.array([0.1, 0.0, -0.2]) * scale) for one in patches], 5e-4 * scale)
        assert found.cone.plainly_open
        return types(found)

    changes_once(answer, 0.006, 0.06, ("prismatic", "ambiguous", "planar"), ("prismatic", "determined", None))


@pytest.mark.parametrize("half", [0.004, 0.02])
def test_a_short_ridge_holds_in_both_senses_and_is_a_guide(half):
    sides = [plane((0, 0.01 * sign, 0.005), (0.0, sign * 0.8, 0.6), (2 * half, 0.01)) for sign in (1.0, -1.0)]
    assert types(decision([plane((0, 0, 0), Z, (0.05, 0.05)), *sides])) == ("prismatic", "determined", None)


def test_a_stepped_shaft_leaves_its_steps_when_it_slides_and_is_no_piston():
    steps = [cylinder(0.008, 0.006, point=(0, 0, 0.03)), cylinder(0.007, 0.003)]
    assert types(decision([*steps, disc((0, 0, -0.0015), outer=0.006)])) == ("revolute", "determined", None)


def test_a_square_piston_that_nothing_but_its_bottom_holds_may_slide():
    walls = [plane(0.01 * n, n, (0.02, 0.02)) for n in (X, -X, Y, -Y)]
    floor = plane((0, 0, -0.01), -Z, (0.02, 0.02))
    found = decision([*walls, floor])
    assert found.status in ("blocked", "ambiguous")
    assert "prismatic" in (found.form.type, found.other.form.type if found.other else "")


def test_a_slight_face_beside_a_finger_may_hold_nothing_and_a_longer_one_is_plainly_open():
    """From 1 % of the area on: what rests against two faces at once may leave both, and keeps to both at rest."""

    def answer(width):
        side = plane((0.015 - width / 2, 0.003, 0.001), Y, (0.002, width))
        found = decision([plane(size=(0.006, 0.03)), side])
        assert found.cone.plainly_open
        return found.form.type, found.status

    changes_once(answer, 0.0005, 0.03, ("prismatic", "ambiguous"), ("prismatic", "determined"))


def test_faces_on_both_sides_of_a_finger_guide_it_however_short():
    flush = plane(size=(0.006, 0.03))
    sides = [plane((0.0, s * 0.003, 0.001), s * Y, (0.004, 0.004)) for s in (1, -1)]
    assert types(decision([flush, *sides])) == ("prismatic", "determined", None)


@pytest.mark.parametrize("side", [1, -1])
def test_a_lever_on_its_stop_turns_away_from_it(side):
    stop = plane((0.03, -0.003 * side, 0), -side * Y, (0.002, 0.002))
    found = decision([cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z), stop])
    assert types(found) == ("revolute", "determined", None)
    [(k, motion, sense)] = found.ended
    assert (k, sense * motion.axis[2]) == (3, side)
    assert (found.cone.rest.shape[1], found.cone.closed.shape[1], found.cone.plainly_open) == (0, 1, False)
    assert abs(found.cone.closed[2, 0]) == pytest.approx(np.linalg.norm(found.cone.closed[:3, 0]))


LEVER_STOP = plane((0.03, -0.003, 0), -Y, (0.002, 0.002))


def test_a_lever_on_its_stop_and_on_a_pad_beside_its_axis_may_leave_the_pad():
    found = decision([cylinder(), plane((0.009, 0, 0.01), Z, (0.004, 0.004)), LEVER_STOP])
    assert types(found) == ("revolute", "ambiguous", "cylindrical")
    assert [k for k, *_ in found.ended] == [2]
    assert (found.cone.rest.shape[1], found.cone.closed.shape[1]) == (0, 2)


def test_a_piston_at_the_bottom_of_its_bore_with_a_lever_on_its_stop_is_as_doubtful_as_without():
    found = decision([cylinder(), disc(), LEVER_STOP])
    assert types(found) == ("revolute", "ambiguous", "cylindrical")
    assert [k for k, *_ in found.ended] == [2]
    assert [k for k, _ in found.other.left_out] == [1]


def test_a_block_in_a_corner_rests_there_and_is_plainly_open_whichever_wall_is_longer():
    """One of its motions opens all three faces; what it may do spans all motions."""
    for length in (0.01, 0.016, 0.025):
        floor = plane(size=(0.01, length))
        walls = [plane((-length / 2, 0, 0.001), X, (0.01, 0.002)), plane((0, -0.005, 0.001), Y, (0.002, length))]
        found = decision([floor, *walls])
        assert types(found) == ("fixed", "determined", None)
        assert (found.cone.plainly_open, found.cone.rest.shape[1], found.cone.closed.shape[1]) == (True, 0, 6)


def test_a_lever_that_a_large_stop_holds_is_not_fused():
    stop = plane((0.03, -0.003, 0), -Y, (0.06, 0.06))
    found = decision([cylinder(length=0.004), ring((0, 0, 0.002)), ring((0, 0, -0.002), normal=-Z), stop])
    assert types(found) == ("revolute", "determined", None)
    assert [k for k, *_ in found.ended] == [3]


@pytest.mark.parametrize(
    ("arc", "one_sided", "area", "status"),
    [
        (0.3, False, 2e-6, "ambiguous"),
        (1.2, False, 2e-4, "determined"),
        (0.3, True, 2e-6, "ambiguous"),
        (1.4, True, 2e-4, "ambiguous"),
    ],
)
def test_a_sliver_of_a_round_makes_no_hinge(arc, one_sided, area, status):
    """Nor do facets of no known surface that run on a quarter of it, however large."""
    wide = plane(size=(0.1, 0.1))
    sliver = cylinder(0.01, 0.002, point=(0, 0, 0.001), arc=(0.0, arc), one_sided=one_sided, area=area)
    assert decision([wide, sliver]).status == status


def test_flanks_of_teeth_alone_are_no_joint():
    flanks = [
        cylinder(0.005, 0.004, point=(0.002 * k, 0, 0), arc=(0.2 * k, 0.2 * k + 0.3), one_sided=True, area=4e-6)
        for k in range(4)
    ]
    assert decision([*flanks, plane((0, 0, 0.002), Z, (0.001, 0.002))]).status == "ambiguous"


@pytest.mark.parametrize(
    ("size", "gap", "status"), [(0.002, -1e-4, "ambiguous"), (0.01, -1e-4, "ambiguous"), (0.03, 0.0, "determined")]
)
def test_a_flat_that_dips_into_a_hinge_makes_no_slider_of_it(size, gap, status):
    assert decision([plane(size=(0.05, 0.05)), plane((0.02, 0.02, 0.001), Y, (size, size), gap=gap)]).status == status


def test_an_axis_that_the_fits_hardly_know_is_none():
    def answer(*uncertainty):
        found = decision([cylinder(uncertainty=uncertainty)])
        return found.form.type, found.status

    sure, doubtful = ("cylindrical", "determined"), ("cylindrical", "ambiguous")
    changes_once(lambda direction: answer(direction, 1e-6), 1e-4, 0.02, sure, doubtful)
    changes_once(lambda place: answer(1e-4, place), 1e-6, 5e-4, sure, doubtful)


SCENES = {
    "piston": [cylinder(), disc()],
    "collar": [cylinder(), ring((0, 0, -0.01), -Z)],
    "finger": [plane(size=(0.006, 0.03)), plane((0.0145, 0.003, 0.0005), Y, (0.001, 0.001))],
    "sliver": [plane(size=(0.1, 0.1)), cylinder(0.01, 0.002, arc=(0.0, 0.3), area=2e-6)],
}


@pytest.mark.parametrize("name", SCENES)
@settings(max_examples=15, deadline=None)
@given(
    turn=st.integers(0, 2**31 - 1),
    scale=st.sampled_from([1e-3, 0.37, 1.0, 1e3]),
    shift=st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
)
def test_attitude_size_and_place_do_not_matter(name, turn, scale, shift):
    turn = Rotation.random(random_state=turn)
    there = [moved(p, turn, scale, scale * np.array(shift)) for p in SCENES[name]]
    assert types(decision(there, 5e-4 * scale)) == types(decision(SCENES[name]))


def test_a_tiny_flat_holds_a_shaft_both_ways():
    flat = plane((0, 0.004, 0), Y, (0.002, 0.002))
    assert types(decision([cylinder(length=0.05), ring((0, 0, 0.025)), ring((0, 0, -0.025), normal=-Z), flat])) in [
        ("fixed", "determined", None)
    ]


def test_a_tiny_face_against_a_ball_joint_leaves_it_a_ball_joint():
    found = decision([sphere(0.01), plane((0.012, 0, 0.002), X, (0.0008, 0.0008))])
    assert found.status in ("blocked", "ambiguous")
    assert "spherical" in (found.form.type, found.other.form.type if found.other else "")


def test_a_constraint_that_the_directions_may_lack_is_none_for_sure():
    """Two faces that lean by 1.1° against each other are a slider, if they really lean."""
    leaning = np.array([0.0, np.sin(0.02), np.cos(0.02)])
    faces = [plane((0, 0.01, 0), size=(0.02, 0.02)), plane((0, -0.01, 0), leaning, size=(0.02, 0.02))]

    def answer(known_to):
        return types(decision([replace(face, mismatch=(known_to, 1e-7)) for face in faces]))[:2]

    changes_once(answer, 1e-6, 2e-3, ("prismatic", "determined"), ("prismatic", "ambiguous"))


def rim(height=0.01, radius=0.008, slope=(-0.6, 0.8), **keys):
    """A circle on a cone or ball about z: its normals out of a."""
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    outward = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    normals = slope[0] * outward + slope[1] * Z
    return patch(radius * outward + height * Z, normals, "line", area=3e-7, radii=(radius, 0.0), **keys)


def test_a_rim_in_its_seat_beside_a_guide_holds_it_or_is_a_stop():
    assert types(decision([cylinder(), rim()])) == ("revolute", "ambiguous", "cylindrical")
    assert types(decision([cylinder(), rim(slope=(0.6, -0.8))])) == ("revolute", "ambiguous", "cylindrical")


def test_a_rim_that_a_shoulder_holds_in_its_seat_changes_nothing():
    assert types(decision([cylinder(), ring((0, 0, -0.01), -Z), rim()])) == ("revolute", "determined", None)


def test_rims_in_seats_at_both_ends_are_no_stop():
    assert types(decision([cylinder(), rim(), rim(-0.01, slope=(-0.6, -0.8))])) == ("revolute", "ambiguous", None)
