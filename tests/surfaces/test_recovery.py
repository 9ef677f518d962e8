"""Surfaces of solids whose geometry is known."""

from __future__ import annotations

from dataclasses import replace

import manifold3d as m3
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.meshes import kinds, mesh_of, of_manifold, rod
from support.solids import block, centred_rod

from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover


def surfaces_of(mesh):
    return recover(mesh, Tolerances())


def only(found, kind):
    (one,) = [s for s in found.surfaces if s.kind == kind]
    return one


@pytest.mark.parametrize("segments", [12, 24, 31, 64, 256])
def test_a_rod_is_one_cylinder_and_two_planes(segments):
    found = surfaces_of(rod(0.005, 0.03, segments))
    assert kinds(found) == {"cylinder": 1, "plane": 2}
    shaft = only(found, "cylinder")
    assert shaft.side == 1
    assert shaft.radius == pytest.approx(0.005, rel=1e-6)
    assert abs(shaft.axis[2]) == pytest.approx(1.0, abs=1e-12)
    assert shaft.extent[1] - shaft.extent[0] == pytest.approx(0.03, rel=1e-6)
    assert shaft.sweep == pytest.approx(2 * np.pi, rel=1e-3)
    assert shaft.chord == pytest.approx(0.005 * (1 - np.cos(np.pi / segments)), rel=0.05)


@pytest.mark.parametrize("segments", [3, 4, 6, 8])
def test_a_coarse_prism_stays_a_prism(segments):
    assert kinds(surfaces_of(rod(0.005, 0.03, segments))) == {"plane": segments + 2}


def test_a_bore_is_concave():
    found = surfaces_of(of_manifold(block(0.03, 0.03, 0.01) - centred_rod(0.006, 0.02, 48)))
    assert kinds(found) == {"cylinder": 1, "plane": 6}
    assert only(found, "cylinder").side == -1


@pytest.mark.parametrize("segments", [24, 48])
def test_a_ball_and_a_socket_are_spheres(segments):
    ball = m3.Manifold.sphere(0.008, segments)
    convex = only(surfaces_of(of_manifold(ball)), "sphere")
    assert convex.side == 1
    assert convex.radius == pytest.approx(0.008, rel=1e-6)
    assert np.abs(convex.point).max() < 1e-8
    socket = surfaces_of(of_manifold(block(0.03, 0.03, 0.03).translate((0, 0, -0.015)) - ball))
    assert only(socket, "sphere").side == -1


def test_a_frustum_is_a_cone_with_its_half_angle():
    solid = m3.Manifold.cylinder(0.02, 0.01, 0.005, 48, True)
    cone = only(surfaces_of(of_manifold(solid)), "cone")
    assert cone.half_angle == pytest.approx(np.arctan(0.005 / 0.02), rel=1e-6)
    assert cone.point[2] == pytest.approx(0.03, rel=1e-5)


def test_a_stadium_is_two_cylinders_and_planes_tangent_to_them():
    profile = m3.CrossSection.square((0.02, 0.01), True) + m3.CrossSection.circle(0.005, 48).translate((0.01, 0))
    profile = profile + m3.CrossSection.circle(0.005, 48).translate((-0.01, 0))
    found = surfaces_of(of_manifold(m3.Manifold.extrude(profile, 0.01)))
    assert kinds(found) == {"cylinder": 2, "plane": 4}
    assert {round(s.radius, 9) for s in found.surfaces if s.kind == "cylinder"} == {0.005}


def test_a_flat_on_a_shaft_is_a_plane():
    flat = block(0.02, 0.02, 0.04).translate((0.014, 0, 0))
    assert kinds(surfaces_of(of_manifold(centred_rod(0.005, 0.03, 48) - flat)), 0.01) == {"cylinder": 1, "plane": 3}


def test_a_flat_between_two_bevels_is_no_cylinder():
    profile = [(-0.012, -0.02), (0.012, -0.02), (0.014, -0.0195), (0.014, 0.0), (-0.014, 0.0), (-0.014, -0.0195)]
    found = surfaces_of(of_manifold(m3.Manifold.extrude(m3.CrossSection([profile]), 0.04)))
    assert set(kinds(found)) == {"plane"}


def test_crossed_bores_are_two_cylinders():
    along = centred_rod(0.004, 0.05, 40)
    solid = block(0.03, 0.03, 0.03) - along - along.rotate((90, 0, 0))
    found = surfaces_of(of_manifold(solid))
    bores = [s for s in found.surfaces if s.kind == "cylinder"]
    assert len(bores) == 2
    assert abs(bores[0].axis @ bores[1].axis) < 1e-6
    assert {s.side for s in bores} == {-1}


