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
    Damper,
    DcMotor,
    EffortDrive,
    Ground,
    JointComponent,
    MotionDrive,
    RigidBody,
    Servo,
    Spring,
    VoltageController,
)
from kinform.behaviour.primitives import Ball, OneFreedom
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import Constant, Ramp, Signal, Sine, Spline, Table
from kinform.exports.equations import Closure, Equations, equations_of, inertia_of, law_numbers, polynomials
from kinform.exports.exported import Exported
from kinform.exports.model import ExportModel
from kinform.exports.names import MODELICA, identifiers
from kinform.exports.text import number, render, vector
from kinform.exports.tree import Link
from kinform.foundation.algebra.spatial import to_matrix
from kinform.model.arrays import Array

LIBRARY = (
    "Frame Shaft Ground Body Revolute Prismatic Screw Spherical Fixed Free Cylindrical Planar PlanarReversed Universal "
    "Motion Effort Spring Damper Gear Train Load System Place Turn turned back product Pin Servo Voltage "
    "VoltageController Motor MotorWithoutCoil"
).split()

_SUFFIXES = ("", "_closure", "_free", *(f"_held_{k}" for k in (1, 2, 3)))
"""What is appended to the name of a component, so that no two names meet."""


@dataclass
class _Package:
    """What the system is made of, as it grows."""

    equations: Equations
    names: dict[str, str]
    """Identifiers of components."""
    classes: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Closures and tables, by name of their class."""
    instances: list[tuple[str, str, str, str]] = field(default_factory=list)
    """(class, name, modifiers, comment)."""
    connections: list[tuple[str, str]] = field(default_factory=list)

    @property
    def model(self) -> ExportModel:
        """What is written."""
        return self.equations.model

    def add(self, cls: str, name: str, modifiers: str, comment: str, **joined: str) -> None:
        """Add an instance; `joined`: by connector of it, what that is connected with."""
        self.instances.append((cls, name, modifiers, comment))
        self.connections += [(f"{name}.{connector}", other) for connector, other in joined.items()]

    def between(self, first: str, name: str, second: str) -> None:
        """Connect a joint from the frame of one component to that of another."""
        self.connections += [(f"{first}.frame", f"{name}.a"), (f"{name}.b", f"{second}.frame")]


def export(model: ExportModel) -> Exported:
    """NAME.mo: the package NAME with the model NAME.System."""
    equations = equations_of(model)
    names = identifiers(
        (component.name for component in model.system.components), MODELICA, beside=("gravity",), suffixes=_SUFFIXES
    )
    package = _Package(equations, names)
    for body in model.system.bodies:
        _body(package, body)
    for link in equations.tree.links:
        if link.joint is not None:
            _joint(package, link, names[link.joint.name])
            package.between(
                names[equations.tree.links[link.parent].body.name], names[link.joint.name], names[link.body.name]
            )
        elif link.parent < 0 and not isinstance(link.body, Ground):
            _free_body(package, link)
    for closure in equations.closures:
        _closure(package, closure)
    _actors(package)
    title = identifiers([model.name], MODELICA, beside=LIBRARY)[model.name]
    text = render(
        __package__, "package.mo.j2", package=title, model=model, built=package, lost=equations.lost,
        remarks=equations.remarks, number_of_free=len(equations.free), v=_array,
    )  # fmt: skip
    return Exported({f"{title}.mo": text}, tuple(equations.lost), tuple(equations.remarks))


def _array(values: Any) -> str:
    return "{" + vector(values, ", ") + "}"


def _matrix(values: Array) -> str:
    return "[" + "; ".join(vector(row, ", ") for row in values) + "]"


def _body(package: _Package, body: Ground | RigidBody) -> None:
    if isinstance(body, Ground):
        package.add("Ground", package.names[body.name], "", body.subject)
        return
    mass, centre, inertia = inertia_of(body)
    values = f"m={number(mass)}, c={_array(centre)}, I={_matrix(inertia)}, g=gravity"
    package.add("Body", package.names[body.name], values, body.subject)


def _closure(package: _Package, closure: Closure) -> None:
    """The joint that closes a loop, and what holds its end to the second body."""
    name, links = package.names[closure.joint.name], package.equations.tree.links
    first, second = (package.names[links[end].body.name] for end in (closure.a, closure.b))
    _joint(package, Link(links[closure.b].body, closure.a, closure.joint, True, closure.point), name)
    kind = "Closure_" + "".join("01"[held] for held in (*closure.place, *closure.turn))
    package.classes[kind] = {"kind": "closure", "place": closure.place, "turn": closure.turn}
    values = f"s={_array(closure.point)}, e={_matrix(closure.axes.T)}"
    package.add(kind, f"{name}_closure", values, f"{closure.joint.subject} closes a loop")
    package.connections += [
        (f"{first}.frame", f"{name}.a"), (f"{name}.b", f"{name}_closure.a"), (f"{name}_closure.b", f"{second}.frame"),
    ]  # fmt: skip


def _joint(package: _Package, link: Link, name: str) -> None:
    """The joint of a link, run through from its parent."""
    joint, equations = link.joint, package.equations
    assert joint is not None
    kind = joint.kind.name
    rates = equations.rates_of(joint)
    q, v = package.model.coordinates(joint.subject)
    if kind == "fixed":
        package.add("Fixed", name, "", joint.subject)
        return
    if kind == "spherical":
        (ball,) = (m.primitive for m in link.motions)
        assert isinstance(ball, Ball)
        _ball(package, link, name, ball, q, 0.0 * v if equations.held.intersection(rates) else v)
        return
    parts: dict[str, str] = {}
    determined = equations.led | equations.held | _geared(equations)
    for motion in link.motions:
        screw, k = motion.primitive, motion.coordinate
        assert isinstance(screw, OneFreedom)
        lead = float(screw.slide @ screw.omega)
        parts[joint.kind.coordinates[k][0]] = _screw(screw, float(q[k]), float(v[k]), rates[k] not in determined)
        if rates[k] in equations.held:
            at, hold = _parts(package, joint)[k], f"{name}_held_{k + 1}"
            _drive(package, "Motion", hold, Constant(float(q[k])), f"{joint.subject} is held", f"{at}.shaft")
    if joint.kind.rates == 1:
        (values,) = parts.values()
        if kind == "screw":
            values += f", lead={number(lead)}"
        package.add(kind.capitalize(), name, values, joint.subject)
        return
    order = [(_PART[kind][k], coordinate) for k, (coordinate, _) in enumerate(joint.kind.coordinates)]
    if kind == "universal" and not link.forward:
        order = [("first", "angle2"), ("second", "angle")]
    inner = ", ".join(f"{part}({parts[coordinate]})" for part, coordinate in order)
    reverse = "Reversed" if kind == "planar" and not link.forward else ""
    package.add(kind.capitalize() + reverse, name, inner, joint.subject)


_PART = {"cylindrical": ("turn", "slide"), "planar": ("turn", "u", "v"), "universal": ("first", "second")}
"""Names of the parts of joints with several freedoms, in the order of their coordinates."""


def _parts(package: _Package, joint: JointComponent) -> tuple[str, ...]:
    """What has the shaft of each of the joint's coordinates: the joint, or its parts."""
    name, kind = package.names[joint.name], joint.kind.name
    if kind not in _PART:
        return (name,)
    parts = _PART[kind]
    links = (link for link in package.equations.tree.links if link.joint is joint)
    if kind == "universal" and not all(link.forward for link in links):
        parts = parts[::-1]
    return tuple(f"{name}.{part}" for part in parts)


