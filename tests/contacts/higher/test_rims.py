"""Sharp rims on round surfaces: where they touch, and what that holds, by screws of the analytic surfaces."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from support.diagonal import diagonal
from support.solids import ball, box, derived, random_pose, rod

MM = 1e-3


def tangent(degrees):
    return math.tan(math.radians(degrees))


def cone(half, height, n, phase=0.0):
    """A cone about z whose apex is the origin, up to this height."""
    return Manifold.cylinder(height, 0, height * tangent(half), n).rotate((0, 0, phase))


def seat(half, n, depth=20.0):
    """A block with a conical hole about z, whose apex is the origin."""
    return rod(depth * tangent(half) + 5, 1, depth - 1, n) - cone(half, depth, n, 1.0)


def plate(radius, n, thick=5.0):
    """A plate below z = 0 with a hole about z."""
    return box(-20, 20, -20, 20, -thick, 0) - rod(radius, -thick - 1, 1, n, 2.0)


def tube(inner, outer, low, high, n):
    return rod(outer, low, high, n, 1.5) - rod(inner, low - 1, high + 1, n, 2.5)


def torus(middle, radius, n):
    angles = np.linspace(0, 2 * np.pi, n, endpoint=False)
    circle = np.stack([middle + radius * np.cos(angles), radius * np.sin(angles)], axis=1)
    return Manifold.revolve(CrossSection([circle]), n)


def flat_ball(radius, low, n):
    """A ball about the origin that ends in a flat at z = `low`."""
    angles = np.linspace(math.asin(low / radius), math.pi / 2, max(n // 2, 8))
    outline = np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)
    outline[-1, 0] = 0.0
    return Manifold.revolve(CrossSection([np.vstack([[[0.0, low]], outline])]), n)


def ring(radius, height, slope):
    """Points and normals out of the round surface of a circle about z; `slope` (2,) of the normals outward and up."""
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    outward = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    slope = np.asarray(slope) / np.linalg.norm(slope)
    return radius * outward + [0, 0, height], slope[0] * outward + [0, 0, slope[1]]


def freedoms(points, normals):
    rows = np.concatenate([np.cross(points, normals), normals], axis=1)
    return 6 - int(np.linalg.matrix_rank(rows, tol=1e-9 * np.abs(rows).max()))


def leg(hypotenuse, other):
    return math.sqrt(hypotenuse**2 - other**2)


H8, H7 = leg(8, 5), leg(8, 6)
ALL_ROUND = {
    "a ball on the rim of a hole": (
        ring(5, 0, (5, -H8)),
        lambda n: (ball(8, n).translate((0, 0, H8)), plate(5, n)),
    ),
    "a cone on the rim of a hole": (
        ring(5, 0, (math.cos(math.pi / 6), -math.sin(math.pi / 6))),
        lambda n: (cone(30, 20, n).translate((0, 0, -5 / tangent(30))), plate(5, n, 20)),
    ),
    "the end of a tube on a ball": (
        ring(6, H7, (6, H7)),
        lambda n: (ball(8, n), tube(6, 9, H7, 25, n)),
    ),
    "the edge of a cylinder in a conical seat": (
        ring(5, 5 / tangent(35), (-math.cos(math.radians(35)), math.sin(math.radians(35)))),
        lambda n: (seat(35, n), rod(5, 5 / tangent(35), 25, n, 3.0)),
    ),
    "the edge of a cylinder in a hollow sphere": (
        ring(6, -H7, (-6, H7)),
        lambda n: (box(-12, 12, -12, 12, -12, 0) - ball(8, n), rod(6, -H7, 20, n, 1.0)),
    ),
    "the edge of a taper in a bore": (
        ring(5, 0, (-1, 0)),
        lambda n: (tube(5, 9, -30, 10, n), Manifold.cylinder(20, 3, 5, n).translate((0, 0, -20))),
    ),
    "a ball with a flat in a conical seat": (
        ring(leg(8, 6), leg(8, 6) / tangent(60), (-math.cos(math.pi / 3), math.sin(math.pi / 3))),
        lambda n: (
            seat(60, n),
            flat_ball(8, -6, n).translate((0, 0, 6 + leg(8, 6) / tangent(60))),
        ),
    ),
    "the edge of a cylinder on a ring": (
        ring(13, leg(4, 2), (-2, leg(4, 2))),
        lambda n: (torus(15, 4, n), rod(13, leg(4, 2), 20, n, 1.0)),
    ),
}
"""By name: closed-form contact, normals out of the first solid, and the solids of so many segments."""
BALLS = {
    "a ball on the rim of a hole",
    "the end of a tube on a ball",
    "the edge of a cylinder in a hollow sphere",
}


def placed(solids, swap, X, scale=MM):
    """Kinematics and contacts of two solids, and the sign of the normals of the first."""
    names = ("b", "a") if swap else ("a", "b")
    return *derived(X, scale, **dict(zip(names, solids, strict=True))), -1.0 if swap else 1.0


def in_design(patch, X, scale=MM):
    """Points and normals of a patch in the frame in which the solids were made, in its units."""
    return (patch.points - X[:3, 3]) @ X[:3, :3] / scale, patch.normals @ X[:3, :3]


def check_all_round(name, contacts, sign, X, scale=MM):
    (expected, directions), _ = ALL_ROUND[name]
    (patch,) = contacts.patches
    assert (patch.kind, patch.one_sided, patch.fit) == ("line", False, "touch")
    points, normals = in_design(patch, X, scale)
    radius, height = np.hypot(*expected[0, :2]), expected[0, 2]
    across, up = directions[0, :2] @ expected[0, :2] / radius, directions[0, 2]
    assert np.hypot(*points[:, :2].T) == pytest.approx(radius, rel=2e-6)
    assert points[:, 2] == pytest.approx(height, abs=2e-5)
    outward = points[:, :2] / radius
    assert (normals[:, :2] * outward).sum(axis=1) == pytest.approx(sign * across, abs=1e-5)
    assert normals[:, 2] == pytest.approx(sign * up, abs=1e-5)
    angles = np.sort(np.arctan2(points[:, 1], points[:, 0]))
    assert np.diff(angles, append=angles[0] + 2 * np.pi).max() < math.radians(30)


@diagonal(name=sorted(ALL_ROUND), mesh=[(16, False), (48, True), (129, False)])
def test_a_rim_about_the_axis_of_a_round_surface_touches_it_all_round(name, mesh):
    segments, swap = mesh
    contact, make = ALL_ROUND[name]
    X = random_pose(np.random.default_rng(segments))
    kinematics, contacts, sign = placed(make(segments), swap, X)
    check_all_round(name, contacts, sign, X)
    (joint,) = kinematics.joints
    assert joint.freedoms == freedoms(*contact)
    assert (joint.type, joint.status) == (("spherical", "ambiguous") if name in BALLS else ("general", "determined"))


@diagonal(name=sorted(ALL_ROUND), scale=[1e-6, 5.0])
def test_rims_touch_at_any_size(name, scale):
    X = random_pose(np.random.default_rng(7), reach=100 * scale)
    kinematics, contacts, sign = placed(ALL_ROUND[name][1](40), False, X, scale)
    check_all_round(name, contacts, sign, X, scale)
    assert kinematics.joints[0].freedoms == freedoms(*ALL_ROUND[name][0])


@settings(max_examples=4, deadline=None)
@given(st.floats(15, 70), st.floats(2, 9), st.integers(13, 120), st.integers(13, 120), st.floats(0, 360))
def test_a_cone_on_a_rim_turns_about_one_point_of_its_axis(half, radius, one, other, turn):
    """All normals of a circle on a cone about its axis meet in one point."""
    apex, tall = -radius / tangent(half), 1.6 * radius / tangent(half)
    solids = cone(half, tall, one, turn).translate((0, 0, apex)), plate(radius, other, 20)
    kinematics, contacts, _ = placed(solids, False, np.eye(4))
    (patch,) = contacts.patches
    meet = np.array([0.0, 0.0, radius * tangent(half)]) * MM
    arms = np.cross(patch.normals, patch.points - meet)
    assert arms == pytest.approx(np.zeros_like(arms), abs=1e-5 * radius * MM)
    assert kinematics.joints[0].freedoms == 3


def tilted_cone(half, tilt, radius, n):
    """A cone whose axis leans to +x by `tilt`, on the rim about z: it touches at (±radius, 0, 0), where the ellipse in
    which it meets the plane of the rim is longest."""
    one, other = half + tilt, half - tilt
    deep = 2 * radius / (tangent(one) + tangent(other))
    return cone(half, 25, n).rotate((0, tilt, 0)).translate((radius - deep * tangent(one), 0, -deep))


def disc_on_cone(lean, n):
    """A disc that touches the cone of 30° about z with its rim at height 10, and the place and the normal."""
    half, wide = math.pi / 6, 10 * tangent(30)
    normal, along = np.array([math.cos(half), 0, -math.sin(half)]), np.array([math.sin(half), 0, math.cos(half)])
    inward = math.cos(lean) * normal + math.sin(lean) * along
    axis = math.sin(lean) * normal - math.cos(lean) * along
    place = np.array([wide, 0.0, 10.0])
    R = np.stack([inward, np.cross(axis, inward), axis], axis=1)
    pose = np.concatenate([R, (place + 6 * inward)[:, None]], axis=1)
    return (cone(30, 20, n), rod(6, 0, 3, n, 2.0).transform(pose)), place[None], normal[None]


def sides(half, tilt):
    one, other = math.radians(half + tilt), math.radians(half - tilt)
    return np.array([[math.cos(one), 0, -math.sin(one)], [-math.cos(other), 0, -math.sin(other)]])


AT_POINTS = {
    "a ball on one side of the rim of a hole": lambda n: (
        (ball(3, n).translate((4, 0, leg(3, 1))), plate(5, n)),
        np.array([[5.0, 0, 0]]),
        np.array([[1.0, 0, -leg(3, 1)]]) / 3,
    ),
    "a cone that leans in a hole": lambda n: (
        (tilted_cone(30, 8, 5, n), plate(5, n, 20)),
        np.array([[5.0, 0, 0], [-5.0, 0, 0]]),
        sides(30, 8),
    ),
    "a disc on its rim on a cone": lambda n: disc_on_cone(0.7, n),
    "a disc on its rim on a cone, nearly flat": lambda n: disc_on_cone(1.3, n),
}
"""By name: two solids, and where they touch with normals out of the first."""


@diagonal(name=sorted(AT_POINTS), mesh=[(20, True), (48, False), (128, True)])
def test_any_other_rim_touches_where_it_comes_nearest(name, mesh):
    segments, swap = mesh
    solids, places, directions = AT_POINTS[name](segments)
    X = random_pose(np.random.default_rng(segments))
    kinematics, contacts, sign = placed(solids, swap, X)
    assert [patch.kind for patch in contacts.patches] == ["point"] * len(places)
    found = [in_design(patch, X) for patch in contacts.patches]
    points, normals = (np.concatenate(of) for of in zip(*found, strict=True))
    order = np.argsort(-points[:, 0])
    assert points[order] == pytest.approx(places, abs=1e-4)
    assert normals[order] == pytest.approx(sign * directions, abs=1e-4)
    (joint,) = kinematics.joints
    assert (joint.type, joint.status) == ("general", "determined")
    assert joint.freedoms == freedoms(places, directions)


def test_of_half_a_rim_half_is_touched():
    half = plate(5, 48) ^ box(-30, 30, 0, 30, -10, 10)
    kinematics, contacts, _ = placed((ball(8, 48).translate((0, 0, H8)), half), False, np.eye(4))
    lines = [patch for patch in contacts.patches if patch.kind == "line"]
    assert len(lines) == 1
    assert lines[0].points[:, 1].min() > 0
    assert np.hypot(*lines[0].points[:, :2].T) == pytest.approx(5 * MM, rel=1e-6)
    assert kinematics.joints[0].freedoms == 3


def test_a_rim_that_is_cut_away_where_it_would_touch_does_not():
    cut = plate(5, 48) - box(2, 30, -3, 3, -10, 10)
    _, contacts, _ = placed((ball(3, 48).translate((4, 0, leg(3, 1))), cut), False, np.eye(4))
    assert not any(np.hypot(*(patch.points[:, 1:] / MM).T).min() < 1 for patch in contacts.patches)


@diagonal(name=["a ball on the rim of a hole", "a cone on the rim of a hole"], sense=[1.0, -1.0])
def test_a_rim_touches_within_what_counts_as_touch(name, sense):
    (_, directions), make = ALL_ROUND[name]
    _, contacts, _ = placed(make(64), False, np.eye(4))
    touch = 0.12 * contacts.tolerance["a", "b"] / MM
    for share, touching in ((0.8, True), (1.2, False)):
        first, second = make(64)
        lifted = first.translate((0, 0, sense * share * touch / -directions[0, 2]))
        found = placed((lifted, second), False, np.eye(4))[1].patches
        patches = [patch for patch in found if not patch.unknown]  # chords of facets leave that in doubt
        assert bool(patches) == touching
        for patch in patches:
            assert patch.gap == pytest.approx(sense * share * touch * MM, rel=0.02)


APART = {
    "a ball over a hole": lambda n: (ball(8, n).translate((0, 0, H8 + 0.5)), plate(5, n)),
    "a ball in a larger hole": lambda n: (ball(4, n).translate((0, 0, 1)), plate(5, n)),
    "a cone through a larger hole": lambda n: (cone(30, 8, n).translate((0, 0, -5)), plate(5, n, 20)),
    "a rod over a cone": lambda n: (seat(35, n), rod(5, 5 / tangent(35) + 0.5, 25, n, 3.0)),
    "a pin in a larger hole": lambda n: (rod(4, -10, 10, n), plate(5, n)),
}


@diagonal(name=sorted(APART), swap=[False, True])
def test_rims_that_stay_clear_touch_nothing(name, swap):
    assert not placed(APART[name](48), swap, np.eye(4))[1].patches


def test_a_ball_that_rests_beside_a_hole_touches_the_plate_alone():
    _, contacts, _ = placed((ball(3, 48).translate((8.5, 0, 3)), plate(5, 48)), False, np.eye(4))
    (patch,) = contacts.patches
    assert patch.kind == "point"
    assert patch.points[0] == pytest.approx([8.5 * MM, 0, 0], abs=1e-7)
    assert patch.normals[0] == pytest.approx([0, 0, -1], abs=1e-9)


def test_a_face_along_a_round_surface_has_no_rim_on_it():
    """The end of a bore that a shaft of its size runs through, and the edge of a socket about its ball."""
    shaft = placed((rod(5, -20, 20, 48), plate(5, 48, 10)), False, np.eye(4))[1]
    assert {patch.kind for patch in shaft.patches} == {"cylinder"}
    socket = box(-12, 12, -12, 12, -12, 0) - ball(8, 48)
    assert {patch.kind for patch in placed((ball(8, 48, 2.0), socket), False, np.eye(4))[1].patches} == {"sphere"}


def countersunk(n, lift=0.0):
    """A screw whose cone stands on the rim of a hole with play for its shank."""
    head = cone(45, 9, n).trim_by_plane((0, 0, 1), 3.5).translate((0, 0, -5))
    return (head + rod(4.8, -15, -1.4, n)).translate((0, 0, lift)), plate(5, n, 10)


def valve(n, lift=0.0):
    """A ball on a rim, with a stem in a guide above."""
    ball_on_stem = ball(8, n).translate((0, 0, H8)) + rod(3, 5, 40, n)
    guide = box(-20, 20, -20, 20, 20, 35) - rod(3.05, 19, 36, n, 1.0)
    return ball_on_stem.translate((0, 0, lift)), plate(5, n) + guide + box(18, 20, -20, 20, -5, 35)


@diagonal(make=[countersunk, valve], mesh=[(24, False), (64, True)])
def test_what_stands_on_a_rim_beside_its_guide_is_held_or_stopped(make, mesh):
    segments, swap = mesh
    kinematics, contacts, _ = placed(make(segments), swap, random_pose(np.random.default_rng(segments)))
    assert sorted(patch.kind for patch in contacts.patches) == ["cylinder", "line"]
    (joint,) = kinematics.joints
    assert (joint.type, joint.status) == ("revolute", "ambiguous")
    assert [reading.type for reading in joint.readings] == ["cylindrical"]


@pytest.mark.parametrize("make", [countersunk, valve])
def test_what_is_lifted_off_its_rim_slides_in_its_guide(make):
    kinematics, contacts, _ = placed(make(48, 0.5), False, np.eye(4))
    assert {patch.kind for patch in contacts.patches} == {"cylinder"}
    assert (kinematics.joints[0].type, kinematics.joints[0].status) == ("cylindrical", "determined")


def test_a_screw_in_its_countersink_lies_on_it_and_on_no_rim():
    screw, board = countersunk(48)
    sunk = board - cone(45, 9, 48, 2.0).translate((0, 0, -8))
    contacts = placed((screw.translate((0, 0, -3)), sunk), False, np.eye(4))[1]
    assert {patch.kind for patch in contacts.patches} == {"cone", "cylinder"}
