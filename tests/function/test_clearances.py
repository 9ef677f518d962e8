"""The least distance of parts that mate: their mates do not count against each other, all else does."""

from __future__ import annotations

import numpy as np
import pytest
from support.slots import derived
from support.solids import box

from kinform.function.clearances import apart


def block_over_a_shelf():
    """A block on a rail that ends at 30; beyond, a shelf lies 0.8 lower."""
    return {"rail": box(-40, 30, -10, 10, -10, 0) + box(29, 80, -10, 10, -10, -0.8), "block": box(0, 20, -5, 5, 0, 8)}


@pytest.mark.parametrize("scale", [1e-3, 1.0])
def test_a_mating_face_counts_against_what_it_does_not_mate_with(scale):
    made, known, touching, _ = derived(block_over_a_shelf(), scale=scale, contact=0.5)
    groups = apart(made, touching, known, ["rail"], ["block"])
    assert groups.left_out == (("rail", "block"),)
    X = np.eye(4)
    X[0, 3] = 45.0 * scale
    found = groups.at(X)
    assert found.distance / scale == pytest.approx(0.8, abs=1e-6)
    X[0, 3] = -15.0 * scale
    # all that is nearer than the sides of the rail, 5 beside the block, is where they mate
    assert groups.at(X).distance / scale == pytest.approx(5.0, abs=1e-6)


def test_parts_that_do_not_mate_leave_nothing_out():
    made, known, touching, _ = derived({"a": box(0, 10, 0, 10, 0, 10), "b": box(0, 10, 0, 10, 15, 20)})
    groups = apart(made, touching, known, ["a"], ["b"])
    assert groups.left_out == ()
    assert groups.at(np.eye(4)).distance == pytest.approx(0.005)
