"""Threads give screw joints with pitch and hand, and where no pitch can be read, nothing certain."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from generators.threads import Thread, threaded
from manifold3d import Manifold
from random_assemblies import case
from random_assemblies.verdict import judge
from support.assemblies import assembly
from support.diagonal import first as first_of
from support.diagonal import first_rows
from support.solids import box, derived, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics


def pair(lead=4.0, starts=1, lean=15.0, gap=0.1, crest=10.0, depth=None, half=8.0, segments=(24, 20)):
    """A nut and its screw (mm) whose crests, roots and flanks stand off by the gap."""
    root = crest - (abs(lead) / starts / 2 if depth is None else depth)
    slope = math.radians(lean)
    play = 2 * gap * (1 - math.sin(slope)) / math.cos(slope)
    hollow = Thread(root + gap, crest + gap, lead, starts, lean, play)
    nut = Manifold.cylinder(2 * half, 1.7 * crest, 1.7 * crest, 6, True)
    nut -= threaded(hollow, -half - 1.0, half + 1.0, segments[1], 7.0).manifold
    return nut, threaded(Thread(root, crest, lead, starts, lean), -half - 6.0, half + 3.0, segments[0]).manifold


def the_screw(joints, X, lead, scale=1e-3):
    (joint,) = joints
    assert (joint.type, joint.status) == ("screw", "determined")
    assert joint.pitch == pytest.approx(scale * lead, rel=1e-3)
    assert np.linalg.norm(np.cross(joint.axis, X[:3, 2])) < 1e-6
    assert np.linalg.norm(np.cross(joint.point - X[:3, 3], X[:3, 2])) < 1e-2 * scale
    return joint


@pytest.mark.parametrize(
    "thread",
    first_of(2, [
        {"lead": 1.0, "half": 3.0}, {"lead": -12.0, "starts": 3}, {"lean": 0.0},
        {"lead": 1.5, "crest": 5.0, "depth": 0.9, "lean": 30.0, "half": 4.0},
        {"lead": -4.0}, {"lead": 10.0}, {"lead": 8.0, "starts": 2},
    ]),
    ids=str,
)  # fmt: skip
def test_a_thread_in_its_nut_is_a_screw_joint(thread):
    X = random_pose(np.random.default_rng(11))
    nut, screw = pair(**thread)
    kinematics, _ = derived(X, nut=nut, screw=screw)
    joint = the_screw(kinematics.joints, X, thread.get("lead", 4.0))
    assert "helicoid" in joint.evidence
    assert kinematics.mobility.instantaneous == 1


@pytest.mark.parametrize("gap", first_of(2, [0.48, -0.2, 0.0, 0.02, 0.3, -0.05]))
def test_clearances_and_overlaps_of_threads_are_screw_joints_too(gap):
    X = random_pose(np.random.default_rng(5))
    nut, screw = pair(gap=gap)
    the_screw(derived(X, nut=nut, screw=screw)[0].joints, X, 4.0)


FACETS = [(8, 9), (12, 16), (16, 12), (64, 24)]
DAILY = [((8, 9), 1e-4), ((16, 12), 1e-1)]


@pytest.mark.parametrize(
    ("segments", "scale"),
    first_rows(2, sorted(product(FACETS, [1e-4, 1e-1]), key=lambda row: row not in DAILY)),
)
def test_neither_tessellation_nor_size_matters(segments, scale):
    X = random_pose(np.random.default_rng(6), reach=100 * scale)
    nut, screw = pair(gap=0.05, segments=segments)
    the_screw(derived(X, scale, nut=nut, screw=screw)[0].joints, X, 4.0, scale)


def test_a_screw_off_the_middle_of_its_play_is_a_screw_joint():
    X = random_pose(np.random.default_rng(8))
    nut, screw = pair()
    (joint,) = derived(X, nut=nut, screw=screw.translate((0.08, 0, 0)))[0].joints
    assert (joint.type, joint.status) == ("screw", "determined")
    assert joint.pitch == pytest.approx(4e-3, rel=1e-3)


def test_the_order_of_names_does_not_change_hand_or_pitch():
    X = random_pose(np.random.default_rng(9))
    nut, screw = pair(lead=-4.0)
    for names in (("a", "b"), ("b", "a")):
        the_screw(derived(X, **dict(zip(names, (nut, screw), strict=True)))[0].joints, X, -4.0)


def test_a_screw_whose_head_lies_on_the_nut_does_not_move():
    nut, screw = pair(gap=0.05)
    head = rod(16.0, 8.0, 14.0)
    kinematics, _ = derived(random_pose(np.random.default_rng(1)), nut=nut, screw=screw + head)
    assert not any(
        j.type in ("screw", "revolute", "cylindrical") and j.status == "determined" for j in kinematics.joints
    )


def test_a_nut_held_between_rails_makes_a_slide_of_the_screw():
    """Lead screw with thrust collars in a frame, nut between two cheeks: one freedom, and it couples turn and slide."""
    screw = threaded(Thread(8.0, 10.0, 4.0), -30.0, 30.0, 24).manifold
    screw += rod(6.0, -50.0, -29.9) + rod(6.0, 29.9, 50.0) + rod(9.0, -44.0, -40.0) + rod(9.0, 40.0, 44.0)
    hollow = Thread(8.05, 10.05, 4.0, 1, 15.0, 0.1 * (1 - math.sin(math.radians(15.0))) / math.cos(math.radians(15.0)))
    nut = box(-15, 15, -15, 15, -8, 8) - threaded(hollow, -9.0, 9.0, 20, 7.0).manifold
    ends = [box(-20, 20, -20, 20, z, z + 6) - rod(6.02, z - 1, z + 7, 36, 3.0) for z in (-40.0, 34.0)]
    cheeks = [box(15, 20, -20, 20, -34.5, 34.5), box(-20, -15, -20, 20, -34.5, 34.5)]
    frame = ends[0] + ends[1]
    for cheek in cheeks:
        frame += cheek
    X = random_pose(np.random.default_rng(12))
    kinematics, _ = derived(X, frame=frame, nut=nut, screw=screw)
    found = {j.name: (j.type, j.status) for j in kinematics.joints}
    assert found["nut~screw"] == ("screw", "determined")
    assert found["frame~screw"] == ("revolute", "determined")
    assert kinematics.mobility.instantaneous == 1
    (freedom,) = kinematics.mobility.freedoms
    rows = {body.name: freedom[k] for k, body in enumerate(kinematics.bodies)}
    base = next(j for j in kinematics.joints if j.name == "nut~screw")
    turn = (rows["screw"] - rows["frame"])[:3] @ base.axis
    slide = (rows["nut"] - rows["frame"])[3:] @ base.axis
    # the nut does not turn, so it goes back by a pitch for each turn of the screw
    assert slide / turn == pytest.approx(-4e-3 / (2 * np.pi), rel=1e-3)


def noisy(lead, segments, size):
    X = random_pose(np.random.default_rng(1))
    rng = np.random.default_rng(3)
    parts = []
    for name, solid in zip(("nut", "screw"), pair(lead=lead, segments=segments), strict=True):
        exact = part(name, solid, X)
        scattered = exact.mesh.vertices + size * rng.normal(size=exact.mesh.vertices.shape)
        parts.append(replace(exact, mesh=replace(exact.mesh, vertices=scattered)))
    made = assembly(*parts)
    found, near = touching_of(made)
    return kinematics.derive(made, found, near)


@pytest.mark.parametrize("size", first_of(1, [1e-5, 1e-6]))
def test_a_little_scatter_leaves_the_pitch(size):
    (joint,) = noisy(4.0, (24, 20), size).joints
    assert (joint.type, joint.status) == ("screw", "determined")
    assert joint.pitch == pytest.approx(4e-3, rel=1e-3)


@pytest.mark.parametrize(("lead", "size"), first_rows(1, [(4.0, 2e-5), (2.0, 1e-4), (4.0, 1e-4), (2.0, 2e-5)]))
def test_a_thread_that_scatters_too_much_is_nothing_certain(lead, size):
    result = noisy(lead, (24, 20), size)
    (joint,) = result.joints
    assert len(result.bodies) == 2
    right = joint.type == "screw" and joint.pitch == pytest.approx(1e-3 * lead, rel=0.02)
    assert right or joint.status != "determined"


@pytest.mark.parametrize("seed", first_of(1, [25, 24]))
def test_random_threads_give_their_truth(seed, tmp_path):
    from kinform import form

    made = case(seed, "screw", "thread")
    loaded = form.load(made.write(tmp_path))
    found, near = touching_of(loaded)
    verdict = judge(made, kinematics.derive(loaded, found, near))
    assert (verdict.outcome, verdict.why) == ("right", "")
