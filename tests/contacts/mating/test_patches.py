"""Patches between mating surfaces: what is found, with which area, gap, normals and fit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.analytic_solids import (
    MM,
    assembly,
    box_loop,
    circle,
    extrusion,
    flat_loop,
    pose,
    revolution,
    round_loop,
    turned,
)

from kinform.contacts import find
from kinform.model.tolerances import Tolerances


def contacts(first, second, X_first=None, X_second=None, **options):
    parts = {
        "a": (first, pose() if X_first is None else X_first),
        "b": (second, pose() if X_second is None else X_second),
    }
    return find(*assembly(parts, **options))


def shaft_in_bore(gap):
    """32-gon of radius 10 mm in a 24-gon larger by `gap`, engaged over 15 mm, one edge turned."""
    shaft = extrusion(round_loop(10 * MM, 32), z0=-10 * MM, z1=30 * MM)
    hub = extrusion(
        box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM),
        [round_loop(10 * MM + gap, 24, 0.05)],
        z0=0.0,
        z1=15 * MM,
    )
    return shaft, hub


@pytest.mark.parametrize(
    ("gap", "fit"),
    [(0.0, "touch"), (0.05 * MM, "transition"), (0.15 * MM, "clearance"), (-0.02 * MM, "transition")],
)
def test_a_32_gon_in_a_24_gon_is_one_cylinder_patch(gap, fit):
    found = contacts(*shaft_in_bore(gap))
    (patch,) = found.patches
    assert patch.kind == "cylinder"
    assert not patch.one_sided
    assert patch.area == pytest.approx(2 * math.pi * (10 * MM + gap / 2) * 15 * MM, rel=1e-6)
    assert patch.weights.sum() == pytest.approx(patch.area)
    assert patch.gap == pytest.approx(gap, abs=1e-9)
    assert patch.radii == pytest.approx((10 * MM, 10 * MM + gap))
    assert patch.fit == fit
    radial = patch.points * [1, 1, 0]
    radial /= np.linalg.norm(radial, axis=1)[:, None]
    np.testing.assert_allclose(patch.normals, radial, atol=1e-12)
    assert np.ptp(patch.points[:, 2]) == pytest.approx(15 * MM)
    assert found.interferences == ()


def test_normals_of_a_bore_that_is_the_first_part_point_to_its_axis():
    shaft, hub = shaft_in_bore(0.0)
    (patch,) = contacts(hub, shaft).patches
    assert (np.einsum("ij,ij->i", patch.normals, patch.points * [1, 1, 0]) < 0).all()
    assert patch.radii == pytest.approx((10 * MM, 10 * MM))


def test_a_hexagon_in_a_hexagon_has_six_plane_patches():
    bar = extrusion(flat_loop(circle(10 * MM, 6)), z0=-10 * MM, z1=30 * MM)
    outer = box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM)
    hub = extrusion(outer, [flat_loop(circle(10.1 * MM, 6))], z0=0.0, z1=15 * MM)
    patches = contacts(bar, hub).patches
    assert [p.kind for p in patches] == ["plane"] * 6
    for patch in patches:
        assert patch.area == pytest.approx(10 * MM * 15 * MM, rel=1e-6)
        np.testing.assert_allclose(patch.gaps, 0.1 * MM * math.cos(math.pi / 6), atol=1e-12)
        assert patch.axis @ patch.point > 0
    np.testing.assert_allclose(sum(p.axis for p in patches), 0, atol=1e-9)


def d_loop(radius, flat, count=36):
    """A circle cut off at x = flat."""
    half = math.acos(flat / radius)
    angles = np.linspace(half, 2 * math.pi - half, count + 1)
    points = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return points, [("round", (0.0, 0.0), radius)] * count + [("flat", 0)]


@pytest.mark.parametrize("flat", [9.0, 9.9])
def test_the_flat_of_a_d_shaft_is_found_however_small(flat):
    shaft = extrusion(d_loop(10 * MM, flat * MM), z0=-10 * MM, z1=30 * MM)
    outer = box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM)
    hub = extrusion(outer, [d_loop(10.05 * MM, (flat + 0.05) * MM, 29)], z0=0.0, z1=15 * MM)
    patches = contacts(shaft, hub).patches
    assert sorted(p.kind for p in patches) == ["cylinder", "plane"]
    (plane,) = (p for p in patches if p.kind == "plane")
    width = 2 * math.sqrt(10.0**2 - flat**2) * MM
    assert plane.area == pytest.approx(width * 15 * MM, rel=1e-6)
    assert plane.gap == pytest.approx(0.05 * MM)
    np.testing.assert_allclose(plane.axis, [1, 0, 0], atol=1e-12)
    assert 0.01 < plane.area / sum(p.area for p in patches) < 0.2


def test_both_sides_of_a_key_are_found():
    key = [(9.5, -1.5), (11, -1.5), (11, 1.5), (9.5, 1.5)]
    half = math.asin(1.5 / 10)
    angles = np.linspace(half, 2 * math.pi - half, 33)
    arc = [(10 * math.cos(t), 10 * math.sin(t)) for t in angles]
    keys = [("round", (0.0, 0.0), 10 * MM)] * 32 + [("flat", 0), ("flat", 1), ("flat", 2)]
    shaft = extrusion((np.array([*arc, key[1], key[2]]) * MM, keys), z0=-10 * MM, z1=30 * MM)
    half = math.asin(1.52 / 10.02)
    angles = np.linspace(half, 2 * math.pi - half, 25)
    arc = [(10.02 * math.cos(t), 10.02 * math.sin(t)) for t in angles]
    keys = [("round", (0.0, 0.0), 10.02 * MM)] * 24 + [("flat", 0), ("flat", 1), ("flat", 2)]
    slot = (np.array([*arc, (11.2, -1.52), (11.2, 1.52)]) * MM, keys)
    hub = extrusion(box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM), [slot], z0=0.0, z1=15 * MM)
    patches = contacts(shaft, hub).patches
    flanks = [p for p in patches if p.kind == "plane" and abs(p.axis[1]) > 0.99]
    assert len(flanks) == 2
    assert flanks[0].axis[1] * flanks[1].axis[1] == pytest.approx(-1)
    depth = 11 - 10.02 * math.cos(math.asin(1.52 / 10.02))
    for flank in flanks:
        assert flank.area == pytest.approx(depth * 15 * MM**2, rel=1e-3)
        assert flank.gap == pytest.approx(0.02 * MM)


def test_a_dowel_beside_a_large_flange_is_found():
    outer = box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM)
    pin = extrusion(round_loop(1.5 * MM, 12, 0.1, (15 * MM, 3 * MM)), z0=-5 * MM, z1=5 * MM)
    hole = [round_loop(1.5 * MM, 16, 0.0, (15 * MM, 3 * MM))]
    below, above = extrusion(outer, hole, z0=-5 * MM, z1=0.0), extrusion(outer, hole, z0=0.0, z1=5 * MM)
    found = find(*assembly({"pin": (pin, pose()), "low": (below, pose()), "top": (above, pose())}))
    area = 2 * math.pi * 1.5 * 5 * MM**2
    assert [(p.parts, p.kind) for p in found.patches] == [
        (("low", "pin"), "cylinder"),
        (("low", "top"), "plane"),
        (("pin", "top"), "cylinder"),
    ]
    assert found.patches[0].area == pytest.approx(area, rel=1e-6)
    hole_area = 0.5 * 16 * 1.5**2 * math.sin(2 * math.pi / 16) * MM**2
    assert found.patches[1].area == pytest.approx(1600 * MM**2 - hole_area, rel=1e-6)


def ball(radius, rows, count):
    profile = [(radius * math.sin(t), -radius * math.cos(t)) for t in np.linspace(0, math.pi, rows + 1)]
    profile[0], profile[-1] = (0.0, -radius), (0.0, radius)
    return revolution(profile, count, arcs=dict.fromkeys(range(rows), ("ball", 0.0, radius)))


def test_a_ball_in_a_socket_is_one_sphere_patch():
    radius, opening = 10.1 * MM, math.pi / 2 + 0.3
    rows = 24
    wall = [(radius * math.sin(t), -radius * math.cos(t)) for t in np.linspace(opening, 0, rows + 1)]
    wall[-1] = (0.0, -radius)
    profile = [*wall, (0.0, -15 * MM), (15 * MM, -15 * MM), (15 * MM, wall[0][1])]
    socket = revolution(profile, 36, 0.1, arcs=dict.fromkeys(range(rows), ("socket", 0.0, radius)))
    (patch,) = contacts(ball(10 * MM, 24, 32), socket).patches
    assert patch.kind == "sphere"
    middle = 10.05 * MM
    assert patch.area == pytest.approx(2 * math.pi * middle**2 * (1 - math.cos(opening)), rel=0.02)
    assert patch.gap == pytest.approx(0.1 * MM)
    np.testing.assert_allclose(patch.point, 0, atol=1e-12)
    np.testing.assert_allclose(patch.normals, patch.points / np.linalg.norm(patch.points, axis=1)[:, None])


def test_a_taper_in_its_socket_is_one_cone_patch():
    taper = revolution([(0, 0), (10 * MM, 30 * MM), (0, 30 * MM)], 32)
    # The same cone with its apex 0.3 mm lower: larger along the normal by 0.3 mm · sin(half-angle).
    shift = 0.3 / 3
    walls = [(10 / 3 + shift, 10), (20, 10), (20, 20), (20 / 3 + shift, 20)]
    socket = revolution([(r * MM, z * MM) for r, z in walls], 24, 0.1)
    (patch,) = contacts(taper, socket).patches
    half = math.atan(1 / 3)
    assert patch.kind == "cone"
    assert patch.radii == pytest.approx((half, half))
    assert patch.gap == pytest.approx(0.3 * MM * math.sin(half), rel=1e-6)
    side = math.pi * ((20 / 3 + shift / 2) ** 2 - (10 / 3 + shift / 2) ** 2) / math.sin(half) * MM**2
    assert patch.area == pytest.approx(side, rel=0.005)
    np.testing.assert_allclose(patch.normals @ [0, 0, 1], -math.sin(half), atol=1e-9)


@pytest.mark.parametrize("spacing", [20.0, 20.2])
def test_two_shafts_side_by_side_do_not_mate(spacing):
    shaft = extrusion(round_loop(10 * MM, 32), z0=0.0, z1=20 * MM)
    found = contacts(shaft, shaft, X_second=pose(translation=(spacing * MM, 0, 0)))
    mated = [p for p in found.patches if not p.one_sided]
    assert [p.kind for p in mated] == (["line"] if spacing == 20.0 else [])


def test_a_shaft_above_the_bore_does_not_mate_with_it():
    shaft, hub = shaft_in_bore(0.05 * MM)
    found = contacts(shaft, hub, X_first=pose(translation=(0, 0, 25.1 * MM)))
    assert found.patches == ()


def test_opposite_faces_of_stacked_thin_sheets_do_not_touch_through_the_walls():
    sheet = extrusion(box_loop(0, 0, 40 * MM, 40 * MM), z0=0.0, z1=0.2 * MM)
    (patch,) = contacts(sheet, sheet, X_second=pose(translation=(0, 0, 0.2 * MM))).patches
    assert patch.area == pytest.approx(1600 * MM**2)
    np.testing.assert_allclose(patch.axis, [0, 0, 1], atol=1e-12)
    assert patch.gap == pytest.approx(0.0, abs=1e-9)


def test_a_wall_between_two_opposed_faces_hides_them_from_each_other():
    # A channel with a floor at 0 and a lid from 0.1 to 0.3 mm: what lies on the lid is not on the floor.
    channel = revolution(
        [(5 * MM, -2 * MM), (20 * MM, -2 * MM), (20 * MM, 0.3 * MM), (5 * MM, 0.3 * MM), (5 * MM, 0.1 * MM),
         (18 * MM, 0.1 * MM), (18 * MM, 0.0), (5 * MM, 0.0)], 48)  # fmt: skip
    ring = revolution([(5 * MM, 0.3 * MM), (20 * MM, 0.3 * MM), (20 * MM, 5 * MM), (5 * MM, 5 * MM)], 48)
    planes = [p for p in contacts(channel, ring).patches if p.kind == "plane"]
    assert [round(p.gap / MM, 6) for p in planes] == [0.0]


def test_tilted_planes_mate_within_the_alignment_and_carry_their_angle():
    block = extrusion(box_loop(-10 * MM, -10 * MM, 10 * MM, 10 * MM), z0=0.0, z1=10 * MM)
    X = pose(turned((1, 0, 0), 0.15), (0, 0, 10 * MM))
    (patch,) = contacts(block, block, X_second=X).patches
    assert patch.kind == "plane"
    assert not patch.one_sided
    assert patch.misalignment == pytest.approx(math.radians(0.15), rel=1e-6)
    assert np.ptp(patch.gaps) == pytest.approx(20 * MM * math.radians(0.15), rel=1e-3)
    assert patch.fit == "transition"


def test_planes_tilted_beyond_the_alignment_touch_without_mating():
    block = extrusion(box_loop(-10 * MM, -10 * MM, 10 * MM, 10 * MM), z0=0.0, z1=10 * MM)
    lid = extrusion(box_loop(-8 * MM, -8 * MM, 8 * MM, 8 * MM), z0=0.0, z1=10 * MM)
    X = pose(turned((1, 0, 0), 1.0), (0, 0, 10 * MM))
    (patch,) = contacts(block, lid, X_second=X).patches
    assert (patch.kind, patch.one_sided) == ("other", True)
    np.testing.assert_allclose(patch.axis, [0, 0, 1], atol=1e-12)
    assert patch.area == pytest.approx(256 * MM**2, rel=0.01)
    np.testing.assert_allclose(patch.gaps.mean(), 0.0, atol=0.02 * MM)


def test_axes_mate_as_far_as_their_clearance_allows_and_not_beyond():
    # 0.2 mm of clearance over 15 mm allows 2 · 0.2 / 15 rad = 1.5°.
    shaft, hub = shaft_in_bore(0.2 * MM)
    about = pose(translation=(0, 0, 7.5 * MM)) @ pose(turned((1, 0, 0), 1.2)) @ pose(translation=(0, 0, -7.5 * MM))
    (patch,) = (p for p in contacts(shaft, hub, X_first=about).patches if p.kind == "cylinder")
    assert patch.misalignment == pytest.approx(math.radians(1.2), rel=1e-6)
    shaft, hub = shaft_in_bore(0.02 * MM)
    assert not [p for p in contacts(shaft, hub, X_first=about).patches if not p.one_sided]


def test_the_offset_of_two_axes_is_measured_where_they_engage():
    shaft, hub = shaft_in_bore(0.1 * MM)
    # Turned about the middle of the bore: no offset there, although the shaft's own middle is 2.5 mm off.
    about = pose(translation=(0, 0, 7.5 * MM)) @ pose(turned((0, 1, 0), 0.3)) @ pose(translation=(0, 0, -7.5 * MM))
    (patch,) = contacts(shaft, hub, X_first=about).patches
    assert patch.offset == pytest.approx(0.0, abs=1e-8)
    (patch,) = contacts(shaft, hub, X_first=pose(translation=(0.06 * MM, 0, 0))).patches
    assert patch.offset == pytest.approx(0.06 * MM, rel=1e-6)


def test_the_common_axis_follows_the_better_fit():
    shaft = extrusion(round_loop(10 * MM, 32), z0=-10 * MM, z1=30 * MM, uncertainty=1e-9)
    outer, hole = box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM), round_loop(10.1 * MM, 24)
    hub = extrusion(outer, [hole], z0=0.0, z1=15 * MM, uncertainty=1e-6)
    (patch,) = contacts(shaft, hub, X_first=pose(translation=(0.03 * MM, 0, 0))).patches
    np.testing.assert_allclose(patch.point[:2], [0.03 * MM, 0], atol=1e-9)
    assert patch.uncertainty[1] < 1e-7


@pytest.mark.parametrize("degrees", [0.0, 17.0, 90.0])
def test_a_gap_of_exactly_the_tolerance_is_a_contact_in_every_pose(degrees):
    block = extrusion(box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM), z0=0.0, z1=20 * MM)
    X = pose(turned((1, 2, 3), degrees), (0.3, -0.1, 0.7))
    tolerance = 0.0085 * 60 * MM
    found = contacts(block, block, X_first=X, X_second=X @ pose(translation=(0, 0, 20 * MM + tolerance)))
    assert found.tolerance == {("a", "b"): pytest.approx(tolerance)}
    assert [p.gap for p in found.patches] == [pytest.approx(tolerance)]


def test_the_tolerance_of_the_manifest_decides():
    block = extrusion(box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM), z0=0.0, z1=20 * MM)
    X = pose(translation=(0, 0, 20.3 * MM))
    assert len(contacts(block, block, X_second=X).patches) == 1
    assert contacts(block, block, X_second=X, tolerances=Tolerances(contact=0.2 * MM)).patches == ()
    X = pose(translation=(0, 0, 21 * MM))
    assert contacts(block, block, X_second=X).patches == ()
    assert len(contacts(block, block, X_second=X, tolerances=Tolerances(contact=1.2 * MM)).patches) == 1


def test_large_journals_mate_at_gaps_beyond_the_tolerance():
    shaft = extrusion(round_loop(50 * MM, 96), z0=-10 * MM, z1=30 * MM)
    hole = [round_loop(51.2 * MM, 96)]
    hub = extrusion(box_loop(-80 * MM, -80 * MM, 80 * MM, 80 * MM), hole, z0=0.0, z1=15 * MM)
    (patch,) = contacts(shaft, hub).patches
    assert patch.gap == pytest.approx(1.2 * MM)
