"""Labels by eliminating nodes: the cheapest of all, where no others come near."""

from __future__ import annotations

from itertools import product

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinform.kinematics.partition.elimination import CLEARLY_LESS, clear_labels


def costs_of(own, pairs, wide):
    """Of all labels of all nodes, the cheapest first."""
    ways = product(range(wide), repeat=len(own))
    total = [
        (
            sum(row[k] for row, k in zip(own, way, strict=True))
            + sum(t[way[a], way[b]] for (a, b), t in pairs.items()),
            way,
        )
        for way in ways
    ]
    return sorted(total)


@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(2, 3), st.booleans())
@settings(max_examples=150, deadline=None)
def test_clear_labels_are_the_cheapest_and_no_others_come_near(seed, nodes, wide, whole):
    """Whole costs are often as good for several labels: nothing is said then."""
    draw = np.random.default_rng(seed)

    def number(*shape):
        return draw.integers(0, 4, shape).astype(float) if whole else draw.random(shape)

    own = number(nodes, wide)
    pairs = {(a, b): number(wide, wide) for a in range(nodes) for b in range(a + 1, nodes) if draw.random() < 0.6}
    (least, labels), (second, _), *_ = costs_of(own, pairs, wide)
    found = clear_labels(own, pairs)
    clearly = second - least > CLEARLY_LESS
    assert found == (list(labels) if clearly else None)


def test_nodes_that_all_touch_are_left_to_the_integer_program():
    nodes, wide = 9, 8
    pairs = {(a, b): 1.0 - np.eye(wide) for a in range(nodes) for b in range(a + 1, nodes)}
    own = np.arange(nodes * wide, dtype=float).reshape(nodes, wide)
    assert clear_labels(own, pairs) is None
    assert clear_labels(own, {ends: cost for ends, cost in pairs.items() if ends[0] == 0}) == [0] * nodes
