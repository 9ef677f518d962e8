"""Rings of flats: those that are there are found, whatever stands beside them, and none is left out at first sight."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import CrossSection, Manifold
from support import solids
from support.analytic_solids import MM, extrusion, flat_loop

from kinform.foundation.meshes import rings
from kinform.foundation.meshes.mesh_index import MeshIndex
from kinform.model.tolerances import Tolerances
from kinform.surfaces import recover


def prism(sides, radius=10.0, squeeze=1.0, phase=0.1, centre=(0.0, 0.0)):
    angles = phase + 2.0 * np.pi * np.arange(sides) / sides
    points = np.stack([radius * np.cos(angles), squeeze * radius * np.sin(angles)], axis=1)
    return flat_loop((points + centre) * MM)


def found(mesh, surfaces):
    return MeshIndex(mesh).rings(surfaces)


@pytest.mark.parametrize("sides", [3, 5, 6, 8, 11, 17])
def test_a_prism_is_one_ring_with_its_corners_and_flats(sides):
    (ring,) = found(*extrusion(prism(sides), z0=0.0, z1=20 * MM))
    assert (ring.sides, ring.side) == (sides, 1)
    assert ring.corner == pytest.approx(10 * MM, rel=1e-9)
    assert ring.flats == pytest.approx((10 * MM * np.cos(np.pi / sides),) * 2, rel=1e-9)
    assert abs(ring.axis[2]) == pytest.approx(1.0, abs=1e-12)


def test_two_sockets_in_one_block_are_two_rings_inside_out_and_the_block_is_none():
    block = flat_loop(np.array([[-30, -15], [30, -15], [30, 15], [-30, 15]]) * MM)
    holes = [prism(6, 5.0, centre=(-15, 0)), prism(8, 6.0, centre=(15, 0))]
    both = found(*extrusion(block, holes, z0=0.0, z1=10 * MM))
    assert sorted((ring.sides, ring.side) for ring in both) == [(6, -1), (8, -1)]


@settings(max_examples=15, deadline=None)
@given(
    st.integers(3, 16),
    st.floats(0.97, 1.03),
    st.floats(0.0, 1.0),
    st.sampled_from([1e-3, 1.0, 1e3]),
    st.sampled_from([0.0, 1e-4, 3e-3, 6e-3]),
)
def test_a_first_sight_leaves_out_nothing_that_a_closer_look_keeps(sides, squeeze, phase, size, scatter):
    outer = size * np.asarray(prism(sides, squeeze=squeeze, phase=phase)[0])
    outer *= 1.0 + scatter * np.random.default_rng(sides).uniform(-1.0, 1.0, (len(outer), 1))
    mesh, surfaces = extrusion(flat_loop(outer), z0=0.0, z1=size * 20 * MM)
    quick = found(mesh, surfaces)
    first_sight, rings._may_be_round = rings._may_be_round, lambda sights, noise: np.ones(len(sights.planes), bool)
    try:
        close = found(mesh, surfaces)
    finally:
        rings._may_be_round = first_sight
    assert [ring.facets.tolist() for ring in quick] == [ring.facets.tolist() for ring in close]
    assert [(ring.corner, ring.flats, ring.turn) for ring in quick] == [(r.corner, r.flats, r.turn) for r in close]


@pytest.mark.parametrize("bevel", [0.0, 0.15, 0.6])
@pytest.mark.parametrize("length", [60.0, 100.0, 200.0])
def test_the_steps_of_a_long_bar_are_no_ring(length, bevel):
    # seen across its length a bar of T section is flats that face four ways, with all corners at both ends
    def rail(low, high):
        ends = [(-1, low, bevel), (1, low, bevel), (1, high, -bevel), (-1, high, -bevel)]
        cut = [
            [(s * length / 2, y + b), (s * (length / 2 - bevel), y)][:: 1 if s * b < 0 or not b else -1]
            for s, y, b in ends
        ]
        return Manifold.extrude(CrossSection([[c for corner in cut for c in corner]]), 4.0)

    solid = rail(-7.0, 7.0) + rail(-4.0, 4.0).translate((0, 0, 4.0)) + rail(-4.0, 7.5).translate((0, 0, 8.0))
    rail_part = solids.part("rail", solid, np.eye(4))
    assert not found(rail_part.mesh, recover(rail_part.mesh, Tolerances()))
