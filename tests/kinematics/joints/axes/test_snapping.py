"""Axes and centres that agree within their uncertainty become exactly so, and nothing else is moved."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.assemblies import assembly, between, contacts, part
from support.patches import cylinder, plane, ring, sphere

from kinform.kinematics import derive
from kinform.kinematics.joints.axes.concurrence import Locus, meeting_shifts

SIGMA = 1e-8


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


def apart(loci, shifts, place):
    return [
        np.linalg.norm(
            np.cross(place - locus.point - s, locus.axis) if locus.axis is not None else place - locus.point - s
        )
        for locus, s in zip(loci, shifts, strict=True)
    ]


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**31), count=st.integers(2, 5), centre=st.booleans(), coplanar=st.booleans())
def test_lines_that_meet_within_their_uncertainty_are_made_to_meet(seed, count, centre, coplanar):
    rng = np.random.default_rng(seed)
    place, loci = rng.normal(size=3), []
    for k in range(count):
        axis = Rotation.from_rotvec([0, 0, 2 * k / count]).apply([1.0, 0, 0]) if coplanar else unit(rng.normal(size=3))
        axis = Rotation.random(random_state=int(seed % 1000)).apply(axis)
        shift = SIGMA * rng.uniform(-0.5, 0.5, 3)
        loci.append(Locus(place + shift + rng.uniform(-0.2, 0.2) * axis, axis, 1e-12, SIGMA, frozenset("g")))
    # what is nearly parallel crosses nowhere in particular
    assume(all(np.linalg.norm(np.cross(a.axis, b.axis)) > 0.06 for a, b in combinations(loci, 2)))
    if centre:
        loci.append(Locus(place + SIGMA * rng.uniform(-0.5, 0.5, 3), None, 0.0, SIGMA, frozenset("g")))
    shifts = meeting_shifts(loci, 3.0)
    assert np.linalg.norm(shifts, axis=1).max() < 10 * SIGMA
    # the common point, by least squares over all of them
    across = [np.eye(3) - (0 if locus.axis is None else np.outer(locus.axis, locus.axis)) for locus in loci]
    met = np.linalg.solve(
        sum(across), sum(c @ (locus.point + s) for c, locus, s in zip(across, loci, shifts, strict=True))
    )
    assert max(apart(loci, shifts, met)) < 1e-14


def test_lines_that_miss_each_other_by_more_stay_where_they_are():
    loci = [Locus(np.array([0, 0, z]), np.eye(3)[k], 0.0, SIGMA, frozenset("g")) for k, z in ((0, 0.0), (1, 8 * SIGMA))]
    assert not np.any(meeting_shifts(loci, 3.0))


def test_lines_of_far_parts_of_the_mechanism_meet_by_chance_and_stay():
    loci = [
        Locus(np.array([0, 0, z]), np.eye(3)[k], 0.0, SIGMA, frozenset({str(k)})) for k, z in ((0, 0.0), (1, SIGMA))
    ]
    assert not np.any(meeting_shifts(loci, 3.0))


def pin(a, b, point, axis, sigma):
    """A hinge: a pin with collars."""
    axis, point = unit(axis), np.asarray(point, float)
    patches = [
        cylinder(0.003, 0.01, axis=axis, point=point),
        ring(point + 0.005 * axis, axis, 0.003, 0.005),
        ring(point - 0.005 * axis, -axis, 0.003, 0.005),
    ]
    return [replace(between(p, a, b), uncertainty=(sigma, sigma)) for p in patches]


CORNERS = [(0, 0, 1.0), (0.5, 0, 0.9), (0.5, 0.6, 0.7), (-0.1, 0.5, 0.8)]
LINKS = ("base", "crank", "coupler", "rocker")


def spherical_four_bar(offset=0.0, sigma=SIGMA):
    """Four hinges whose axes meet in the origin, 0.1 m away from it; the first is moved sideways by `offset`."""
    patches = []
    for k, corner in enumerate(CORNERS):
        axis = unit(corner)
        side = unit(np.cross(axis, [0.3, 1.0, 0.2]))
        patches += pin(LINKS[k], LINKS[(k + 1) % 4], 0.1 * axis + (offset if k == 0 else 0.0) * side, axis, sigma)
    return assembly(*(part(name) for name in LINKS), ground="base"), contacts(*patches)


def test_a_spherical_four_bar_moves_once_its_axes_meet_and_the_misfit_says_by_how_much():
    model, touching = spherical_four_bar(offset=2e-6, sigma=1e-6)
    found = derive(model, {}, touching)
    assert [j.type for j in found.joints] == ["revolute"] * 4
    assert found.mobility.instantaneous == 1
    assert 1e-7 < found.misfit.distance < 3e-6
    assert found.misfit.distance_at in {j.name for j in found.joints}


def test_a_spherical_four_bar_whose_axes_really_miss_is_a_structure():
    model, touching = spherical_four_bar(offset=2e-5, sigma=1e-6)
    found = derive(model, {}, touching)
    assert found.mobility.instantaneous == 0
    assert found.misfit.distance == 0.0


def slider_crank(tilt, sigma):
    """Crank and rod turn about z; the slider runs along x, tilted out of the plane."""
    along = unit([1.0, 0.0, tilt])
    side = unit(np.cross([0, 0, 1.0], along))
    up = np.cross(along, side)
    faces = [plane((0.2, s * 0.01, 0), s * side, (0.02, 0.03)) for s in (1, -1)]
    faces += [plane((0.2, 0, s * 0.01), s * up, (0.03, 0.02)) for s in (1, -1)]
    slides = [replace(between(p, "base", "slider"), uncertainty=(sigma, 0.01 * sigma)) for p in faces]
    hinges = pin("base", "crank", (0, 0, 0), (0, 0, 1), SIGMA) + pin("crank", "rod", (0.03, 0.04, 0), (0, 0, 1), SIGMA)
    hinges += pin("rod", "slider", (0.2, 0, 0), (0, 0, 1), SIGMA)
    return assembly(*(part(n) for n in ("base", "crank", "rod", "slider")), ground="base"), contacts(*hinges, *slides)


def test_a_slider_perpendicular_to_the_hinges_within_its_uncertainty_is_made_so():
    found = derive(*swap(slider_crank(2e-6, 1e-6)))
    slide = next(j for j in found.joints if j.type == "prismatic")
    assert all(abs(slide.axis @ j.axis) < 1e-15 for j in found.joints if j.type == "revolute")
    assert found.mobility.instantaneous == 1
    assert found.misfit.angle > 1e-7


def test_a_slider_that_really_is_askew_jams():
    found = derive(*swap(slider_crank(2e-4, 1e-6)))
    assert found.mobility.instantaneous == 0


def swap(made):
    model, touching = made
    return model, {}, touching


def test_a_ball_whose_centre_is_on_an_axis_is_put_exactly_there():
    hinge = pin("arm", "base", (0, 0, 0), (0, 0, 1), 1e-7)
    ball = replace(between(sphere(centre=(1e-7, 0, 0.1)), "arm", "rod"), uncertainty=(0.0, 1e-7))
    found = derive(assembly(part("arm"), part("base"), part("rod"), ground="base"), {}, contacts(*hinge, ball))
    centre = next(j for j in found.joints if j.type == "spherical").point
    line = next(j for j in found.joints if j.type == "revolute")
    assert np.linalg.norm(np.cross(centre - line.point, line.axis)) < 1e-16
    assert found.misfit.distance == pytest.approx(5e-8, rel=0.5)
