"""Stops where parts meet: the ends of found ranges stop a motion as stated ones do."""

from __future__ import annotations

from dataclasses import replace
from math import asin, atan2, hypot

import numpy as np
import pytest
from support.devices import Z, initial
from support.slots import lever_between_pegs
from support.solids import assembly, box, part, rod

from kinform import stages
from kinform.design import Design
from kinform.model.function import SimulationRequest

UPPER = atan2(12, 32) - asin(4 / hypot(32, 12))
LOWER = -(atan2(16, 24) - asin(4 / hypot(24, 16)))


def thrown(velocity, stops="found", **solids):
    """(run, sign of its value about z) of a lever that is thrown at so many degrees a second, without gravity."""
    asked = SimulationRequest(
        gravity=np.zeros(3), duration=1.0, step=0.01, stops=stops, restitution=0.5, initial=(initial(*velocity),)
    )
    made = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()), ground="base")
    design = stages.mass(stages.joints(stages.contacts(Design(replace(made, simulation=asked)))))
    (joint,) = design.kinematics.joints
    about = 1.0 if joint.axis @ np.array(Z) > 0.0 else -1.0
    about *= 1.0 if joint.bodies[0] == "base" else -1.0
    return stages.simulate(design), about


def test_a_lever_swings_between_its_pegs():
    """At 40° a second, half of it after each impact."""
    speed = np.radians(40.0)
    design, about = thrown(("base~lever", 0.0, 40.0), **lever_between_pegs())
    run = design.simulation
    assert run.status == "done", run.reason
    first, second = (UPPER, LOWER) if run.joint_velocity[0, 0] * about > 0.0 else (LOWER, UPPER)
    hit = abs(first) / speed
    back = np.abs(first) - 0.5 * speed * (run.time - hit)
    expected = np.sign(first) * np.where(run.time < hit, speed * run.time, back)
    until = hit + abs(first - second) / (0.5 * speed)
    seen = run.time < min(until, 1.0) - 0.01
    assert seen.sum() > 60
    np.testing.assert_allclose(run.joint_position[seen, 0] * about, expected[seen], atol=np.radians(0.02))
    assert not [met for met in run.collisions if met.depth > 1e-4]
    assert any("base~lever" in note for note in run.assumptions)
    assert run.ranges


def test_without_being_asked_it_passes_them():
    design, _ = thrown(("base~lever", 0.0, 40.0), stops="", **lever_between_pegs())
    assert abs(design.simulation.joint_position[-1, 0]) == pytest.approx(np.radians(40.0))


def test_a_joint_that_nothing_stops_is_said_to_have_no_stop():
    plate = box(-20, 20, -20, 20, -5, 0) + rod(5, -1, 11) + rod(8, 10, 13)
    wheel = rod(15, 0, 10) - rod(5, -1, 11)
    design, _ = thrown(("base~wheel", 0.0, 40.0), base=plate, wheel=wheel)
    run = design.simulation
    assert run.status == "done", run.reason
    assert abs(run.joint_position[-1, 0]) == pytest.approx(np.radians(40.0))
    assert any("base~wheel" in note for note in run.assumptions)
