"""Solids that are seen not to overlap without a cut: that they are, and that a cut would say no more of them."""

from __future__ import annotations

import numpy as np
import pytest
from support.analytic_solids import MM, assembly, box_loop, extrusion, flat_loop, pose, revolution, turned
from support.diagonal import diagonal

from kinform.contacts import find
from kinform.contacts.overlap import interference
from kinform.contacts.overlap.constants import EXACT_OVERLAP
from kinform.contacts.overlap.interference import THINNER
from kinform.contacts.overlap.solids import SolidStore
from kinform.contacts.search.candidates import candidate_pairs

SLOT = flat_loop([(0, 0), (10, 0), (10, 10), (7, 10), (8, 4), (2, 4), (3, 10), (0, 10)])
SLIDE = flat_loop([(2, 4), (8, 4), (7, 10), (3, 10)])


def prism(loop, height=8.0, z0=0.0):
    points, keys = loop
    return extrusion((points * MM, keys), z0=z0 * MM, z1=height * MM)


def overlaps(first, second, X_second=None, X_all=None):
    X_all = pose() if X_all is None else X_all
    X_second = pose() if X_second is None else X_second
    return find(*assembly({"a": (first, X_all), "b": (second, X_all @ X_second)})).interferences


def counts_from(first, second):
    """m: what is less deep than this is no overlap."""
    (tolerance,) = candidate_pairs(assembly({"a": (first, pose()), "b": (second, pose())})[0]).values()
    return EXACT_OVERLAP * tolerance


@pytest.fixture
def cuts(monkeypatch):
    """Pairs of parts that are cut."""
    seen, cut = [], SolidStore.overlap
    monkeypatch.setattr(SolidStore, "overlap", lambda self, a, b, least: seen.append((a, b)) or cut(self, a, b, least))
    return seen


def test_a_slide_that_lies_on_all_sides_of_its_slot_is_not_cut(cuts):
    X = pose(turned((1, -2, 0.5), 73.0), (0.2, -0.1, 0.4))
    assert overlaps(prism(SLOT), prism(SLIDE), X_all=X) == ()
    assert not cuts


def test_a_plug_that_fills_its_hole_is_not_cut(cuts):
    hole, plug = box_loop(3, 3, 7, 7), prism(box_loop(3, 3, 7, 7))
    outer = box_loop(0, 0, 10, 10)
    plate = extrusion((outer[0] * MM, outer[1]), [(hole[0] * MM, hole[1])], z1=8 * MM)
    assert overlaps(plate, plug) == overlaps(plug, plate) == ()
    assert not cuts
    (found,) = overlaps(prism(outer), plug)
    assert found.volume == pytest.approx(4 * 4 * 8 * MM**3)


@diagonal(
    share=[0.0, 0.2, 0.24, 0.26, 0.5, 0.9, 1.1, 2.0, 10.0],
    towards=[(0, -1, 0), (1, 0, 0), (0.6, 0, 0.8), (0.48, -0.6, 0.64)],
)
def test_what_is_said_without_a_cut_is_what_the_cut_says(share, towards, cuts, monkeypatch):
    slot, slide = prism(SLOT), prism(SLIDE)
    X = pose(translation=share * counts_from(slot, slide) * np.array(towards))
    told = overlaps(slot, slide, X)
    without = not cuts
    monkeypatch.setattr(interference, "are_within", lambda *_: False)
    by_cut = overlaps(slot, slide, X)
    assert len(cuts) > (not without)
    assert [(i.depth, i.volume, i.place.tolist()) for i in told] == [
        (i.depth, i.volume, i.place.tolist()) for i in by_cut
    ]
    assert not (without and by_cut)
    assert without or share > 0.1


def test_solids_that_share_more_are_cut(cuts):
    cube = prism(box_loop(0, 0, 10, 10), 10.0)
    corner = prism(box_loop(0, 0, 4, 4), 4.0)
    for other in (cube, corner):
        assert len(overlaps(cube, other)) == 1
    assert len(cuts) == 2


@pytest.mark.parametrize("thick", [0.2, 1.0, 3.0])
def test_a_blade_no_thicker_than_what_it_is_made_thinner_by_is_found(thick, cuts):
    cube = prism(box_loop(0, 0, 10, 10), 10.0)
    least = THINNER * counts_from(cube, cube)
    blade = extrusion(box_loop(5 * MM, -3 * MM, 5 * MM + thick * least, 6 * MM), z0=-2 * MM, z1=7 * MM)
    (found,) = overlaps(cube, blade)
    assert found.depth > MM
    assert len(cuts) == 1


def test_a_shell_within_another_solid_is_found(cuts):
    cube = prism(box_loop(0, 0, 10, 10), 10.0)
    inner = prism(box_loop(4, 4, 6, 6), 6.0, z0=4.0)
    assert len(overlaps(cube, inner)) == 1
    assert len(overlaps(inner, cube)) == 1


def ball_and_socket(count):
    half = np.linspace(-np.pi / 2, np.pi / 2, count // 2 + 1)
    arc = np.stack([10 * MM * np.cos(half), 10 * MM * np.sin(half)], axis=1)
    arc[[0, -1], 0] = 0.0
    lower = arc[: count // 4 + 1]
    cup = np.concatenate([[[0.0, -14 * MM], [14 * MM, -14 * MM], [14 * MM, 0.0]], lower[::-1]])
    sphere = ("sphere", 0.0, 10 * MM)
    ball = revolution(arc, count, arcs=dict.fromkeys(range(len(arc) - 1), sphere))
    return ball, revolution(cup, count, arcs=dict.fromkeys(range(3, len(cup) - 1), sphere))


@pytest.mark.parametrize("turn", [0.0, 0.37])
def test_a_ball_of_many_facets_that_lies_in_its_socket_is_not_cut(turn, cuts):
    ball, socket = ball_and_socket(96)
    assert overlaps(socket, ball, pose(turned((0, 0, 1), turn * 360.0 / 96))) == ()
    assert len(cuts) == (turn > 0.0)  # then their edges cross, and lenses are left of it, less deep than chords
