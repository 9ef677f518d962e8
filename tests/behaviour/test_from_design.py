"""The network of components: nodes, counts, what is in it and what cannot be."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import Z, body, device, drive, intended, joint, rod, sine

from kinform.behaviour import Constant, Node, RigidBody, System, build, count, signal, smooth
from kinform.behaviour.components import Ground
from kinform.behaviour.joints import KINDS
from kinform.behaviour.shafts import EffortDrive, MotionDrive
from kinform.model.function import Coupling, Law, Load


def arm(**more):
    """base – one – two, driven and loaded."""
    parts = [rod("one", (0, 0, 0), (1, 0, 0)), rod("two", (1, 0, 0), (2, 0, 0))]
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0)), joint("one", "two", "cylindrical", Z, (1, 0, 0))]
    return device(parts, joints, **more)


def test_a_node_joins_a_body_with_all_joints_and_loads_on_it():
    push = Load("one", np.array([0, 1.0, 0]), None, None, "world", "device.toml", 1)
    system = build(*arm(loads=[push], drives=[drive("base~one", "effort", sine(1, 1))])).system
    met = {(c.name, port) for c, port in system.at("body one", "frame")}
    assert met == {("joint base~one", "b"), ("joint one~two", "a"), ("load 1 one", "frame")}
    assert [type(a) for a in system.actors("joint base~one")] == [EffortDrive]
    assert isinstance(system.ground, Ground)
    assert system.body_at("joint one~two", "b").subject == "two"


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_every_joint_leaves_as_many_equations_as_unknowns(kind):
    needs = {"axis": Z, "point": (0, 0, 0), "axis2": (1, 0, 0), "pitch": 0.01}
    parts = [rod("one", (0, 0, 0), (1, 0, 0)), rod("two", (1, 0, 0), (2, 0, 0))]
    joints = [joint("base", "one", kind, **needs), joint("one", "two", "revolute", Z, (1, 0, 0)),
              joint("base", "two", "spherical", None, (2, 0, 0))]  # fmt: skip
    drives = [drive("one~two", "spring", stiffness=1.0), drive("one~two", "damper", damping=1.0)]
    system = build(*device(parts, joints, drives=drives)).system
    found = count(system)
    assert found.balanced
    # Ports: 3 frames, 3 × 2 joint ends, the shafts, and two drives.
    shafts = KINDS[kind].rates + 1 + 3
    assert found.unknowns == 2 * (6 * (3 + 6) + shafts + 2)


def test_gears_couple_shafts_and_keep_the_count():
    wanted = [
        intended("a", "base", "one", "revolute", Z, (0, 0, 0)),
        intended("b", "base", "two", "revolute", Z, (1, 0, 0)),
    ]
    parts = [rod("one", (0, 0, 0), (1, 0, 0)), rod("two", (1, 0, 0), (2, 0, 0))]
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0)), joint("base", "two", "revolute", Z, (1, 0, 0))]
    couplings = [Coupling(("a", "b"), 3.0, "device.toml", 1)]
    made = device(parts, joints, intended=wanted, couplings=couplings)
    system = build(*made, gears=True).system
    assert [gear.ratio for gear in system.gears] == [3.0]
    assert count(system).balanced
    # no teeth give these joints a ratio: it is imposed on joints of geometry too, and said to be stated
    assert build(*made, gears=True).imposed == ()
    assert build(*made).system.gears[0].ratio == 3.0
    assert build(*made).imposed == (("gear 1 a b", ""),)


def test_a_port_in_no_node_or_in_two_is_refused():
    one = RigidBody("body one", "one", 1.0, np.zeros(3), np.eye(3))
    with pytest.raises(ValueError, match="body one"):
        System((one,), ())
    node = Node((("body one", "frame"),), 6)
    with pytest.raises(ValueError, match="body one"):
        System((one,), (node, node))
    with pytest.raises(ValueError, match="body one"):
        System((one, one), (node,))


def test_a_body_without_mass_is_part_of_the_network():
    parts = [body("stick", mass=None)]
    system = build(*device(parts, [joint("base", "stick", "revolute", Z, (0, 0, 0))])).system
    (stick,) = (b for b in system.bodies if isinstance(b, RigidBody))
    assert stick.mass is None


def test_what_acts_only_by_forces_is_told_apart_from_what_moves():
    drives = [drive("base~one", "servo", sine(1, 1)), drive("one~two", "motion", sine(1, 1))]
    lost = Load("nothing", None, None, None, "world", "device.toml", 1)
    made = build(*arm(drives=drives, loads=[lost]))
    assert [subject for subject, _ in made.failures] == ["one~two"]
    assert [subject for subject, _ in made.forces_missing] == ["base~one", "nothing"]


def test_a_drive_takes_the_designers_sense():
    wanted = [intended("swing", "one", "base", "revolute", Z, (0, 0, 0))]
    law = Law("ramp", rate=10.0, offset=4.0)
    system = build(*arm(intended=wanted, drives=[drive("swing", "motion", law)])).system
    (actor,) = system.actors("joint base~one")
    assert isinstance(actor, MotionDrive)
    assert actor.signal.value(2.0) == pytest.approx(-np.radians(24.0))
    assert actor.signal.rate(2.0) == pytest.approx(-np.radians(10.0))


LAWS = [
    Law("constant", value=3.0),
    Law("ramp", offset=1.0, rate=-2.0),
    Law("sine", amplitude=2.0, frequency=0.8, phase=30.0, offset=1.0),
    Law("table", times=(0.0, 0.4, 1.0, 1.5), values=(0.0, 2.0, -1.0, 0.5)),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.type)
@pytest.mark.parametrize("change", [lambda s: s, smooth], ids=["plain", "smooth"])
def test_rates_and_accelerations_are_derivatives_of_values(law, change):
    made, h = change(signal(law, 1.7)), 1e-5
    for t in (-0.3, 0.13, 0.61, 1.21, 1.9):
        rate = (made.value(t + h) - made.value(t - h)) / (2 * h)
        assert made.rate(t) == pytest.approx(rate, abs=1e-7)
        assert made.acceleration(t) == pytest.approx((made.rate(t + h) - made.rate(t - h)) / (2 * h), abs=1e-6)


def test_a_table_holds_outside_and_its_spline_meets_it_at_every_row_without_a_jump_of_rate():
    law = LAWS[3]
    for made in (signal(law, 1.0), smooth(signal(law, 1.0))):
        assert [made.value(t) for t in law.times] == pytest.approx(list(law.values))
        assert (made.value(-1.0), made.value(9.0)) == (0.0, 0.5)
    curve = smooth(signal(law, 1.0))
    for t in law.times:
        assert curve.rate(t - 1e-9) == pytest.approx(curve.rate(t + 1e-9), abs=1e-6)


def test_a_table_of_one_row_is_constant():
    assert signal(Law("table", times=(1.0,), values=(2.0,)), 3.0) == Constant(6.0)


@pytest.mark.parametrize(
    "law",
    [Law("table"), Law("table", times=(0.0, 1.0), values=(1.0,)), Law("wave"), Law("constant", value=np.inf)],
)
def test_laws_that_are_no_functions_are_refused(law):
    with pytest.raises(ValueError, match=r"law|table"):
        signal(law, 1.0)
