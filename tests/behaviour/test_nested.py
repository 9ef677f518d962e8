"""Systems in systems: what is inside counts for itself, and without levels it is the same network."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.designs import difference

from kinform.behaviour import Component, Constant, Model, Sine, System, count, counts, flat, nest, placed
from kinform.behaviour.component_owners import component_owners
from kinform.simulation import Course, simulate_system

STILL = np.zeros(3)


def motor(gear: float = 5.0) -> System:
    """A motor as a system: winding, rotor in its bearing, gear, output shaft; its ports: stator, output, terminals."""
    model = Model()
    model.body("stator", 0.3, (0, 0, 0), (1e-4, 1e-4, 1e-4))
    model.body("rotor", 0.1, (0, 0, 0), (2e-5, 2e-5, 3e-5))
    model.body("output", 0.05, (0, 0, 0.02), (1e-5, 1e-5, 1e-5))
    model.joint("bearing", "stator", "rotor", axis=(0, 0, 1), point=(0, 0, 0))
    model.joint("shaft", "stator", "output", axis=(0, 0, 1), point=(0, 0, 0))
    model.gear("gear", "bearing", "shaft", gear)
    model.motor("winding", "bearing", resistance=2.0, inductance=0.01, constant=0.04)
    model.expose("housing", "stator", "frame")
    model.expose("output", "output", "frame")
    model.expose("terminals", "winding", "terminals")
    return model.system("motor")


def device() -> System:
    """Two motors of one kind in one device, one turning about z, the other about x, each with a load of its own."""
    turned = np.eye(4)
    turned[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    turned[:3, 3] = [0.2, 0.0, 0.1]
    model = Model()
    model.ground("frame")
    model.include("left", motor(), housing="frame")
    model.include("right", motor(), turned, housing="frame")
    model.body("wheel", 0.5, (0, 0, 0.05), (1e-3, 1e-3, 2e-3))
    model.joint("flange", "wheel", ("left", "output"), "fixed")
    model.voltage("supply", ("left", "terminals"), Constant(6.0))
    model.voltage("second supply", ("right", "terminals"), Sine(0.0, 6.0, 20.0, 0.0))
    return model.system("device")


def test_unknowns_equal_equations_on_every_level_and_without_levels():
    found = dict(counts(device()))
    assert list(found) == ["", "left", "right"]
    assert all(level.balanced for level in found.values())
    inside = found["left"]
    # Ports inside: 3 bodies, 2 joints with shafts, gear, winding; outside two frames and the terminals.
    assert inside.unknowns == 2 * (3 * 6 + 2 * 13 + 2 + 2) + 2 * (6 + 6 + 1)
    assert motor().equations == sum(port.size for port in motor().ports)
    assert count(flat(device())).balanced


class Mute(Component):
    """A frame that says nothing about itself."""

    equations = 0


def test_what_is_missing_inside_a_system_is_missing_outside():
    model = Model()
    model.add(Mute("mute", "mute"))
    model.expose("out", "mute", "frame")
    outer = Model()
    outer.ground("base")
    outer.include("inner", model.system(), out="base")
    found = count(outer.system())
    assert found.unknowns - found.equations == 6


def test_a_motor_written_once_turns_twice_as_its_equations_say():
    run = simulate_system(device(), Course(1.0, 0.01, STILL))
    assert (run.status, run.failures) == ("done", ())
    assert {"left/shaft", "right/shaft", "left/bearing", "flange"} <= set(run.joint_names)
    speed = run.joint_velocity[:, run.joint_names.index("left/bearing")]
    output = run.joint_velocity[:, run.joint_names.index("left/shaft")]
    np.testing.assert_allclose(speed, 5.0 * output, atol=1e-9)
    # Inertia at the rotor: its own, and output and wheel through the gear.
    inertia = 3e-5 + (1e-5 + 2e-3) / 25.0
    A = np.array([[-2.0 / 0.01, -0.04 / 0.01], [0.04 / inertia, 0.0]])
    steady = np.array([0.0, 6.0 / 0.04])
    values, vectors = np.linalg.eig(A)
    parts = np.linalg.solve(vectors, -steady)
    exact = np.real((vectors * parts) @ np.exp(np.outer(values, run.time))).T + steady
    np.testing.assert_allclose(speed, exact[:, 1], atol=1e-6)
    np.testing.assert_allclose(run.p_WB[:, run.body_names.index("left/stator")], 0.0, atol=1e-12)


def test_a_motor_moved_elsewhere_gives_the_same_run_there():
    X = np.eye(4)
    X[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    X[:3, 3] = [0.4, -0.2, 0.3]

    def alone(pose: np.ndarray | None) -> np.ndarray:
        model = Model()
        model.ground("base")
        model.include("motor", motor() if pose is None else placed(motor(), pose), housing="base")
        model.voltage("supply", "motor", Constant(6.0))
        run = simulate_system(model.system(), Course(0.2, 0.02, STILL))
        return run.joint_velocity

    np.testing.assert_allclose(alone(X), alone(None), atol=1e-8)


def chain(names: list[str]) -> System:
    """Bodies in a row, one hinged to the next, the first to the ground."""
    model = Model()
    model.ground("base")
    before = "base"
    for k, name in enumerate(names):
        model.body(f"{name} {k}", 1.0, (k + 0.5, 0, 0), (0.01, 0.1, 0.1))
        model.joint(f"hinge {k}", before, f"{name} {k}", axis=(0, 0, 1), point=(k, 0, 0))
        model.damper(f"damper {k}", f"hinge {k}", 0.1)
        before = f"{name} {k}"
    return model.system()


def same(one: System, two: System) -> bool:
    """Equal but for the order of components, nodes and ports."""
    ports = [{(frozenset(node.ports), node.size) for node in system.nodes} for system in (one, two)]
    components = [{c.name: c for c in system.components} for system in (one, two)]
    return ports[0] == ports[1] and difference(*components) is None


PATHS = ["", "arm", "arm/motor", "arm/motor/core", "arm/gear", "leg", "leg/motor"]


@settings(max_examples=60, deadline=None)
@given(st.lists(st.sampled_from(PATHS), min_size=12, max_size=12))
def test_levels_put_in_and_taken_out_leave_the_network_as_it_was(where):
    system = chain(["a", "b", "c", "d"])
    homes = {c.name: path for c, path in zip(system.components, [*where, ""], strict=True)}
    nested = nest(system, homes)
    assert same(flat(nested), system)
    assert all(level.balanced for _, level in counts(nested))
    deepest = max((path.count("/") + 1 if path else 0) for path in homes.values())
    assert max(path.count("/") + 1 if path else 0 for path, _ in counts(nested)) == deepest


def test_bodies_that_meet_in_a_node_move_as_one():
    model = Model()
    model.ground("base")
    model.body("arm", 1.0, (0.5, 0, 0), (0, 0.1, 0.1))
    model.body("tip", 1.0, (1.0, 0, 0), (0, 0, 0))
    model.joint("hinge", "base", "arm", axis=(0, 0, 1), point=(0, 0, 0))
    model.join(("tip", "frame"), "arm")
    run = simulate_system(model.system(), Course(0.5, 0.1, np.array([0, -9.81, 0])))
    assert "weld arm~tip" in run.joint_names
    one = Model()
    one.ground("base")
    one.body("both", 2.0, (0.75, 0, 0), (0, 0.1 + 2 * 0.25**2, 0.1 + 2 * 0.25**2))
    one.joint("hinge", "base", "both", axis=(0, 0, 1), point=(0, 0, 0))
    alone = simulate_system(one.system(), Course(0.5, 0.1, np.array([0, -9.81, 0])))
    np.testing.assert_allclose(run.joint_position[:, 0], alone.joint_position[:, 0], atol=1e-9)


def test_a_port_that_does_not_exist_cannot_be_exposed_or_joined():
    model = Model()
    model.ground("base")
    with pytest.raises(ValueError, match=r'"shaft".*"base"'):
        model.expose("out", "base", "shaft")
    with pytest.raises(ValueError, match=r'"motor".*"rotor"'):
        model.include("motor", motor(), rotor="base")
    with pytest.raises(ValueError, match='"bas"'):
        model.include("motor", motor(), housing="bas")
    inner = motor()
    with pytest.raises(ValueError, match="out"):
        System(inner.components, inner.nodes, "m", exposed=(("out", ("rotor", "shaft")),))


def test_what_acts_inside_a_sub_assembly_belongs_to_it():
    model = Model()
    model.ground("base")
    model.body("a/one", 1.0, (0, 0, 0), (1, 1, 1))
    model.body("a/b/two", 1.0, (0, 0, 0), (1, 1, 1))
    model.joint("outer", "base", "a/one", axis=(0, 0, 1), point=(0, 0, 0))
    model.joint("inner", "a/one", "a/b/two", axis=(0, 0, 1), point=(0, 0, 0))
    model.motor("winding", "inner", 1.0, 0.0, 0.1)
    model.voltage("supply", "winding", Constant(1.0))
    model.load("push", "a/b/two", (0, 0, 0))
    model.gear("gear", "inner", "outer", 2.0)
    model.spring_between("cord", "a/one", "a/b/two", ((0, 0, 0), (1, 0, 0)), 1.0)
    system = model.system()
    found = component_owners(system, {body.subject: (body.subject,) for body in system.bodies})
    assert {name: home for name, home in found.items() if home} == {
        "a/one": "a", "a/b/two": "a/b", "inner": "a", "winding": "a", "supply": "a", "push": "a/b", "cord": "a",
    }  # fmt: skip


def test_a_system_that_was_asked_survives_copies_and_pickles():
    known = device()
    met = known.bodies_at("wheel", "frame")
    for again in (copy.deepcopy(known), pickle.loads(pickle.dumps(known))):
        assert [body.name for body in again.bodies_at("wheel", "frame")] == [body.name for body in met]
        assert {joint.name for joint in again.joints_at("wheel", "frame")} == {"flange"}
        assert again.systems[0].bodies_at("stator", "frame")
