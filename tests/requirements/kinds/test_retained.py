"""What can leave an assembly, by what contacts say."""

from __future__ import annotations

from dataclasses import replace

import pytest
from generators.solids import box, join
from support.manifests import manifest
from support.numbers import numbers
from support.places import FIXTURES
from support.requirements import state

from kinform import stages


def fixture(derive_design, name):
    return derive_design(FIXTURES / "pairs" / name / f"{name}.toml")


def test_what_can_leave_is_not_retained(derive_design):
    assert state(fixture(derive_design, "revolute_collars"), "retained", part="shaft")[0] == "met"
    table = fixture(derive_design, "general_ball_on_table")
    ball = next(p.name for p in table.assembly.parts if p.name != table.assembly.ground)
    found, finding = state(table, "retained", part=ball)
    assert found == "violated"
    assert numbers(finding.found) == [0.0, 0.0, 1.0]
    # it rolls away sideways too
    assert state(table, "retained", part=ball, directions=[[0, 0, 1.0]])[0] == "violated"
    every = [[0, 0, 1.0], [1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0]]
    assert state(table, "retained", part=ball, directions=every)[0] == "met"
    socket = fixture(derive_design, "spherical_open")
    assert state(socket, "retained", part="ball")[0] == "violated"
    assert state(socket, "retained", part="ball", directions=[[0, 0, -1.0]])[0] == "violated"
    assert state(socket, "retained", part="ball", directions=[[0, 0, 1.0]])[0] == "met"
    assert state(fixture(derive_design, "spherical_captive"), "retained", part="ball")[0] == "met"
    apart = fixture(derive_design, "free_apart")
    loose = next(b.name for b in apart.kinematics.bodies if not b.ground)
    assert state(apart, "retained", part=loose)[0] == "violated"


def test_a_slide_without_stops_lets_its_part_leave_both_ways(derive_design):
    drawer = fixture(derive_design, "prismatic_drawer")
    made = replace(drawer, simulation=replace(drawer.simulation, ranges=None))
    both = [[0, 0, 1.0], [0, 0, -1.0]]
    for known in (drawer, made):
        assert state(known, "retained", part="drawer")[0] == "violated"
        assert state(known, "retained", part="drawer", directions=both[:1])[0] == "violated"
        assert state(known, "retained", part="drawer", directions=both)[0] == "met"


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("names", [("rail", "slider"), ("zrail", "slider")], ids=["first", "second"])
def test_a_slide_with_one_stop_leaves_the_other_way(tmp_path, mirrored, names):
    rail, slider = names
    rails = [box(-60, 60, -15, 15, -5, 0), box(-60, 60, -15, -10, -1, 10), box(-60, 60, 10, 15, -1, 10)]
    rails += [box(-60, 60, -15, -8, 8, 10), box(-60, 60, 8, 15, 8, 10)]
    parts = {rail: join(*rails, box(-55, -50, -11, 11, -1, 10)), slider: box(-20, 25, -10, 10, 0, 8)}
    turn = "rpy = [0, 0, 180]\n" if mirrored else ""
    path = manifest(tmp_path, parts, "", ground=rail, more=f'material = "steel"\n{turn}')
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    made = stages.simulate(design, ranges=True)
    out = [-1.0 if mirrored else 1.0, 0.0, 0.0]
    found, finding = state(made, "retained", part=slider)
    assert found == "violated"
    assert finding.found == f"({out[0]:g}, 0, 0)"
    assert state(made, "retained", part=slider, directions=[[-v for v in out]])[0] == "violated"
    assert state(made, "retained", part=slider, directions=[out])[0] == "met"
