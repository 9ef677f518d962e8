"""FCL as a proximity query: slivers miss nothing within their reach, and depths and insides are exact."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from support.analytic_solids import MM, box_loop, extrusion, revolution, round_loop

from kinform.foundation.meshes import box_pairs, probes
from kinform.foundation.meshes.mesh_index import MeshIndex
from kinform.foundation.meshes.slivers import crossing


@cache
def plate():
    return MeshIndex(extrusion(round_loop(50 * MM, 90), z0=-5 * MM, z1=0.0)[0])


@pytest.mark.parametrize("gap", [0.0, 1e-12, -0.05, 0.15, 0.499, -0.499])
def test_slivers_miss_no_sample_within_their_reach(gap):
    angles, radii = np.random.default_rng(1).random((2, 500)) * [[2 * math.pi], [49 * MM]]
    points = np.stack([radii * np.cos(angles), radii * np.sin(angles), np.full(500, gap * MM)], axis=1)
    down = np.tile([0.0, 0.0, -1.0], (500, 1))
    hits = plate().whole().cast(points, down, np.full(500, 0.5 * MM))
    assert set(hits.probe) == set(range(500))
    np.testing.assert_allclose(hits.along, gap * MM, atol=1e-12)
    np.testing.assert_allclose(hits.facing, -1.0)


@pytest.mark.parametrize("width", [1e-3, 0.05])
def test_few_probes_and_many_hit_the_same(width, monkeypatch):
    rng = np.random.default_rng(4)
    points = rng.uniform([-52 * MM, -52 * MM, -6 * MM], [52 * MM, 52 * MM, 1 * MM], (300, 3))
    directions = rng.normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reach = rng.uniform(1 * MM, 9 * MM, 300)
    for region in (plate().whole(), plate().region(np.arange(0, len(plate().mesh.faces), 2))):
        found = []
        for few, most in ((10**9, 0), (-1, 10**9), (-1, -1)):
            monkeypatch.setattr(box_pairs, "BOXES_MATRIX", few)
            for limit in ("BOXES_MOST", "BESIDE_MOST"):
                monkeypatch.setattr(box_pairs, limit, most)
            found.append(region.cast(points, directions, reach, width))
        by_comparison, by_grid, by_fcl = found
        assert len(by_fcl.probe) > 100
        for name in ("probe", "facet", "along", "facing"):
            told = getattr(by_fcl, name).tobytes()
            assert getattr(by_comparison, name).tobytes() == told, name
            assert getattr(by_grid, name).tobytes() == told, name


def test_slivers_do_not_hit_what_is_beyond_their_reach():
    points = np.array([[0.0, 0.0, 0.6 * MM], [0.0, 0.0, 0.4 * MM]])
    hits = plate().whole().cast(points, np.tile([0.0, 0.0, 1.0], (2, 1)), np.full(2, 0.5 * MM))
    assert set(hits.probe) == {1}


def test_depths_are_distances_to_the_boundary_and_name_the_nearest_facet():
    box = MeshIndex(extrusion(box_loop(0, 0, 10 * MM, 20 * MM), z0=0.0, z1=30 * MM)[0])
    points = np.random.default_rng(2).uniform([0, 0, 0], [10 * MM, 20 * MM, 30 * MM], (50, 3))
    depth, facet = box.whole().depths(points)
    walls = np.concatenate([points, np.array([10, 20, 30]) * MM - points], axis=1)
    np.testing.assert_allclose(depth, walls.min(axis=1), atol=1e-10)
    nearest = np.argmin(walls, axis=1)
    np.testing.assert_allclose(np.abs(box.normals(facet)).argmax(axis=1), nearest % 3)


def test_points_inside_a_solid_are_told_from_points_in_its_cavities():
    ring = [(5, 0), (20, 0), (20, 10), (5, 10)]
    tube = MeshIndex(revolution([(r * MM, z * MM) for r, z in ring], 48)[0])
    points = np.random.default_rng(3).uniform([-25 * MM, -25 * MM, -5 * MM], [25 * MM, 25 * MM, 15 * MM], (400, 3))
    radius = np.hypot(points[:, 0], points[:, 1]) / MM
    height = points[:, 2] / MM
    within = (radius > 5) & (radius < 20) & (height > 0) & (height < 10)
    sharp = (np.abs(radius - 5) > 0.1) & (np.abs(radius - 20) > 0.1)
    np.testing.assert_array_equal(tube.contains(points)[sharp], within[sharp])


def test_a_mesh_meets_triangles_exactly_where_a_few_of_them_do(monkeypatch):
    rng = np.random.default_rng(8)
    middle = rng.uniform([-52 * MM, -52 * MM, -8 * MM], [52 * MM, 52 * MM, 3 * MM], (400, 1, 3))
    triangles = middle + rng.normal(scale=1.5 * MM, size=(400, 3, 3))
    for region in (plate().whole(), plate().region(np.arange(0, len(plate().mesh.faces), 2))):
        each = [region.meets(triangle[None]) for triangle in triangles]
        hit = [crossing(triangle[None], region.corners()) for triangle in triangles]
        assert each == hit
        assert 20 < sum(each) < 380
        first = each.index(True)
        monkeypatch.setattr(probes, "MET_AT_ONCE", 3)
        assert region.meets(triangles[~np.array(each)]) is False
        assert region.meets(np.concatenate([triangles[~np.array(each)], triangles[first : first + 1]]))
        assert not region.meets(triangles[:0])
        monkeypatch.undo()
