"""modelica: one package with the components of the port model, and the system made of them.

Connectors carry position and orientation (a unit quaternion) as across and force and torque as flow
variables, as in section 3 of the paper. Joints give the pose of the body that they carry in the tree of
the simulation; a joint that closes a loop ends in a frame of its own, and a closure holds that frame to
the body in the independent directions alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kinform.behaviour import (
    Component,
    Damper,
    DcMotor,
    EffortDrive,
    Ground,
    MotionDrive,
    RigidBody,
    Servo,
    Spring,
    System,
    VoltageController,
)
from kinform.behaviour.primitives import Ball, OneFreedom
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import Constant, Ramp, Signal, Sine, Spline, Table, smooth
from kinform.exports.exported import Exported
from kinform.exports.laws import pieces
from kinform.exports.loops import Closure, Loops, held_rates, loops, singular
from kinform.exports.losses import of_teeth
from kinform.exports.model import ExportModel
from kinform.exports.names import MODELICA, identifiers
from kinform.exports.text import number, render, vector
from kinform.exports.tree import Link, Tree, grow
from kinform.foundation.algebra.spatial import to_matrix
from kinform.model.arrays import Array

__all__ = ["export"]


LIBRARY = (
    "Frame Shaft Ground Body Revolute Prismatic Screw Spherical Fixed Free Cylindrical Planar PlanarReversed Universal "
    "Motion Effort Spring Damper Gear Load System Place Turn turned back product Pin Servo Voltage VoltageController Motor "
    "MotorWithoutCoil"
).split()

_SUFFIXES = ("", "_closure", "_free", *(f"_held_{k}" for k in (1, 2, 3)))
"""What is appended to the name of a component, so that no two names meet."""


@dataclass
class _Built:
    """What the system is made of."""

    classes: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Closures and tables, by name of their class."""
    instances: list[tuple[str, str, str, str]] = field(default_factory=list)
    """(class, name, modifiers, comment)."""
    connections: list[tuple[str, str]] = field(default_factory=list)


def export(model: ExportModel) -> Exported:
    """NAME.mo: the package NAME with the model NAME.System."""
    tree = grow(model.system)
    found = loops(model, tree)
    names = identifiers(
        (component.name for component in model.system.components), MODELICA, beside=("gravity",), suffixes=_SUFFIXES
    )
    lost = [*model.lost, *singular(model)]
    remarks: list[str] = [*of_teeth(model.system)]
    built = _Built()
    for component in model.system.components:
        if isinstance(component, Ground | RigidBody):
            _body(built, component, names)
    held = held_rates(model, found, lost, remarks)
    for link in tree.links:
        if link.joint is not None:
            _carried(built, model, tree, link, names, found, held)
        elif link.parent < 0 and not isinstance(link.body, Ground):
            _adrift(built, model, link, names, tree)
    for closure in found.closures:
        _closed(built, model, tree, closure, names, found, held)
    for closing in tree.closing:
        if not closing.rigid and closing.joint.subject not in {c.joint.subject for c in found.closures}:
            lost.append(f"{closing.joint.subject}: it closes a loop that is not connected with the ground")
    _actors(built, model, names, found, lost, remarks)
    if model.ranges:
        remarks.append("joints do not stop at the ends of their ranges, as in our simulation")
    if found.closures:
        remarks.append("redundant constraints of loops are left out: closures hold independent directions only")
    package = identifiers([model.name], MODELICA, beside=LIBRARY)[model.name]
    text = render(
        "package.mo.j2", package=package, model=model, built=built, lost=lost, remarks=remarks,
        number_of_free=len(found.free), v=_array,
    )  # fmt: skip
    return Exported({f"{package}.mo": text}, tuple(lost), tuple(remarks))


def _array(values: Any) -> str:
    return "{" + vector(values, ", ") + "}"


def _matrix(values: Array) -> str:
    return "[" + "; ".join(vector(row, ", ") for row in values) + "]"


