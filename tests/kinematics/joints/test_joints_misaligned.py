"""How far the axes of two sides are from each other, beyond what lets them lie on each other."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import diagonal
from support.solids import box, derived, extrusion, random_pose, rod


def oval(long, short, sides):
    turn = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    return np.stack([long * np.cos(turn), short * np.sin(turn)], axis=1)


@diagonal(2, long=[12.12, 13.2, 12.3], sides=[48, 96, 256])
def test_an_oval_peg_fills_its_hole_though_arcs_of_other_radii_meet(long, sides):
    """Its pieces are cut elsewhere on either side, so that arcs touch from within, whose centres differ. Where they are
    cut hangs on the attitude, and one in thirty leaves so little on either side that it is in doubt."""
    outline = oval(long, 12.0, sides)
    hole = box(-30, 30, -30, 30, 0, 10) - extrusion(outline, -20, 40)
    answers = []
    for seed in range(3):
        pose = random_pose(np.random.default_rng(sides + seed))
        kinematics, _ = derived(pose, a=hole, b=extrusion(outline, -10, 30))
        answers += [(joint.type, joint.status) for joint in kinematics.joints]
        assert kinematics.misaligned == ()
    assert [kind for kind, _ in answers] == ["prismatic"] * 3
    assert answers.count(("prismatic", "determined")) >= 2


@pytest.mark.parametrize("aside", [0.1, 0.2])
def test_bores_that_are_not_on_one_line_are_told_by_how_far(aside):
    wall = box(-20, 20, -20, 20, 0, 10)
    first, second = wall - rod(6, -1, 11, 96), (wall - rod(6, -1, 11, 96)).translate((0, aside, 60))
    body = first + second + box(-20, 20, -20, -15, 0, 70)
    kinematics, _ = derived(np.eye(4), a=body, b=rod(6, -10, 80, 96))
    ((_, _, offset),) = kinematics.misaligned
    assert offset == pytest.approx(aside * 1e-3, rel=0.1)
