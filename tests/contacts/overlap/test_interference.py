"""Solids that overlap: volume and depth against arithmetic, and what tessellation alone explains."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np
import pytest
from support.analytic_solids import MM, assembly, box_loop, extrusion, pose, round_loop, turned

from kinform.contacts import find


@cache
def cube():
    return extrusion(box_loop(0, 0, 10 * MM, 10 * MM), z0=0.0, z1=10 * MM)


def interferences(first, second, X_second, X_first=None):
    parts = {"a": (first, pose() if X_first is None else X_first), "b": (second, X_second)}
    return find(*assembly(parts)).interferences


def opened(solid):
    """The same mesh without its first facet."""
    mesh, surfaces = solid
    health = dataclasses.replace(mesh.health, watertight=False, manifold_status="NotManifold", open_edges=3)
    mesh = dataclasses.replace(mesh, faces=mesh.faces[1:], health=health, digest=mesh.digest + "-open")
    kept = tuple(dataclasses.replace(s, faces=s.faces[s.faces > 0] - 1) for s in surfaces.surfaces)
    return mesh, dataclasses.replace(surfaces, digest=mesh.digest, labels=surfaces.labels[1:], surfaces=kept)


def test_overlap_of_two_boxes_has_the_volume_depth_and_place_of_arithmetic():
    (found,) = interferences(cube(), cube(), pose(translation=(8 * MM, 3 * MM, 1 * MM)))
    assert found.volume == pytest.approx(2 * 7 * 9 * MM**3, rel=1e-9)
    assert found.depth == pytest.approx(2 * MM, rel=0.05)
    np.testing.assert_allclose(found.place, np.array([9, 6.5, 5.5]) * MM, atol=1e-9)
    assert found.parts == ("a", "b")
    assert found.method == "manifold"
    assert not found.mated


def test_overlap_does_not_depend_on_the_pose_of_the_whole():
    X = pose(turned((1, -2, 0.5), 73.0), (2.0, -1.0, 0.4))
    (found,) = interferences(cube(), cube(), X @ pose(translation=(8 * MM, 3 * MM, 1 * MM)), X)
    assert found.volume == pytest.approx(2 * 7 * 9 * MM**3, rel=1e-9)
    np.testing.assert_allclose(found.place, X[:3, :3] @ np.array([9, 6.5, 5.5]) * MM + X[:3, 3], atol=1e-9)


@pytest.mark.parametrize("shift", [(10, 0, 0), (10, 10, 0), (10, 3, 2), (10.01, 0, 0)])
def test_boxes_that_only_touch_do_not_interfere(shift):
    assert interferences(cube(), cube(), pose(translation=np.array(shift) * MM)) == ()


def test_a_part_inside_another_interferes_with_all_its_volume():
    small = extrusion(box_loop(4 * MM, 4 * MM, 6 * MM, 6 * MM), z0=4 * MM, z1=6 * MM)
    (found,) = interferences(cube(), small, pose())
    assert found.volume == pytest.approx(8 * MM**3, rel=1e-9)
    assert not found.mated
    (swapped,) = interferences(small, cube(), pose())
    assert swapped.volume == pytest.approx(8 * MM**3, rel=1e-9)


def test_a_part_in_a_cavity_does_not_interfere():
    ring = extrusion(box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM), [round_loop(15 * MM, 32)], z1=10 * MM)
    assert interferences(ring, cube(), pose(translation=(-5 * MM, -5 * MM, 0))) == ()


def test_a_part_placed_twice_interferes_with_all_its_volume():
    (found,) = interferences(cube(), cube(), pose())
    assert found.volume == pytest.approx(1000 * MM**3, rel=1e-6)
    assert not found.mated


def test_flush_bars_that_run_into_each_other_interfere():
    (found,) = interferences(cube(), cube(), pose(translation=(4 * MM, 0, 0)))
    assert found.volume == pytest.approx(600 * MM**3, rel=1e-6)


def bored(gap):
    outer, hole = box_loop(-20 * MM, -20 * MM, 20 * MM, 20 * MM), round_loop(10 * MM + gap, 24, 0.05)
    return extrusion(outer, [hole], z0=0.0, z1=15 * MM)


@pytest.mark.parametrize("gap", [0.0, 0.05 * MM, -0.02 * MM])
def test_facets_that_overlap_within_their_chord_errors_do_not_interfere(gap):
    shaft = extrusion(round_loop(10 * MM, 32), z0=-10 * MM, z1=30 * MM)
    assert interferences(shaft, bored(gap), pose()) == ()
    assert interferences(bored(gap), shaft, pose()) == ()


def test_a_press_fit_beyond_the_chord_errors_is_a_mated_interference():
    shaft = extrusion(round_loop(10 * MM, 32), z0=-10 * MM, z1=30 * MM)
    (found,) = interferences(shaft, bored(-0.3 * MM), pose())
    assert found.mated
    # Between the inscribed polygon of the bore and that of the shaft.
    assert 0.2 * MM < found.depth < 0.42 * MM
    shell = 15 * (0.5 * 32 * 100 * math.sin(2 * math.pi / 32) - 0.5 * 24 * 9.7**2 * math.sin(2 * math.pi / 24))
    assert found.volume == pytest.approx(shell * MM**3, rel=0.02)


def test_an_overlap_beyond_the_tolerance_is_no_fit():
    (found,) = interferences(cube(), cube(), pose(translation=(9.2 * MM, 0, 0)))
    assert found.depth == pytest.approx(0.8 * MM, rel=0.05)
    assert not found.mated
    (found,) = interferences(cube(), cube(), pose(translation=(9.9 * MM, 0, 0)))
    assert found.mated


def test_overlap_of_an_open_mesh_has_a_depth_and_no_volume():
    (found,) = interferences(opened(cube()), cube(), pose(translation=(8 * MM, 0.1 * MM, 0.2 * MM)))
    assert found.method == "facets"
    assert math.isnan(found.volume)
    assert found.depth == pytest.approx(2 * MM, rel=0.05)


def test_surfaces_without_a_solid_have_contacts_and_no_interference():
    first, surfaces = assembly({"a": (cube(), pose()), "b": (cube(), pose(translation=(9.9 * MM, 0, 0)))})
    hollow = dataclasses.replace(first, parts=(first.parts[0], dataclasses.replace(first.parts[1], solid=False)))
    found = find(hollow, surfaces)
    assert found.patches
    assert found.interferences == ()
