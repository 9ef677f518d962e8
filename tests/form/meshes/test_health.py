"""Welded meshes and facts about them."""

from __future__ import annotations

import manifold3d
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.raw import MeshError, RawMesh
from kinform.foundation.meshes.boxes import bounds

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


SIDES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip


def built(vertices, faces, solid=True, metres=1.0):
    return build_mesh(
        RawMesh(np.asarray(vertices, float), np.asarray(faces)), metres, None, path="m", body=None, solid=solid
    )


def test_facts_about_a_cube():
    health = built(CUBE, SIDES).health
    assert (health.watertight, health.consistent_winding, health.manifold_status) == (True, True, "NoError")
    assert health.volume == pytest.approx(1.0, rel=1e-14)
    assert (health.open_edges, health.overused_edges, health.shells, health.duplicate_facets) == (0, 0, 1, 0)


def test_an_open_cube_counts_its_edges():
    health = built(CUBE, SIDES[2:]).health
    assert (health.watertight, health.open_edges) == (False, 4)


def test_an_inverted_cube_is_turned_and_its_health_remembers():
    mesh = built(CUBE, SIDES[:, ::-1])
    assert mesh.health.volume == pytest.approx(-1.0)
    assert built(mesh.vertices, mesh.faces).health.volume == pytest.approx(1.0)


def test_one_turned_facet_a_duplicate_and_a_degenerate_one_are_counted():
    turned = SIDES.copy()
    turned[0] = turned[0][::-1]
    assert built(CUBE, turned).health.consistent_winding is False
    assert built(CUBE, np.vstack([SIDES, SIDES[:1]])).health.duplicate_facets == 1
    assert built(CUBE, np.vstack([SIDES, [[0, 0, 1]]])).health.degenerate_facets == 1


def test_nearly_equal_vertices_weld_and_units_scale():
    soup = CUBE[SIDES].reshape(-1, 3) + np.random.default_rng(0).uniform(-1e-8, 1e-8, (36, 3))
    mesh = built(soup, np.arange(36).reshape(-1, 3), metres=1e-3)
    assert len(mesh.vertices) == 8
    assert mesh.health.watertight
    assert mesh.health.volume == pytest.approx(1e-9, rel=1e-6)


def test_a_flat_solid_is_refused_and_a_flat_surface_is_not():
    square = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    with pytest.raises(MeshError):
        built(*square)
    assert built(*square, solid=False).health.open_edges == 4


@st.composite
def closed_soups(draw):
    """Faces over few vertices at whose edges as many run one way as the other: shells of four, some doubled, turned or
    pinched at a vertex, pillows of two."""
    count = draw(st.integers(4, 9))
    faces = []
    for _ in range(draw(st.integers(1, 4))):
        a, b, c, d = draw(st.permutations(range(count)))[:4]
        shell = draw(st.sampled_from([
            [(a, b, c), (a, c, d), (a, d, b), (b, d, c)], [(a, b, c), (c, b, a)],
        ]))  # fmt: skip
        faces += shell
    return np.random.default_rng(draw(st.integers(0, 99))).normal(size=(count, 3)), np.array(faces)


@settings(max_examples=8, deadline=None)
@given(closed_soups())
def test_status_and_duplicates_are_those_of_manifold3d_and_of_a_count(mesh):
    vertices, faces = mesh
    made = built(vertices, faces, solid=False)
    health = made.health
    alike = [tuple(sorted(face)) for face in faces.tolist()]
    assert health.duplicate_facets == len(alike) - len(set(alike))
    if health.watertight and health.consistent_winding:  # of others it reads beyond its tables
        corners = made.faces.astype(np.uint64)
        asked = manifold3d.Manifold(manifold3d.Mesh64(made.vertices.copy(), corners)).status().name
        assert health.manifold_status == asked


def repetitions():
    """Cubes with copies of facets, and how many these are."""
    back = SIDES[:, ::-1]
    yield "a shell twice", np.vstack([SIDES, SIDES]), 12
    yield "each facet twice", np.repeat(SIDES, 2, axis=0), 12
    yield (
        "each facet three times, from another corner",
        np.vstack([SIDES, np.roll(SIDES, 1, 1), np.roll(SIDES, 2, 1)]),
        24,
    )
    yield "two facets twice", np.vstack([SIDES, SIDES[3:5]]), 2
    yield "both sides of each facet", np.vstack([SIDES, back]), 12
    yield "both sides, one after the other", np.stack([SIDES, back], axis=1).reshape(-1, 3), 12
    yield "both sides of some, and some twice", np.vstack([SIDES, back[:3], SIDES[6:]]), 9


@pytest.mark.parametrize("faces,copies", [pytest.param(f, n, id=name) for name, f, n in repetitions()])
def test_facets_that_are_there_more_than_once_are_taken_once(faces, copies):
    mesh, alone = built(CUBE, faces), built(CUBE, SIDES)
    assert np.array_equal(mesh.faces, alone.faces)
    assert (mesh.health.facets, mesh.health.duplicate_facets) == (12 + copies, copies)
    assert (mesh.health.watertight, mesh.health.shells, mesh.health.degenerate_facets) == (True, 1, 0)
    assert mesh.health.volume == pytest.approx(1.0, rel=1e-14)


def test_the_back_of_a_facet_is_kept_where_the_mesh_is_not_closed_without_it():
    flap = np.vstack([SIDES[2:], SIDES[2:3, ::-1]])  # an open cube, with one facet drawn from both sides
    mesh = built(CUBE, flap)
    assert (len(mesh.faces), mesh.health.duplicate_facets, mesh.health.watertight) == (11, 1, False)
    stacked = np.vstack([SIDES, SIDES + 8])  # two cubes one on the other: the face between is in both
    cubes = built(np.vstack([CUBE, CUBE + [0, 0, 1]]), stacked)
    assert (len(cubes.faces), cubes.health.duplicate_facets, cubes.health.shells) == (24, 2, 2)


@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000])
def test_bounds_are_the_least_and_greatest_of_columns(count):
    points = np.random.default_rng(count).normal(size=(count, 3)).astype(np.float32)
    low, high = bounds(points)
    assert np.array_equal(low, points.min(axis=0)) and np.array_equal(high, points.max(axis=0))
