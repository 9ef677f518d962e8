"""What acts on shafts in a VHDL-AMS system: instances, and the quantities and terminals between them.

Drives, springs, dampers and motors read the value of a joint's coordinate and give an effort; the efforts on a
coordinate sum to the joint's. A motor has an electric terminal, at which its supply is; a controller reads a target.
"""

from __future__ import annotations

import math

from kinform.behaviour import Damper, DcMotor, EffortDrive, MotionDrive, Servo, Spring, VoltageController
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import Constant, Ramp, Signal, Sine, Spline, Table, smooth
from kinform.exports.laws import pieces
from kinform.exports.loops import Loops
from kinform.exports.scopes import Scope
from kinform.exports.text import number
from kinform.exports.vhdl_structure import Part, Writer

__all__ = ["drives"]

Values = dict[str, str]
"""Generics by name, as text."""


def drives(writer: Writer, found: Loops, held: frozenset[int], lost: list[str], remarks: list[str]) -> None:
    """Add what acts on joints, what holds rates, and gears."""
    model, system = writer.model, writer.model.system
    slots = {slot.name: slot for slot in model.mechanism.slots}
    for joint in system.joints:
        label, home, led = writer.names[joint.name], writer.scopes.of[joint.name], False
        for actor in system.actors(joint.name):
            name, value = writer.names[actor.name], f"{label}_{joint.kind.coordinates[0][0]}"
            if isinstance(actor, MotionDrive):
                if led:
                    lost.append(f"{actor.subject}: a second drive prescribes the motion of {joint.subject}")
                    continue
                led = True
                signal = smooth(actor.signal) if model.with_forces else actor.signal
                _on_shaft(writer, home, name, actor.subject, value, *_law(writer, "motion", name, signal))
            elif isinstance(actor, EffortDrive):
                _on_shaft(writer, home, name, actor.subject, value, *_law(writer, "effort", name, actor.signal))
            elif isinstance(actor, Spring):
                given = {"stiffness": number(actor.stiffness), "rest": number(actor.rest)}
                _on_shaft(writer, home, name, actor.subject, value, "spring", given)
            elif isinstance(actor, Damper):
                _on_shaft(writer, home, name, actor.subject, value, "damper", {"damping": number(actor.damping)})
            elif isinstance(actor, Servo):
                ports = {"target": _target(writer, home, name, actor.subject, actor.target)}
                _on_shaft(writer, home, name, actor.subject, value, "servo", _gains(actor.controller), ports)
            elif isinstance(actor, DcMotor):
                _motor(writer, home, name, actor, value)
        for k, (coordinate, _) in enumerate(joint.kind.coordinates):
            if slots[joint.subject].v.start + k in held and joint.kind.name != "spherical":
                value = f"{label}_{coordinate}"
                level = {"level": number(float(model.coordinates(joint.subject)[0][k]))}
                _on_shaft(writer, home, f"{value}_held", f"{joint.subject} is held", value, "motion_constant", level)
    for gear, kept in zip(system.gears, found.gears, strict=True):
        if not kept:
            remarks.append(f"{gear.subject}: it is redundant with the loops")
            continue
        _gear(writer, gear.name, gear.ratio)


def _on_shaft(
    writer: Writer, home: Scope, name: str, text: str, value: str, entity: str, given: Values,
    ports: dict[str, str] | None = None,
) -> None:  # fmt: skip
    """An actor on a coordinate: it reads the value and gives an effort."""
    writer.of[home].declarations.append(f"quantity {name}_effort : real")
    writer.efforts[f"{value}_effort"][1].append(f"{name}_effort")
    joined = {**(ports or {}), "value": value, "effort": f"{name}_effort"}
    _instance(writer, home, name, entity, text, given, joined)


def _instance(
    writer: Writer, home: Scope, name: str, entity: str, text: str, given: Values, ports: dict[str, str]
) -> None:
    generics = {key: writer.generic(home, f"{name}_{key}", "real", value) for key, value in given.items()}
    writer.add(home, Part(f"{name}_i", entity, text, generics, ports))


def _target(writer: Writer, home: Scope, name: str, text: str, signal: Signal) -> str:
    """The quantity that a controller follows."""
    target = f"{name}_target"
    writer.of[home].declarations.append(f"quantity {target} : real")
    entity, given = _law(writer, "target", target, signal)
    _instance(writer, home, target, entity, f"target of {text}", given, {"target": target})
    return target


def _gains(controller: Controller) -> Values:
    bound = number(controller.limit) if math.isfinite(controller.limit) else "unlimited"
    return {
        "kp": number(controller.kp), "ki": number(controller.ki), "kd": number(controller.kd), "bound": bound,
    }  # fmt: skip


def _motor(writer: Writer, home: Scope, name: str, motor: DcMotor, value: str) -> None:
    """A motor, and at its terminal what supplies it."""
    writer.of[home].declarations.append(f"terminal {name}_p : electrical")
    writer.potentials += 1
    given = {key: number(getattr(motor, key)) for key in ("resistance", "inductance", "gear")}
    given["coupling"] = number(motor.constant)
    _on_shaft(writer, home, name, motor.subject, value, "dc_motor", given, {"p": f"{name}_p"})
    supply = writer.model.system.supply(motor.name)
    label, at = f"{name}_supply", {"p": f"{name}_p"}
    if isinstance(supply, VoltageController):
        at |= {"target": _target(writer, home, name, supply.subject, supply.target), "value": value}
        _instance(writer, home, label, "voltage_controller", supply.subject, _gains(supply.controller), at)
        return
    entity, given = _law(writer, "voltage", label, supply.signal)
    _instance(writer, home, label, entity, f"voltage of {supply.subject}", given, at)


def _gear(writer: Writer, name: str, ratio: float) -> None:
    """A gear in the innermost scope around both joints: their values come up to it, its efforts go down."""
    system, top, label = writer.model.system, writer.scopes.of[name], writer.names[name]
    ports: dict[str, str] = {}
    for port in "ab":
        joint = system.joint_at(name, port)
        home = writer.scopes.of[joint.name]
        value, effort = f"{writer.names[joint.name]}_{joint.kind.coordinates[0][0]}", f"{label}_{port}_effort"
        writer.pass_up(value, home, top)
        writer.pass_down(effort, top, home)
        writer.efforts[f"{value}_effort"][1].append(effort)
        ports |= {f"{port}_value": value, f"{port}_effort": effort}
    generics = {"ratio": writer.generic(top, f"{label}_ratio", "real", number(ratio))}
    writer.add(top, Part(label, "gear", name, generics, ports))


def _law(writer: Writer, kind: str, name: str, signal: Signal) -> tuple[str, Values]:
    """The entity of a law and its generics; a table gets an entity of its own. Kinds: see the template."""
    if isinstance(signal, Constant):
        return f"{kind}_constant", {"level": number(signal.level)}
    if isinstance(signal, Ramp):
        return f"{kind}_ramp", {"offset": number(signal.offset), "slope": number(signal.slope)}
    if isinstance(signal, Sine):
        keys = ("offset", "amplitude", "speed", "phase")
        return f"{kind}_sine", {key: number(getattr(signal, key)) for key in keys}
    assert isinstance(signal, Table | Spline)
    entity = f"table_{name}"
    writer.tables.append({"name": entity, "kind": kind, "pieces": pieces(signal)})
    return entity, {}
