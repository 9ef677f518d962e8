"""Vertices that scatter, and tessellations as meshers other than ours make them."""

from __future__ import annotations

from dataclasses import replace

import manifold3d as m3
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.diagonal import diagonal
from support.meshes import kinds, mesh_of, of_manifold
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover
from kinform.surfaces.polygons.facets import Facets
from kinform.surfaces.polygons.noise import scatter


def scattered(mesh, size, seed=0):
    rng = np.random.default_rng(seed)
    away = rng.normal(size=mesh.vertices.shape)
    return replace(mesh, vertices=mesh.vertices + size * away / np.linalg.norm(away, axis=1)[:, None])


def drilled():
    plate = block(0.06, 0.04, 0.012)
    for x in (-0.018, 0.0, 0.018):
        plate = plate - centred_rod(0.005, 0.03, 48).translate((x, 0, 0))
    return of_manifold(plate)


@pytest.mark.parametrize("size", [1e-6, 2e-6, 1e-5])
def test_a_drilled_plate_is_the_same_when_its_vertices_scatter(size):
    found = recover(scattered(drilled(), size), Tolerances())
    assert kinds(found) == {"cylinder": 3, "plane": 6}
    for bore in (s for s in found.surfaces if s.kind == "cylinder"):
        assert bore.radius == pytest.approx(0.005, abs=size)
        assert np.linalg.norm(np.cross(bore.axis, [0, 0, 1])) <= bore.axis_uncertainty


def test_the_scatter_is_read_from_the_mesh():
    mesh = drilled()
    assert scatter(Facets.of(mesh.vertices, mesh.faces), np.radians(32)) < 1e-12
    for size in (1e-6, 1e-5):
        noisy = scattered(mesh, size)
        assert scatter(Facets.of(noisy.vertices, noisy.faces), np.radians(32)) == pytest.approx(
            size / np.sqrt(3), rel=0.6
        )


def test_a_glance_that_ends_early_hides_no_scatter():
    for size in (0.0, 1e-7, 1e-6, 1e-5):
        noisy = scattered(drilled(), size)
        facets = Facets.of(noisy.vertices, noisy.faces)
        whole = scatter(facets, np.radians(32))
        for least in np.geomspace(1e-9, 1e-4, 31):
            glance = scatter(facets, np.radians(32), least)
            assert glance == whole or (glance == 0.0 and whole <= least)
        assert scatter(facets, np.radians(32), 1e-3) == 0.0


def staggered(radius, length, segments, bands):
    """A closed cylinder whose rings of vertices are turned by half a step from one to the next."""
    step = 2 * np.pi / segments
    rings = []
    for k in range(bands + 1):
        angle = step * (np.arange(segments) + 0.5 * (k % 2))
        height = np.full(segments, length * (k / bands - 0.5))
        rings.append(np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1))
    here, following = np.arange(segments), (np.arange(segments) + 1) % segments
    faces = []
    for k in range(bands):
        low, high = k * segments, (k + 1) * segments
        if k % 2 == 0:
            faces += [np.stack([low + here, low + following, high + here], axis=1)]
            faces += [np.stack([high + here, low + following, high + following], axis=1)]
        else:
            faces += [np.stack([low + here, high + following, high + here], axis=1)]
            faces += [np.stack([low + here, low + following, high + following], axis=1)]
    fan = np.arange(1, segments - 1)
    top = bands * segments
    faces += [np.stack([np.zeros_like(fan), fan + 1, fan], axis=1)]
    faces += [np.stack([np.full_like(fan, top), top + fan, top + fan + 1], axis=1)]
    return np.concatenate(rings), np.concatenate(faces)


@pytest.mark.parametrize("segments", [16, 24, 48, 96])
@pytest.mark.parametrize("bands", [3, 8])
def test_a_staggered_tessellation_is_a_cylinder_all_the_same(segments, bands):
    found = recover(mesh_of(*staggered(0.01, 0.03, segments, bands)), Tolerances())
    assert kinds(found) == {"cylinder": 1, "plane": 2}
    (shaft,) = (s for s in found.surfaces if s.kind == "cylinder")
    assert shaft.radius == pytest.approx(0.01, rel=1e-6)
    assert abs(shaft.axis[2]) == pytest.approx(1.0, abs=1e-12)


@diagonal(share=[0.5, 0.7, 0.8, 0.85, 0.9], segments=[16, 24, 64, 200])
def test_a_flat_on_a_shaft_is_a_plane(share, segments):
    rng = np.random.default_rng(segments)
    circle = m3.CrossSection.circle(0.01, segments).rotate(rng.uniform(0, 360))
    cut = m3.CrossSection.square((0.04, 0.04), True).translate((0.01 * share - 0.02, 0))
    found = recover(of_manifold((circle ^ cut).extrude(0.02)), Tolerances())
    assert kinds(found) == {"cylinder": 1, "plane": 3}


@diagonal(segments=[32, 64, 128, 256], lost=[1e-3, 5e-3, 1e-2])
def test_rounding_far_from_the_origin_leaves_a_cylinder(segments, lost):
    """`lost`: what single precision loses there, in widths of a facet."""
    radius = 0.01
    away = lost * (2 * np.pi * radius / segments) * 2**24
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=segments).as_matrix()
    pose[:3, 3] = away * np.array([0.7, 0.6, 0.4])
    found = recover(of_manifold(centred_rod(radius, 0.02, segments), pose=pose, rounding=True), Tolerances())
    assert kinds(found) == {"cylinder": 1, "plane": 2}


@pytest.mark.parametrize(("segments", "depth"), [(16, 0.5), (24, 0.3), (24, 0.7), (32, 0.5)])
def test_a_cap_of_a_coarse_ball_is_a_sphere(segments, depth):
    cup = block(0.03, 0.03, 0.015).translate((0, 0, -0.0075)) - m3.Manifold.sphere(0.01, segments).translate(
        (0, 0, 0.01 * (1 - depth))
    )
    found = recover(of_manifold(cup), Tolerances())
    assert kinds(found) == {"plane": 6, "sphere": 1}


@pytest.mark.parametrize("segments", [12, 22, 61])
def test_a_ring_and_a_point_are_a_cone(segments):
    tip = of_manifold(m3.Manifold.cylinder(0.01, 0.008, 0.0, segments))
    found = recover(tip, Tolerances())
    assert kinds(found) == {"cone": 1, "plane": 1}
    (cone,) = (s for s in found.surfaces if s.kind == "cone")
    assert cone.half_angle == pytest.approx(np.arctan(0.8), abs=1e-7)
    assert cone.axis_uncertainty < 1e-4


def test_a_scanned_shape_does_not_fall_into_planes():
    ball = of_manifold(m3.Manifold.sphere(0.02, 480))
    x, y, z = ball.vertices.T
    swelling = 1 + 0.5 / 20 * np.sin(700 * x) * np.cos(500 * y) + 0.2 / 20 * np.cos(300 * z)
    shape = replace(ball, vertices=ball.vertices * swelling[:, None])
    found = recover(scattered(shape, 6e-6), Tolerances())
    # a few facets each; had planes been taken off to the end, 0.003
    flat = sum(s.area for s in found.surfaces if s.kind == "plane")
    assert flat < 0.002 * sum(s.area for s in found.surfaces)
