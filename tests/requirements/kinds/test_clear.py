"""Clearances over ranges and along motions."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from support.devices import intended, sine
from support.numbers import numbers
from support.places import FIXTURES
from support.requirements import ORIGIN, bar, requiring, state, thin_wall, wall

from kinform.consistency import check
from kinform.model.assembly import Group
from kinform.model.contacts import Interference
from kinform.model.function import Function
from kinform.simulation import simulate


def nearest(degrees):
    """Gap (m) between the corner of the bar and the wall."""
    a = math.radians(degrees)
    return 1e-3 * (30 - (2 * math.cos(a) + 40 * math.sin(a)))


def test_the_clearance_over_a_range():
    between = {"between": ["bar", "base"], "over": "ranges"}
    assert state(bar(wall()), "clear", distance=nearest(30) - 2e-5, **between)[0] == "met"
    assert state(bar(wall()), "clear", distance=nearest(30) + 2e-5, **between)[0] == "violated"
    assert state(bar(wall(), reach=60), "clear", distance=0.0, **between)[0] == "violated"
    assert state(bar(wall(), reach=40), "clear", distance=0.0, **between)[0] == "met"
    assert state(bar(wall(), reach=None), "clear", distance=0.0, **between)[0] == "undecided"


def test_the_clearance_along_a_motion_and_where_it_is_lost():
    swing = lambda amplitude: bar(wall(), law=sine(amplitude, 1.0), duration=1.0, step=0.05, level="kinematic")
    between = {"between": ["bar", "base"]}
    assert state(swing(30.0), "clear", distance=nearest(30) - 2e-5, **between)[0] == "met"
    found, finding = state(swing(30.0), "clear", distance=nearest(30) + 2e-5, **between)
    assert found == "violated"
    assert numbers(finding.found) == [pytest.approx(1e3 * nearest(30), abs=2e-2)]
    found, finding = state(swing(60.0), "clear", **between)
    assert found == "violated"
    assert finding.found == "collision"
    assert 0.02 < finding.place[0] < 0.045
    assert state(swing(60.0), "clear")[0] == "violated"


def test_parts_that_may_overlap_as_they_are_drawn_are_not_known_to_be_clear():
    """What may overlap is near, and counts no more than what touches does; what collides elsewhere is told."""
    asked = {"between": ["bar", "base"], "over": "ranges"}
    for reach, expected in ((40, "undecided"), (60, "violated")):
        made = bar(wall(), reach=reach)
        perhaps = (Interference(("bar", "base"), 1e-12, 1e-4, np.zeros(3), False, "manifold"),)
        made = replace(made, contacts=replace(made.contacts, possible_overlaps=perhaps))
        assert state(made, "clear", **asked)[0] == expected


def test_no_thin_wall_is_jumped_over():
    # samples 120° apart, on either side of a foil of 0.05 mm
    law = sine(60.0, 1.0, phase=-90.0)
    made = bar(thin_wall(), law=law, duration=0.5, step=0.5, level="kinematic")
    ends = np.degrees(made.simulation.joint_position[:, 0])
    assert np.allclose(np.abs(ends), 60.0)
    assert state(made, "clear", between=["bar", "base"])[0] == "violated"


def test_mating_surfaces_of_real_joints_are_no_collision(derive_design):
    for name in ("revolute_collars", "cylindrical_press_002", "prismatic_dovetail"):
        made = derive_design(FIXTURES / "pairs" / name / f"{name}.toml")
        first, second = (p.name for p in made.assembly.parts)
        (found,) = made.kinematics.joints
        stated = intended("j", *found.bodies, found.type, found.axis, found.point, range=(-0.003, 0.003))
        made = replace(made, assembly=replace(made.assembly, function=Function(joints=(stated,))))
        result = state(made, "clear", between=[first, second], over="ranges")
        assert result[0] == ("undecided" if found.freedoms > 1 else "met"), (name, result)


@pytest.mark.slow
def test_no_part_of_the_seeker_collides_and_a_twin_that_overlaps_does(derive_design):
    sound = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    assert state(sound, "clear", between=["base", "outer"])[0] == "met"
    wrong = derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml")
    wrong = replace(wrong, simulation=simulate(wrong.assembly, wrong.kinematics, wrong.mass, level="kinematic"))
    assert state(wrong, "clear", between=["outer_gimbal", "housing"])[0] == "violated"


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("turned", [False, True])
def test_where_a_clearance_is_lost_is_told_by_the_designers_name_and_sign(sign, turned):
    made, limits = bar(wall(), reach=60), (-math.radians(60), math.radians(60))
    between = ("bar", "base") if turned else ("base", "bar")
    wanted = intended("swing", *between, "revolute", (0, 0, sign), ORIGIN, range=limits)
    made = replace(made, assembly=replace(made.assembly, function=Function(joints=(wanted,))))
    found, finding = state(made, "clear", between=["bar", "base"], over="ranges")
    assert found == "violated"
    value = float(re.search(r"at swing = (-?[\d.]+)°", finding.message)[1])
    # the corner of the bar at (2, 40) comes to x = 30 as the bar turns about -z
    meets = math.degrees(math.asin(30 / math.hypot(2, 40)) - math.atan2(2, 40))
    assert value == pytest.approx((1 if turned else -1) * sign * meets, abs=0.05)


def test_parts_that_would_be_on_both_sides_are_no_clearance():
    made = bar(wall())
    groups = (Group("both", ("bar", "base"), made.assembly.source),)
    made = replace(made, assembly=replace(made.assembly, groups=groups))
    assert state(made, "clear", between=["both", "bar"], over="ranges")[0] == "undecided"


def test_answers_do_not_depend_on_the_order_of_parts():
    made = requiring(bar(wall(), reach=60), "clear", between=["bar", "base"], over="ranges")
    turned = replace(made, assembly=replace(made.assembly, parts=made.assembly.parts[::-1]))
    assert check(made).findings == check(turned).findings
