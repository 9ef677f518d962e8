"""What is told of parts by few facets, or by few at a time: how far they are certainly apart, how deep points are."""

from __future__ import annotations

from dataclasses import replace

import fcl
import numpy as np
import pytest
from support.diagonal import first
from support.solids import ball, box, part, random_pose, rod

from kinform.collisions.parts import coarse_meshes
from kinform.collisions.parts.coarse_meshes import coarse_mesh
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose
from kinform.foundation.meshes.mesh_index import MeshIndex

SEEDS = range(8)


def perforated():
    """A plate with many fine holes, and a ball on it."""
    plate = box(-20, 20, -15, 15, 0, 3)
    for x in range(-15, 16, 5):
        plate -= rod(1.0, -1, 4, 96).translate((x, x / 2, 0))
    return plate + ball(4.0, 200).translate((3, 8, 4))


def mesh_of(solid):
    return part("plate", solid, np.eye(4)).mesh


def strewn(rng, count):
    """Triangles strewn about, many far smaller than a cell, some without area."""
    corners = rng.uniform(-1, 1, (count, 1, 3)) + 10.0 ** rng.uniform(-5, 0, (count, 1, 1)) * rng.normal(
        size=(count, 3, 3)
    )
    corners[::5, 2] = 0.5 * (corners[::5, 0] + corners[::5, 1])
    return replace(
        mesh_of(box(0, 1, 0, 1, 0, 1)), vertices=corners.reshape(-1, 3), faces=np.arange(3 * count).reshape(-1, 3)
    )


def samples(rng, vertices, faces, count):
    weights = rng.dirichlet(np.ones(3), count)
    return np.einsum("nk,nki->ni", weights, vertices[faces[rng.integers(0, len(faces), count)]])


def away(points, vertices, faces):
    """m of points from facets, by FCL, one by one."""
    mesh, out = fcl.CollisionObject(fcl_model(vertices, faces)), []
    for p in points:
        X = np.eye(4)
        X[:3, 3] = p
        point = fcl.CollisionObject(fcl_model(np.zeros((3, 3)), np.array([[0, 1, 2]])), fcl_pose(X))
        out.append(fcl_distance(mesh, point))
    return np.array(out)


@pytest.mark.parametrize("seed", first(2, SEEDS))
def test_every_point_of_a_part_is_as_near_to_its_few_facets_as_is_said(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    if seed % 2:
        mesh = mesh_of(perforated())
    else:
        monkeypatch.setattr(coarse_meshes, "COARSE_WORTH", 2.0)
        mesh = strewn(rng, 4000)
    vertices, faces, off = coarse_mesh(mesh)
    assert seed % 2 == 0 or len(faces) <= len(mesh.faces) / 2
    points = samples(rng, mesh.vertices, mesh.faces, 400)
    assert away(points, vertices, faces).max() <= off * (1 + 1e-9)


@pytest.mark.parametrize("seed", first(2, SEEDS))
def test_parts_that_are_apart_by_few_facets_are_apart(seed):
    rng = np.random.default_rng(seed)
    mesh = mesh_of(perforated())
    vertices, faces, off = coarse_mesh(mesh)
    few, whole = fcl_model(vertices, faces), fcl_model(mesh.vertices, mesh.faces)
    told = 0
    for _ in range(20):
        X = fcl_pose(random_pose(rng, 0.02))
        coarse, exact = (
            fcl_distance(fcl.CollisionObject(model), fcl.CollisionObject(model, X)) for model in (few, whole)
        )
        assert exact >= coarse - 2.0 * off - 1e-12
        told += coarse > 2.0 * off
    assert told


def test_a_part_of_few_facets_stays_as_it_is():
    assert coarse_mesh(mesh_of(box(0, 1, 0, 2, 0, 3))) is None


@pytest.mark.parametrize("seed", first(2, SEEDS))
def test_points_are_as_deep_by_some_facets_at_a_time_as_by_all(seed):
    rng = np.random.default_rng(seed)
    mesh = mesh_of(perforated()) if seed % 2 else strewn(rng, 900)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    points = np.concatenate([rng.uniform(low, high, (60, 3)), samples(rng, mesh.vertices, mesh.faces, 20), [3 * high]])
    expected = MeshIndex(mesh).depths(points)
    assert MeshIndex(mesh).whole().depths(points)[0] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    # in any order, and whichever were asked before
    index, order = MeshIndex(mesh), rng.permutation(len(points))
    assert index.depths(points[order[:7]]).tobytes() == expected[order[:7]].tobytes()
    assert index.depths(points[order]).tobytes() == expected[order].tobytes()


@pytest.mark.parametrize("seed", first(2, SEEDS))
def test_points_are_as_deep_up_to_a_limit_as_they_are(seed):
    rng = np.random.default_rng(seed)
    mesh = mesh_of(perforated()) if seed % 2 else strewn(rng, 900)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    on = samples(rng, mesh.vertices, mesh.faces, 20)
    points = np.concatenate([rng.uniform(low, high, (30, 3)), on, on + 1e-9 * mesh.diagonal, [3 * high]])
    index = MeshIndex(mesh)
    depth = index.depths(points)
    each = mesh.diagonal * rng.uniform(0.0, 0.3, len(points))
    for enough in (1e-8 * mesh.diagonal, 1e-3 * mesh.diagonal, 0.1 * mesh.diagonal, each):
        told = index.depths_up_to(points, enough)
        assert told == pytest.approx(np.minimum(depth, enough), rel=1e-9, abs=1e-12 * mesh.diagonal)
        assert (told < enough).sum() >= 10


def test_points_that_many_facets_are_about_are_as_deep_by_a_model_of_all():
    """On the axis of a tube, the facets of which are all as near: they ask until that is worth a model."""
    mesh = mesh_of(rod(10, -200, 200, 600) - rod(8, -300, 300, 600))
    index, axis = MeshIndex(mesh), 1e-3 * np.linspace([0, 0, -150], [0, 0, 150], 90)
    asked = [index.depths(axis) for _ in range(5)]
    assert index.depths(axis[:3]) == pytest.approx(8e-3 * np.cos(np.pi / 600), rel=1e-9)
    assert all(again.tobytes() == asked[0].tobytes() for again in asked)
