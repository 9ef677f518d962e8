"""Parts whose faces are flush run into each other's ends without any facets that cross: a collision all the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.diagonal import diagonal
from support.slots import SLOT, block_in_slot, derived, moved
from support.solids import box, random_pose, rod

from kinform import collisions
from kinform.collisions import run_collisions


def loose_block_in_slot():
    lever = box(-60, 60, -20, 20, 0, 8) - box(*SLOT, -9, 9, -1, 9)
    return {"lever": lever, "block": box(-12, 12, -9, 9, 0, 8)}


def piston_in_cylinder(segments=48):
    cylinder = rod(14, -45, 5, segments) - rod(10, -40, 6, segments)
    return {"cylinder": cylinder, "piston": rod(10, -20, 5, segments)}


def tenon_in_mortise():
    post = box(-20, 20, -20, 20, -40, 0) - box(-8, 8, -5, 5, -30, 1)
    return {"post": post, "rail": box(-8, 8, -5, 5, -12, 10)}


def narrowing_slot():
    lever = box(-60, 60, -20, 20, 0, 8) - box(-70, 29, -9, 9, -1, 9) - box(28, 70, -9, 7.5, -1, 9)
    lever -= box(-70, 70, -11, 0, 3, 5)
    return {"lever": lever, "block": box(-12, 12, -9, 9, 0, 8) + box(-12, 12, -11, 0, 3, 5)}


def ends(solids, along, X=None):
    """How far (m) the part named second goes along the world direction `along`: lower, upper."""
    X = np.eye(4) if X is None else X
    made, known, touching, kin = derived(solids, X)
    (joint,) = kin.joints
    assert joint.type in ("prismatic", "cylindrical")
    if joint.type == "cylindrical":
        kin = replace(
            kin, joints=(replace(joint, type="prismatic", twists=joint.twists[joint.twists[:, :3].any(1) == 0]),)
        )
    (item,) = collisions.ranges(made, known, touching, kin)
    sign = float(joint.axis @ (X[:3, :3] @ along)) * (1 if joint.bodies[1] == list(solids)[1] else -1)
    lower, upper = (item.lower, item.upper) if sign > 0 else (item.upper, item.lower)
    return tuple(None if e.status != "found" else round(np.sign(sign) * e.value, 12) for e in (lower, upper))


x, z = np.eye(3)[[0, 2]]


def finer(solid, times=2):
    return solid.refine(times)


@diagonal(seed=[None, 1, 4], gap=[0.0, 0.05])
def test_a_block_goes_to_the_ends_of_its_slot(seed, gap):
    X = None if seed is None else random_pose(np.random.default_rng(seed))
    assert ends(block_in_slot(gap), x, X) == pytest.approx((-0.028, 0.018), abs=1e-6)


@pytest.mark.parametrize("times", [2, 5])
def test_smaller_facets_change_nothing(times):
    solids = {name: finer(solid, times) for name, solid in block_in_slot().items()}
    assert ends(solids, x) == pytest.approx((-0.028, 0.018), abs=1e-6)


@diagonal(segments=[24, 48], seed=[None, 2])
def test_a_piston_stops_at_the_bottom(segments, seed):
    X = None if seed is None else random_pose(np.random.default_rng(seed))
    lower, upper = ends(piston_in_cylinder(segments), z, X)
    assert (lower, upper) == (pytest.approx(-0.020, abs=1e-6), None)


@pytest.mark.parametrize("seed", [None, 2])
def test_a_tenon_stops_at_the_bottom_of_its_mortise(seed):
    X = None if seed is None else random_pose(np.random.default_rng(seed))
    lower, upper = ends(tenon_in_mortise(), z, X)
    assert (lower, upper) == (pytest.approx(-0.018, abs=1e-6), None)


def test_a_narrow_step_stops_a_flush_block():
    lower, upper = ends(narrowing_slot(), x)
    assert (lower, upper) == (None, pytest.approx(0.017, abs=1e-6))


@diagonal(seed=[None, 5], solids=[block_in_slot, loose_block_in_slot])
def test_the_time_of_the_collision_is_when_the_ends_meet(seed, solids):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    made, known, touching, kin = derived(solids(), X, ground="lever")
    (met,), untested = collisions.along(made, known, touching, kin, moved(kin, [0, 0.010, 0.030, 0.020], X))
    assert met.parts == ("block", "lever") and not untested
    assert met.time == pytest.approx(1.4, abs=2e-4)
    assert met.depth == pytest.approx(0.008, abs=5e-4)  # the lever is 8 mm thick
    place = np.linalg.inv(X) @ np.append(met.place, 1.0)
    assert place[0] == pytest.approx(0.030, abs=1e-5)
    assert abs(place[1]) < 0.009 and 0.0 < place[2] < 0.008
    assert collisions.along(made, known, touching, kin, moved(kin, [0, 0.017, -0.027, 0.0], X)) == ((), ())


def test_what_is_passed_between_two_outputs_has_a_depth():
    rail = box(-30, 120, -8, 8, -6, 0) + box(30, 34, -8, 8, -1, 10)
    made, known, touching, kin = derived({"rail": rail, "block": box(-10, 10, -5, 5, 0, 8)}, ground="rail")
    run = moved(kin, [0.0, 0.080], np.eye(4))
    ((met,), _) = collisions.along(made, known, touching, kin, run)
    assert met.time == pytest.approx(20 / 80, abs=1e-3)
    # in the middle of the wall, 2 mm from its faces and the less deep in the block
    assert 0.002 < met.depth < 0.012


def test_a_crossing_of_which_no_point_is_inside_is_not_known_to_be_a_collision(monkeypatch):
    """As far from the origin, where files round: links that slide flush along each other."""
    rail = box(-30, 120, -8, 8, -6, 0) + box(30, 34, -8, 8, -1, 10)
    made, known, touching, kin = derived({"rail": rail, "block": box(-10, 10, -5, 5, 0, 8)}, ground="rail")
    run = moved(kin, [0.0, 0.080], np.eye(4))
    monkeypatch.setattr(run_collisions, "_depth", lambda *asked: 0.0)
    met, ((first, second, _),) = collisions.along(made, known, touching, kin, run)
    assert (met, first, second) == ((), "block", "rail")
