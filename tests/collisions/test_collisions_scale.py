"""An assembly and its copy a thousand times smaller or larger stop at the same places: equal times, scaled lengths."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import diagonal
from support.slots import block_in_slot, derived, moved
from support.solids import box, rod

from kinform import collisions
from kinform.function.clearances import apart

SCALES = [1e-6, 1e-3, 1e-2, 1.0]


@diagonal(scale=SCALES, gap=[0.0, 0.05])
def test_a_block_stops_at_the_same_share_of_its_slot(gap, scale):
    made, known, touching, kin = derived(block_in_slot(gap), None, "lever", scale, 0.5)
    assert [joint.type for joint in kin.joints] == ["prismatic"]
    (item,) = collisions.ranges(made, known, touching, kin)
    found = sorted(abs(end.value) / scale for end in (item.lower, item.upper))
    assert found == pytest.approx([18.0, 28.0], abs=1e-3)


@diagonal(scale=SCALES, gap=[0.0, 0.05])
def test_a_block_meets_the_end_at_the_same_time_and_in_proportion_as_deep(gap, scale):
    made, known, touching, kin = derived(block_in_slot(gap), None, "lever", scale, 0.5)
    run = moved(kin, scale * np.array([0.0, 10.0, 30.0, 20.0]), np.eye(4))
    (met,), untested = collisions.along(made, known, touching, kin, run)
    assert not untested
    assert met.time == pytest.approx(1.4, abs=2e-4)
    assert met.depth / scale == pytest.approx(8.0, abs=0.5)
    assert met.place[0] / scale == pytest.approx(30.0, abs=0.01)


def peg_at_the_end_of_its_slot():
    """A peg of radius 6 that slides on a plate, in a slot that it meets after 20."""
    plate = box(-60, 60, -20, 20, 0, 8) - box(-40, 26, -9, 9, -1, 9)
    return {"plate": plate, "peg": rod(6, -5, 14, 48) + box(-12, 12, -12, 12, 8, 12)}


@pytest.mark.parametrize("scale", SCALES)
def test_a_shallow_and_short_collision_is_found_at_every_size(scale):
    made, known, touching, kin = derived(peg_at_the_end_of_its_slot(), None, "plate", scale)
    run = moved(kin, scale * np.concatenate([np.linspace(0, 21, 6), np.linspace(20, -20, 60)]), np.eye(4), "peg")
    (met,), untested = collisions.along(made, known, touching, kin, run)
    assert not untested
    assert met.time == pytest.approx(20 / 4.2, abs=1e-3)
    assert met.depth / scale == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("scale", SCALES)
def test_an_overlap_is_as_deep_and_a_gap_as_wide_in_proportion(scale):
    solids = {"a": box(0, 40, 0, 40, 0, 10), "b": box(10, 30, 10, 30, 8, 20), "c": box(0, 40, 0, 40, 25, 30)}
    made, known, touching, _ = derived(solids, scale=scale)
    assert [(i.parts, pytest.approx(2.0, abs=1e-3)) for i in touching.interferences] == [
        (i.parts, i.depth / scale) for i in touching.interferences if i.parts == ("a", "b")
    ]
    assert touching.interferences
    groups = apart(made, touching, known, ["b"], ["c"])
    assert groups.at(np.eye(4)).distance / scale == pytest.approx(5.0, abs=1e-9)