def _geared(equations: Equations) -> frozenset[int]:
    """Rates that gears give."""
    system = equations.model.system
    geared: set[int] = set()
    for gear in equations.gears:
        rates = [equations.rates_of(system.joint_at(gear.name, port))[0] for port, _ in gear.terms]
        geared.add(next((k for k in rates if k not in equations.led and k not in geared), rates[0]))
    return frozenset(geared)


def _screw(screw: OneFreedom, q: float, v: float, known: bool) -> str:
    """Modifiers of a joint with one freedom; `known`: its start is not that of a drive."""
    state = f"fixed={'true' if known else 'false'}"
    start = f"value(start={number(q)}, {state}), rate(start={number(v)}, {state})"
    if not screw.omega.any():
        return f"n={_array(screw.slide)}, {start}"
    return f"n={_array(screw.omega)}, s={_array(screw.point)}, {start}"


def _ball(package: _Package, link: Link, name: str, ball: Ball, q: Array, v: Array) -> None:
    """A spherical joint that starts at the quaternion q with the angular velocity v, both of the joint."""
    if not link.forward:
        v = -to_matrix(q).T @ v
        q = q * np.array([1.0, -1.0, -1.0, -1.0])
    values = f"s={_array(ball.point)}, q(start={_array(q)}, each fixed=true), w(start={_array(v)}, each fixed=true)"
    assert link.joint is not None
    package.add("Spherical", name, values, link.joint.subject)


