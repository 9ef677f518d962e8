"""Designs with one requirement, and what became of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from kinform.consistency import RULES, check
from kinform.consistency.requirements import RequirementRule
from kinform.design import Design
from kinform.mass import compile_mass
from kinform.model.function import Function, Requirement, SimulationRequest
from kinform.simulation import simulate
from support.assemblies import contacts as no_contacts
from support.devices import assembly, body, drive, intended, joint, kinematics, rod
from support.solids import box, part

X, Y, Z, ORIGIN = (1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0), (0, 0, 0)
G = 9.81

CODES = {rule.kind: rule.code for rule in RULES if isinstance(rule, RequirementRule)}
"""By kind of requirement the code of its rule."""


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


def rubbing_arm(effort=0.1):
    """The arm with friction in its shoulder: a journal of 20 mm and a seal."""
    of_seal = {"effort": effort, "static_effort": effort, "coefficient": 0.1, "radius": 0.01}
    return arm(drives=[drive("shoulder", "friction", **of_seal)])


def gimbal(yaw=45.0, pitch=30.0):
    """A yaw about z that carries a pitch about y."""
    joints = [joint("base", "outer", "revolute", Z, ORIGIN), joint("inner", "outer", "revolute", Y, ORIGIN)]
    wanted = [
        intended("yaw", "base", "outer", "revolute", Z, ORIGIN, range=(-math.radians(yaw), math.radians(yaw))),
        intended("pitch", "outer", "inner", "revolute", Y, ORIGIN, range=(-math.radians(pitch), math.radians(pitch))),
    ]
    return design([body("outer"), body("inner")], joints, wanted=wanted)


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


def wheel(law=None, kind="motion", level=None, com=(0.0, 0, 0), duration=1.0, step=0.01):
    """A disc of 2 kg and 0.01 kg·m² about the z axis, driven."""
    turn = joint("base", "disc", "revolute", Z, ORIGIN)
    wanted = [intended("spin", "base", "disc", "revolute", Z, ORIGIN)]
    drives = [] if law is None else [drive("spin", kind, law)]
    parts = [body("disc", 2.0, com, (0.006, 0.006, 0.01))]
    return design(parts, [turn], wanted=wanted, drives=drives, run=True, level=level, duration=duration, step=step)


def circle(rows=101, radius=0.1, amplitude=30.0, shift=0.0, turned=False, last=1.0):
    """Where a point of the wheel is to be."""
    out = []
    for t in np.linspace(0.0, last, rows):
        a = math.radians(amplitude) * math.sin(math.pi * t)
        turn = [math.cos(a / 2), 0.0, 0.0, math.sin(a / 2)] if turned else []
        out.append([float(t), radius * math.cos(a) + shift, radius * math.sin(a), 0.0, *turn])
    return out


def bar(wall, reach=30.0, law=None, **request):
    """A bar of 4 × 40 × 4 mm, from its pivot along y, turning about z beside a wall (mm) of the base."""
    parts = [part("base", wall, np.eye(4)), part("bar", box(-2, 2, 0, 40, -2, 2), np.eye(4))]
    limits = None if reach is None else (-math.radians(reach), math.radians(reach))
    wanted = [intended("swing", "base", "bar", "revolute", Z, ORIGIN, range=limits)]
    drives = [] if law is None else [drive("swing", "motion", law)]
    turn = joint("bar", "base", "revolute", Z, ORIGIN)
    made = design(parts, [turn], wanted=wanted, drives=drives, run=law is not None, **request)
    return made


def wall():
    return box(30, 40, -60, 60, -10, 10)


def thin_wall():
    """A foil in the middle of the swing."""
    return box(-0.025, 0.025, 35, 60, -10, 10)
