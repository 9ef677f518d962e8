"""Contacts where one side, or both, is no analytic surface, and contacts without area."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np
import pytest
from support.analytic_solids import MM, assembly, box_loop, extrusion, flat_loop, pose, revolution, round_loop, turned

from kinform.contacts import find


@cache
def block():
    return extrusion(box_loop(-10 * MM, -10 * MM, 10 * MM, 10 * MM), z0=0.0, z1=10 * MM)


@cache
def table():
    return extrusion(box_loop(-30 * MM, -30 * MM, 30 * MM, 30 * MM), z0=-10 * MM, z1=0.0)


LYING = turned((0, 1, 0), 90.0)


def freeform(solid, *numbers):
    """The same solid with some of its surfaces (all by default) not recognised."""
    mesh, surfaces = solid
    digest = mesh.digest + "-freeform" + "-".join(map(str, numbers))
    unknown = {"kind": "freeform", "axis": np.zeros(3), "point": np.zeros(3), "radius": 0.0, "side": 1}
    own = tuple(
        dataclasses.replace(s, **unknown, extent=(0.0, 0.0)) if not numbers or k in numbers else s
        for k, s in enumerate(surfaces.surfaces)
    )
    mesh = dataclasses.replace(mesh, digest=digest)
    return mesh, dataclasses.replace(surfaces, digest=digest, surfaces=own)


def patches(first, second, X_first=None, X_second=None):
    parts = {"a": (first, pose() if X_first is None else X_first)}
    parts["b"] = (second, pose() if X_second is None else X_second)
    return find(*assembly(parts)).patches


@pytest.mark.parametrize("gap", [-0.1, 0.0, 0.2])
def test_facets_of_no_known_surface_rest_on_a_plane_with_its_normal(gap):
    X = pose(translation=(0, 0, gap * MM))
    (patch,) = patches(freeform(block()), table(), X_first=X)
    assert (patch.kind, patch.one_sided) == ("plane", True)
    assert patch.area == pytest.approx(400 * MM**2, rel=1e-6)
    np.testing.assert_allclose(patch.gaps, gap * MM, atol=1e-9)
    np.testing.assert_allclose(patch.normals, [[0, 0, -1]] * len(patch.normals), atol=1e-12)
    (patch,) = patches(table(), freeform(block()), X_second=X)
    np.testing.assert_allclose(patch.axis, [0, 0, 1], atol=1e-12)


def test_a_coarse_bore_that_was_not_recognised_takes_its_normals_from_the_shaft():
    shaft = extrusion(round_loop(10 * MM, 48), z0=-10 * MM, z1=30 * MM)
    outer = box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM)
    hub = freeform(extrusion(outer, [round_loop(10.1 * MM, 20)], z0=0.0, z1=15 * MM), 6)
    (patch,) = patches(shaft, hub)
    assert (patch.kind, patch.one_sided) == ("cylinder", True)
    assert patch.area == pytest.approx(2 * math.pi * 10 * 15 * MM**2, rel=1e-3)
    radial = patch.points * [1, 1, 0]
    np.testing.assert_allclose(patch.normals, radial / np.linalg.norm(radial, axis=1)[:, None], atol=1e-9)


def test_facets_beside_a_mating_face_do_not_repeat_it():
    # The edges of the foot rise by 4°: within the tolerance of the table, and unknown surfaces.
    rise = 6 * math.tan(math.radians(4.0))
    outline = [(-10, 0), (10, 0), (16, rise), (16, 10), (-16, 10), (-16, rise)]
    foot = extrusion(flat_loop(np.array(outline) * MM), z0=-10 * MM, z1=10 * MM)
    upright = pose(turned((1, 0, 0), 90.0))
    (patch,) = patches(freeform(foot, 3, 7), table(), X_first=upright)
    assert not patch.one_sided
    assert patch.area == pytest.approx(400 * MM**2, rel=1e-6)


def test_how_a_round_of_no_known_surface_rests_on_a_plane_is_not_known():
    barrel = freeform(extrusion(round_loop(10 * MM, 64), z0=-10 * MM, z1=10 * MM))
    (patch,) = patches(barrel, table(), X_first=pose(LYING, (0, 0, 10 * MM)))
    assert patch.unknown


def test_two_unknown_faces_touch_as_freeform_with_the_normals_of_their_facets():
    fine = revolution([(r * MM, z * MM) for r, z in ((4, 0), (10, 0), (10, 5), (4, 5))], 64)
    (patch,) = patches(freeform(fine), freeform(fine), X_second=pose(translation=(0, 0, 5.1 * MM)))
    assert (patch.kind, patch.one_sided) == ("freeform", True)
    ring = 0.5 * 64 * (10**2 - 4**2) * math.sin(2 * math.pi / 64) * MM**2
    assert patch.area == pytest.approx(ring, rel=0.02)
    np.testing.assert_allclose(patch.gaps, 0.1 * MM, atol=1e-9)
    np.testing.assert_allclose(patch.normals, [[0, 0, 1]] * len(patch.normals), atol=1e-9)


def ball(radius=10 * MM):
    angles = np.linspace(0, math.pi, 25)
    profile = [(radius * math.sin(t), -radius * math.cos(t)) for t in angles]
    profile[0], profile[-1] = (0.0, -radius), (0.0, radius)
    return revolution(profile, 32, arcs=dict.fromkeys(range(24), ("ball", 0.0, radius)))


def test_a_ball_on_a_table_touches_it_in_one_point():
    (patch,) = patches(ball(), table(), X_first=pose(turned((1, 2, 3), 20.0), (2 * MM, 3 * MM, 10 * MM)))
    assert patch.kind == "point"
    np.testing.assert_allclose(patch.points, [[2 * MM, 3 * MM, 0]], atol=1e-9)
    np.testing.assert_allclose(patch.normals, [[0, 0, -1]], atol=1e-12)
    assert patch.gap == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("place", [(0, 0, 10.2), (31, 0, 10.0)])
def test_a_ball_above_or_beside_the_table_does_not_touch_it(place):
    found = patches(ball(), table(), X_first=pose(translation=np.array(place) * MM))
    assert all(patch.unknown for patch in found)  # 0.05 mm beside its edge nobody knows
    assert len(found) == (place[0] > 0)


def test_a_roller_touches_a_table_along_the_line_that_both_have():
    roller = extrusion(round_loop(10 * MM, 40, 0.03), z0=-15 * MM, z1=15 * MM)
    (patch,) = patches(table(), roller, X_second=pose(LYING, (20 * MM, 0, 10 * MM)))
    assert patch.kind == "line"
    np.testing.assert_allclose(patch.normals, [[0, 0, 1]] * len(patch.normals), atol=1e-12)
    np.testing.assert_allclose(patch.points[:, 1:], 0.0, atol=1e-9)
    # From 5 mm, where the roller begins, to the table's edge at 30 mm.
    assert 5 * MM < patch.points[:, 0].min() < 7 * MM
    assert 28 * MM < patch.points[:, 0].max() < 30 * MM
