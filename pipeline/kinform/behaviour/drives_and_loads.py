"""Drives, gears and loads as components, or why they cannot be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from string import ascii_lowercase

import numpy as np

from kinform.behaviour.components import (
    Bushing,
    Elastic,
    GasSpring,
    Gear,
    JointComponent,
    LoadComponent,
    SpringDamper,
)
from kinform.behaviour.ports import Component
from kinform.behaviour.shafts import (
    Controller,
    Damper,
    DcMotor,
    EffortDrive,
    Friction,
    MotionDrive,
    Servo,
    Spring,
    VoltageController,
    VoltageSource,
    rubbing_back,
)
from kinform.behaviour.signals import STEADY, Constant, Signal, signal
from kinform.behaviour.sliding import Sliding
from kinform.frozen import dataclass
from kinform.function import FREEDOMS, acted_freedom
from kinform.model.assembly import Assembly
from kinform.model.function import Coupling, Drive, Load
from kinform.model.kinematics import Coupling as Found
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.springs import BUSHING, GAS_SPRING, StatedSpring

Joints = Mapping[str, JointComponent]


@dataclass(frozen=True)
class OneFreedom:
    """One freedom of a joint of the port model."""

    joint: JointComponent
    freedom: int
    """Which of its rates, and of its coordinates where it has as many."""
    sign: int
    """Designer's value = sign · kinform's."""

    @property
    def turns(self) -> bool:
        """Whether its values are angles."""
        return self.joint.kind.coordinates[self.freedom][1]

    @property
    def valued(self) -> bool:
        """Whether it has values: a ball's turns have rates alone."""
        return len(self.joint.kind.coordinates) == self.joint.kind.rates

    @property
    def fields(self) -> dict[str, int]:
        """Those of what acts on it."""
        return {"freedom": self.freedom, "rates": self.joint.kind.rates}


def one_freedom(
    assembly: Assembly, kinematics: Kinematics, joints: Joints, name: str, freedom: str = ""
) -> OneFreedom | str:
    """The freedom that the name of a joint, and of one of several freedoms, stand for; or why there is none."""
    meant = acted_freedom(assembly, kinematics, name, freedom)
    if meant.joint is None:
        return meant.reason
    component = joints.get(meant.joint.name)
    if component is None:
        return f'the joint "{meant.joint.name}" is {meant.joint.type} and {meant.joint.status}'
    return meant.reason if meant.freedom is None else OneFreedom(component, meant.freedom, meant.sign)


def make_drive(
    assembly: Assembly,
    kinematics: Kinematics,
    joints: Joints,
    drive: Drive,
    number: int,
    sliding: Mapping[str, Sliding],
) -> tuple[tuple[Component, ...], str, str, bool]:
    """(components, joint, why there are none, whether they would act by force only)."""
    by_force = drive.kind != "motion"
    on = one_freedom(assembly, kinematics, joints, drive.joint, drive.freedom)
    if isinstance(on, str):
        return (), "", on, False
    try:
        return _actors(drive, on, f"drive {number} {drive.joint}", sliding), on.joint.subject, "", by_force
    except ValueError as error:
        return (), on.joint.subject, f"{drive.kind} drive: {error}", by_force


def _actors(drive: Drive, on: OneFreedom, name: str, found: Mapping[str, Sliding]) -> tuple[Component, ...]:
    """The drive on the shaft first, then what supplies it. Raises ValueError with what is missing."""
    sign, scale, at = on.sign, drive.scale(on.turns), on.fields
    if not on.valued and drive.kind not in ("effort", "damper"):
        raise ValueError("a ball's turn about one direction has a rate and no value: efforts and dampers can act on it")
    if drive.kind == "motion":
        return (MotionDrive(name, drive.joint, _signal(drive, sign * scale), **at),)
    if drive.kind == "effort":
        return (EffortDrive(name, drive.joint, _signal(drive, float(sign)), **at),)
    if drive.kind == "spring":
        rest = sign * scale * drive.parameters.get("rest", 0.0)
        return (Spring(name, drive.joint, _number(drive, "stiffness"), rest, **at),)
    if drive.kind == "damper":
        return (Damper(name, drive.joint, _number(drive, "damping"), **at),)
    if drive.kind == "friction":
        return (_friction(drive, on, name, found),)
    if drive.kind == "servo":
        return (Servo(name, drive.joint, _signal(drive, sign * scale), _controller(drive, on.turns), **at),)
    if drive.kind == "dc_motor":
        return _motor(drive, on, name)
    raise ValueError("this kind is not simulated")


