"""Joints that are proposed where no function is: what is proposed on small assemblies with a joint of each make."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from manifold3d import Manifold
from support.assemblies import assembly
from support.solids import box, part, rod
from support.touching import touching as touching_of

from kinform.foundation.tied_sizes import tied_sizes
from kinform.kinematics import propose
from kinform.kinematics.partition.sides import TouchingParts, substantial


def proposed(ground=None, **solids):
    """(type, sides) of what is proposed."""
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()))
    whole = replace(whole, ground=ground)
    found, near = touching_of(whole)
    return [(one.type, one.sides, one) for one in propose(whole, found, near)]


BASE = box(-30, 30, -30, 30, -10, 0) + rod(5, -1, 10, 48)
ARM = box(-10, 60, -10, 10, 0, 6) - rod(5.02, -1, 7, 48)


@pytest.mark.parametrize("radius", [None, 8.0])
def test_a_pivot_is_proposed_among_screw_holes_too(radius):
    """Holes of a horn line up with those of its motor in the pose that is drawn."""
    base, arm = BASE, ARM
    for x, y in () if radius is None else ((0, radius), (0, -radius), (radius, 0), (-radius, 0)):
        hole = rod(1, -20, 20, 24).translate((x, y, 0))
        base, arm = base - hole, arm - hole
    ((type_, sides, one),) = proposed(base=base, arm=arm)
    assert (type_, sides) == ("revolute", (("base",), ("arm",)))
    assert np.linalg.norm(one.axis[:2]) < 1e-9
    assert np.linalg.norm(one.point[:2]) < 1e-9


@pytest.mark.parametrize(
    ("ground", "moves", "share"), [(None, "arm", 0.18), ("base", "arm", 0.18), ("arm", "base", 0.82)]
)
def test_what_moves_is_not_the_ground(ground, moves, share):
    ((_, sides, one),) = proposed(ground, base=BASE, arm=ARM)
    assert sides[1] == (moves,)
    assert one.moved == pytest.approx(share, abs=0.005)


def test_what_lies_on_an_axis_does_not_hide_the_joint_there():
    """A foot of the arm slides on the base, beside the axis; a battery stands under the base, on the axis."""
    foot, battery = box(20, 28, 10, 25, 0, 6), box(-12, 12, -12, 12, -30, -10)
    ((type_, sides, _),) = proposed(base=BASE, arm=ARM, foot=foot, battery=battery)
    assert type_ == "revolute"
    assert {"arm", "foot"} in map(set, sides)


def test_a_ball_on_a_pin_is_a_ball_joint():
    """Lever and fork could turn about the pin alone, and the ball in the lever lets them more."""
    pin = rod(1.5, -9, 9, 32)
    ball = Manifold.sphere(4, 48) - rod(1.5, -9, 9, 32)
    lever = box(-4.5, 30, -6, 6, -2.5, 2.5) + box(30, 90, -30, 30, -20, 20) - Manifold.sphere(4, 48)
    fork = (
        box(-90, -30, -30, 30, -20, 20)
        + box(-30, 8, -6, 6, 5, 9)
        + box(-30, -25, -6, 6, -9, 9)
        + box(-30, 8, -6, 6, -9, -5)
    )
    ((type_, sides, one),) = proposed(pin=pin, ball=ball, lever=lever, fork=fork - pin)
    assert type_ == "spherical"
    assert np.linalg.norm(one.point) < 1e-5
    assert ("lever",) in sides


def test_a_bolt_turns_nothing_that_only_touches_its_head():
    """A block that leaves room for the hexagon of one of the bolts could turn with it on the plate."""
    low, high = box(-60, 60, -20, 20, -4, 0), box(-40, 40, -20, 20, 0, 4)
    places = [(-30, -10), (-30, 10), (30, -10), (30, 10)]
    bolts = {
        f"bolt_{k}": (rod(1.5, -4, 4, 32) + rod(2.7, 4, 6.2, 6)).translate((x, y, 0)) for k, (x, y) in enumerate(places)
    }
    block = box(10, 31, 4, 16, 4, 9)
    for bolt in bolts.values():
        low, high, block = low - bolt, high - bolt, block - bolt
    assert proposed(low=low, high=high, block=block, **bolts) == []


def chained(bars, washer=None):
    """Bars in a row, all parted from each other; beside each a washer of this share of a bar, parted from it too."""
    names = [f"bar{k:05d}" for k in range(bars)]
    pairs = list(pairwise(names))
    volume = dict.fromkeys(names, 2e-6)
    if washer is not None:
        rings = {f"ring{name}": name for name in names}
        volume |= dict.fromkeys(rings, washer * 2e-6)
        pairs += [(name, ring) for ring, name in rings.items()]
    cut = frozenset(pairs)
    graph = TouchingParts(sorted(volume), sorted(pairs), volume, [])
    return graph, cut


@pytest.mark.parametrize("bars", [3, 300, 3000])
def test_a_link_is_a_body_however_many_there_are_of_it(bars):
    graph, cut = chained(bars)
    first, second = "bar00001", "bar00002"
    assert graph.sides(frozenset({(first, second)}), cut) == [((first,), (second,))]


def test_a_washer_is_none_however_many_there_are_of_it():
    graph, cut = chained(1500, washer=0.01)
    for pair in (("bar00001", "ringbar00001"), ("bar00700", "ringbar00700")):
        assert graph.sides(frozenset({pair}), cut) == []


@given(st.integers(1, 3000), st.integers(0, 3000), st.sampled_from([1e-9, 1.0, 1e6]))
def test_what_is_substantial_is_half_a_part_at_most_and_scales(large, small, unit):
    volumes = unit * np.array([1.0] * large + [1e-3] * small)
    least = substantial(volumes, 0.001)
    assert least == pytest.approx(unit * substantial(volumes / unit, 0.001), rel=1e-9)
    assert least <= min(0.5 * unit, 0.001 * volumes.sum()) * (1 + 1e-9)
    if large + small <= 500:
        assert least == pytest.approx(0.001 * volumes.sum())


@given(st.integers(0, 10**6), st.sampled_from([1e-12, 1.0, 1e9]))
def test_sizes_that_differ_by_rounding_are_equal_and_so_are_their_sums(seed, unit):
    rng = np.random.default_rng(seed)
    kinds = rng.choice([1.0, 0.3, 0.3003 / 1.3, 7e-5, 0.0], 40)
    names = [f"part{k}" for k in range(40)]
    rounded = {n: unit * k * (1 + 2e-4 * rng.uniform(-1, 1)) for n, k in zip(names, kinds, strict=True)}
    level = tied_sizes(rounded)
    assert list(level) == names
    sizes = np.array(list(level.values()))
    assert np.allclose(sizes, unit * kinds, rtol=3e-4, atol=0.0 if kinds.min() else 1e-300)
    for kind in np.unique(kinds):
        assert len(set(sizes[kinds == kind].tolist())) == 1
    order = rng.permutation(40)
    assert sum(sizes[order].tolist()) == sum(sizes.tolist()) == float(np.add.reduce(sizes[::-1]))


@pytest.mark.parametrize("seed", range(6))
def test_which_of_equal_links_is_between_the_others_does_not_hang_on_rounding(seed):
    """Three plates on one pin, and its head: nobody is a ring between the others."""
    rng = np.random.default_rng(seed)
    names = ["a", "b", "c"]
    pairs = list(pairwise(names))
    volume = tied_sizes({name: 1e-6 * (1 + 1e-5 * rng.uniform(-1, 1)) for name in names})
    graph = TouchingParts(names, pairs, volume, [])
    assert graph.sides(frozenset(pairs), frozenset(pairs)) == [(("a",), ("b",)), (("b",), ("c",))]
