"""Turned solids of few rings: two rings about one axis lie on a sphere whatever is between them, and are no ball."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.assemblies import assembly
from support.diagonal import diagonal, first
from support.solids import part, random_pose

from kinform import surfaces


def recovered(solid, X=None, scale=1e-3):
    made = part("a", solid, np.eye(4) if X is None else X, scale)
    return surfaces.recover(made.mesh, assembly(made).tolerances).surfaces


def kinds(solid, X=None, scale=1e-3):
    return sorted(surface.kind for surface in recovered(solid, X, scale))


def turned(outline, segments):
    return Manifold.revolve(CrossSection([np.array(outline, float)]), segments)


def banded(leans, lengths, radius=10.0):
    """Profile of bands of these lengths whose generators lean from the axis by these angles (degrees), from the widest
    ring up."""
    points = [(radius, 0.0)]
    for lean, length in zip(np.radians(leans), lengths, strict=True):
        rho, z = points[-1]
        points.append((rho - length * np.sin(lean), z + length * np.cos(lean)))
    return [(0.0, 0.0), *points, (0.0, points[-1][1])]


def arc(radius, start, end, rings, middle=0.0):
    """Points of a profile on a circle about (middle, 0)."""
    angle = np.radians(np.linspace(start, end, rings))
    return [(middle + radius * np.cos(a), radius * np.sin(a)) for a in angle]


def zone(start, end, rings, core=0.0):
    profile = arc(10, start, end, rings)
    return [(core, profile[0][1]), *profile, (core, profile[-1][1])]


def chamfered(half, length, chamfer=1.0):
    """A disc with a chamfer at both ends."""
    top = 10 - chamfer * np.tan(np.radians(half))
    return [
        (0, -chamfer), (top, -chamfer), (10, 0), (10, length), (top, length + chamfer), (0, length + chamfer)
    ]  # fmt: skip


@diagonal(5, length=[1, 2, 3, 4, 8], half=[8, 10, 12, 15, 20, 28, 31], segments=[16, 24, 32, 64])
def test_a_disc_with_equal_chamfers_is_a_cylinder_between_cones(segments, half, length):
    found = recovered(turned(chamfered(half, length), segments))
    assert sorted(surface.kind for surface in found) == ["cone", "cone", "cylinder", "plane", "plane"]
    cylinder = next(surface for surface in found if surface.kind == "cylinder")
    assert cylinder.radius == pytest.approx(10e-3, rel=1e-9)
    assert np.ptp(cylinder.extent) == pytest.approx(length * 1e-3, rel=1e-9)
    for cone in (surface for surface in found if surface.kind == "cone"):
        assert abs(cone.half_angle) == pytest.approx(np.radians(half), abs=1e-7)


@diagonal(segments=[16, 24, 48], half=[8, 12, 15])
def test_chamfers_that_lean_less_than_a_facet_turns_are_no_part_of_a_bore(half, segments):
    wide = 10 + np.tan(np.radians(half))
    outline = [(wide, -1), (15, -1), (15, 4), (wide, 4), (10, 3), (10, 0)]
    assert kinds(turned(outline, segments)) == ["cone", "cone", "cylinder", "cylinder", "plane", "plane"]


@diagonal(
    bands=[
        ((-12, 12), (2, 2)),
        ((-20, 0, 20), (2, 2, 2)),
        ((-15, 5, 25), (2, 3, 2)),
        ((5, 20, 35), (2, 2, 2)),
        ((1, 16, 31), (2, 2, 2)),
        ((-30, -10, 10, 25), (2, 3, 2, 2)),
    ],
    segments=[24, 61],
)
def test_bands_are_cones_each(bands, segments):
    leans, lengths = bands
    every = ["cylinder" if lean == 0 else "cone" for lean in leans]
    assert kinds(turned(banded(leans, lengths), segments)) == sorted([*every, "plane", "plane"])


@pytest.mark.parametrize("seed", first(2, range(12)))
def test_bands_at_random_are_no_spheres(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 4))
    leans = np.cumsum([rng.uniform(-40, -10), *rng.uniform(6, 30, count - 1)])
    segments = int(rng.integers(18, 70))
    solid = turned(banded(leans, rng.uniform(1, 4, count)), segments)
    scale = 10.0 ** rng.uniform(-5, 0)
    assert kinds(solid, random_pose(rng, 10 * scale), scale) == [*["cone"] * count, "plane", "plane"]


@pytest.mark.parametrize("seed", first(1, range(6)))
def test_neither_pose_nor_size_nor_order_makes_a_disc_a_ball(seed):
    rng = np.random.default_rng(seed)
    scale = 10.0 ** rng.uniform(-5, 0)
    half, length, segments = rng.uniform(9, 30), rng.uniform(1, 5), int(rng.integers(16, 60))
    X = random_pose(rng, 10 * scale)
    solid = turned(chamfered(half, length), segments)
    assert kinds(solid, X, scale) == ["cone", "cone", "cylinder", "plane", "plane"]
    assert kinds(solid.mirror((0, 0, 1)), X, scale) == ["cone", "cone", "cylinder", "plane", "plane"]


@diagonal(rings=[3, 4, 5, 9], latitude=[30, 20, 40], segments=[16, 24, 48])
def test_a_ball_zone_of_three_rings_and_more_is_a_sphere_in_every_pose(segments, latitude, rings):
    if 2 * latitude / (rings - 1) > 31:
        pytest.skip("its edges are sharp")
    for seed, core, bore in ((0, 0.0, []), (1, 4.0, ["cylinder"])):
        rng = np.random.default_rng(seed)
        scale = 10.0 ** rng.uniform(-5, 0)
        solid = turned(zone(-latitude, latitude, rings, core), segments)
        found = recovered(solid, random_pose(rng, 10 * scale), scale)
        assert sorted(surface.kind for surface in found) == [*bore, "plane", "plane", "sphere"]
        sphere = next(surface for surface in found if surface.kind == "sphere")
        assert sphere.radius == pytest.approx(10 * scale, rel=1e-6)


@pytest.mark.parametrize("segments", first(2, [16, 48, 24]))
def test_balls_domes_and_sockets_stay_spheres(segments):
    pole = [*arc(10, 30, 75, 4), (0.0, 10.0)]
    assert kinds(turned([(0, pole[0][1]), *pole], segments)) == ["plane", "sphere"]
    socket = arc(10, 40, -40, 7)
    outline = [(14, socket[-1][1]), (14, socket[0][1]), *socket]
    assert kinds(turned(outline, segments)) == ["cylinder", "plane", "plane", "sphere"]
    ball = Manifold.sphere(10, segments)
    assert kinds(ball) == ["sphere"]
    assert kinds(ball - Manifold.cylinder(30, 4, 4, 24, True)) == ["cylinder", "sphere"]
    assert kinds(ball.trim_by_plane((0.3, 0.2, 1), 2.7)) == ["plane", "sphere"]


def test_a_shaft_cut_across_keeps_its_facets():
    """Cuts leave corners on chords; the facets are pieces of the cylinder none the less."""
    shaft = Manifold.cylinder(40, 10, 10, 48, True)
    keyed = shaft - Manifold.cube((6, 20, 8), True).translate((0, 10, 0))
    oblique = keyed.trim_by_plane((0.5, 0.3, 1), -12)
    found = recovered(oblique)
    round_ = [surface for surface in found if surface.kind == "cylinder"]
    assert len(round_) == 1
    assert round_[0].radius == pytest.approx(10e-3, rel=1e-9)
    assert not [surface for surface in found if surface.kind == "freeform"]


@diagonal(radius=[15, 20, 40], segments=[24, 36])
def test_a_barrel_is_no_bundle_of_cylinders_across_it(segments, radius):
    """What lies between two meridians of it is a row of strips on a circle, which no part of a shaft is."""
    solid = turned(
        [(0, -radius * np.sin(0.3)), *arc(radius, -np.degrees(0.3), np.degrees(0.3), 9, 10 - radius),
         (0, radius * np.sin(0.3))], segments,
    )  # fmt: skip
    assert "cylinder" not in kinds(solid)


def test_a_fillet_of_three_strips_between_sharp_ends_is_a_cylinder():
    angle = np.radians([0, 30, 60, 90])
    corner = [(7 + 3 * np.cos(a), 7 + 3 * np.sin(a)) for a in angle]
    solid = Manifold.extrude(CrossSection([np.array([(0, 0), (10, 0), *corner, (0, 10)])]), 20)
    found = recovered(solid)
    (fillet,) = (surface for surface in found if surface.kind == "cylinder")
    assert fillet.radius == pytest.approx(3e-3, rel=1e-7)
