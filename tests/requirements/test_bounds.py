"""Requirements on masses, centres of mass, inertia and balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import HERE
from support.devices import body, rod
from support.numbers import numbers
from support.places import FIXTURES
from support.requirements import ORIGIN, X, Y, Z, arm, design, state, wheel

from kinform.model.assembly import Group, MassOverride


def test_masses_are_compared_with_their_bounds():
    whole = design([body("a", 1.0), body("base", 0.5)], [])
    assert state(whole, "mass", maximum=1.5 - 1e-9)[0] == "violated"
    assert state(whole, "mass", maximum=1.5 + 1e-9)[0] == "met"
    assert state(arm(), "mass", of="upper", minimum=0.9, maximum=1.1)[0] == "met"
    assert state(arm(), "mass", of="upper", minimum=1.1)[0] == "violated"
    assert state(arm(), "mass")[0] == "undecided"
    assert state(design([body("a", mass=None)], []), "mass", maximum=1.0)[0] == "undecided"


def test_a_mass_nearer_to_its_bound_than_coarse_facets_allow_is_undecided(derive_design):
    made = derive_design(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    shaft = next(p for p in made.mass.parts if p.name == "shaft")
    assert shaft.mass_bound > 1e-4
    near = shaft.mass * (1.0 - 0.5 * shaft.mass_bound)
    assert state(made, "mass", of="shaft", maximum=near)[0] == "undecided"
    assert state(made, "mass", of="shaft", maximum=0.9 * near)[0] == "violated"


def test_groups_with_a_stated_mass_weigh_that_and_not_what_their_parts_do():
    made = design([body("a", 1.0), body("b", mass=None), body("base", 0.5)], [])
    stated = MassOverride(3.0, np.array([0.1, 0.0, 0.0]), np.eye(3) * 1e-3)
    grouped = replace(made, assembly=replace(made.assembly, groups=(Group("g", ("a", "b"), HERE, stated),)))
    assert state(grouped, "mass", minimum=3.5 - 1e-9, maximum=3.5 + 1e-9)[0] == "met"
    assert state(grouped, "mass", of="g", minimum=3.0 - 1e-9, maximum=3.0 + 1e-9)[0] == "met"
    assert state(grouped, "mass", of="a", maximum=1.0 + 1e-9)[0] == "met"
    assert state(grouped, "mass", of="b", maximum=9.0)[0] == "undecided"
    assert state(grouped, "centre_of_mass", point=[0.3 / 3.5, 0, 0], tolerance=1e-9)[0] == "met"


def test_the_centre_of_mass_of_several_parts():
    middle = (0.15 * 1.0 + 0.45 * 0.5) / 1.5
    made = design([rod("upper", ORIGIN, (0.3, 0, 0), 1.0), rod("lower", (0.3, 0, 0), (0.6, 0, 0), 0.5),
                   body("base", 1e-12)], [])  # fmt: skip
    assert state(made, "centre_of_mass", point=[middle, 0, 0], tolerance=1e-6)[0] == "met"
    found, finding = state(made, "centre_of_mass", point=[middle, 0.002, 0], tolerance=1e-3)
    assert found == "violated"
    assert finding.place == pytest.approx((middle, 0.0, 0.0), abs=1e-9)


def test_the_moment_of_inertia_about_a_line():
    made = arm()
    about_end = 1.0 * 0.3**2 / 3.0
    near = {"minimum": about_end - 1e-9, "maximum": about_end + 1e-9}
    assert state(made, "inertia", of="upper", axis=list(Y), point=[0, 0, 0], **near)[0] == "met"
    assert state(made, "inertia", of="upper", axis=list(Y), **near)[0] == "violated"
    assert state(made, "inertia", of="upper", axis=list(X), maximum=1e-9)[0] == "met"


def test_the_imbalance_about_an_axis():
    made = wheel(com=(0.003, 0.004, 0.1))
    assert state(made, "balance", of="disc", joint="spin", limit=0.0101)[0] == "met"
    found, finding = state(made, "balance", of="disc", joint="spin", limit=0.0099)
    assert found == "violated"
    assert numbers(finding.found) == [0.01]
    assert state(made, "balance", of="disc", axis=list(Z), point=[0.003, 0.004, 0], limit=1e-9)[0] == "met"
    assert state(made, "balance", of="disc", limit=1.0)[0] == "undecided"


@pytest.mark.parametrize("excess", [1e-2, 1e-4, 1e-6])
def test_what_is_found_and_what_is_intended_never_read_the_same(excess):
    whole = design([body("a", 1.5)], [])
    for key, limit in (("maximum", 1.5 * (1.0 - excess)), ("minimum", 1.5 * (1.0 + excess))):
        found, finding = state(whole, "mass", of="a", **{key: limit})
        assert found == "violated"
        has, wanted = (numbers(text)[0] for text in (finding.found, finding.intended))
        assert has == pytest.approx(1.5, rel=0.5 * excess)
        assert wanted == pytest.approx(limit, rel=0.5 * excess)
        assert (has < wanted) == (key == "minimum")
