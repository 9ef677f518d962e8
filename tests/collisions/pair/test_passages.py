"""Where points pass through facets: between passages they are inside or outside all the way."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod

from kinform.collisions.pair.passages import Path, passages
from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.meshes.mesh_index import MeshIndex

SOLIDS = {
    "block": box(-30, 30, -12, 12, -9, 9),
    "plate with a hole": box(10, 60, -20, 20, -4, 4) - rod(8, -5, 5, 24).translate((35, 0, 0)),
    "cavity": box(-40, 40, -40, 40, -10, 10) - box(-30, 30, -30, 30, -5, 5),
}


def mesh_of(solid):
    return part("part", solid, np.eye(4), 1e-3).mesh


def setting(name, seed):
    """A mesh, and points about it, in a frame whose z is the axis."""
    rng = np.random.default_rng(seed)
    mesh = mesh_of(SOLIDS[name])
    X = random_pose(rng)
    X[:3, 3] = rng.normal(scale=0.01, size=3)
    points = rng.uniform(-0.06, 0.06, (150, 3))
    corners = (mesh.vertices @ X[:3, :3].T + X[:3, 3])[mesh.faces]
    return mesh, X, points, corners


@diagonal(name=list(SOLIDS), sign=[1, -1], turning=[True, False])
def test_points_are_inside_from_a_passage_inward_to_one_outward(name, sign, turning):
    mesh, X, points, corners = setting(name, 3)
    index, path = MeshIndex(mesh), Path(np.eye(4), turning, sign)
    known = passages(points, corners, turning, mesh).ordered(path)
    twist = sign * np.eye(6)[2 if turning else 5]
    passing, seen = np.isin(np.arange(len(points)), known.point), set()
    for s in np.linspace(0.0, 3.0 if turning else 0.12, 40):
        D = displacement(s * twist)
        placed = points @ D[:3, :3].T + D[:3, 3]
        inside = index.contains((placed - X[:3, 3]) @ X[:3, :3])
        assert (known.maybe_inside(s) == inside)[passing].all()
        seen |= set(np.flatnonzero(inside & passing).tolist())
    assert 5 < len(seen)
    passed = ~np.isnan(known.last(0.0, 3.0 if turning else 0.12))
    start = np.flatnonzero(known.maybe_inside(0.0))
    assert seen <= set(np.flatnonzero(passed).tolist()) | set(start.tolist())


def test_a_point_passes_a_wall_where_its_circle_meets_it():
    mesh = mesh_of(box(-40, 40, 12, 15, -5, 5))
    known = passages(np.array([[0.025, 0, 0]]), mesh.vertices[mesh.faces], True, mesh)
    walls = np.arcsin(np.array([12, 15]) / 25)
    first, second, third, fourth = np.unique(np.round(known.ordered(Path(np.eye(4), True, 1)).place, 12))[:4]
    assert [first, second, third, fourth] == pytest.approx([*walls, *(np.pi - walls[::-1])], abs=1e-11)
    back = known.ordered(Path(np.eye(4), True, -1))
    assert np.unique(np.round(back.place, 12))[:4] == pytest.approx(
        np.sort(math.tau - np.array([*walls, *(np.pi - walls)])), abs=1e-11
    )


@pytest.mark.parametrize("turning", [True, False])
def test_an_edge_that_two_facets_share_is_passed(turning):
    """On the diagonal of a face, by which it is divided."""
    mesh = mesh_of(box(-40, 40, 12, 15, -40, 40))
    corners = mesh.vertices[mesh.faces]
    if not turning:
        corners = corners[..., [0, 2, 1]] * [1, 1, -1]
    along = np.linspace(-0.01, 0.01, 21)
    points = (
        np.column_stack([np.full(21, 0.02), np.zeros(21), along])
        if turning
        else np.column_stack([along, along, np.full(21, -0.05)])
    )
    found = passages(points, corners, turning, mesh)
    assert set(found.point.tolist()) == set(range(21))


def test_of_open_meshes_all_points_may_be_inside():
    mesh, _, points, corners = setting("block", 1)
    mesh = replace(mesh, health=replace(mesh.health, watertight=False))
    known = passages(points, corners, True, mesh).ordered(Path(np.eye(4), True, 1))
    assert known.maybe_inside(0.0).all()