def test_a_stepped_shaft_has_a_cylinder_a_step():
    solid = m3.Manifold.cylinder(0.01, 0.004, 0.004, 36) + m3.Manifold.cylinder(0.01, 0.006, 0.006, 36).translate(
        (0, 0, 0.01)
    )
    found = surfaces_of(of_manifold(solid))
    assert sorted(round(s.radius, 9) for s in found.surfaces if s.kind == "cylinder") == [0.004, 0.006]


def test_a_plate_with_a_hundred_holes():
    holes = m3.Manifold.batch_boolean(
        [centred_rod(0.001, 0.01, 20).translate((0.005 * i, 0.005 * k, 0)) for i in range(10) for k in range(10)],
        m3.OpType.Add,
    )
    plate = block(0.06, 0.06, 0.004).translate((0.0225, 0.0225, 0))
    assert kinds(surfaces_of(of_manifold(plate - holes))) == {"cylinder": 100, "plane": 6}


def test_every_facet_belongs_to_one_surface_in_the_order_of_area():
    found = surfaces_of(of_manifold(block(0.03, 0.03, 0.01) - centred_rod(0.006, 0.02, 48)))
    counted = np.concatenate([s.faces for s in found.surfaces])
    assert sorted(counted.tolist()) == list(range(len(found.labels)))
    areas = [s.area for s in found.surfaces]
    assert areas == sorted(areas, reverse=True)
    for k, surface in enumerate(found.surfaces):
        assert (found.labels[surface.faces] == k).all()


@settings(max_examples=10, deadline=None)
@given(
    seed=st.integers(0, 2**31), scale=st.sampled_from([1e-3, 1.0, 1e3]), segments=st.integers(12, 80),
)  # fmt: skip
def test_pose_and_scale_move_the_surfaces_with_the_part(seed, scale, segments):
    rng = np.random.default_rng(seed)
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    pose[:3, 3] = rng.normal(size=3) * scale
    shaft = only(surfaces_of(rod(0.2, 1.0, segments, pose=pose, scale=scale)), "cylinder")
    axis = pose[:3, 2]
    assert np.linalg.norm(np.cross(shaft.axis, axis)) < 1e-7
    assert np.linalg.norm(np.cross(shaft.point - pose[:3, 3], axis)) < 1e-7 * scale
    assert shaft.radius == pytest.approx(0.2 * scale, rel=1e-6)


def test_the_order_of_facets_and_vertices_does_not_matter():
    mesh = of_manifold(block(0.03, 0.03, 0.01) - centred_rod(0.006, 0.02, 48))
    rng = np.random.default_rng(3)
    order, names = rng.permutation(len(mesh.faces)), rng.permutation(len(mesh.vertices))
    back = np.argsort(names)
    shuffled = replace(mesh, vertices=mesh.vertices[names], faces=back[mesh.faces][order])
    plain, other = surfaces_of(mesh), surfaces_of(shuffled)
    assert kinds(plain) == kinds(other)
    assert only(plain, "cylinder").radius == pytest.approx(only(other, "cylinder").radius, rel=1e-9)


def test_single_precision_stays_within_the_stated_uncertainty():
    rng = np.random.default_rng(7)
    inside = []
    for _ in range(16):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.random(random_state=rng).as_matrix()
        pose[:3, 3] = rng.normal(size=3)
        mesh = rod(0.02, 0.05, 36, pose=pose, rounding=True)
        shaft = only(surfaces_of(mesh), "cylinder")
        angle = np.linalg.norm(np.cross(shaft.axis, pose[:3, 2]))
        offset = np.linalg.norm(np.cross(shaft.point + mesh.origin - pose[:3, 3], pose[:3, 2]))
        inside.append(angle < 3 * shaft.axis_uncertainty and offset < 3 * shaft.point_uncertainty)
    assert np.mean(inside) > 0.9


def test_an_open_mesh_and_a_single_facet_are_read_as_they_are():
    mesh = rod(0.005, 0.03, 24)
    opened = replace(mesh, faces=mesh.faces[5:])
    assert kinds(surfaces_of(opened), 0.01)["cylinder"] == 1
    lone = mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert kinds(surfaces_of(lone)) == {"plane": 1}
