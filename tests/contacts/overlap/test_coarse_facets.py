"""Round sockets of coarse facets: what their facets alone overlap is none, and what is deeper is told."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold
from random_assemblies import case
from support.diagonal import diagonal, first
from support.solids import box, derived, random_pose, rod

from kinform import contacts, form, surfaces
from kinform.contacts.overlap import coarse_facets

INSIDE = np.array([(i, j, 12 - i - j) for i in range(13) for j in range(13 - i)]) / 12.0
"""Weights of the corners at points all over a triangle."""


def contacts_of(seed, **solids):
    return derived(random_pose(np.random.default_rng(seed)), **solids)[1]


def overlaps(seed, **solids):
    return contacts_of(seed, **solids).interferences


def chord(segments):
    """mm that the facets of a ball of 10 mm stand off it."""
    mesh = Manifold.sphere(10.0, segments).to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts, dtype=np.int64)]
    return 10.0 - np.linalg.norm(np.einsum("wk,nkc->nwc", INSIDE, corners), axis=2).min()


def socket_and_ball(phase, push, segments=64):
    """A ball of so many segments in a shallow socket of 12, pushed (mm) into it."""
    socket = box(-14, 14, -14, 14, -30, -7) - Manifold.sphere(10.0, 12).rotate((0, 0, phase))
    ball = Manifold.sphere(10.0, segments).rotate((30, 0, 0)) + rod(3, 0, 30)
    return {"socket": socket, "ball": ball.translate((0, 0, -push))}


@pytest.mark.parametrize("phase", first(2, [0.0, 33.0, 10.0]))
def test_that_it_is_not_known_whether_it_does_is_said(phase):
    found = contacts_of(1, **socket_and_ball(phase, 0.0))
    assert found.interferences == ()
    (possible,) = found.possible_overlaps
    assert 0.5 * chord(12) < 1e3 * possible.depth < chord(12) + chord(64)
    assert not possible.mated
    # deeper, it is known
    deep = contacts_of(1, **socket_and_ball(phase, 1.3 * (chord(12) + chord(64))))
    assert deep.possible_overlaps == ()


@pytest.mark.parametrize(
    ("segments", "at_once"), [(32, None), (128, 1_000_000), pytest.param(384, None, marks=pytest.mark.sweep)]
)
def test_it_does_not_hang_on_how_fine_the_ball_is(segments, at_once, monkeypatch):
    """Of a ball of 70,000 facets too many are near to be looked at at once; so are those of one that is coarser, where
    fewer may be."""
    if at_once is not None:
        monkeypatch.setattr(coarse_facets, "COARSE_AT_ONCE", at_once)
    found = contacts_of(1, **socket_and_ball(10.0, 0.0, segments))
    assert (len(found.interferences), len(found.possible_overlaps)) == (0, 1)
    (deep,) = overlaps(1, **socket_and_ball(10.0, 1.3 * (chord(12) + chord(segments)), segments))
    assert not deep.mated


@pytest.mark.parametrize("phase", first(1, [10.0, 0.0, 33.0]))
def test_a_ball_pushed_into_it_by_more_than_facets_stand_off_overlaps(phase):
    off = chord(12) + chord(64)
    (found,) = overlaps(1, **socket_and_ball(phase, 1.3 * off))
    # the facets of the socket stand further in than the ball that they stand for
    assert 1.3 * off < 1e3 * found.depth < 2.6 * off
    assert not found.mated


def countersink(segments, turn, push):
    """A plug of 64 segments in a countersink at 45° that ends at a fine bore, pushed (mm) into it."""
    bore = box(-20, 20, -20, 20, -15, 0) - rod(8, -16, 1, 180)
    seat = bore - Manifold.cylinder(7.0, 6.0, 13.0, segments).rotate((0, 0, turn)).translate((0, 0, -6.0))
    plug = Manifold.cylinder(4.4, 7.1, 11.5, 64).translate((0, 0, -4.9)) + rod(3, -4, 20)
    return {"seat": seat, "plug": plug.translate((0, 0, -push))}


@diagonal(segments=[12, 16, 24], turn=[0.0, 7.0])
def test_a_plug_in_a_coarse_countersink_that_ends_at_a_fine_bore_does_not_overlap(segments, turn):
    assert all(found.mated for found in overlaps(2, **countersink(segments, turn, 0.0)))
    off = 11.5 * (1 - np.cos(np.pi / segments)) + 11.5 * (1 - np.cos(np.pi / 64))
    (found,) = overlaps(2, **countersink(segments, turn, 2.0 * off))
    assert 1e3 * found.depth > 2.0 * off * np.sqrt(0.5)


@pytest.mark.parametrize("seed", first(1, [970531, 970553]))
def test_coarse_sockets_of_random_assemblies_do_not_overlap(seed, tmp_path):
    assembly = form.load(case(seed).write(tmp_path))
    found = {part.mesh.digest: surfaces.recover(part.mesh, assembly.tolerances) for part in assembly.parts}
    assert contacts.find(assembly, found).interferences == ()


@pytest.mark.parametrize("away", [0.0, 7.0])
def test_coarse_facets_explain_no_overlap_of_flats_beside_them(away):
    dimple = Manifold.sphere(6.0, 12).rotate((10, 20, 30)).translate((-3, 0, 2))
    first = box(-10, 10, -10, 10, -5, 0) - dimple
    (found,) = overlaps(3, dimpled=first, slab=box(away - 10, away + 10, -9, 9, -0.2, 4))
    assert found.depth == pytest.approx(0.2e-3, rel=0.05)
