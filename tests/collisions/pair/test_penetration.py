"""How deep parts are in each other where facets cross, and whether that is deeper than is allowed."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import first
from support.solids import assembly, ball, box, part, rod

from kinform import surfaces
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.pair.states import State
from kinform.collisions.parts.shapes import Shapes


def pair_of(**solids):
    """Two parts, with all facets."""
    names = list(solids)
    made = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()), ground=None)
    shapes = Shapes(made, {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}, None)
    return PairTest(shapes, *names, tuple(np.arange(len(shapes.mesh(name).faces)) for name in names), ())


def slid(x):
    D = np.eye(4)
    D[0, 3] = 1e-3 * x
    return D


@pytest.mark.parametrize("deep", [1e-3, 0.02, 0.3, 2.0])
def test_a_block_is_as_deep_in_a_wall_as_it_was_moved(deep):
    test = pair_of(wall=box(0, 10, -20, 20, -20, 20), block=box(-30, -1, -5, 5, -5, 5))
    D = slid(1.0 + deep)
    segments = test.crossing(D).segments()
    # the middle of the end of the block is as deep in the wall; in the block it is on its surface
    assert 1e3 * test.depth(D, segments) == pytest.approx(min(deep, 5.0), rel=1e-6)


@pytest.mark.parametrize("seed", first(4, range(12)))
def test_deeper_than_allowed_is_what_is_deeper_however_little_is_allowed(seed):
    rng = np.random.default_rng(seed)
    ring = rod(12, -4, 4, 48) - rod(8, -5, 5, 48)
    test = pair_of(first=ring + box(11, 30, -2, 2, -2, 2), second=ball(5, 24) + rod(2, -20, 20, 24))
    D = np.eye(4)
    D[:3, 3] = 1e-3 * rng.uniform([4, -6, -8], [24, 6, 8])
    segments = test.crossing(D).segments()
    deepest = test.depth(D, segments)
    for least in np.append(deepest * np.array([1e-3, 0.3, 0.999, 1.001, 3.0]), 1e-9):
        if least > 0.0:
            assert test.depth(D, segments, least) == (deepest if deepest > least else 0.0)


@pytest.mark.parametrize("seed", first(2, range(6)))
def test_what_is_told_of_several_places_together_is_what_is_told_of_each(seed):
    rng = np.random.default_rng(seed)
    ring = rod(12, -4, 4, 48) - rod(8, -5, 5, 48)
    test = pair_of(first=ring + box(11, 30, -2, 2, -2, 2), second=ball(5, 24) + rod(2, -20, 20, 24))
    poses = [np.eye(4) for _ in range(12)]
    for D in poses:
        D[:3, 3] = 1e-3 * rng.uniform([-10, -16, -8], [34, 16, 8])
    hits = [test.hits(D) for D in poses]
    together = test.crossings(poses, hits)
    assert 3 <= sum(map(bool, together)) < len(poses)
    for D, crossing in zip(poses, together, strict=True):
        alone = test.crossing(D)
        assert crossing.slack == alone.slack and list(crossing.shared) == list(alone.shared)
        assert crossing.segments().tobytes() == alone.segments().tobytes()
    some = [(D, crossing.segments()) for D, crossing in zip(poses, together, strict=True) if crossing]
    depths = [test.depth(*one) for one in some]
    for share in (0.3, 0.999, 1.001):
        least = [share * depth for depth in depths]
        shallow = test.shallow([D for D, _ in some], [segments for _, segments in some], least)
        alone = [test.shallow([D], [segments], [deep])[0] for (D, segments), deep in zip(some, least, strict=True)]
        assert shallow == alone
        assert not any(known and depth > deep for known, depth, deep in zip(shallow, depths, least, strict=True))
        assert share > 1.0 or not any(shallow)


def test_states_told_together_are_as_deep_as_each_alone():
    test = pair_of(wall=box(0, 10, -20, 20, -20, 20), block=box(-30, -1, -5, 5, -5, 5))
    poses = [slid(1.0 + deep) for deep in (-0.5, 0.005, 0.02, 0.06, 0.3, 2.0)]
    for least in (None, 1e-4):
        together = [State(test, D, True) for D in poses]
        State.cross(together, least)
        alone = [State(test, D, False) for D in poses]
        allowed = [state.crossing.slack if least is None else least for state in alone]
        deeper = [state.deeper(deep) for state, deep in zip(together, allowed, strict=True)]
        assert deeper == [state.deeper(deep) for state, deep in zip(alone, allowed, strict=True)]
        assert set(deeper) == {False, True}
