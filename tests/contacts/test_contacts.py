"""What must not change the contacts: pose, order, names, and scale when the tolerances scale with it."""

from __future__ import annotations

import dataclasses
import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.analytic_solids import MM, assembly, box_loop, extrusion, pose, revolution, round_loop, turned

from kinform.contacts import find
from kinform.model.tolerances import Tolerances


def collared(scale=1.0, turn=0.0):
    """A shaft with a collar, which rests on a bushing: a cylinder and an annulus."""
    outline = [(0, -20), (10, -20), (10, 0), (14, 0), (14, 5), (0, 5)]
    shaft = revolution([(r * MM * scale, z * MM * scale) for r, z in outline], 32, turn)
    outer = box_loop(*(np.array([-20, -20, 20, 20]) * MM * scale))
    hole = round_loop(10.1 * MM * scale, 24)
    return shaft, extrusion(outer, [hole], z0=-15 * MM * scale, z1=0.0)


def areas(found):
    return sorted((p.kind, p.area, p.gap) for p in found.patches)


@cache
def reference():
    return areas(find(*assembly(dict(zip("ab", [(s, pose()) for s in collared()], strict=True)))))


angle = st.floats(-180, 180)
place = st.tuples(*[st.floats(-2, 2)] * 3)


def close(found, scale=1.0, rel=1e-6):
    assert [kind for kind, _, _ in found] == [kind for kind, _, _ in reference()]
    for (_, area, gap), (_, area_0, gap_0) in zip(found, reference(), strict=True):
        assert area == pytest.approx(area_0 * scale**2, rel=rel)
        assert gap == pytest.approx(gap_0 * scale, abs=1e-9 * scale)


def test_the_reference_is_right():
    (cylinder, area, gap), (plane, thrust, touch) = reference()
    assert (cylinder, plane) == ("cylinder", "plane")
    assert area == pytest.approx(2 * math.pi * 10.05 * 15 * MM**2, rel=1e-6)
    assert gap == pytest.approx(0.1 * MM)
    collar = 0.5 * 32 * 14**2 * math.sin(2 * math.pi / 32) - 0.5 * 24 * 10.1**2 * math.sin(2 * math.pi / 24)
    assert thrust == pytest.approx(collar * MM**2, rel=2e-3)
    assert touch == pytest.approx(0.0, abs=1e-12)


@settings(max_examples=6, deadline=None)
@given(st.tuples(angle, angle, angle), place)
def test_moving_the_whole_assembly_moves_the_contacts_with_it(angles, shift):
    X = pose(turned((1, 0, 0), angles[0]) @ turned((0, 1, 0), angles[1]) @ turned((0, 0, 1), angles[2]), shift)
    shaft, hub = collared()
    found = find(*assembly({"a": (shaft, X), "b": (hub, X)}))
    close(areas(found))
    for patch in found.patches:
        np.testing.assert_allclose(np.abs(patch.axis @ X[:3, 2]), 1.0, atol=1e-9)


@settings(max_examples=4, deadline=None)
@given(angle, st.floats(0, 2))
def test_turning_the_shaft_in_its_bore_changes_nothing(degrees, turn):
    shaft, hub = collared(turn=turn)
    found = find(*assembly({"a": (shaft, pose(turned((0, 0, 1), degrees))), "b": (hub, pose())}))
    close(areas(found), rel=0.01)


def test_swapping_the_names_turns_the_normals_and_keeps_the_rest():
    shaft, hub = collared()
    X = pose(turned((3, 1, 2), 40.0), (0.1, 0.2, 0.3))
    first = find(*assembly({"a": (shaft, X), "b": (hub, X)})).patches
    second = find(*assembly({"z": (shaft, X), "b": (hub, X)})).patches
    for p in first:
        (q,) = (q for q in second if q.kind == p.kind)
        assert q.surfaces == p.surfaces[::-1]
        assert q.radii == p.radii[::-1]
        assert q.area == pytest.approx(p.area, rel=1e-6)
        if p.kind == "plane":
            np.testing.assert_allclose(q.axis, -p.axis, atol=1e-9)
        else:
            outward = p.points - p.point
            assert (np.einsum("ij,ij->i", p.normals, outward) > 0).all()
            outward = q.points - q.point
            assert (np.einsum("ij,ij->i", q.normals, outward) < 0).all()


@pytest.mark.parametrize("scale", [0.01, 25.0])
def test_scaling_the_assembly_and_its_tolerances_scales_the_contacts(scale):
    shaft, hub = collared(scale)
    tolerances = Tolerances(contact=0.5 * MM * scale)
    found = find(*assembly({"a": (shaft, pose()), "b": (hub, pose())}, tolerances=tolerances))
    close(areas(found), scale)


def test_baking_a_pose_into_the_vertices_keeps_the_contacts():
    X = pose(turned((1, 1, 0), 33.0), (0.05, -0.02, 0.4))
    baked = {}
    for name, (mesh, surfaces) in zip("ab", collared(), strict=True):
        baked[name] = (_moved(mesh, X), _turned(surfaces, X))
    design, recovered = assembly({name: (shape, pose()) for name, shape in baked.items()})
    close(areas(find(design, recovered)), rel=1e-6)


def _moved(mesh, X):
    vertices = mesh.vertices @ X[:3, :3].T + X[:3, 3]
    return dataclasses.replace(mesh, vertices=vertices, digest=mesh.digest + "-moved")


def _turned(surfaces, X):
    moved = tuple(
        dataclasses.replace(s, axis=X[:3, :3] @ s.axis, point=X[:3, :3] @ s.point + X[:3, 3]) for s in surfaces.surfaces
    )
    return dataclasses.replace(surfaces, digest=surfaces.digest + "-moved", surfaces=moved)