def _friction(drive: Drive, on: OneFreedom, name: str, found: Mapping[str, Sliding]) -> Friction:
    """Friction as stated, with what contact says where nothing is."""
    stated, joint = drive.parameters, on.joint
    sliding = found.get(joint.subject, Sliding())
    kinetic, static = stated.get("coefficient"), stated.get("static")
    effort = stated.get("effort", 0.0)
    rest = stated.get("static_effort", effort)
    if kinetic is None and static is None and "effort" not in stated and "static_effort" not in stated:
        kinetic, static = sliding.coefficients()
    kinetic = kinetic if kinetic is not None else static if static is not None else 0.0
    static = kinetic if static is None else static
    if static < kinetic or rest < effort:
        raise ValueError("friction at rest cannot be less than that in motion")
    least = bool(stated.get("least_reactions", 0.0))
    rates = joint.kind.rates
    friction = Friction(name, drive.joint, kinetic, static, effort, rest, least=least, freedom=on.freedom, rates=rates)
    if static == 0.0:
        return friction
    freedom = FREEDOMS[joint.kind.name][on.freedom]
    rubs = sliding.stated(drive, joint.kind.name, freedom)
    return replace(friction, **rubs.levers(joint.kind, joint.geometry, on.freedom))


def _signal(drive: Drive, scale: float) -> Signal:
    if drive.law is None:
        raise ValueError("it has no law")
    return signal(drive.law, scale)


def _motor(drive: Drive, on: OneFreedom, name: str) -> tuple[Component, ...]:
    """The motor and the source of its voltage, or its controller; both have the designer's sense."""
    sign = on.sign
    resistance, constant = _number(drive, "resistance"), _number(drive, "constant")
    inductance, gear = _number(drive, "inductance", 0.0), _number(drive, "gear", 1.0)
    if resistance <= 0.0 or inductance < 0.0:
        raise ValueError("its resistance must be positive, its inductance not negative")
    limit = _number(drive, "current_limit") if "current_limit" in drive.parameters else math.inf
    motor = DcMotor(name, drive.joint, resistance, inductance, constant, gear, limit, *_rotor(drive), **on.fields)
    if "kp" in drive.parameters or "position_gain" in drive.parameters:
        if not on.valued:
            raise ValueError("a ball's turn about one direction has a rate and no value to be controlled")
        target = _signal(drive, sign * drive.scale(on.turns))
        control = _controller(drive, on.turns)
        return motor, VoltageController(f"controller of {name}", drive.joint, target, control, **on.fields)
    voltage = signal(drive.law, float(sign)) if drive.law is not None else Constant(sign * _number(drive, "voltage"))
    return motor, VoltageSource(f"voltage of {name}", drive.joint, voltage)


def _rotor(drive: Drive) -> tuple[float, float, float, float]:
    """Inertia and friction of a motor's rotor, efficiency of its gear and back."""
    efficiency = _number(drive, "efficiency", 1.0)
    inertia, friction = _number(drive, "rotor_inertia", 0.0), _number(drive, "rotor_friction", 0.0)
    return inertia, friction, efficiency, _number(drive, "efficiency_back", rubbing_back(efficiency))


def _controller(drive: Drive, turns: bool) -> Controller:
    """The controller; its limit of speed is in degrees or lengths of the manifest a second."""
    limit = _number(drive, "limit") if "limit" in drive.parameters else math.inf
    if "position_gain" in drive.parameters:
        kp, ki, kd = (_number(drive, key, 0.0) for key in ("position_gain", "speed_integral", "speed_gain"))
        return Controller(kp, ki, kd, limit, drive.scale(turns) * _number(drive, "speed_limit"))
    return Controller(_number(drive, "kp"), _number(drive, "ki", 0.0), _number(drive, "kd", 0.0), limit)


def _number(drive: Drive, key: str, default: float | None = None) -> float:
    value = drive.parameters.get(key, default)
    if value is None or not math.isfinite(value):
        raise ValueError(f"its {key} is not stated")
    return value