def _free_body(package: _Package, link: Link) -> None:
    """What carries a body that no joints connect with the ground."""
    body = package.names[link.body.name]
    start = package.model.start[link.body.subject]
    values = f"x(start={_array(start.position)}, each fixed=true), q(start={_array(start.quaternion)}, each fixed=true)"
    package.add("Free", f"{body}_free", values, f"nothing connects {link.body.subject} with the ground")
    package.between(package.names[package.equations.tree.links[0].body.name], f"{body}_free", body)


def _actors(package: _Package) -> None:
    """What acts on joints, gears and loads."""
    system, names = package.model.system, package.names
    for joint in system.joints:
        parts = _parts(package, joint)
        for actor in package.equations.actors(joint):
            name, about = names[actor.name], actor.subject
            shaft = f"{parts[actor.freedom]}.shaft"
            if isinstance(actor, MotionDrive):
                _drive(package, "Motion", name, actor.signal, about, shaft)
            elif isinstance(actor, EffortDrive):
                _drive(package, "Effort", name, actor.signal, about, shaft)
            elif isinstance(actor, Spring):
                values = f"k={number(actor.stiffness)}, rest={number(actor.rest)}"
                package.add("Spring", name, values, about, shaft=shaft)
            elif isinstance(actor, Damper):
                package.add("Damper", name, f"d={number(actor.damping)}", about, shaft=shaft)
            elif isinstance(actor, Servo):
                package.add("Servo", name, _controlled(actor.controller, actor.target), about, shaft=shaft)
            elif isinstance(actor, DcMotor):
                _motor(package, actor, shaft)
    for gear in package.equations.gears:
        ends = {port: f"{names[system.joint_at(gear.name, port).name]}.shaft" for port, _ in gear.terms}
        if gear.others:
            first, *others = ends.values()
            ratios = _array([-factor for _, factor in gear.terms[1:]])
            joined = {"a": first} | {f"b[{k}]": end for k, end in enumerate(others, start=1)}
            values = f"n={len(others)}, ratios={ratios}"
            package.add("Train", names[gear.name], values, gear.subject, **joined)
            continue
        package.add("Gear", names[gear.name], f"ratio={number(gear.ratio)}", gear.subject, **ends)
    for load in system.steady_loads:
        values = f"f={_array(load.force)}, t={_array(load.torque)}, s={_array(load.point)}, turning={int(load.turning)}"
        frame = f"{names[system.body_at(load.name, 'frame').name]}.frame"
        package.add("Load", names[load.name], values, load.subject, frame=frame)


def _motor(package: _Package, motor: DcMotor, shaft: str) -> None:
    """A motor, and at its terminal what supplies it."""
    names, pin = package.names, f"{package.names[motor.name]}.pin"
    keys = ("resistance", "constant", "gear", *(("inductance",) if motor.inductance else ()))
    values = [f"{'k' if key == 'constant' else key}={number(getattr(motor, key))}" for key in keys]
    package.add(
        "Motor" if motor.inductance else "MotorWithoutCoil", names[motor.name], ", ".join(values), motor.subject
    )
    supply = package.model.system.supply(motor.name)
    if isinstance(supply, VoltageController):
        control = _controlled(supply.controller, supply.target)
        package.add("VoltageController", names[supply.name], control, supply.subject, shaft=shaft, pin=pin)
    else:
        law = f"given={_formula(supply.signal)}"
        package.add("Voltage", names[supply.name], law, f"voltage of {supply.subject}", pin=pin)
    package.connections.append((f"{names[motor.name]}.shaft", shaft))


def _controlled(controller: Controller, target: Signal) -> str:
    """Modifiers of a controller."""
    controller = controller.without_speed_limit
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
    for end, start, coefficients in polynomials(signal):
        powers = (
            f"({number(c)})" + f"*(time - ({number(start)}))" * bool(k) + f"^{k}" * (k > 1)
            for k, c in enumerate(coefficients)
        )  # fmt: skip
        head = f"if time < {number(end)} then " if math.isfinite(end) else ""
        out += f"{' else' * bool(out)}{' ' * (bool(out) and not head)}{head}{' + '.join(powers)}"
    return out


def _drive(package: _Package, kind: str, name: str, signal: Signal, comment: str, shaft: str) -> None:
    """A drive of the class of its law; tables have a class each."""
    if isinstance(signal, Table | Spline):
        cls, values = f"Table_{name}", ""
        package.classes[cls] = {"kind": "table", "moving": kind == "Motion", "pieces": polynomials(signal)}
    else:
        law, numbers = law_numbers(signal)
        cls, values = f"{law.capitalize()}{kind}", ", ".join(f"{key}={number(value)}" for key, value in numbers.items())
    package.add(cls, name, values, comment, shaft=shaft)