def _body(built: _Built, body: Ground | RigidBody, names: dict[str, str]) -> None:
    if isinstance(body, Ground):
        built.instances.append(("Ground", names[body.name], "", body.subject))
        return
    known = body.mass is not None
    mass, centre, inertia = (
        (body.mass, body.centre_of_mass, body.inertia) if known else (0.0, np.zeros(3), np.zeros((3, 3)))
    )
    values = f"m={number(mass or 0.0)}, c={_array(centre)}, I={_matrix(inertia)}, g=gravity"
    built.instances.append(("Body", names[body.name], values, body.subject))


def _carried(
    built: _Built, model: ExportModel, tree: Tree, link: Link, names: dict[str, str], found: Loops, held: frozenset[int]
) -> None:
    assert link.joint is not None
    name = names[link.joint.name]
    parent = tree.links[link.parent].body
    _joint(built, model, link, name, found, held)
    built.connections.append((f"{names[parent.name]}.frame", f"{name}.a"))
    built.connections.append((f"{name}.b", f"{names[link.body.name]}.frame"))


def _closed(
    built: _Built, model: ExportModel, tree: Tree, closure: Closure, names: dict[str, str], found: Loops,
    held: frozenset[int],
) -> None:  # fmt: skip
    name = names[closure.joint.name]
    first, second = tree.links[closure.a].body, tree.links[closure.b].body
    _joint(built, model, Link(second, closure.a, closure.joint, True, closure.point), name, found, held)
    kind = "Closure_" + "".join("01"[held] for held in (*closure.place, *closure.turn))
    built.classes[kind] = {"kind": "closure", "place": closure.place, "turn": closure.turn}
    values = f"s={_array(closure.point)}, e={_matrix(closure.axes.T)}"
    built.instances.append((kind, f"{name}_closure", values, f"{closure.joint.subject} closes a loop"))
    built.connections.append((f"{names[first.name]}.frame", f"{name}.a"))
    built.connections.append((f"{name}.b", f"{name}_closure.a"))
    built.connections.append((f"{name}_closure.b", f"{names[second.name]}.frame"))


def _joint(built: _Built, model: ExportModel, link: Link, name: str, found: Loops, held: frozenset[int]) -> None:
    """The joint of a link, run through from its parent."""
    joint = link.joint
    assert joint is not None
    kind = joint.kind.name
    (slot,) = (s for s in model.mechanism.slots if s.name == joint.subject)
    q, v = model.coordinates(joint.subject)
    comment = joint.subject
    if kind == "fixed":
        built.instances.append(("Fixed", name, "", comment))
        return
    if kind == "spherical":
        (primitive,) = (m.primitive for m in link.motions)
        assert isinstance(primitive, Ball)
        _ball(built, link, name, primitive, q, v, any(k in held for k in range(slot.v.start, slot.v.stop)))
        return
    parts: dict[str, str] = {}
    tied = _geared(model, found)
    for motion in link.motions:
        screw = motion.primitive
        assert isinstance(screw, OneFreedom)
        k = motion.coordinate
        rate = slot.v.start + k
        known = rate not in found.led and rate not in held and rate not in tied
        parts[joint.kind.coordinates[k][0]] = _screw(screw, float(q[k]), float(v[k]), known)
        if rate in held:
            at = name if joint.kind.rates == 1 else f"{name}.{_PART[kind][k]}"
            _drive(built, "Motion", f"{name}_held_{k + 1}", Constant(float(q[k])), f"{joint.subject} is held")
            built.connections.append((f"{name}_held_{k + 1}.shaft", f"{at}.shaft"))
    if joint.kind.rates == 1:
        cls = {"revolute": "Revolute", "prismatic": "Prismatic", "screw": "Screw"}[kind]
        (values,) = parts.values()
        if kind == "screw":
            (screw,) = (m.primitive for m in link.motions)
            assert isinstance(screw, OneFreedom)
            values += f", lead={number(float(screw.slide @ screw.omega))}"
        built.instances.append((cls, name, values, comment))
        return
    cls = {"cylindrical": "Cylindrical", "planar": "Planar", "universal": "Universal"}[kind]
    if kind == "planar" and not link.forward:
        cls = "PlanarReversed"
    inner = ", ".join(
        f"{_PART[kind][k]}({parts[coordinate]})" for k, (coordinate, _) in enumerate(joint.kind.coordinates)
    )
    if kind == "universal" and not link.forward:
        inner = ", ".join(f"{part}({parts[c]})" for part, c in (("first", "angle2"), ("second", "angle")))
    built.instances.append((cls, name, inner, comment))


