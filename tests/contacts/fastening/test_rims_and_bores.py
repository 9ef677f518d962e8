"""Where the evidence is read, and where it must not be: rims, bolt circles, holes on several planes, dowels."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold
from support.solids import box, random_pose, rod
from support.suggestions import CORNERS, drilled, found


def turned(profile, segments=72):
    """A solid of revolution about z, of (radius, height) corners, counter-clockwise."""
    return Manifold.revolve(CrossSection([np.array(profile, float)]), segments)


def spread(count, radius, phase=0.0):
    angles = np.radians(phase) + 2 * np.pi * np.arange(count) / count
    return [(radius * np.cos(a), radius * np.sin(a)) for a in angles]


def plate(z0, z1, places, hole=1.5):
    solid = box(-25, 25, -25, 25, z0, z1)
    for x, y in places:
        solid -= rod(hole, z0 - 1, z1 + 1).translate((x, y, 0))
    return solid


def bracket_with_bore():
    return box(-20, 20, -20, 20, -5, 0) - rod(4, -6, 1, 48)


@pytest.mark.parametrize("X", [np.eye(4), random_pose(np.random.default_rng(8))])
def test_the_rim_of_a_chamfer_counts(X):
    horn = turned([(0, 1e-9), (10, 0), (12, 2), (12, 5), (0, 5)])
    hints, _ = found(X, horn=horn, bracket=bracket_with_bore())
    (hint,) = hints
    assert (hint.kind, hint.confidence) == ("rim", "low")
    assert hint.evidence == "coaxial rims of diameter 8 and 20 mm"
    assert np.linalg.norm(np.cross(hint.point - X[:3, 3], X[:3, 2])) < 1e-8


def test_a_round_boss_away_from_the_contact_is_no_rim():
    lever = box(-14, 14, -14, 14, 0, 4) + rod(12, 3, 9, 72)
    hints, _ = found(np.eye(4), lever=lever, bracket=bracket_with_bore())
    assert hints == ()


@pytest.mark.parametrize("places, expected", [([(9, 0), (-9, 0)], []), ([(9, 0)], ["rim"])])
def test_rims_on_two_axes_suggest_none_of_them(places, expected):
    table = box(-14, 14, -14, 14, 8, 12)
    for x, y in places:
        table += rod(7, 0, 9, 64).translate((x, y, 0))
    hints, _ = found(np.eye(4), table=table, floor=plate(-6, 0, places, 4.0))
    assert [hint.kind for hint in hints] == expected


def test_rims_that_miss_each_other_suggest_nothing():
    horn = (rod(12, 0, 4, 72) - rod(3, -1, 6, 48)).translate((0.6, 0, 0))
    assert found(np.eye(4), horn=horn, bracket=bracket_with_bore())[0] == ()


def test_half_a_rim_is_none():
    horn = rod(12, 0, 4, 72) ^ box(-20, 20, 0, 20, -1, 9)
    assert found(np.eye(4), horn=horn, bracket=bracket_with_bore())[0] == ()


def test_a_small_contact_gives_no_axis():
    foot = rod(2, 0, 6, 48) + box(-20, 20, -20, 20, 5, 10)
    hints, _ = found(np.eye(4), foot=foot, bracket=box(-20, 20, -20, 20, -5, 0) - rod(1, -6, 1, 48))
    assert hints == ()


def test_bolt_circles_about_one_centre_suggest_the_axis():
    X = random_pose(np.random.default_rng(5))
    solids = {"upper": plate(0, 4, spread(4, 12)), "lower": plate(-4, 0, spread(4, 12, 30), 1.0)}
    hints, planar = found(X, **solids)
    assert [hint.evidence for hint in hints] == ["bolt circles of 4 and 4 holes about one centre"]
    assert [(joint.type, joint.status) for joint in planar.joints] == [("planar", "determined")]
    _, derived = found(X, infer=True, **solids)
    (joint,) = derived.joints
    assert (joint.type, joint.status) == ("revolute", "inferred")
    assert "bolt circle" in joint.evidence
    assert hints[0].confidence == "low"
    assert np.linalg.norm(np.cross(joint.point - X[:3, 3], X[:3, 2])) < 1e-8


def test_holes_that_are_not_evenly_spaced_are_no_bolt_circle():
    uneven = [(x * 12, y * 12) for x, y in ((0.8, 0.6), (-0.8, 0.6), (-0.8, -0.6), (0.8, -0.6))]
    hints, _ = found(np.eye(4), upper=plate(0, 4, uneven), lower=plate(-4, 0, spread(4, 12, 60), 1.0))
    assert hints == ()


def test_holes_count_on_any_plane_not_only_the_largest():
    ears = [(17.0, 0.0), (-17.0, 0.0)]
    body = box(-10, 10, -10, 10, -12, 0) + drilled(0, 3, ears)
    bracket = drilled(-4, 0, ears) - box(-10, 10, -16, 16, -20, 1)
    hints, _ = found(np.eye(4), body=body, bracket=bracket)
    assert [hint.evidence for hint in hints if hint.kind == "holes"] == ["2 aligned empty holes"]


def test_one_hole_through_two_walls_is_one_hole():
    fork = box(-10, 10, -10, 10, -12, 12) - box(-20, 20, -20, 20, -5, 5) + box(8, 12, -10, 10, -12, 12)
    fork -= rod(2, -20, 20, 48)
    hints, _ = found(np.eye(4), fork=fork, eye=box(-12, 7, -6, 6, -5, 5) - rod(2, -9, 9, 48))
    assert "holes" not in [hint.kind for hint in hints]


def test_holes_beside_two_dowels_are_a_fastening():
    dowels = [(0.0, 8.0), (0.0, -8.0)]
    lower, upper = drilled(-5, 0, CORNERS), drilled(0, 5, CORNERS)
    for x, y in dowels:
        lower += rod(2.5, -1, 4, 48).translate((x, y, 0))
        upper -= rod(2.5, -1, 6, 48).translate((x, y, 0))
    hints, _ = found(np.eye(4), lower=lower, upper=upper)
    assert [hint.evidence for hint in hints if hint.kind == "holes"] == ["4 aligned empty holes"]


def test_blind_holes_that_do_not_reach_the_plane_do_not_count():
    lower = drilled(-12, 0, []) - sum((rod(2, -13, -6, 48).translate((x, y, 0)) for x, y in CORNERS), Manifold())
    hints, _ = found(np.eye(4), upper=drilled(0, 5, CORNERS), lower=lower)
    assert "holes" not in [hint.kind for hint in hints]


def test_a_part_between_floor_and_walls_that_leave_a_way_aside_is_in_no_pocket():
    body = box(-10, 10, -6, 6, 0, 20)
    open_ = box(-14, 24, -10, 10, -4, 12) - box(-10, 30, -6, 6, 0, 30)
    assert "pocket" not in [hint.kind for hint in found(np.eye(4), servo=body, bracket=open_)[0]]


def test_a_part_that_goes_right_through_is_in_no_pocket():
    body = box(-10, 10, -6, 6, -20, 20)
    sleeve = box(-14, 14, -10, 10, -8, 8) - box(-10, 10, -6, 6, -30, 30)
    assert "pocket" not in [hint.kind for hint in found(np.eye(4), slider=body, sleeve=sleeve)[0]]


def test_what_parts_are_called_changes_no_suggestion():
    solids = (drilled(0, 5, CORNERS, 2.2), drilled(-5, 0, CORNERS, 1.6), box(-3, 3, -3, 3, 5, 9))
    one, _ = found(np.eye(4), a=solids[0], b=solids[1], c=solids[2])
    two, _ = found(np.eye(4), b=solids[0], a=solids[1], c=solids[2])
    assert [(h.kind, h.evidence) for h in one] == [(h.kind, h.evidence) for h in two]
    assert np.allclose(one[0].point, two[0].point, atol=1e-12)
    assert np.allclose(one[0].axis, two[0].axis, atol=1e-12)
