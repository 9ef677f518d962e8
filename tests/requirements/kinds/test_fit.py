"""Clearances of fits, by what contacts say."""

from __future__ import annotations

from support.numbers import numbers
from support.places import FIXTURES
from support.requirements import state


def fixture(derive_design, name):
    return derive_design(FIXTURES / "pairs" / name / f"{name}.toml")


def test_the_radial_clearance_of_a_shaft(derive_design):
    made = fixture(derive_design, "cylindrical_gap_015")
    fit = {"between": ["shaft", "block"]}
    assert state(made, "fit", minimum=0.14e-3, maximum=0.16e-3, **fit)[0] == "met"
    assert state(made, "fit", minimum=0.16e-3, **fit)[0] == "violated"
    found, finding = state(made, "fit", maximum=0.1e-3, **fit)
    assert found == "violated"
    assert numbers(finding.found) == [0.15]
    press = fixture(derive_design, "cylindrical_press_002")
    assert state(press, "fit", minimum=-0.025e-3, maximum=-0.015e-3, **fit)[0] == "met"
    assert state(press, "fit", minimum=0.0, **fit)[0] == "violated"
    apart = fixture(derive_design, "free_apart")
    names = [p.name for p in apart.assembly.parts]
    assert state(apart, "fit", between=names, minimum=0.0)[0] == "undecided"


def test_the_clearance_of_a_drawer_counts_both_sides(derive_design):
    made = fixture(derive_design, "prismatic_drawer")
    fit = {"between": ["drawer", "cabinet"]}
    assert state(made, "fit", minimum=0.19e-3, maximum=0.21e-3, **fit)[0] == "met"
    assert state(made, "fit", maximum=0.15e-3, **fit)[0] == "violated"
