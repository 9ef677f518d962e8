"""Each kind of requirement: violated where it should be, met where it should be, and else undecided with a reason."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from assemblies import contacts as no_contacts
from devices import assembly, body, drive, intended, joint, kinematics, rod, sine
from known import FIXTURES
from solids import box, part

from kinform.consistency import RULES, check
from kinform.consistency.rules.kf902_requirement_not_checked import JUDGES
from kinform.mass import compile_mass
from kinform.model.design import Design
from kinform.model.function import Function, Load, Requirement, SimulationRequest
from kinform.model.simulation import Simulation
from kinform.simulation import simulate

X, Y, Z, ORIGIN = (1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0), (0, 0, 0)
G = 9.81

CODES = {
    "reach": "KF421", "follow": "KF422", "clear": "KF423", "hold": "KF424", "torque": "KF425", "speed": "KF426",
    "reaction": "KF427", "mass": "KF428", "centre_of_mass": "KF429", "inertia": "KF430", "balance": "KF431",
    "retained": "KF432", "fit": "KF433",
}  # fmt: skip


def design(parts, joints, *, wanted=(), drives=(), loads=(), run=False, **request):
    """A design of these bodies and joints, simulated if asked."""
    parts = sorted(parts if any(p.name == "base" for p in parts) else [*parts, body("base", mass=None)],
                   key=lambda p: p.name)  # fmt: skip
    function = Function(joints=tuple(wanted), drives=tuple(drives), loads=tuple(loads))
    made = assembly(parts, function, SimulationRequest(**request))
    chain = kinematics(parts, joints)
    mass = compile_mass(made, chain)
    simulation = simulate(made, chain, mass) if run else None
    return Design(made, contacts=no_contacts(), kinematics=chain, mass=mass, simulation=simulation)


def requiring(made, kind, **values):
    """The design with one requirement."""
    function = replace(made.assembly.function, requirements=(Requirement("r", kind, values, "m.toml", 40),))
    return replace(made, assembly=replace(made.assembly, function=function))


def state(made, kind, **values):
    """violated, met or undecided, with the finding, and what the rules say of themselves."""
    report = check(requiring(made, kind, **values))
    outcomes = {rule.code: rule for rule in report.rules}
    fired = [f for f in report.findings if f.code == CODES[kind]]
    doubted = [f for f in report.findings if f.code == "KF902"]
    for finding in (*fired, *doubted):
        assert finding.subject == ("r",)
        assert finding.line == 40
        assert finding.message
        assert finding.remedy
    assert (outcomes["KF902"].outcome == "inconclusive") == bool(doubted)
    if fired:
        assert not doubted
        assert all(f.severity == "error" and f.found and f.intended for f in fired)
        assert outcomes[CODES[kind]].outcome == "failed"
        return "violated", fired[0]
    if doubted:
        assert outcomes[CODES[kind]].outcome == "skipped"
        return "undecided", doubted[0]
    assert outcomes[CODES[kind]].outcome == "passed"
    return "met", outcomes[CODES[kind]]


def arm(shoulder=(-math.pi / 2, math.pi / 2), elbow=(-5 * math.pi / 6, 5 * math.pi / 6), **more):
    """Two rods of 0.3 m along x, of 1 and 0.5 kg, turning about y."""
    joints = [joint("base", "upper", "revolute", Y, ORIGIN), joint("lower", "upper", "revolute", Y, (0.3, 0, 0))]
    # geometry lists lower before upper: the designer has it the other way round
    wanted = [
        intended("shoulder", "base", "upper", "revolute", Y, ORIGIN, range=shoulder),
        intended("elbow", "upper", "lower", "revolute", Y, (0.3, 0, 0), range=elbow),
    ]
    parts = [rod("upper", ORIGIN, (0.3, 0, 0), 1.0), rod("lower", (0.3, 0, 0), (0.6, 0, 0), 0.5)]
    return design(parts, joints, wanted=wanted, **more)


def gimbal(yaw=45.0, pitch=30.0):
    """A yaw about z that carries a pitch about y."""
    joints = [joint("base", "outer", "revolute", Z, ORIGIN), joint("inner", "outer", "revolute", Y, ORIGIN)]
    wanted = [
        intended("yaw", "base", "outer", "revolute", Z, ORIGIN, range=(-math.radians(yaw), math.radians(yaw))),
        intended("pitch", "outer", "inner", "revolute", Y, ORIGIN, range=(-math.radians(pitch), math.radians(pitch))),
    ]
    return design([body("outer"), body("inner")], joints, wanted=wanted)


def wheel(law=None, kind="motion", level=None, com=(0.0, 0, 0), duration=1.0):
    """A disc of 2 kg and 0.01 kg·m² about the z axis, driven."""
    turn = joint("base", "disc", "revolute", Z, ORIGIN)
    wanted = [intended("spin", "base", "disc", "revolute", Z, ORIGIN)]
    drives = [] if law is None else [drive("spin", kind, law)]
    parts = [body("disc", 2.0, com, (0.006, 0.006, 0.01))]
    return design(parts, [turn], wanted=wanted, drives=drives, run=True, level=level, duration=duration, step=0.01)


# --- mass ----------------------------------------------------------------------------------------


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


def test_the_centre_of_mass_of_several_parts():
    middle = (0.15 * 1.0 + 0.45 * 0.5) / 1.5
    made = design([rod("upper", ORIGIN, (0.3, 0, 0), 1.0), rod("lower", (0.3, 0, 0), (0.6, 0, 0), 0.5),
                   body("base", 1e-12)], [])  # fmt: skip
    assert state(made, "centre_of_mass", point=[middle, 0, 0], tolerance=1e-6)[0] == "met"
    found, finding = state(made, "centre_of_mass", point=[middle, 0.002, 0], tolerance=1e-3)
    assert found == "violated"
    assert "2 mm" in finding.message


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
    assert "0.01 kg·m" in finding.found
    assert state(made, "balance", of="disc", axis=list(Z), point=[0.003, 0.004, 0], limit=1e-9)[0] == "met"
    assert state(made, "balance", of="disc", limit=1.0)[0] == "undecided"


# --- simulation ----------------------------------------------------------------------------------


def test_the_peak_speed_of_a_driven_joint():
    # 30° at 0.5 Hz: 30°·π a second
    made = wheel(sine(30.0, 0.5))
    peak = math.radians(30.0) * math.pi
    assert state(made, "speed", joint="spin", limit=1.001 * peak)[0] == "met"
    found, finding = state(made, "speed", joint="spin", limit=0.999 * peak)
    assert found == "violated"
    assert "94.2" in finding.found
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


def test_a_run_that_stopped_proves_only_what_it_saw():
    made = wheel(sine(30.0, 0.5))
    stopped = replace(made, simulation=replace(made.simulation, status="stopped", reason="singular"))
    peak = math.radians(30.0) * math.pi
    assert state(stopped, "speed", joint="spin", limit=0.999 * peak)[0] == "violated"
    assert state(stopped, "speed", joint="spin", limit=1.001 * peak)[0] == "undecided"


@dataclass(frozen=True, eq=False)
class WithReactions(Simulation):
    """A run with reactions."""

    F_A: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 6)))
    undetermined: np.ndarray = field(default_factory=lambda: np.zeros((0, 6), dtype=bool))


def test_the_peak_reaction_of_a_joint():
    made = wheel(sine(30.0, 0.5))
    names = Simulation.__dataclass_fields__
    known = {name: getattr(made.simulation, name) for name in names if name not in ("F_A", "undetermined")}
    wrench = np.zeros((len(made.simulation.time), 1, 6))
    wrench[:, 0, 3:] = (0.0, 3.0, 4.0)
    wrench[7, 0, :3] = (0.0, 0.0, 2.0)
    open_ = np.zeros((1, 6), dtype=bool)
    reacting = replace(made, simulation=WithReactions(**known, F_A=wrench, undetermined=open_))
    assert state(reacting, "reaction", joint="spin", force=5.01, torque=2.01)[0] == "met"
    assert state(reacting, "reaction", joint="spin", force=4.99)[0] == "violated"
    found, finding = state(reacting, "reaction", joint="spin", torque=1.99)
    assert found == "violated"
    assert "t = 0.07 s" in finding.message
    open_ = np.array([[False, False, False, True, False, False]])
    doubtful = replace(made, simulation=WithReactions(**known, F_A=wrench, undetermined=open_))
    assert state(doubtful, "reaction", joint="spin", force=100.0)[0] == "undecided"
    assert state(doubtful, "reaction", joint="spin", torque=2.01)[0] == "met"
    assert state(replace(made, simulation=Simulation(**known)), "reaction", joint="spin", force=1.0)[0] == "undecided"


def circle(rows=101, radius=0.1, amplitude=30.0, shift=0.0, turned=False, last=1.0):
    """Where a point of the wheel is to be."""
    out = []
    for t in np.linspace(0.0, last, rows):
        a = math.radians(amplitude) * math.sin(math.pi * t)
        turn = [math.cos(a / 2), 0.0, 0.0, math.sin(a / 2)] if turned else []
        out.append([float(t), radius * math.cos(a) + shift, radius * math.sin(a), 0.0, *turn])
    return out


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


# --- statics -------------------------------------------------------------------------------------


def test_the_torque_that_holds_an_arm_against_gravity():
    made, torque = arm(), G * (1.0 * 0.15 + 0.5 * 0.45)
    assert state(made, "hold", joint="shoulder", limit=1.0001 * torque)[0] == "met"
    assert state(made, "hold", joint="shoulder", limit=0.9999 * torque)[0] == "violated"
    assert state(made, "hold", joint="elbow", limit=1.0001 * G * 0.5 * 0.15)[0] == "met"
    assert state(made, "hold", joint="elbow", limit=0.9999 * G * 0.5 * 0.15)[0] == "violated"


@pytest.mark.parametrize("sign", [1, -1])
def test_poses_are_in_the_designers_sign(sign):
    # elbow bent by 90°: the forearm hangs below or stands above its joint
    bent = {"shoulder": 0.0, "elbow": sign * math.pi / 2}
    torque = G * (1.0 * 0.15 + 0.5 * 0.3)
    assert state(arm(), "hold", joint="shoulder", limit=1.0001 * torque, poses=[bent])[0] == "met"
    # shoulder by 30° and elbow by −30°·sign: only one sign makes the forearm level
    tilted = {"shoulder": math.radians(30), "elbow": -sign * math.radians(30)}
    lever = 0.3 * math.cos(math.radians(30))
    level = G * (0.15 * math.cos(math.radians(30)) + 0.5 * (lever + 0.15))
    other = G * (0.15 * math.cos(math.radians(30)) + 0.5 * (lever + 0.15 * math.cos(math.radians(60))))
    exact = level if sign == 1 else other
    assert state(arm(), "hold", joint="shoulder", limit=exact + 1e-6, poses=[tilted])[0] == "met"
    assert state(arm(), "hold", joint="shoulder", limit=exact - 1e-6, poses=[tilted])[0] == "violated"


def test_loads_and_springs_take_part_in_holding():
    load = Load("lower", np.array([0, 0, -10.0]), None, np.array([0.6, 0, 0]), "world", "m.toml", 1)
    torque = G * (1.0 * 0.15 + 0.5 * 0.45) + 10.0 * 0.6
    assert state(arm(loads=[load]), "hold", joint="shoulder", limit=torque + 1e-6)[0] == "met"
    assert state(arm(loads=[load]), "hold", joint="shoulder", limit=torque - 1e-6)[0] == "violated"
    # gravity turns the arm down, about +y: a spring at rest 0.5 rad above holds 2 N·m of it
    spring = drive("shoulder", "spring", stiffness=4.0, rest=math.degrees(-0.5))
    left = G * (1.0 * 0.15 + 0.5 * 0.45) - 2.0
    assert state(arm(drives=[spring]), "hold", joint="shoulder", limit=left + 1e-6)[0] == "met"
    assert state(arm(drives=[spring]), "hold", joint="shoulder", limit=left - 1e-6)[0] == "violated"


def parallelogram(range_=None):
    """Two cranks of 0.1 m along z, 0.3 m apart, and a coupler of 2 kg; all turns about y."""
    A, B, C, D = ORIGIN, (0.3, 0, 0), (0.0, 0, 0.1), (0.3, 0, 0.1)
    joints = [
        joint("base", "crank", "revolute", Y, A), joint("base", "rocker", "revolute", Y, B),
        joint("coupler", "crank", "revolute", Y, C), joint("coupler", "rocker", "revolute", Y, D),
    ]  # fmt: skip
    wanted = [intended("drive", "base", "crank", "revolute", Y, A, range=range_)]
    parts = [body("crank", 1e-12, A, np.eye(3) * 1e-12), body("rocker", 1e-12, B, np.eye(3) * 1e-12),
             body("coupler", 2.0, (0.15, 0, 0.1), np.eye(3) * 1e-3)]  # fmt: skip
    return design(parts, joints, wanted=wanted)


def test_a_loop_is_held_by_its_one_drive():
    # at 30° from the vertical the coupler, which does not turn, pulls 2·g·0.1·sin 30°
    pose, torque = {"drive": math.radians(30)}, 2.0 * G * 0.1 * 0.5
    assert state(parallelogram(), "hold", joint="drive", limit=torque + 1e-6, poses=[pose])[0] == "met"
    assert state(parallelogram(), "hold", joint="drive", limit=torque - 1e-6, poses=[pose])[0] == "violated"


def test_what_an_unknown_mass_leaves_open():
    made = arm()
    parts = tuple(replace(p, override=None) if p.name == "lower" else p for p in made.assembly.parts)
    model = replace(made.assembly, parts=parts)
    made = replace(made, assembly=model, mass=compile_mass(model, made.kinematics))
    found, finding = state(made, "hold", joint="shoulder", limit=100.0)
    assert found == "undecided"
    assert "'lower'" in finding.message


# --- reach ---------------------------------------------------------------------------------------


def places(*points):
    return {"type": "poses", "points": [list(p) for p in points]}


def test_an_arm_reaches_what_its_links_and_ranges_allow():
    tip = {"part": "lower", "point": [0.6, 0, 0], "tolerance": 1e-4}
    assert state(arm(), "reach", region=places((0.6, 0, 0), (0.3, 0, 0.3), (0.2, 0, -0.1)), **tip)[0] == "met"
    found, finding = state(arm(), "reach", region=places((0.7, 0, 0)), **tip)
    assert found == "violated"
    assert "100 mm off" in finding.message
    # folded by 150° the tip stays 2·0.3·sin 15° away from the shoulder
    found, finding = state(arm(), "reach", region=places((0.1, 0, 0)), **tip)
    assert found == "violated"
    assert f"{1e3 * (0.6 * math.sin(math.radians(15)) - 0.1):.4g} mm off" in finding.message
    # out of the plane of the arm
    assert state(arm(), "reach", region=places((0.5, 0.01, 0)), **tip)[0] == "violated"


def test_a_box_is_covered_or_not():
    region = {"type": "box", "lower": [0.2, 0, -0.1], "upper": [0.35, 0, 0.1], "X_WF": np.eye(4).tolist()}
    tip = {"part": "lower", "point": [0.6, 0, 0]}
    found, outcome = state(arm(), "reach", region=region, **tip)
    assert found == "met"
    assert "can be missed" in outcome.reason
    assert state(arm(), "reach", region=region | {"upper": [0.7, 0, 0.1]}, **tip)[0] == "violated"


def test_a_pointing_direction_covers_a_cone():
    cone = {"type": "cone", "axis": [1, 0, 0], "half_angle": math.radians(30)}
    pointing = {"part": "inner", "direction": [1.0, 0, 0]}
    assert state(gimbal(), "reach", region=cone, **pointing)[0] == "met"
    found, finding = state(gimbal(), "reach", region=cone | {"half_angle": math.radians(40)}, **pointing)
    assert found == "violated"
    assert "10° off at most" in finding.found
    assert state(gimbal(yaw=25.0), "reach", region=cone, **pointing)[0] == "violated"
    assert state(gimbal(), "reach", region=cone, part="inner", point=[1.0, 0, 0])[0] == "undecided"


def test_a_yes_needs_ranges_and_a_no_does_not():
    made = arm(shoulder=None)
    tip = {"part": "lower", "point": [0.6, 0, 0]}
    found, finding = state(made, "reach", region=places((0.6, 0, 0)), **tip)
    assert found == "undecided"
    assert "base~upper" in finding.message
    assert state(made, "reach", region=places((0.7, 0, 0)), **tip)[0] == "violated"


def test_reach_along_a_closed_loop_is_decided_by_the_range_of_the_crank():
    on = lambda degrees: (0.15 + 0.1 * math.sin(math.radians(degrees)), 0, 0.1 * math.cos(math.radians(degrees)))
    middle = {"part": "coupler", "point": [0.15, 0, 0.1], "tolerance": 1e-5}
    made = parallelogram((-math.pi / 3, math.pi / 3))
    assert state(made, "reach", region=places(on(0), on(-50), on(59)), **middle)[0] == "met"
    assert state(made, "reach", region=places(on(65)), **middle)[0] == "violated"
    # the middle of the circle
    assert state(made, "reach", region=places((0.15, 0, 0.0)), **middle)[0] == "violated"
    assert state(parallelogram(), "reach", region=places(on(50)), **middle)[0] == "undecided"


# --- clearances ----------------------------------------------------------------------------------


def bar(wall, reach=30.0, law=None, **request):
    """A bar of 4 × 40 × 4 mm, from its pivot along y, turning about z beside a wall (mm) of the base."""
    parts = [part("base", wall, np.eye(4)), part("bar", box(-2, 2, 0, 40, -2, 2), np.eye(4))]
    limits = None if reach is None else (-math.radians(reach), math.radians(reach))
    wanted = [intended("swing", "base", "bar", "revolute", Z, ORIGIN, range=limits)]
    drives = [] if law is None else [drive("swing", "motion", law)]
    turn = joint("bar", "base", "revolute", Z, ORIGIN)
    made = design(parts, [turn], wanted=wanted, drives=drives, run=law is not None, **request)
    return made


WALL = box(30, 40, -60, 60, -10, 10)
THIN = box(-0.025, 0.025, 35, 60, -10, 10)
"""A foil in the middle of the swing."""


def nearest(degrees):
    """Gap (m) between the corner of the bar and the wall."""
    a = math.radians(degrees)
    return 1e-3 * (30 - (2 * math.cos(a) + 40 * math.sin(a)))


def test_the_clearance_over_a_range():
    between = {"between": ["bar", "base"], "over": "ranges"}
    assert state(bar(WALL), "clear", distance=nearest(30) - 2e-5, **between)[0] == "met"
    assert state(bar(WALL), "clear", distance=nearest(30) + 2e-5, **between)[0] == "violated"
    assert state(bar(WALL, reach=60), "clear", distance=0.0, **between)[0] == "violated"
    assert state(bar(WALL, reach=40), "clear", distance=0.0, **between)[0] == "met"
    assert state(bar(WALL, reach=None), "clear", distance=0.0, **between)[0] == "undecided"


def test_the_clearance_along_a_motion_and_where_it_is_lost():
    swing = lambda amplitude: bar(WALL, law=sine(amplitude, 1.0), duration=1.0, step=0.05, level="kinematic")
    between = {"between": ["bar", "base"]}
    assert state(swing(30.0), "clear", distance=nearest(30) - 2e-5, **between)[0] == "met"
    found, finding = state(swing(30.0), "clear", distance=nearest(30) + 2e-5, **between)
    assert found == "violated"
    assert "mm" in finding.found
    found, finding = state(swing(60.0), "clear", **between)
    assert found == "violated"
    assert finding.found == "collision"
    assert 0.02 < finding.place[0] < 0.045
    assert state(swing(60.0), "clear")[0] == "violated"


def test_no_thin_wall_is_jumped_over():
    # samples 120° apart, on either side of a foil of 0.05 mm
    law = sine(60.0, 1.0, phase=-90.0)
    made = bar(THIN, law=law, duration=0.5, step=0.5, level="kinematic")
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


def test_no_part_of_the_seeker_collides_and_a_twin_that_overlaps_does(derive_design):
    sound = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    assert state(sound, "clear", between=["base", "outer"])[0] == "met"
    wrong = derive_design(FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml")
    wrong = replace(wrong, simulation=simulate(wrong.assembly, wrong.kinematics, wrong.mass, level="kinematic"))
    found, finding = state(wrong, "clear", between=["outer_gimbal", "housing"])
    assert found == "violated"
    assert "at t = 0 s" in finding.message


# --- contacts ------------------------------------------------------------------------------------


def fixture(derive_design, name):
    return derive_design(FIXTURES / "pairs" / name / f"{name}.toml")


def test_the_radial_clearance_of_a_shaft(derive_design):
    made = fixture(derive_design, "cylindrical_gap_015")
    fit = {"between": ["shaft", "block"]}
    assert state(made, "fit", minimum=0.14e-3, maximum=0.16e-3, **fit)[0] == "met"
    assert state(made, "fit", minimum=0.16e-3, **fit)[0] == "violated"
    found, finding = state(made, "fit", maximum=0.1e-3, **fit)
    assert found == "violated"
    assert "0.15 mm" in finding.found
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


def test_what_can_leave_is_not_retained(derive_design):
    assert state(fixture(derive_design, "revolute_collars"), "retained", part="shaft")[0] == "met"
    table = fixture(derive_design, "general_ball_on_table")
    ball = next(p.name for p in table.assembly.parts if p.name != table.assembly.ground)
    found, finding = state(table, "retained", part=ball)
    assert found == "violated"
    assert "lift off along +z" in finding.message
    # it rolls away sideways too, and nothing says where that ends
    assert state(table, "retained", part=ball, directions=[[0, 0, 1.0]])[0] == "undecided"
    socket = fixture(derive_design, "spherical_open")
    assert state(socket, "retained", part="ball")[0] == "violated"
    assert state(socket, "retained", part="ball", directions=[[0, 0, -1.0]])[0] == "violated"
    assert state(socket, "retained", part="ball", directions=[[0, 0, 1.0]])[0] == "met"
    assert state(fixture(derive_design, "spherical_captive"), "retained", part="ball")[0] == "met"
    apart = fixture(derive_design, "free_apart")
    loose = next(b.name for b in apart.kinematics.bodies if not b.ground)
    assert state(apart, "retained", part=loose)[0] == "violated"


def test_a_slide_with_stops_holds_its_part(derive_design):
    made = fixture(derive_design, "prismatic_drawer")
    assert state(made, "retained", part="drawer")[0] == "undecided"

    def ranged(**found):
        (joint,) = made.kinematics.joints
        return replace(made, kinematics=replace(made.kinematics, joints=(replace(joint, **found),)))

    stopped = ranged(range_lower=-0.01, range_upper=0.02, range_status="found")
    assert state(stopped, "retained", part="drawer")[0] == "met"
    open_ = ranged(range_status="unbounded")
    assert state(open_, "retained", part="drawer")[0] == "violated"
    both = [[0, 0, 1.0], [0, 0, -1.0]]
    assert state(open_, "retained", part="drawer", directions=both)[0] == "met"


def test_answers_do_not_depend_on_the_order_of_parts(derive_design):
    made = requiring(bar(WALL, reach=60), "clear", between=["bar", "base"], over="ranges")
    turned = replace(made, assembly=replace(made.assembly, parts=made.assembly.parts[::-1]))
    assert check(made).findings == check(turned).findings


# --- the table -----------------------------------------------------------------------------------


def test_every_kind_of_requirement_has_a_rule_of_its_own():
    from typing import get_args

    from kinform.form.schema.require import Require

    union = get_args(Require)[0]
    kinds = {get_args(kind.model_fields["kind"].annotation)[0] for kind in get_args(union)}
    assert kinds == set(CODES) == set(JUDGES)
    assert set(CODES.values()) <= {rule.code for rule in RULES}


def test_a_smooth_peak_between_output_times_is_not_passed():
    made = wheel(sine(30.0, 0.5))
    # as if the output times lay half a step beside the peak
    run = made.simulation
    step = float(run.time[1])
    shifted = np.sin(math.pi * (run.time + 0.5 * step)) * math.radians(30.0) * math.pi
    coarse = replace(made, simulation=replace(run, joint_velocity=shifted[:, None]))
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
    jumped = replace(made, simulation=replace(run, joint_velocity=jumping))
    assert state(jumped, "speed", joint="spin", limit=1.001)[0] == "met"
