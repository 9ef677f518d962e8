"""Assemblies far from the origin of the world, placed there by their poses: the same answers as at the origin.

At 1e8 m doubles are 1.5e-8 m apart: of a mechanism of a tenth of a metre that leaves six digits.
"""

from __future__ import annotations

import numpy as np
import pytest
from support.copies import Change, answers, checked, copy_of, derived, turned
from support.places import FIXTURES

from kinform.mechanism.first_order import close

DESIGNS = {
    "revolute_collars": "pairs",
    "four_bar": "mechanisms",
    "roberval_balance": "mechanisms",
    "rack_and_pinion": "mechanisms",
    "elbow_in_groups": "wild",
    "general_ball_on_table": "pairs",
}
COUNTS = ("instantaneous", "finite", "effective", "idle", "redundant", "blocked", "on_edge", "singular")


OFTEN = {("revolute_collars", 1e4), ("four_bar", 1e8), ("rack_and_pinion", 1e7), ("elbow_in_groups", 1e6)}
CASES = [
    pytest.param(name, far, marks=() if (name, far) in OFTEN else pytest.mark.sweep)
    for name in DESIGNS
    for far in (1e4, 1e6, 1e7, 1e8)
]


def derivation(name, folder, change):
    copy = copy_of(FIXTURES / DESIGNS[name] / name / f"{name}.toml", folder, change)
    design = derived(copy.path)
    kinematics = design.kinematics
    counts = {key: getattr(kinematics.mobility, key) for key in COUNTS}
    freedoms = [(f.driver, f.kind, f.idle, f.looped, len(f.drives)) for f in kinematics.mobility.named]
    parts = [(apart.bodies, apart.contacts, len(apart.releases)) for apart in kinematics.separations]
    held = [(r.kind, r.rows) for r in kinematics.mobility.redundancies]
    return answers(design, copy.originals) | counts | {"freedoms": freedoms, "parts": parts, "held": held}, kinematics


@pytest.mark.parametrize(("name", "far"), CASES)
def test_what_is_far_away_moves_as_it_does_here(name, far, tmp_path):
    here, kinematics = derivation(name, tmp_path / "here", Change())
    offset = (far, -0.75 * far, 0.5 * far)
    there, moved = derivation(name, tmp_path / "there", Change(offset=offset))
    assert there == here
    ratios = {coupling.joints: coupling.ratio for coupling in kinematics.couplings}
    rounding = 1e-14 * far / 0.05
    for coupling in moved.couplings:
        assert coupling.ratio == pytest.approx(ratios[coupling.joints], rel=max(rounding, 1e-9))


def hinge(point, axis=(0.0, 0.0, 1.0)):
    return np.concatenate([axis, np.cross(point, axis)])[None]


def slide(direction):
    return np.concatenate([np.zeros(3), direction])[None]


@pytest.mark.parametrize("far", [0.0, 1e4, 1e6, 1e8, 1e10])
def test_closed_loops_count_as_the_formula_says(far):
    """Of a planar loop of n joints n − 3 rates are left; a hinge and two slides of a plane close to nothing, and so do
    the three hinges of a triangle. Coordinates are whole, so that they are exact wherever the loop is."""
    away = far * turned(3)[0].round()
    squares = [away + point for point in ((0, 0, 0), (0, 64, 0), (96, 64, 0), (96, 0, 0))]
    loop = [(0, 1), (1, 2), (2, 3), (0, 3)]
    assert close(4, loop, [hinge(p) for p in squares], 0, 100.0).mobility == 1
    triangle = [(0, 1), (1, 2), (0, 2)]
    assert close(3, triangle, [hinge(p) for p in squares[:3]], 0, 100.0).mobility == 0
    assert close(3, triangle, [hinge(away), slide((1.0, 0, 0)), slide((0, 1.0, 0))], 0, 100.0).mobility == 0
    assert (
        close(4, loop, [hinge(away), hinge(squares[1]), slide((1.0, 0, 0)), slide((0, 1.0, 0))], 0, 1.0).mobility == 1
    )


def test_a_ball_that_is_very_far_away_turns_as_it_does_here(tmp_path):
    _, kinematics = derivation("general_ball_on_table", tmp_path, Change(offset=(1e10, -0.75e10, 0.5e10)))
    assert [freedom.kind for freedom in kinematics.mobility.named] == ["turn"] * 3 + ["slide"] * 2


@pytest.mark.parametrize("name", ["revolute_collars", "rack_and_pinion"])
def test_where_the_numbers_of_a_place_are_too_coarse_nothing_is_certain(name, tmp_path):
    """At 1e15 m doubles are 0.125 m apart, and the parts are less across."""
    change = Change(offset=(1e14, -7.5e14, 5e14))
    copy = copy_of(FIXTURES / DESIGNS[name] / name / f"{name}.toml", tmp_path, change)
    design = checked(copy.path)
    parts = {part.name for part in design.assembly.parts}
    assert design.assembly.lost == parts
    assert all(joint.status == "ambiguous" for joint in design.kinematics.joints)
    told = [f for f in design.report.findings if f.code == "KF111"]
    assert {part for finding in told for part in finding.subject} == parts