_PART = {"cylindrical": ("turn", "slide"), "planar": ("turn", "u", "v"), "universal": ("first", "second")}
"""Names of the parts of joints with several freedoms, in the order of their coordinates."""


def _geared(model: ExportModel, found: Loops) -> frozenset[int]:
    """Rates that gears give."""
    slots = {slot.name: slot for slot in model.mechanism.slots}
    given: set[int] = set()
    for gear, kept in zip(model.system.gears, found.gears, strict=True):
        rates = [slots[model.system.joint_at(gear.name, port).subject].v.start for port in ("a", "b")]
        if kept:
            given.add(next((k for k in rates if k not in found.led and k not in given), rates[0]))
    return frozenset(given)


def _screw(screw: OneFreedom, q: float, v: float, known: bool) -> str:
    """Modifiers of a joint with one freedom; `known`: its start is not that of a drive."""
    state = f"fixed={'true' if known else 'false'}"
    start = f"value(start={number(q)}, {state}), rate(start={number(v)}, {state})"
    if not screw.omega.any():
        return f"n={_array(screw.slide)}, {start}"
    return f"n={_array(screw.omega)}, s={_array(screw.point)}, {start}"


def _ball(built: _Built, link: Link, name: str, ball: Ball, q: Array, v: Array, resting: bool) -> None:
    """A spherical joint; `resting`: it starts at rest, whatever the joint's rates."""
    if not link.forward:
        v = -to_matrix(q).T @ v
        q = q * np.array([1.0, -1.0, -1.0, -1.0])
    values = (
        f"s={_array(ball.point)}, q(start={_array(q)}, each fixed=true), "
        f"w(start={_array(0.0 * v if resting else v)}, each fixed=true)"
    )
    assert link.joint is not None
    built.instances.append(("Spherical", name, values, link.joint.subject))


def _adrift(built: _Built, model: ExportModel, link: Link, names: dict[str, str], tree: Tree) -> None:
    name = f"{names[link.body.name]}_free"
    start = model.start[link.body.subject]
    assert isinstance(link.body, RigidBody)
    values = f"x(start={_array(start.position)}, each fixed=true), q(start={_array(start.quaternion)}, each fixed=true)"
    built.instances.append(("Free", name, values, f"nothing connects {link.body.subject} with the ground"))
    built.connections.append((f"{names[tree.links[0].body.name]}.frame", f"{name}.a"))
    built.connections.append((f"{name}.b", f"{names[link.body.name]}.frame"))


def _actors(
    built: _Built, model: ExportModel, names: dict[str, str], found: Loops, lost: list[str], remarks: list[str]
) -> None:
    system = model.system
    for joint in system.joints:
        led = False
        for actor in system.actors(joint.name):
            name = names[actor.name]
            if isinstance(actor, MotionDrive):
                if led:
                    lost.append(f"{actor.subject}: a second drive prescribes the motion of {joint.subject}")
                    continue
                led = True
                signal = smooth(actor.signal) if model.with_forces else actor.signal
                _drive(built, "Motion", name, signal, actor.subject)
            elif isinstance(actor, EffortDrive):
                _drive(built, "Effort", name, actor.signal, actor.subject)
            elif isinstance(actor, Spring):
                values = f"k={number(actor.stiffness)}, rest={number(actor.rest)}"
                built.instances.append(("Spring", name, values, actor.subject))
            elif isinstance(actor, Damper):
                built.instances.append(("Damper", name, f"d={number(actor.damping)}", actor.subject))
            elif isinstance(actor, Servo):
                built.instances.append(("Servo", name, _controlled(actor.controller, actor.target), actor.subject))
            elif isinstance(actor, DcMotor):
                _motor(built, system, names, actor, f"{names[joint.name]}.shaft")
            else:
                continue
            built.connections.append((f"{name}.shaft", f"{names[joint.name]}.shaft"))
    for gear, held in zip(system.gears, found.gears, strict=True):
        if not held:
            remarks.append(f"{gear.subject}: it is redundant with the loops")
            continue
        built.instances.append(("Gear", names[gear.name], f"ratio={number(gear.ratio)}", gear.subject))
        for port in ("a", "b"):
            other = names[system.joint_at(gear.name, port).name]
            built.connections.append((f"{names[gear.name]}.{port}", f"{other}.shaft"))
    for load in system.loads:
        values = f"f={_array(load.force)}, t={_array(load.torque)}, s={_array(load.point)}, turning={int(load.turning)}"
        built.instances.append(("Load", names[load.name], values, load.subject))
        body: Component = system.body_at(load.name, "frame")
        built.connections.append((f"{names[load.name]}.frame", f"{names[body.name]}.frame"))


