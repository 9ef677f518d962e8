"""What is suggested, and what is not, on small assemblies in any pose; and what follows when it is asked for."""

from __future__ import annotations

import numpy as np
import pytest
from support.solids import box, random_pose, rod
from support.suggestions import CORNERS, drilled, found, kinds, made_of

from kinform.contacts import find
from kinform.surfaces import recover

POSES = [np.eye(4), random_pose(np.random.default_rng(3))]


@pytest.mark.parametrize("X", POSES)
def test_empty_holes_that_line_up_suggest_a_fastening(X):
    hints, derived = found(X, upper=drilled(0, 5, CORNERS, 2.2), lower=drilled(-5, 0, CORNERS, 1.6))
    assert kinds(hints) == [(("lower", "upper"), "holes")]
    assert hints[0].evidence == "4 aligned empty holes"
    assert np.allclose(np.abs(hints[0].axis @ X[:3, 2]), 1.0)
    assert [joint.type for joint in derived.joints] == ["planar"]


def test_holes_with_bolts_in_them_are_not_empty():
    bolts = {f"bolt{k}": rod(1.5, -6, 6).translate((x, y, 0)) for k, (x, y) in enumerate(CORNERS)}
    hints, _ = found(np.eye(4), upper=drilled(0, 5, CORNERS), lower=drilled(-5, 0, CORNERS), **bolts)
    assert (("lower", "upper"), "holes") not in kinds(hints)


def test_holes_that_do_not_line_up_suggest_nothing():
    aside = [(x + 1.5, y) for x, y in CORNERS]
    hints, _ = found(np.eye(4), upper=drilled(0, 5, CORNERS), lower=drilled(-5, 0, aside))
    assert "holes" not in [hint.kind for hint in hints]


def test_holes_beside_a_journal_suggest_nothing():
    lower = drilled(-5, 0, CORNERS) + rod(4, -5, 5)
    upper = drilled(0, 5, CORNERS) - rod(4, -1, 6)
    hints, derived = found(np.eye(4), upper=upper, lower=lower)
    assert "holes" not in [hint.kind for hint in hints]
    assert derived.joints[0].type in ("revolute", "cylindrical")


@pytest.mark.parametrize("X", POSES)
def test_a_pressed_pin_is_suggested_with_its_size(X):
    hints, _ = found(X, eye=box(-20, 20, -20, 20, -8, 8) - rod(5.0, -9, 9, 96), pin=rod(5.1, -12, 12, 96))
    assert [hint.evidence for hint in hints if hint.kind == "pressed"] == [
        "pressed together by 0.2 mm in diameter 10 mm"
    ]


@pytest.mark.parametrize("X", POSES)
def test_a_pocket_is_left_one_way(X):
    body = box(-10, 10, -6, 6, 0, 20)
    hints, _ = found(X, servo=body, bracket=box(-14, 14, -10, 10, -4, 12) - box(-10, 10, -6, 6, 0, 30))
    (hint,) = (hint for hint in hints if hint.kind == "pocket")
    assert np.allclose(np.abs(hint.axis @ X[:3, 2]), 1.0)


def test_a_shaft_in_a_blind_hole_is_no_pocket():
    hints, _ = found(np.eye(4), shaft=rod(5, 0, 30), block=box(-14, 14, -14, 14, -4, 12) - rod(5, 0, 30))
    assert "pocket" not in [hint.kind for hint in hints]


def horn_on_bracket():
    ring = rod(3, -1, 6)
    return {"horn": rod(12, 0, 4, 72) - ring, "bracket": box(-20, 20, -20, 20, -5, 0) - rod(4, -6, 1)}


def test_coaxial_rims_suggest_an_axis_and_the_joint_stays_planar():
    hints, derived = found(np.eye(4), **horn_on_bracket())
    assert kinds(hints) == [(("bracket", "horn"), "rim")]
    assert [(joint.type, joint.status) for joint in derived.joints] == [("planar", "determined")]


def test_inferring_turns_the_planar_joint_about_the_rims_and_labels_it():
    X = POSES[1]
    _, derived = found(X, infer=True, **horn_on_bracket())
    (joint,) = derived.joints
    assert (joint.type, joint.status) == ("revolute", "inferred")
    assert "rim" in joint.evidence
    assert np.allclose(np.abs(joint.axis @ X[:3, 2]), 1.0)
    offset = joint.point - X[:3, 3]
    assert np.linalg.norm(offset - (offset @ X[:3, 2]) * X[:3, 2]) < 1e-8


def test_inferring_makes_one_body_and_labels_the_joints_that_follow():
    lower = drilled(-5, 0, CORNERS) - rod(3, -4, 1, 48)
    pin = rod(3, -3.95, -0.05, 48)
    _, plain = found(np.eye(4), upper=drilled(0, 5, CORNERS), lower=lower, pin=pin)
    _, derived = found(np.eye(4), infer=True, upper=drilled(0, 5, CORNERS), lower=lower, pin=pin)
    assert len(plain.bodies) == 3
    assert sorted(body.parts for body in derived.bodies) == [("lower", "upper"), ("pin",)]
    (body,) = (body for body in derived.bodies if len(body.parts) == 2)
    assert body.merged == ("inferred: lower~upper: 4 aligned empty holes",)
    (joint,) = derived.joints
    assert joint.status == "inferred"
    assert "fasteners" in joint.evidence


def pinned(overlap, segments=96):
    return {"eye": box(-20, 20, -20, 20, -8, 8) - rod(5.0, -9, 9, segments), "pin": rod(5.0 + overlap, -12, 12, 96)}


def test_a_pin_that_nothing_could_press_in_is_no_press_fit():
    """0.74 mm on 4 mm stood in a public robot; here as much of 10 mm."""
    made = made_of(np.eye(4), **pinned(0.925 * 0.5))
    touching = find(made, {p.mesh.digest: recover(p.mesh, made.tolerances) for p in made.parts})
    (overlap,) = touching.interferences
    assert "pressed" not in [hint.kind for hint in touching.suggestions]
    assert not overlap.mated


def test_what_coarse_facets_leave_open_may_be_a_press_fit():
    """4 % of the radius: more than can be pressed, unless the hole is a 12-gon that may be as much larger."""
    assert "pressed" not in [hint.kind for hint in found(np.eye(4), **pinned(0.2))[0]]
    design = made_of(np.eye(4), **pinned(0.2, 12))
    touching = find(design, {p.mesh.digest: recover(p.mesh, design.tolerances) for p in design.parts})
    assert all(overlap.mated for overlap in touching.interferences)
