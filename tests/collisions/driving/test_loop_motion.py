"""A screw jack goes on for many turns: until a collar meets the base, or the table leaves its post."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.diagonal import first
from support.slots import derived
from support.solids import box, random_pose, rod

from kinform import collisions


def jack():
    """A spindle in a base that carries a table, which a square post keeps from turning. Its collar is 30 above the
    base, the table 50 below the end of the post."""
    post = box(36, 52, -8, 8, -1, 90)
    return {
        "base": box(-30, 60, -20, 20, -20, 0) - rod(5, -30, 10, 24) + post,
        "spindle": rod(5, -90, 53, 24) + rod(8, 30, 40, 24) + rod(8, 50, 53, 24),
        "table": box(-20, 60, -20, 20, 40, 50) - rod(5, 30, 60, 24) - box(36, 52, -8, 8, 30, 60),
    }


def threaded(kin, pitch, bodies=frozenset({"base", "spindle"})):
    """With a thread (m a turn) where two bodies slide along each other as they like."""
    (joint,) = (j for j in kin.joints if set(j.bodies) == bodies)
    assert joint.type == "cylindrical"
    axis, point = joint.axis, joint.point
    twist = np.concatenate([axis, np.cross(point, axis) + pitch / (2.0 * np.pi) * axis])
    screw = replace(joint, type="screw", pitch=pitch, twists=twist[None])
    joints = tuple(screw if j is joint else j for j in kin.joints)
    # the spindle, which could spin by itself, no longer can
    return replace(kin, joints=joints, mobility=replace(kin.mobility, named=()))


@pytest.mark.parametrize(("pitch", "seed"), [pytest.param(2e-3, None, marks=pytest.mark.sweep), (-2e-3, 3)])
def test_a_jack_goes_from_its_collar_to_the_end_of_its_post(pitch, seed):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    made, known, touching, kin = derived(jack(), X, ground="base")
    kin = threaded(kin, pitch)
    items = {item.joint: item for item in collisions.ranges(made, known, touching, kin)}
    lift = next(j for j in kin.joints if set(j.bodies) == {"base", "table"})
    up = float(lift.axis @ X[:3, 2]) * (1 if lift.bodies[1] == "table" else -1)
    item = items[lift.name]
    down, top = (item.lower, item.upper) if up > 0 else (item.upper, item.lower)
    assert down.status == "found"
    assert abs(down.value) == pytest.approx(0.030, abs=1e-6)
    assert down.parts == ("base", "spindle")
    assert top.status == "unbounded"
    assert abs(top.leaves) == pytest.approx(0.050, abs=1e-6)
    turned = items[next(j.name for j in kin.joints if j.type == "screw")]
    found = [end.value for end in (turned.lower, turned.upper) if end.status == "found"]
    assert [abs(value) for value in found] == pytest.approx([2.0 * np.pi * 0.030 / abs(pitch)], rel=1e-5)


@pytest.mark.parametrize("pitch", first(1, [1e-3, 2e-4]))
def test_the_head_of_a_fine_screw_stops_on_its_plate(pitch):
    solids = {
        "plate": box(-20, 20, -20, 20, -10, 0) - rod(5, -20, 10, 24),
        "screw": rod(5, -12, 10, 24) + rod(8, 2, 6, 24),
    }
    made, known, touching, kin = derived(solids, ground="plate")
    kin = threaded(kin, pitch, {"plate", "screw"})
    (item,) = collisions.ranges(made, known, touching, kin)
    stops = [end for end in (item.lower, item.upper) if end.status == "found"]
    assert [abs(end.value) for end in stops] == pytest.approx([2.0 * np.pi * 0.002 / pitch], rel=1e-4)
    assert stops[0].parts == ("plate", "screw")
    # the other way round it leaves its bore
    (free,) = (end for end in (item.lower, item.upper) if end.status != "found")
    assert free.status == "unbounded"
    assert abs(free.leaves) == pytest.approx(2.0 * np.pi * 0.012 / pitch, rel=1e-4)