def _motor(built: _Built, system: System, names: dict[str, str], motor: DcMotor, shaft: str) -> None:
    """A motor, and at its terminal what supplies it."""
    keys = ("resistance", "constant", "gear", *(("inductance",) if motor.inductance else ()))
    values = [f"{'k' if key == 'constant' else key}={number(getattr(motor, key))}" for key in keys]
    kind = "Motor" if motor.inductance else "MotorWithoutCoil"
    built.instances.append((kind, names[motor.name], ", ".join(values), motor.subject))
    supply = system.supply(motor.name)
    label = names[supply.name]
    if isinstance(supply, VoltageController):
        built.instances.append(
            ("VoltageController", label, _controlled(supply.controller, supply.target), supply.subject)
        )
        built.connections.append((f"{label}.shaft", shaft))
    else:
        built.instances.append(("Voltage", label, f"given={_formula(supply.signal)}", f"voltage of {supply.subject}"))
    built.connections.append((f"{label}.pin", f"{names[motor.name]}.pin"))


def _controlled(controller: Controller, target: Signal) -> str:
    """Modifiers of a controller."""
    values = {"kp": controller.kp, "ki": controller.ki, "kd": controller.kd}
    if math.isfinite(controller.limit):
        values["bound"] = controller.limit
    return ", ".join([*(f"{key}={number(value)}" for key, value in values.items()), f"target={_formula(target)}"])


def _formula(signal: Signal) -> str:
    """A law as an expression of time."""
    if isinstance(signal, Constant):
        return number(signal.level)
    if isinstance(signal, Ramp):
        return f"{number(signal.offset)} + ({number(signal.slope)})*time"
    if isinstance(signal, Sine):
        turn = f"({number(signal.speed)})*time + ({number(signal.phase)})"
        return f"{number(signal.offset)} + ({number(signal.amplitude)})*sin({turn})"
    assert isinstance(signal, Table | Spline)
    out = ""
    for end, start, coefficients in pieces(signal):
        powers = (
            f"({number(c)})" + f"*(time - ({number(start)}))" * bool(k) + f"^{k}" * (k > 1)
            for k, c in enumerate(coefficients)
        )  # fmt: skip
        head = f"if time < {number(end)} then " if math.isfinite(end) else ""
        out += f"{' else' * bool(out)}{' ' * (bool(out) and not head)}{head}{' + '.join(powers)}"
    return out


def _drive(built: _Built, kind: str, name: str, signal: Signal, comment: str) -> None:
    """A drive of the class of its law; tables have a class each."""
    cls, values = f"Sine{kind}", ""
    if isinstance(signal, Constant):
        cls, values = f"Constant{kind}", f"level={number(signal.level)}"
    elif isinstance(signal, Ramp):
        cls, values = f"Ramp{kind}", f"offset={number(signal.offset)}, slope={number(signal.slope)}"
    elif isinstance(signal, Sine):
        values = ", ".join(f"{key}={number(getattr(signal, key))}" for key in ("offset", "amplitude", "speed", "phase"))
    else:
        assert isinstance(signal, Table | Spline)
        cls = f"Table_{name}"
        built.classes[cls] = {"kind": "table", "moving": kind == "Motion", "pieces": pieces(signal)}
    built.instances.append((cls, name, values, comment))
