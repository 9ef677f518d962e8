"""Places and directions that a chain of joints reaches, or does not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.numbers import numbers
from support.requirements import arm, gimbal, parallelogram, state


def places(*points):
    return {"type": "poses", "points": [list(p) for p in points]}


def test_an_arm_reaches_what_its_links_and_ranges_allow():
    tip = {"part": "lower", "point": [0.6, 0, 0], "tolerance": 1e-4}
    assert state(arm(), "reach", region=places((0.6, 0, 0), (0.3, 0, 0.3), (0.2, 0, -0.1)), **tip)[0] == "met"
    found, finding = state(arm(), "reach", region=places((0.7, 0, 0)), **tip)
    assert found == "violated"
    assert numbers(finding.found)[-1] == 100.0
    # folded by 150° the tip stays 2·0.3·sin 15° away from the shoulder
    found, finding = state(arm(), "reach", region=places((0.1, 0, 0)), **tip)
    assert found == "violated"
    assert numbers(finding.found)[-1] == pytest.approx(1e3 * (0.6 * math.sin(math.radians(15)) - 0.1), rel=1e-3)
    # out of the plane of the arm
    assert state(arm(), "reach", region=places((0.5, 0.01, 0)), **tip)[0] == "violated"


def test_a_box_is_covered_or_not():
    region = {"type": "box", "lower": [0.2, 0, -0.1], "upper": [0.35, 0, 0.1], "X_WF": np.eye(4).tolist()}
    tip = {"part": "lower", "point": [0.6, 0, 0]}
    assert state(arm(), "reach", region=region, **tip)[0] == "met"
    assert state(arm(), "reach", region=region | {"upper": [0.7, 0, 0.1]}, **tip)[0] == "violated"


def test_a_pointing_direction_covers_a_cone():
    cone = {"type": "cone", "axis": [1, 0, 0], "half_angle": math.radians(30)}
    pointing = {"part": "inner", "direction": [1.0, 0, 0]}
    assert state(gimbal(), "reach", region=cone, **pointing)[0] == "met"
    found, finding = state(gimbal(), "reach", region=cone | {"half_angle": math.radians(40)}, **pointing)
    assert found == "violated"
    assert numbers(finding.found)[-1] == 10.0
    assert state(gimbal(yaw=25.0), "reach", region=cone, **pointing)[0] == "violated"
    assert state(gimbal(), "reach", region=cone, part="inner", point=[1.0, 0, 0])[0] == "undecided"


def test_a_yes_needs_ranges_and_a_no_does_not():
    made = arm(shoulder=None)
    tip = {"part": "lower", "point": [0.6, 0, 0]}
    assert state(made, "reach", region=places((0.6, 0, 0)), **tip)[0] == "undecided"
    assert state(made, "reach", region=places((0.7, 0, 0)), **tip)[0] == "violated"


@pytest.mark.slow
def test_reach_along_a_closed_loop_is_decided_by_the_range_of_the_crank():
    on = lambda degrees: (0.15 + 0.1 * math.sin(math.radians(degrees)), 0, 0.1 * math.cos(math.radians(degrees)))
    middle = {"part": "coupler", "point": [0.15, 0, 0.1], "tolerance": 1e-5}
    made = parallelogram((-math.pi / 3, math.pi / 3))
    assert state(made, "reach", region=places(on(0), on(-50), on(59)), **middle)[0] == "met"
    assert state(made, "reach", region=places(on(65)), **middle)[0] == "violated"
    # the middle of the circle
    assert state(made, "reach", region=places((0.15, 0, 0.0)), **middle)[0] == "violated"
    assert state(parallelogram(), "reach", region=places(on(50)), **middle)[0] == "undecided"
