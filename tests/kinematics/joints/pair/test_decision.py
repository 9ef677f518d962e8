"""Types of pairs from patches whose geometry is exact: the oracle is the mechanics of each pair."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.patches import Z, cone, cylinder, plane, ring, sphere
from support.thresholds import changes_once

from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import gather
from kinform.model.contacts import Patch
from kinform.model.tolerances import Tolerances

X, Y = np.eye(3)[0], np.eye(3)[1]


@cache
def collars():
    return [ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)]


def hexagon():
    normals = [np.array([np.cos(a), np.sin(a), 0.0]) for a in np.pi / 3 * np.arange(6)]
    return [plane(centre=n * 0.005 * np.cos(np.pi / 6), normal=n, size=(0.005, 0.02)) for n in normals]


def key():
    return [plane(centre=(0.005, s * 0.001, 0), normal=s * Y, size=(0.002, 0.01)) for s in (1, -1)]


CASES = {
    "shaft in bore": (lambda: [cylinder()], "cylindrical"),
    "shaft with collars": (lambda: [cylinder(), *collars()], "revolute"),
    "shaft on one shoulder": (lambda: [cylinder(), collars()[0]], "revolute"),
    "hexagon in hexagon": (lambda: hexagon(), "prismatic"),
    "ball in socket": (lambda: [sphere(cap=0.3)], "spherical"),
    "ball in shallow socket": (lambda: [sphere(cap=-0.8)], "spherical"),
    "block on table": (lambda: [plane()], "planar"),
    "cone in cone": (lambda: [cone()], "revolute"),
    "one degree taper": (lambda: [cone(half_angle=np.radians(1))], "revolute"),
    "quarter arc with collars": (lambda: [cylinder(arc=(0, np.pi / 2)), *collars()], "revolute"),
    "D-shaft with shoulders": (
        lambda: [cylinder(arc=(0.3, 6.0)), plane((0.004, 0, 0), X, (0.002, 0.01)), *collars()],
        "fixed",
    ),
    "D-shaft": (lambda: [cylinder(arc=(0.3, 6.0)), plane((0.004, 0, 0), X, (0.002, 0.01))], "prismatic"),
    "keyed shaft with collars": (lambda: [cylinder(), *key(), *collars()], "fixed"),
    "keyed shaft": (lambda: [cylinder(), *key()], "prismatic"),
    "piloted flange with one dowel": (
        lambda: [plane(size=(0.04, 0.04)), cylinder(0.01, 0.005), cylinder(0.0015, 0.005, point=(0.015, 0, 0))],
        "fixed",
    ),
    "plate on two dowels": (
        lambda: [cylinder(0.002, 0.006, point=(-0.02, 0, 0)), cylinder(0.002, 0.006, point=(0.02, 0.01, 0))],
        "prismatic",
    ),
    "box in slot": (lambda: [plane(), plane((0.01, 0, 0.005), X), plane((-0.01, 0, 0.005), -X)], "prismatic"),
    "ball in tube": (lambda: [sphere(cap=0.9), cylinder(0.005, 0.02)], "revolute"),
    "two balls": (lambda: [sphere(), sphere(centre=(0.05, 0, 0))], "revolute"),
}


def decision(patches, **keys):
    tolerances = Tolerances(**keys)
    evidence = gather([(k, p, False) for k, p in enumerate(patches)], tolerances, 5e-4)
    return decide(evidence, tolerances)


@pytest.mark.parametrize("name", CASES)
def test_the_type_is_that_of_the_mechanics(name):
    make, expected = CASES[name]
    patches = make()
    found = decision(patches)
    assert (found.form.type, found.status) == (expected, "determined")


@pytest.mark.parametrize("name", CASES)
def test_zeros_are_exact_and_the_rest_is_far_above_the_threshold(name):
    found = decision(CASES[name][0]())
    freedoms = found.basis.shape[1]
    assert np.abs(found.singular_values[:freedoms]).max(initial=0.0) < 1e-10
    assert found.singular_values[freedoms:].min(initial=1.0) > 0.01


def moved(patch: Patch, rotation: Rotation, shift, scale: float) -> Patch:
    return replace(
        patch,
        points=scale * rotation.apply(patch.points) + shift,
        normals=rotation.apply(patch.normals),
        axis=rotation.apply(patch.axis),
        point=scale * rotation.apply(patch.point) + shift,
        area=scale**2 * patch.area,
        weights=scale**2 * patch.weights,
        gaps=scale * patch.gaps,
        gap=scale * patch.gap,
        offset=scale * patch.offset,
        uncertainty=(patch.uncertainty[0], scale * patch.uncertainty[1]),
    )


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(sorted(CASES)),
    seed=st.integers(0, 2**31),
    scale=st.sampled_from([1e-2, 1.0, 1e3]),
    far=st.sampled_from([0.0, 1.0]),
)
def test_pose_scale_and_order_change_nothing(name, seed, scale, far):
    rng = np.random.default_rng(seed)
    make, expected = CASES[name]
    patches = make()
    rotation = Rotation.random(random_state=rng)
    shift = far * scale * rng.normal(size=3)
    turned = [moved(p, rotation, shift, scale) for p in patches]
    order = rng.permutation(len(turned))
    tolerances = Tolerances()
    evidence = gather([(int(k), turned[k], False) for k in order], tolerances, 5e-4 * scale)
    found, plain = decide(evidence, tolerances), decision(patches)
    assert (found.form.type, found.status) == (expected, "determined")
    if plain.form.axis is not None:
        axis = rotation.apply(plain.form.axis)
        assert abs(abs(axis @ found.form.axis) - 1.0) < 1e-12
        if expected in ("revolute", "cylindrical"):
            point = scale * rotation.apply(plain.form.point) + shift
            assert np.linalg.norm(np.cross(point - found.form.point, axis)) < 1e-9 * scale


@pytest.mark.parametrize("share", [0.02, 0.1, 0.2])
@pytest.mark.parametrize("overlap", [0.0, -2e-4])
@pytest.mark.parametrize(
    ("name", "expected", "rest", "centre", "normal", "sense"),
    [
        ("shaft with collars", "revolute", 0, (0.02, 0, 0), Y, -1),
        ("shaft with collars", "revolute", 0, (0.02, 0, 0), -Y, 1),
        ("ball in socket", "spherical", 1, (0.02, 0, 0.01), Z, 0),
    ],
)
def test_a_stray_patch_beside_a_journal_ends_its_turn_in_one_sense(
    name, expected, rest, centre, normal, sense, share, overlap
):
    """A ball still turns about the normal of the patch; beside that it has no one axis, and no one sense."""
    patches = CASES[name][0]()
    stray = plane(centre, normal, (0.003, 0.003), area=share * sum(p.area for p in patches), gap=overlap)
    found = decision([*patches, stray])
    assert (found.form.type, found.status, found.left_out) == (expected, "determined", ())
    assert [k for k, *_ in found.ended] == [len(patches)]
    assert (found.cone.rest.shape[1], found.cone.closed.shape[1]) == (rest, found.basis.shape[1])
    _, motion, ends = found.ended[0]
    assert ends * (motion.axis[2] if sense else 1.0) == sense


@pytest.mark.parametrize("share", [0.02, 0.1, 0.2])
def test_a_face_at_the_end_of_a_long_guide_holds_it_or_is_its_end(share):
    """Drawn into the other by more than a press it blocks what it touches."""
    patches = hexagon()
    end = plane((0, 0, 0.01), Z, (0.003, 0.003), area=share * sum(p.area for p in patches))
    found = decision([*patches, end])
    assert (found.form.type, found.status, found.other.form.type) == ("fixed", "ambiguous", "prismatic")
    assert found.cone.withdraws
    assert np.abs(found.cone.closed[:, 0]) == pytest.approx([0, 0, 0, 0, 0, 1], abs=1e-9)
    found = decision([*patches, replace(end, gap=-2e-4)])
    assert (found.form.type, found.status) == ("prismatic", "blocked")
    assert [k for k, _ in found.left_out] == [len(patches)]


@pytest.mark.parametrize("share", [0.01, 0.05, 0.2])
def test_locators_hold_however_small_they_are(share):
    shaft = [cylinder(), *collars()]
    area = share * sum(p.area for p in shaft)
    flat = plane((0.004, 0, 0), X, (0.002, 0.01), area=area)
    faces = [plane((0.005, s * 0.001, 0), s * Y, (0.002, 0.01), area=area / 2) for s in (1, -1)]
    dowel = cylinder(0.0005, 0.005, point=(0.015, 0, 0), area=area)
    for locator in ([flat], faces, [dowel]):
        assert decision([*shaft, *locator]).form.type == "fixed"


def test_a_taper_too_small_to_tell_from_a_cylinder_is_ambiguous():
    found = decision([cone(half_angle=np.radians(0.05))])
    assert found.status == "ambiguous"


def test_misaligned_bearings_within_the_alignment_tolerance_mate_and_beyond_do_not():
    def pair(angle):
        axis = (np.sin(angle), 0.0, np.cos(angle))
        return [cylinder(length=0.005), cylinder(length=0.005, axis=axis), *collars()]

    changes_once(lambda angle: decision(pair(angle)).form.type, np.radians(0.1), np.radians(1.0), "revolute", "fixed")


def test_an_axis_through_two_short_bearings_passes_through_both():
    apart = [
        cylinder(length=0.005, gap=5e-5),
        cylinder(length=0.005, point=(2e-5, 0, 0.1), gap=5e-5),
        *collars(),
    ]
    found = decision(apart)
    assert found.form.type == "revolute"
    assert found.form.axis[0] == pytest.approx(2e-4, rel=0.05)
