"""Models written in Python: the documentation runs as it stands, files give them back, and every kind moves."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from support.designs import difference
from support.places import FIXTURES, ROOT

from kinform import results
from kinform.behaviour import Behaviour, Constant, Controller, Model, Sine, System, flat
from kinform.behaviour.components import COMPONENTS, kind_of
from kinform.behaviour.joints import KINDS
from kinform.behaviour.nested import arranged
from kinform.errors import InputError
from kinform.exports import port_model
from kinform.exports.port_model import schema
from kinform.simulation import Course, simulate_system


@pytest.fixture(scope="module")
def shown():
    """What the documentation's blocks of Python leave behind, run one after the other."""
    text = (ROOT / "docs" / "port-model.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL):
        exec(block, names)
    return names


def test_the_documentation_runs_and_its_pendulum_swings_as_long_as_it_should(shown):
    run_of = simulate_system(shown["pendulum"], Course(2.0, 0.001), initial={"hinge": (0.1, 0.0)})
    k = np.flatnonzero(np.diff(np.sign(run_of.joint_velocity[:, 0])) > 0)
    assert len(k) >= 1
    # The first return of the velocity to zero from below is after half a period; large swings take a little longer.
    half = run_of.time[k[0]] if run_of.joint_velocity[1, 0] < 0 else run_of.time[k[0]] / 2
    assert half == pytest.approx(np.pi / np.sqrt(9.81) * (1 + 0.1**2 / 16), abs=2e-3)


def every_kind():
    """One of each kind of component, in a system in a system."""
    model = Model()
    model.ground("base")
    before = "base"
    needs = {"axis": (0, 0, 1), "axis2": (1, 0, 0), "point": (0, 0, 0), "pitch": 0.01}
    for kind in KINDS:
        model.body(f"{kind} body", 1.0, (0.1, 0.2, 0), (0.1, 0.1, 0.1))
        model.joint(kind, before, f"{kind} body", kind, **needs)
        before = f"{kind} body"
    model.motion("motion", "revolute", Sine(0.0, 0.1, 2.0, 0.0))
    model.effort("effort", "prismatic", Constant(0.1))
    model.spring("spring", "prismatic", 20.0, 0.01)
    model.damper("damper", "prismatic", 0.5)
    model.stop("stop", "prismatic", -0.5, 0.5)
    model.servo("servo", "prismatic", Constant(0.02), Controller(3.0, 0.1, 0.2))
    model.body("wheel", 1.0, (0, 0, 1), (0.1, 0.1, 0.1))
    model.joint("axle", "base", "wheel", **needs)
    model.gear("gear", "axle", "screw", 2.0)
    model.motor("motor", "axle", 2.0, 0.01, 0.05)
    model.voltage("voltage", "motor", Constant(2.0))
    model.body("disc", 1.0, (0, 0, 1), (0.1, 0.1, 0.1))
    model.joint("spindle", "base", "disc", **needs)
    model.motor("second motor", "spindle", 2.0, 0.0, 0.05)
    model.controller("pid", "second motor", "spindle", Constant(0.3), Controller(3.0, 0.1, 0.2, 5.0))
    model.spring_between("cord", "base", "planar body", ((0, 0, 1), (0, 0, 0)), 30.0, 1.0, 0.5)
    model.gas_spring("gas", "base", "planar body", ((0, 0, 1), (0, 0, 0)), 5.0, 1.2, 0.8, 1.3, 0.1)
    model.bushing("rubber", "base", "planar body", (0, 0, 0), (1, 2, 3), (0.1, 0.2, 0.3), (1, 1, 1))
    model.load("push", "wheel", (0, 0, 1), force=(0, 0, 1), torque=(0, 0.1, 0))
    outer = Model()
    outer.include("all", model.system())
    return outer.system("outer")


def test_every_kind_of_component_runs_and_comes_back_from_a_file():
    system = every_kind()
    found = {kind_of(component) for component in flat(system).components}
    assert found == set(COMPONENTS) - {
        "system",
        "friction",
    }  # friction: tests/simulation/test_simulation_friction_stated.py
    run = simulate_system(system, Course(0.2, 0.05))
    assert (run.status, run.failures) == ("done", ())
    assert run.balance.max() < 1e-9
    again = port_model.read(port_model.write(system, "every kind"))
    unnamed = System(system.components, system.nodes)
    assert difference(again, unnamed) is None


def test_names_of_kinds_are_those_of_the_schema(shown):
    mapping = schema()["properties"]["components"]["items"]["discriminator"]["mapping"]
    assert set(mapping) == set(COMPONENTS)


def test_a_port_that_a_file_leaves_open_is_refused_with_its_name(shown):
    text = json.loads(port_model.write(shown["device"], "device"))
    text["components"][1]["nodes"].pop()
    with pytest.raises(InputError):
        port_model.read(json.dumps(text))


def test_systems_with_names_of_their_own_survive_a_results_file(shown, derive_design, tmp_path):
    device = shown["device"]
    whole = flat(device)
    assert any(component.name.startswith("weld ") for component in whole.components)
    named = [component.name for component in whole.components if not component.name.startswith("weld ")]
    order = [*sorted(named), *(c.name for c in whole.components if c.name not in named)]
    made = Behaviour(arranged(whole, order), device, (), ())
    design = replace(derive_design(FIXTURES / "pairs/revolute_collars/revolute_collars.toml"), behaviour=made)
    results.write(design, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5").behaviour
    assert difference(again, made) is None
    run, twin = (simulate_system(model.nested, Course(0.1, 0.05)) for model in (made, again))
    assert difference(run, twin) is None
