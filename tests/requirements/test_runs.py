"""Requirements on a simulated motion: speeds, efforts, reactions, paths, and peaks between output times."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.devices import Z, intended, joint, rod, sine
from support.numbers import numbers
from support.requirements import ORIGIN, G, Y, circle, design, state, wheel
from support.sleds import sled

import kinform
from kinform.consistency import check
from kinform.model.function import InitialValue, Law


def test_the_peak_speed_of_a_driven_joint():
    # 30° at 0.5 Hz: 30°·π a second
    made = wheel(sine(30.0, 0.5))
    peak = math.radians(30.0) * math.pi
    assert state(made, "speed", joint="spin", limit=1.001 * peak)[0] == "met"
    found, finding = state(made, "speed", joint="spin", limit=0.999 * peak)
    assert found == "violated"
    assert numbers(finding.found) == [pytest.approx(math.degrees(peak), rel=1e-3)]
    assert state(replace(made, simulation=None), "speed", joint="spin", limit=10.0)[0] == "undecided"


def test_the_peak_torque_of_a_driven_joint():
    made = wheel(sine(30.0, 0.5))
    peak = 0.01 * math.radians(30.0) * math.pi**2
    assert made.simulation.level == "dynamic"
    assert state(made, "torque", joint="spin", limit=1.001 * peak)[0] == "met"
    assert state(made, "torque", joint="spin", limit=0.999 * peak)[0] == "violated"
    # a free joint has no torque to speak of, and a kinematic run no forces
    assert state(wheel(), "torque", joint="spin", limit=1.0)[0] == "undecided"
    assert state(wheel(sine(30.0, 0.5), level="kinematic"), "torque", joint="spin", limit=1.0)[0] == "undecided"


def test_a_drive_beside_the_curve_of_its_motor():
    """sin and cos of one phase are an ellipse of speed and effort; a straight curve touches it where both shares are
    1/√2: it is exceeded by √2 where either end of the curve is the amplitude."""
    made = wheel(sine(30.0, 0.5))
    speed = math.radians(30.0) * math.pi
    peak = 0.01 * math.radians(30.0) * math.pi**2
    for scale, wanted in ((1.002 * math.sqrt(2.0), "met"), (0.998 * math.sqrt(2.0), "violated")):
        line = {"speeds": [0.0, scale * speed], "efforts": [scale * peak, 0.0]}
        assert state(made, "torque_speed", joint="spin", **line)[0] == wanted
    # a motor that keeps its torque up to its greatest speed: each side of the box by itself
    for fast, strong, wanted in ((1.002, 1.002, "met"), (0.998, 1.002, "violated"), (1.002, 0.998, "violated")):
        box = {"speeds": [0.0, 0.5 * fast * speed, fast * speed], "efforts": [strong * peak] * 3}
        assert state(made, "torque_speed", joint="spin", **box)[0] == wanted
    assert state(wheel(), "torque_speed", joint="spin", speeds=[0.0, 1.0], efforts=[1.0, 0.0])[0] == "undecided"


def test_a_run_that_stopped_proves_only_what_it_saw():
    made = wheel(sine(30.0, 0.5))
    stopped = replace(made, simulation=replace(made.simulation, status="stopped", reason="singular"))
    peak = math.radians(30.0) * math.pi
    assert state(stopped, "speed", joint="spin", limit=0.999 * peak)[0] == "violated"
    assert state(stopped, "speed", joint="spin", limit=1.001 * peak)[0] == "undecided"


def test_the_peak_reaction_of_a_joint():
    made = wheel(sine(30.0, 0.5))
    wrench = np.zeros((len(made.simulation.time), 1, 6))
    wrench[:, 0, 3:] = (0.0, 3.0, 4.0)
    wrench[7, 0, :3] = (0.0, 0.0, 2.0)
    open_ = np.zeros((1, 6), dtype=bool)
    reacting = replace(made, simulation=replace(made.simulation, F_A=wrench, undetermined=open_))
    assert state(reacting, "reaction", joint="spin", force=5.01, torque=2.01)[0] == "met"
    assert state(reacting, "reaction", joint="spin", force=4.99)[0] == "violated"
    found, finding = state(reacting, "reaction", joint="spin", torque=1.99)
    assert found == "violated"
    assert numbers(finding.found) == [2.0]
    open_ = np.array([[False, False, False, True, False, False]])
    doubtful = replace(made, simulation=replace(made.simulation, F_A=wrench, undetermined=open_))
    assert state(doubtful, "reaction", joint="spin", force=100.0)[0] == "undecided"
    assert state(doubtful, "reaction", joint="spin", torque=2.01)[0] == "met"
    assert (
        state(
            replace(made, simulation=replace(made.simulation, F_A=np.zeros((0, 0, 6)))),
            "reaction",
            joint="spin",
            force=1.0,
        )[0]
        == "undecided"
    )


def test_a_point_follows_its_path():
    made = wheel(sine(30.0, 0.5))
    given = {"part": "disc", "point": [0.1, 0, 0], "path": "p.csv"}
    assert state(made, "follow", rows=circle(), tolerance=1e-4, **given)[0] == "met"
    assert state(made, "follow", rows=circle(turned=True), tolerance=1e-4, angle_tolerance=1e-3, **given)[0] == "met"
    found, finding = state(made, "follow", rows=circle(shift=2e-3), tolerance=1e-3, **given)
    assert found == "violated"
    assert finding.found == "2 mm"
    wrong = [[*row[:4], 1.0, 0.0, 0.0, 0.0] for row in circle()]
    found, finding = state(made, "follow", rows=wrong, tolerance=1e-4, angle_tolerance=0.1, **given)
    assert found == "violated"
    assert finding.found == "30°"
    assert state(made, "follow", rows=circle(last=1.5), tolerance=1.0, **given)[0] == "undecided"


def test_a_smooth_peak_between_output_times_is_not_passed():
    made = wheel(sine(30.0, 0.5))
    # as if the output times lay half a step beside the peak
    run = made.simulation
    step = float(run.time[1])
    phase = math.pi * (run.time + 0.5 * step)
    moved = math.radians(30.0) * np.array([-np.cos(phase), math.pi * np.sin(phase), math.pi**2 * np.cos(phase)])
    shifted = moved[1]
    position, velocity, acceleration = moved[:, :, None]
    coarse = replace(run, joint_position=position, joint_velocity=velocity, joint_acceleration=acceleration)
    coarse = replace(made, simulation=coarse)
    sampled = float(np.abs(shifted).max())
    true = math.radians(30.0) * math.pi
    assert sampled < true
    between = 0.5 * (sampled + true)
    assert state(coarse, "speed", joint="spin", limit=between)[0] == "undecided"
    assert state(coarse, "speed", joint="spin", limit=1.0001 * true)[0] == "met"
    assert state(coarse, "speed", joint="spin", limit=0.9999 * sampled)[0] == "violated"


def test_a_jump_has_no_peak_beside_it():
    made = wheel(sine(30.0, 0.5))
    run = made.simulation
    jumping = np.where(run.time < 0.5, 0.0, 1.0)[:, None]
    along = np.maximum(run.time - 0.5, 0.0)[:, None]
    jumped = replace(run, joint_position=along, joint_velocity=jumping, joint_acceleration=np.zeros_like(jumping))
    jumped = replace(made, simulation=jumped)
    assert state(jumped, "speed", joint="spin", limit=1.001)[0] == "met"


@pytest.mark.parametrize("share", [1, 2, 3, 4])
def test_a_motion_of_which_there_are_too_few_output_times_is_not_passed(share):
    """At a half or a quarter of the period of 0.5 Hz all that is seen is rest, or full speed without torque."""
    spin, peak = sine(30.0, 0.5), 0.01 * math.radians(30.0) * math.pi**2
    made = wheel(spin, duration=8.0, step=2.0 / share)
    assert len(made.simulation.time) == 4 * share + 1
    seen = float(np.abs(made.simulation.joint_effort).max())
    assert seen < 0.99 * peak or share == 4
    assert state(made, "torque", joint="spin", limit=max(1.01 * seen, 0.5 * peak))[0] == "undecided"
    fine = wheel(spin, duration=8.0, step=2.0 / 16)
    assert state(fine, "torque", joint="spin", limit=1.01 * peak)[0] == "met"
    assert state(fine, "torque", joint="spin", limit=0.5 * peak)[0] == "violated"


def test_a_pendulum_of_which_there_are_too_few_output_times_is_not_passed():
    """It swings by itself: no law says how fast."""
    turn, start = joint("base", "bob", "revolute", Y, ORIGIN), InitialValue("swing", 20.0, 0.0, 1.0, "m.toml", 9)
    made = lambda step: design(
        [rod("bob", ORIGIN, (0, 0, -0.3), 1.0)], [turn],
        wanted=[intended("swing", "base", "bob", "revolute", Y, ORIGIN)],
        run=True, initial=(start,), duration=4.0, step=step,
    )  # fmt: skip
    # half the period of a rod of 0.3 m: 2π √(2·0.3/(3 g)), a little longer at 20°
    period = 2.0 * math.pi * math.sqrt(2.0 * 0.3 / (3.0 * G)) * (1.0 + math.radians(20.0) ** 2 / 16.0)
    fastest = math.sqrt(3.0 * G / 0.3 * (1.0 - math.cos(math.radians(20.0))))
    assert state(made(period / 2), "speed", joint="swing", limit=0.5 * fastest)[0] != "met"
    assert state(made(period / 20), "speed", joint="swing", limit=1.02 * fastest)[0] == "met"
    assert state(made(period / 20), "speed", joint="swing", limit=0.95 * fastest)[0] == "violated"


def test_energy_that_only_rounding_exchanges_between_output_times_is_no_finding():
    # at full speed at every output time
    made = wheel(sine(30.0, 0.5), duration=8.0, step=2.0)
    assert float(np.ptp(made.simulation.energy[:, 0])) < 1e-9 * float(made.simulation.energy[:, 0].max())
    assert "KF504" not in {finding.code for finding in check(made).findings}


@pytest.mark.parametrize(
    ("axis", "between", "range_", "fires"),
    [
        (Z, ("base", "disc"), (-10, 31), False),
        (Z, ("base", "disc"), (-31, 10), True),
        ((0, 0, -1.0), ("base", "disc"), (-10, 31), True),
        ((0, 0, -1.0), ("base", "disc"), (-31, 10), False),
        (Z, ("disc", "base"), (-10, 31), True),
        ((0, 0, -1.0), ("disc", "base"), (-10, 31), False),
        (Z, ("base", "disc"), (-10, math.inf), False),
    ],
)
def test_a_motion_beyond_the_stated_range_is_told_in_the_designers_sense(axis, between, range_, fires):
    """A ramp from 0 to 30° about z, of the disc relative to the base."""
    made = wheel(Law("ramp", rate=30.0))
    (own,) = made.assembly.function.joints
    stated = replace(own, axis=np.asarray(axis, float), between=between, range=tuple(np.radians(range_)))
    # the drive is of kinform's joint, whose sense is another
    drives = tuple(replace(item, joint="base~disc") for item in made.assembly.function.drives)
    function = replace(made.assembly.function, joints=(stated,), drives=drives)
    made = replace(made, assembly=replace(made.assembly, function=function))
    found = [f for f in check(made).findings if f.code == "KF413"]
    assert len(found) == fires
    if fires:
        assert abs(numbers(found[0].found)[0]) == 30.0
        assert 10.0 in map(abs, numbers(found[0].intended))


@pytest.mark.parametrize("phase", [0.0, 30.0, 90.0])
def test_a_motion_of_whole_oscillations_between_output_times_leaves_its_range_unknown(phase):
    """At every output time the disc is where it began; at 90° it is at rest there, too."""
    made = wheel(
        replace(sine(30.0, 0.5), phase=phase, offset=-30.0 * math.sin(math.radians(phase))), duration=8.0, step=2.0
    )
    assert float(np.ptp(made.simulation.joint_position)) < 1e-9
    (own,) = made.assembly.function.joints
    function = replace(made.assembly.function, joints=(replace(own, range=(-0.1, 0.1)),))
    made = replace(made, assembly=replace(made.assembly, function=function))
    report = check(made)
    (ran,) = [rule for rule in report.rules if rule.code == "KF413"]
    assert ran.outcome == "inconclusive"


@pytest.mark.parametrize(("velocity", "side"), [(1000, "upper"), (-1000, "lower"), (15, "")])
def test_bodies_without_meshes_leave_their_range_too(tmp_path, velocity, side):
    path = tmp_path / "sled.toml"
    path.write_text(sled("bed", "sled", "range = [-10, 10]", velocity=velocity))
    found = [f for f in kinform.run(path).findings if f.code == "KF413"]
    assert len(found) == bool(side)
