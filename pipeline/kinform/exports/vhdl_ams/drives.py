"""What acts on shafts in a VHDL-AMS system: instances, and the quantities and terminals between them.

Drives, springs, dampers and motors read the value of a joint's coordinate and give an effort; the efforts on a
coordinate sum to the joint's. A motor has an electric terminal, at which its supply is; a controller reads a target.
"""

from __future__ import annotations

import math

from kinform.behaviour import Actor, Damper, DcMotor, EffortDrive, Gear, MotionDrive, Servo, Spring, VoltageController
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import Signal, Spline, Table
from kinform.exports.equations import law_numbers, polynomials
from kinform.exports.text import number
from kinform.exports.vhdl_ams.structure import Part, Scope, Writer
from kinform.frozen import dataclass

Values = dict[str, str]
"""Generics by name, as text."""


@dataclass(frozen=True)
class _Shaft:
    """Where an actor acts: a coordinate of a joint, in the scope of the joint."""

    writer: Writer
    home: Scope
    value: str
    """The quantity with the value of the coordinate."""

    def instance(self, name: str, entity: str, text: str, values: Values, ports: dict[str, str]) -> None:
        """Add an instance, the values its generics."""
        generics = self.writer.generics(self.home, name, {key: ("real", value) for key, value in values.items()})
        self.writer.add(self.home, Part(f"{name}_i", entity, text, generics, ports))

    def actor(self, name: str, entity: str, text: str, values: Values, **ports: str) -> None:
        """Add an actor: it reads the value and gives an effort."""
        self.writer.of[self.home].declarations.append(f"quantity {name}_effort : real")
        self.writer.efforts[f"{self.value}_effort"][1].append(f"{name}_effort")
        self.instance(name, entity, text, values, {**ports, "value": self.value, "effort": f"{name}_effort"})

    def target(self, name: str, text: str, signal: Signal) -> str:
        """Add what a controller follows; the quantity with it."""
        target = f"{name}_target"
        self.writer.of[self.home].declarations.append(f"quantity {target} : real")
        entity, values = _law(self.writer, "target", target, signal)
        self.instance(target, entity, f"target of {text}", values, {"target": target})
        return target


def drives(writer: Writer) -> None:
    """Add what acts on joints, what holds rates, and gears."""
    for joint in writer.model.system.joints:
        label, home = writer.names[joint.name], writer.scopes.of[joint.name]
        rates, coordinates = writer.equations.rates_of(joint), [name for name, _ in joint.kind.coordinates]
        for actor in writer.equations.actors(joint):
            _actor(_Shaft(writer, home, f"{label}_{coordinates[actor.freedom]}"), actor)
        if joint.kind.name == "spherical":
            continue
        for k, coordinate in enumerate(coordinates):
            if rates[k] in writer.equations.held:
                shaft = _Shaft(writer, home, f"{label}_{coordinate}")
                level = {"level": number(float(writer.model.coordinates(joint.subject)[0][k]))}
                shaft.actor(f"{shaft.value}_held", "motion_constant", f"{joint.subject} is held", level)
    for gear in writer.equations.gears:
        _gear(writer, gear)


def _actor(shaft: _Shaft, actor: Actor) -> None:
    name, text = shaft.writer.names[actor.name], actor.subject
    if isinstance(actor, MotionDrive | EffortDrive):
        kind = "motion" if isinstance(actor, MotionDrive) else "effort"
        entity, values = _law(shaft.writer, kind, name, actor.signal)
        shaft.actor(name, entity, text, values)
    elif isinstance(actor, Spring):
        shaft.actor(name, "spring", text, {"stiffness": number(actor.stiffness), "rest": number(actor.rest)})
    elif isinstance(actor, Damper):
        shaft.actor(name, "damper", text, {"damping": number(actor.damping)})
    elif isinstance(actor, Servo):
        target = shaft.target(name, text, actor.target)
        shaft.actor(name, "servo", text, _gains(actor.controller), target=target)
    elif isinstance(actor, DcMotor):
        _motor(shaft, name, actor)


def _gains(controller: Controller) -> Values:
    controller = controller.without_speed_limit
    bound = number(controller.limit) if math.isfinite(controller.limit) else "unlimited"
    return {
        "kp": number(controller.kp), "ki": number(controller.ki), "kd": number(controller.kd), "bound": bound,
    }  # fmt: skip


def _motor(shaft: _Shaft, name: str, motor: DcMotor) -> None:
    """A motor, and at its terminal what supplies it."""
    writer, terminal, label = shaft.writer, f"{name}_p", f"{name}_supply"
    writer.of[shaft.home].declarations.append(f"terminal {terminal} : electrical")
    writer.potentials += 1
    values = {key: number(getattr(motor, key)) for key in ("resistance", "inductance", "gear")}
    shaft.actor(name, "dc_motor", motor.subject, values | {"coupling": number(motor.constant)}, p=terminal)
    supply = writer.model.system.supply(motor.name)
    if isinstance(supply, VoltageController):
        ports = {"p": terminal, "target": shaft.target(name, supply.subject, supply.target), "value": shaft.value}
        shaft.instance(label, "voltage_controller", supply.subject, _gains(supply.controller), ports)
        return
    entity, values = _law(writer, "voltage", label, supply.signal)
    shaft.instance(label, entity, f"voltage of {supply.subject}", values, {"p": terminal})


def _gear(writer: Writer, gear: Gear) -> None:
    """A gear in the innermost scope around its joints: their values come up to it, its efforts go down."""
    system, top, label = writer.model.system, writer.scopes.of[gear.name], writer.names[gear.name]
    ports: dict[str, str] = {}
    for port, _ in gear.terms:
        joint = system.joint_at(gear.name, port)
        home = writer.scopes.of[joint.name]
        value, effort = f"{writer.names[joint.name]}_{joint.kind.coordinates[0][0]}", f"{label}_{port}_effort"
        writer.pass_up(value, home, top)
        writer.pass_down(effort, top, home)
        writer.efforts[f"{value}_effort"][1].append(effort)
        ports |= {f"{port}_value": value, f"{port}_effort": effort}
    ratios = {"ratio": gear.ratio} | {f"ratio_{port}": float(ratio) for port, ratio in gear.others.items()}
    generics = {key: writer.generic(top, f"{label}_{key}", "real", number(ratio)) for key, ratio in ratios.items()}
    entity = f"gear_{len(gear.terms)}" if gear.others else "gear"
    writer.add(top, Part(label, entity, gear.name, generics, ports))


def _law(writer: Writer, kind: str, name: str, signal: Signal) -> tuple[str, Values]:
    """The entity of a law and its generics; a table gets an entity of its own. Kinds: see the template."""
    if not isinstance(signal, Table | Spline):
        law, numbers = law_numbers(signal)
        return f"{kind}_{law}", {key: number(value) for key, value in numbers.items()}
    entity = f"table_{name}"
    writer.tables.append({"name": entity, "kind": kind, "pieces": polynomials(signal)})
    return entity, {}
