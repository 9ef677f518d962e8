"""How far facets may stand off their surface, against surfaces whose facets' true chord errors are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation
from support.solids import box

from kinform.foundation.meshes.chordal_deviation import standoffs

SMOOTH, COPLANAR, ROUNDING = math.radians(32.0), 5e-4, 1e-6
INSIDE = np.array([(i, j, 12 - i - j) for i in range(13) for j in range(13 - i)]) / 12.0
"""Weights of the corners at points all over a triangle."""


def facets_of(solid):
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)


def turned(outline, segments):
    """The solid of revolution of an outline of (r, z)."""
    return facets_of(Manifold.revolve(CrossSection([outline]), segments))


def estimated(vertices, faces):
    return standoffs(vertices, faces, SMOOTH, COPLANAR, ROUNDING * np.abs(vertices).max())


def true(vertices, faces, depth):
    """(m,) the greatest of what `depth` says at points of each facet."""
    return np.abs(depth(np.einsum("wk,nkc->nwc", INSIDE, vertices[faces]))).max(axis=1)


def off_ball(points):
    return np.linalg.norm(points, axis=2) - 10.0


@pytest.mark.parametrize("segments", [16, 20, 32, 64])
def test_triangles_on_a_ball_stand_off_by_r_1_minus_cos(segments):
    vertices, faces = facets_of(Manifold.sphere(10.0, segments))
    sides = np.linalg.norm(np.roll(vertices[faces], -1, axis=1) - vertices[faces], axis=2)
    half = sides.sum(axis=1) / 2
    area = np.sqrt(half * (half - sides[:, 0]) * (half - sides[:, 1]) * (half - sides[:, 2]))
    angle = np.arcsin(sides.prod(axis=1) / (4 * area) / 10.0)
    sagitta = 10.0 * (1 - np.cos(angle))
    np.testing.assert_allclose(sagitta, true(vertices, faces, off_ball), rtol=0.06)
    np.testing.assert_allclose(estimated(vertices, faces), sagitta, rtol=0.035)


@pytest.mark.parametrize("segments", [12, 16, 64])
def test_strips_of_a_cylinder_stand_off_by_r_1_minus_cos(segments):
    vertices, faces = facets_of(Manifold.cylinder(30.0, 10.0, 10.0, segments))
    side = faces[np.ptp(vertices[faces][:, :, 2], axis=1) > 1.0]
    np.testing.assert_allclose(estimated(vertices, side), 10.0 * (1 - math.cos(math.pi / segments)), rtol=0.02)


@pytest.mark.parametrize("segments", [24, 48])
def test_quadrilaterals_of_balls_and_rings_stand_off_by_both_their_curvatures(segments):
    half = np.linspace(-np.pi / 2, np.pi / 2, segments // 2 + 1)
    outline = np.stack([10.0 * np.cos(half), 10.0 * np.sin(half)], axis=1)
    outline[[0, -1], 0] = 0.0
    vertices, faces = turned(outline, segments)
    share = estimated(vertices, faces) / true(vertices, faces, off_ball)
    assert 0.98 < share.min() < share.max() < 1.2
    around = np.arange(segments // 2) * 4 * np.pi / segments
    vertices, faces = turned(np.stack([20 + 4 * np.cos(around), 4 * np.sin(around)], axis=1), segments)

    def off_ring(points):
        return np.hypot(np.hypot(points[..., 0], points[..., 1]) - 20.0, points[..., 2]) - 4.0

    share = estimated(vertices, faces) / true(vertices, faces, off_ring)
    assert 0.9 < share.min() < share.max() < 1.35


def test_a_flat_does_not_bend_as_the_fillet_beside_it_does():
    around = np.radians(np.linspace(0.0, 90.0, 7))
    fillet = np.stack([30 + 2 * np.sin(around), 2 * np.cos(around)], axis=1)
    outline = np.concatenate([[(0.0, -20.0), (32.0, -20.0)], fillet[::-1], [(0.0, 2.0)]])
    vertices, faces = facets_of(Manifold.extrude(CrossSection([outline]), 50.0))
    corners = vertices[faces]
    side = np.ptp(corners[:, :, 2], axis=1) > 1.0
    smooth = side & ((corners[:, :, 0] > 29.9) | (corners[:, :, 1] > 1.9)).all(axis=1)
    faces, corners = faces[smooth], corners[smooth]
    found = estimated(vertices, faces)
    flat = np.ptp(corners[:, :, 1], axis=1) < 1e-9
    assert flat.any()
    sagitta = 2.0 * (1 - math.cos(math.radians(7.5)))
    round_ = (np.linalg.norm(corners[:, :, :2] - (30.0, 0.0), axis=2) < 2.01).all(axis=1)
    round_ &= (corners[..., 0] > 29.9).all(axis=1)
    assert 0.9 * sagitta < found[round_].min() < found[round_].max() < 3.1 * sagitta
    assert np.median(found[round_]) == pytest.approx(sagitta, rel=0.02)
    assert found[flat].max() < 5 * sagitta


def test_pieces_that_a_cut_left_stand_off_like_the_facets_they_were():
    cut = Manifold.sphere(10.0, 16).rotate((10, 20, 30)) ^ box(-20, 20, -20, 20, -3, 3)
    vertices, faces = facets_of(cut)
    flat = np.ptp(vertices[faces][:, :, 2], axis=1) < 1e-9
    faces = faces[~flat]
    truth, found = true(vertices, faces, off_ball), estimated(vertices, faces)
    spans = np.cross(vertices[faces][:, 1] - vertices[faces][:, 0], vertices[faces][:, 2] - vertices[faces][:, 0])
    area = np.linalg.norm(spans, axis=1)
    large = area > 0.2 * area.max()
    assert np.median((found / truth)[large]) > 1.0
    assert (found / truth)[large].min() > 0.6
    assert found.max() < 1.6 * truth.max()


def test_what_facets_stand_off_hangs_on_neither_place_nor_size_nor_order():
    rng = np.random.default_rng(4)
    vertices, faces = facets_of(Manifold.sphere(10.0, 20) ^ box(-20, 20, -20, 20, -6.3, 4.1))
    found = estimated(vertices, faces)
    assert found.min() >= 0.0
    order, names = rng.permutation(len(faces)), rng.permutation(len(vertices))
    mixed = np.empty_like(vertices)
    mixed[names] = vertices
    rolled = np.stack([np.roll(face, k) for face, k in zip(names[faces], rng.integers(0, 3, len(faces)), strict=True)])
    np.testing.assert_allclose(estimated(mixed, rolled[order]), found[order], rtol=1e-6, atol=1e-9)
    R = Rotation.random(random_state=rng).as_matrix()
    np.testing.assert_allclose(estimated(1e-3 * vertices @ R.T, faces), 1e-3 * found, rtol=1e-6, atol=1e-12)


def test_facets_without_area_and_single_ones_stand_off_by_nothing():
    corners = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    assert estimated(corners, np.array([(0, 1, 2)])).tolist() == [0.0]
    assert estimated(corners, np.array([(0, 1, 3)])).tolist() == [0.0]
    assert estimated(corners, np.array([(0, 1, 2), (0, 3, 1), (1, 4, 0)])).tolist() == [0.0, 0.0, 0.0]
