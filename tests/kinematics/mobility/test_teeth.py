"""Teeth that keep a constant ratio are told from those that do not, by sections of the meshes alone."""

from __future__ import annotations

import numpy as np
import pytest
from generators.involute import Gear, mesh_angle
from support.gear_trains import WIDTH, gear_pair, limited, rack_and_pinion, ring, wheel
from support.solids import box, derived, part, random_pose, rod

from kinform.kinematics.mobility.teeth import Side, meshing

Z = np.array([0.0, 0.0, 1.0])


def only(solids, seed=0):
    kinematics, _ = derived(random_pose(np.random.default_rng(seed)), **solids)
    (coupling,) = kinematics.couplings
    return coupling


@pytest.mark.parametrize(("teeth", "points"), [((20, 30), 6), pytest.param((17, 40), 12, marks=pytest.mark.sweep)])
def test_teeth_are_counted_on_both_sides_whatever_the_pose_and_the_facets(teeth, points):
    for seed, turn in enumerate((0.03, 0.17)):  # of 20 teeth, the second touches at a tip
        found = only(gear_pair(*teeth, turn, points), seed).meshing
        assert found.teeth == teeth
        assert found.ratio == pytest.approx(-teeth[1] / teeth[0], rel=1e-12)
        assert found.reach == (-np.inf, np.inf)


def test_the_departure_from_the_ratio_is_that_of_the_facets_and_lines_of_action_are_those_of_the_teeth():
    """Chords of an involute lie off it by the square of their length."""
    found = []
    for points in (6, 12, 24):
        (coupling,) = derived(**gear_pair(20, 30, 0.1, points))[0].couplings
        found.append(coupling.meshing)
    errors = [meshing.deviation for meshing in found]
    assert errors[0] > 2.5 * errors[1] > 6.25 * errors[2] > 0.0
    # lines of action lean by the pressure angle, through the pitch point
    np.testing.assert_allclose(found[-1].place[:2], (0.01, 0.0), atol=1e-7)
    lean = np.degrees(np.arcsin(found[-1].normals[:, 0]))
    np.testing.assert_allclose(lean, 20.0, atol=0.1)
    assert np.prod(found[-1].normals[:, 1]) < -0.8


def test_the_play_is_that_of_the_construction():
    """Each of both teeth is thinner by 0.04 mm at a pitch radius of 10 mm."""
    found = only(gear_pair(20, 30, 0.13, 12, 0.04)).meshing
    assert found.play == pytest.approx(2 * 0.04 / 10, rel=0.05)


def test_a_rack_has_its_pitch_and_its_ends():
    """21 teeth of π mm: half a pitch beyond the outer ones there is nothing left to touch."""
    coupling = only(rack_and_pinion(turn=0.2))
    found = coupling.meshing
    assert coupling.kind == "rack"
    assert found.teeth == (20, 21)
    assert abs(found.ratio) == pytest.approx(100.0, rel=1e-6)
    assert found.reach[1] - found.reach[0] == pytest.approx(21 * 2 * np.pi / 20, rel=1e-6)


def side(solid, centre, axis=Z):
    made = part("wheel", solid, np.eye(4))
    return Side(made.mesh, made.X_WP, np.concatenate([axis, np.cross(centre, axis)]))


def test_a_pinion_in_a_ring_turns_with_it():
    """Inner teeth 20 : 50, the pinion shifted by the difference of the pitch radii, a tooth in a space."""
    apart = 0.5 * (50 - 20)
    pinion = wheel(limited(Gear(20, thin=0.04).outline(), 0.0, 10.7), apart)
    sides = side(pinion, np.array([apart, 0.0, 0.0]) * 1e-3), side(ring(50, 30, 24.2), np.zeros(3))
    found = meshing(sides, Z, np.array([25.0, 0.0, 4.0]) * 1e-3, np.array([0.3, 0.95, 0.0]), 2.5)
    assert found.teeth == (20, 50)
    assert found.ratio == pytest.approx(2.5)
    np.testing.assert_allclose(found.place[:2], (0.025, 0.0), atol=1e-9)


def square(teeth, radius, height):
    """A wheel with straight flanks: no such teeth keep their ratio."""
    disc = rod(radius - height, 0, WIDTH, 96)
    half = 0.24 * 2 * np.pi * radius / teeth
    for k in range(teeth):
        disc += box(0, radius + height, -half, half, 0, WIDTH).rotate((0, 0, 360 * k / teeth))
    return disc


def test_straight_flanks_keep_no_ratio():
    first = square(12, 12, 2).rotate((0, 0, 3))
    second = square(18, 18, 2).rotate((0, 0, 180 + 10 - 2)).translate((30, 0, 0))
    sides = side(first, np.zeros(3)), side(second, np.array([0.03, 0.0, 0.0]))
    found = meshing(sides, Z, np.array([12.0, 1.0, 4.0]) * 1e-3, np.array([0.0, 1.0, 0.0]), -1.5)
    assert isinstance(found, str)
    assert "of a pitch from a constant ratio" in found


def test_a_ratio_that_is_not_that_of_the_teeth_is_none():
    first, second = Gear(20), Gear(30)
    sides = [
        side(wheel(first.outline(0.1)), np.zeros(3)),
        side(wheel(second.outline(mesh_angle(first, second, 0.1)), 25.0), np.array([0.025, 0.0, 0.0])),
    ]
    place, normal = np.array([10.0, 0.0, 4.0]) * 1e-3, np.array([0.0, 1.0, 0.0])
    assert meshing(tuple(sides), Z, place, normal, -1.5).ratio == pytest.approx(-1.5)
    assert "20 and 30 teeth -1.5" in meshing(tuple(sides), Z, place, normal, -1.6)


def test_a_gear_without_some_of_its_teeth_has_an_end():
    """A third of the wheel is cut down to its root."""
    plain = Gear(30).outline(mesh_angle(Gear(20), Gear(30), 0.0))
    radius, angle = np.hypot(*plain.T), np.arctan2(plain[:, 1], plain[:, 0])
    cut = np.where(np.abs(angle) < np.pi / 3, np.minimum(radius, 13.75), radius)
    outline = np.stack([cut * np.cos(angle), cut * np.sin(angle)], axis=1)
    sides = (
        side(wheel(Gear(20).outline(0.0)), np.zeros(3)),
        side(wheel(outline, 25.0), np.array([0.025, 0.0, 0.0])),
    )
    found = meshing(sides, Z, np.array([10.0, 0.0, 4.0]) * 1e-3, np.array([0.0, 1.0, 0.0]), -1.5)
    assert found.ratio == pytest.approx(-1.5, rel=1e-3)
    assert found.teeth[0] == 20
    assert found.teeth[1] < 25
    span = found.reach[1] - found.reach[0]
    assert span == pytest.approx(found.teeth[1] * 2 * np.pi / 20, rel=1e-3)