def make_gear(
    assembly: Assembly, kinematics: Kinematics, joints: Joints, coupling: Coupling, number: int
) -> tuple[Gear | None, dict[str, str], str]:
    """(component, the joint at each of its ports, why not)."""
    sides = []
    for name in coupling.every:
        side = one_freedom(assembly, kinematics, joints, name)
        if isinstance(side, str):
            return None, {}, side
        if side.joint.kind.rates != 1:
            kind = side.joint.kind
            why = f'the joint "{side.joint.subject}" is {kind.name}: it has {kind.rates} freedoms, not one'
            return None, {}, why
        sides.append(side)
    of_joints = (coupling.ratio, *coupling.others.values())
    ratio, *others = (sides[0].sign * side.sign * float(one) for side, one in zip(sides[1:], of_joints, strict=True))
    if not all(math.isfinite(one) for one in (ratio, *others)):
        return None, {}, "its ratio is not a number"
    name = " ".join([f"gear {number}", *coupling.every])
    more = dict(zip(ascii_lowercase[2:], others, strict=False))
    shares = coupling.efficiency, coupling.efficiency_back
    gear = Gear(name, name, ratio, None, None, None, -math.inf, math.inf, more, *shares)
    return gear, {port.name: side.joint.subject for port, side in zip(gear.ports, sides, strict=True)}, ""


def mesh_gear(coupling: Found, joints: Joints) -> Gear | str:
    """The gear that teeth of constant ratio make between two joints, or why there is none."""
    tied = " and ".join(coupling.joints)
    if coupling.meshing is None:
        why = coupling.reason or "a section across the contact does not show teeth on both sides"
        return f"the contact couples {tied}, in a ratio that is known at this pose only: {why}"
    if coupling.status != "determined":
        return f"the contact couples {tied}, and is {coupling.status}"
    missing = [name for name in coupling.joints if name not in joints or joints[name].kind.rates != 1]
    if missing:
        return f"the contact couples {tied}, and {missing[0]} is not simulated"
    teeth = coupling.meshing
    flank, back = teeth.normals
    return Gear(f"gear {coupling.through}", coupling.through, teeth.ratio, teeth.place, flank, back, *teeth.reach)


def make_load(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, load: Load, number: int
) -> tuple[LoadComponent | None, str, str]:
    """(component, body, why not)."""
    try:
        parts = assembly.parts_of(load.part)
    except KeyError:
        return None, "", f'a load acts on "{load.part}", which is no part or group'
    body = kinematics.body_of(parts[0]).name
    point = load.point
    if point is None:
        known = [p for p in (() if mass is None else mass.parts) if p.name in parts]
        whole = sum(p.mass or 0.0 for p in known)
        if len(known) < len(parts) or any(p.mass is None for p in known) or not whole > 0.0:
            return None, "", "a load acts at its centre of mass, which is not known"
        point = np.sum([(p.mass or 0.0) * p.centre_of_mass for p in known], axis=0) / whole
    force = np.zeros(3) if load.force is None else load.force
    torque = np.zeros(3) if load.torque is None else load.torque
    if not np.all(np.isfinite(np.concatenate([force, torque, point]))):
        return None, "", "a load on it contains a value that is not a number"
    try:
        factor = STEADY if load.law is None else signal(load.law, 1.0)
    except ValueError as error:
        return None, "", f"a load on it: {error}"
    name = f"load {number} {load.part}"
    return LoadComponent(name, load.part, force, torque, point, load.frame == "body", factor), body, ""


def make_spring(
    assembly: Assembly, kinematics: Kinematics, stated: StatedSpring, number: int
) -> tuple[Elastic | None, tuple[str, str], str]:
    """(component, bodies of its two ends, why not)."""
    try:
        first, second = (str(kinematics.body_of(assembly.parts_of(name)[0]).name) for name in stated.between)
    except KeyError as error:
        return None, ("", ""), f"{error} is no part or group"
    if first == second:
        return None, ("", ""), f"{' and '.join(stated.between)} are parts of one body: it does nothing"
    name, numbers = f"{stated.kind.replace('_', ' ')} {number} {stated.name}", stated.parameters
    at = (name, stated.name, stated.point, stated.other)
    made: Elastic
    if stated.kind == BUSHING:
        assert stated.axes is not None
        keys = ("stiffness", "torsion", "damping", "torsion_damping")
        made = Bushing(*at, stated.axes, *(np.array([numbers[f"{key}_{axis}"] for axis in "xyz"]) for key in keys))
    elif "exponent" in numbers:
        made = GasSpring(*at, *(numbers[key] for key in ("force", "extended", "column", "exponent", "damping")))
    elif stated.kind == GAS_SPRING:
        stiffness = numbers["stiffness"]
        made = SpringDamper(*at, stiffness, numbers["damping"], numbers["extended"] + numbers["force"] / stiffness)
    else:
        made = SpringDamper(*at, *(numbers[key] for key in ("stiffness", "damping", "rest")))
    return made, (first, second), ""
