"""What rubs in joints of meshes, against the numbers that the fixtures were made from."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.places import FIXTURES

from kinform.behaviour.sliding import sliding_joints
from kinform.model.function import Drive


def _sliding(derive, name):
    design = derive(FIXTURES / "pairs" / name / f"{name}.toml")
    friction = Drive("any", "friction", None, {}, 1.0, "", 1)
    assembly = replace(design.assembly, function=replace(design.assembly.function, drives=(friction,)))
    (found,) = sliding_joints(assembly, design.kinematics, design.contacts, design.surfaces).values()
    return found


@pytest.mark.parametrize("name", ["screw_right", "screw_left_double"])
def test_a_trapezoidal_thread_has_its_mean_radius_and_its_flanks(derive_design, name):
    rubs = _sliding(derive_design, name).rubs
    assert abs(rubs.radius - 9e-3) < 0.1e-3  # between 8 and 10 mm, with play
    assert abs(math.degrees(rubs.flank) - 15.0) < 0.01


def test_a_journal_with_collars_has_its_radius_its_ends_and_its_rings(derive_design):
    found = _sliding(derive_design, "revolute_collars")
    assert not found.open and found.pairs == (("aluminium", "steel"),)
    assert found.coefficients() == (0.47, 0.61)
    rubs = found.rubs
    assert abs(rubs.radius - 10.025e-3) < 1e-6
    np.testing.assert_allclose((rubs.lower, rubs.upper), (-0.015, 0.015), atol=1e-9)
    assert rubs.radius < rubs.thrust < 1.5 * rubs.radius


def test_a_drawer_has_two_pairs_of_faces_at_right_angles(derive_design):
    rubs = _sliding(derive_design, "prismatic_drawer").rubs
    first, second = rubs.faces
    assert abs(first @ second) < 1e-9
    np.testing.assert_allclose((rubs.lower, rubs.upper), (-0.03, 0.03), atol=1e-9)


@pytest.mark.parametrize(
    ("name", "kind", "key"),
    [
        ("prismatic_dovetail", "prismatic", "length"),
        ("prismatic_two_dowels", "prismatic", "length"),
        ("revolute_cone", "revolute", "thrust_radius"),
    ],
)
def test_what_surfaces_share_in_unknown_ways_has_no_radius_but_a_reason(derive_design, name, kind, key):
    found = _sliding(derive_design, name)
    assert found.open
    of = (kind, "turn" if kind == "revolute" else "slide")
    with pytest.raises(ValueError, match=key):
        found.stated(Drive("any", "friction", None, {"coefficient": 0.1}, 1.0, "", 1), *of)
