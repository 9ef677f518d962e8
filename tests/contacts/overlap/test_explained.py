"""Overlaps that the tessellation of mates explains, which is seen without a cut: the cut says no more of them."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import Manifold
from support.diagonal import first
from support.solids import box, derived, random_pose, recovered, rod

from kinform import contacts
from kinform.contacts.overlap.solids import SolidStore

STAGE = sys.modules["kinform.contacts.find"]
STEPS = np.array([-0.02, -0.004, 0.0, 0.004, 0.02, 0.06, 0.2, 0.7])
"""mm by which one part is moved into the other, about chord errors of .005 to .1."""


def plate(segments, radius=3.0):
    return box(-9, 9, -8, 8, -5, 5) - rod(radius, -6, 6, segments)


def ball(radius, segments):
    return Manifold.sphere(radius, segments)


def coned(low, high, z0, z1, segments):
    return Manifold.cylinder(z1 - z0, low, high, segments).translate((0, 0, z0))


def pairs(segments, others, phase):
    """A block and what is in it, of two tessellations."""
    pin = rod(3.0, -5, 9, others, phase)
    bore = plate(segments)
    yield "a pin", bore, pin
    yield "a pin that is flush with both faces", bore, rod(3.0, -5, 5, others, phase)
    yield "a pin with a collar", bore, pin + rod(4.5, 5, 6, others)
    yield "a pin with a flat", bore, pin - box(2.2, 4, -4, 4, -6, 10)
    yield "a blunt pin", bore, rod(3.0, -3, 9, others, phase) + coned(2.0, 3.0, -5, -3, others).rotate((0, 0, 7))
    yield "a pin with a key", bore - box(2, 4, -1, 1, -6, 6), pin + box(2, 3.9, -0.9, 0.9, -5, 9)
    yield "a countersunk screw", bore - coned(3.0, 5.0, 3, 5.0001, segments), pin + coned(3.0, 5.0, 3, 5, others)
    hollow = box(-8, 8, -8, 8, -8, 0) - ball(5.0, segments)
    yield "a ball in its cup", hollow, ball(5.0, others).rotate((0, 0, 11))
    yield "a ball on a rod", hollow, ball(5.0, others).rotate((0, 0, 11)) + rod(1.0, 0, 12, others)
    yield "a ball in a bore", plate(segments, 4.0), ball(4.0, others)
    yield "a plug", box(-9, 9, -8, 8, -5, 5) - coned(2.0, 4.0, -5, 5, segments), coned(2.0, 4.0, -5, 5, others)
    yield "a buried rod", box(-9, 9, -8, 8, -5, 5), rod(2.0, -1, 1, others)
    yield "a pin in no bore", box(-9, 9, -8, 8, -5, 5), pin
    yield "a pin placed twice", pin, rod(3.0, -5, 9, segments)


def bossed(segments, others, high):
    """Pins and bores that mate, and what stands off one of them by `high` mm, in the other."""
    pin, bore = rod(3.0, -9, 9, others), plate(segments)
    yield bore, pin + rod(3.0 + high, -1, 1, 60)
    yield bore, pin + box(2, 3.0 + high, -0.4, 0.4, -1, 1)
    # on the middle of a facet of the bore
    yield bore, pin + box(2, 3.0 + high, -0.1, 0.1, -1, 1).rotate((0, 0, 180 / segments))
    yield bore + (rod(3.2, -1, 1, segments) - rod(3.0 - high, -2, 2, 60)), pin
    yield bore + box(3.0 - high, 4, -0.4, 0.4, -1, 1), pin
    yield box(-8, 8, -8, 8, -8, 0) - ball(5.0, segments), ball(5.0, others) + rod(0.4, -5.0 - high, 0, 30)


def told_of(made):
    return [(i.parts, i.depth, i.volume, i.place.tolist(), i.mated, i.method) for i in made.interferences]


def asked_of(pose, block, other, monkeypatch, names=("block", "other")):
    """Whether the overlap is said to be explained, and what the stage says of it; with explaining and without."""
    seen, judged = [], STAGE.explained
    made = recovered(pose, **dict(zip(names, (block, other), strict=True)))

    def watched(asked):
        seen.extend(out := judged(asked))
        return out

    with monkeypatch.context() as patch:
        patch.setattr(STAGE, "explained", watched)
        told = told_of(contacts.find(*made))
        patch.setattr(STAGE, "explained", lambda asked: [False] * len(asked))
        by_cut = told_of(contacts.find(*made))
    return any(seen), told, by_cut


@given(
    st.integers(8, 60),
    st.integers(8, 60),
    st.floats(0, 1),
    st.sampled_from(STEPS),
    st.integers(0, 999),
    st.integers(0, 13),
)
@settings(max_examples=12, deadline=None)
def test_what_is_explained_is_no_overlap_by_a_cut(segments, others, phase, step, seed, which):
    rng = np.random.default_rng(seed)
    _, block, other = list(pairs(segments, others, phase))[which]
    towards = rng.normal(size=3)
    other = other.translate(tuple(step * towards / np.linalg.norm(towards)))
    explained, told, by_cut = asked_of(random_pose(rng), block, other, pytest.MonkeyPatch())
    assert told == by_cut
    assert not (explained and by_cut)


@pytest.mark.parametrize("which", [0, 1, 2, 3, 5, 6, 7, 8, 10])
def test_mates_of_two_tessellations_are_not_cut(which, monkeypatch):
    cuts, cut = [], SolidStore.overlap
    monkeypatch.setattr(SolidStore, "overlap", lambda self, a, b, least: cuts.append(a) or cut(self, a, b, least))
    _, block, other = list(pairs(24, 32, 0.1))[which]
    seen, judged = [], STAGE.explained
    monkeypatch.setattr(STAGE, "explained", lambda asked: seen.extend(out := judged(asked)) or out)
    assert told_of(derived(random_pose(np.random.default_rng(which)), block=block, other=other)[1]) == []
    assert seen == [True]
    assert not cuts


@pytest.mark.parametrize("which", range(14))
def test_what_is_drawn_deeper_is_told(which, monkeypatch):
    rng = np.random.default_rng(which)
    what, block, other = list(pairs(24, 32, 0.1))[which]
    buried = "no bore" in what or "buried" in what or "twice" in what
    other = other.translate((0.0 if buried else 0.4, 0, -0.1))
    explained, told, by_cut = asked_of(random_pose(rng), block, other, monkeypatch)
    assert not explained
    assert told == by_cut
    assert len(told) == 1


BOSSED = [((60, 12), ("a", "b")), ((12, 60), ("b", "a"))]
HEIGHTS = (0.002, 0.008, 0.03, 0.033, 0.06, 0.2)
MORE_FACETS = [(60, 8), (24, 32), (22, 8), (28, 8), (32, 28), (60, 12), (12, 60)]


@pytest.mark.parametrize(
    ("facets", "names", "heights"),
    [*((*made, HEIGHTS[k::2]) for k, made in enumerate(BOSSED)),
     *(pytest.param(facets, names, HEIGHTS, marks=pytest.mark.sweep)
       for facets in MORE_FACETS for names in (("a", "b"), ("b", "a")))],
)  # fmt: skip
def test_a_boss_beside_mates_is_no_part_of_them(facets, names, heights, monkeypatch):
    seen = []
    for high in heights:
        for block, other in bossed(*facets, high):
            _, told, by_cut = asked_of(random_pose(np.random.default_rng(1)), block, other, monkeypatch, names)
            assert told == by_cut
            seen.append(bool(by_cut))
    assert any(seen)


@pytest.mark.parametrize("seed", first(2, range(6)))
def test_a_boss_is_not_explained_by_both_mates(seed, monkeypatch):
    """Its partner stands off its facets by 0.019 mm, both mates by 0.033 mm together."""
    block, other = list(bossed(32, 28, 0.03))[4]
    names = (("a", "b"), ("b", "a"))[seed % 2]
    assert not asked_of(random_pose(np.random.default_rng(seed)), block, other, monkeypatch, names)[0]
