"""The port model: levels with their counts, components with their parameters, and what their ports meet."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from kinform.behaviour import (
    Bushing,
    Component,
    Controller,
    Damper,
    DcMotor,
    EffortDrive,
    EndStop,
    Friction,
    GasSpring,
    Gear,
    Ground,
    JointComponent,
    LoadComponent,
    MotionDrive,
    RigidBody,
    Servo,
    Signal,
    Spring,
    SpringDamper,
    System,
    VoltageController,
    VoltageSource,
    count,
    counts,
)
from kinform.behaviour.components import kind_of
from kinform.behaviour.signals import STEADY, Constant, Ramp, Sine, Table
from kinform.design import Design
from kinform.foundation.words import counted
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE, Lengths, number, vector


def render(design: Design) -> RenderableType:
    """One sentence, the levels where there are any, one row a component, then what could not be made part of it."""
    model = design.behaviour
    assert model is not None
    lengths, total = Lengths.of(design.assembly), count(model.system)
    balance = f"{total.unknowns} unknowns, {total.equations} equations"
    parts = counted(len(model.system.components), "component"), counted(len(model.system.nodes), "node")
    items: list[RenderableType] = [Text(f"Port model: {parts[0]}, {parts[1]}, {balance}", style="bold")]
    levels = counts(model.nested)
    if len(levels) > 1:
        rows = Rows(
            "system", "unknowns", "equations", title="\nLevels", right=("unknowns", "equations"), names=["system"]
        )
        for path, level in levels:
            rows.add(path or "the whole", str(level.unknowns), str(level.equations))
        items.append(rows)
    headings, texts = ("component", "kind", "parameters", "meets"), ("parameters", "meets")
    rows = Rows(*headings, title="\nComponents", texts=texts)
    _add(rows, model.nested, "", lengths)
    items.append(rows)
    items += [f"not in the model: {subject}: {why}" for subject, why in model.failures]
    items += [f"not in the model, which dynamics needs: {subject}: {why}" for subject, why in model.forces_missing]
    return stacked(*items)


def _add(rows: Rows, system: System, path: str, lengths: Lengths) -> None:
    for component in system.components:
        if isinstance(component, System):
            ports = ", ".join(port.name for port in component.ports)
            rows.add(f"{path}{component.subject}/", "system", f"ports {ports}" if ports else "no ports", "")
            _add(rows, component, f"{path}{component.subject}/", lengths)
            continue
        parameters = _PARAMETERS[type(component)](component, lengths)
        rows.add(component.name, _kind(component), parameters or NONE, _meets(system, component))


def _kind(component: Component) -> str:
    return component.kind.name if isinstance(component, JointComponent) else kind_of(component).replace("_", " ")


def _meets(system: System, component: Component) -> str:
    """What its ports meet; of bodies the joints say it."""
    if isinstance(component, Ground | RigidBody):
        return ""
    meets = []
    for port in component.ports:
        met = [other.name for other, _ in system.at(component.name, port.name)]
        bodies = [name for name in met if isinstance(system.component(name), Ground | RigidBody | System)]
        if bodies or not isinstance(component, JointComponent):
            meets.append(f"{port.name}: {', '.join(bodies or met) or NONE}")
    return "; ".join(meets)


def _signal(signal: Signal) -> str:
    if isinstance(signal, Constant):
        return number(signal.level)
    if isinstance(signal, Ramp):
        return f"{number(signal.offset)} + {number(signal.slope)}·t"
    if isinstance(signal, Sine):
        wave = f"{number(signal.amplitude)}·sin({number(signal.speed)}·t + {number(signal.phase)})"
        return f"{number(signal.offset)} + {wave}"
    assert isinstance(signal, Table)
    return f"table of {len(signal.knots)} rows from {number(signal.knots[0])} to {number(signal.knots[-1])} s"


def _controller(controller: Controller) -> str:
    gains = [f"{name} {number(getattr(controller, name))}" for name in ("kp", "ki", "kd")]
    speed = [f"speed up to {number(controller.speed_limit)} rad/s or m/s"] if controller.cascade else []
    return ", ".join((*gains, f"limit {number(controller.limit)}", *speed))


def _body(body: RigidBody, lengths: Lengths) -> str:
    if body.mass is None:
        return "mass not known"
    return f"{number(body.mass)} kg at {lengths.point(body.centre_of_mass)} {lengths.unit}"


def _joint(joint: JointComponent, lengths: Lengths) -> str:
    g, facts = joint.geometry, []
    if joint.kind.name != "fixed" and g.axis is not None:
        facts.append(f"axis {vector(g.axis)}")
    if joint.kind.name == "universal":
        facts.append(f"then {vector(g.axis2)}")
    if joint.kind.name not in ("fixed", "prismatic") and g.point is not None:
        facts.append(f"at {lengths.point(g.point)} {lengths.unit}")
    if joint.kind.name == "screw":
        facts.append(f"{lengths.length(g.pitch)} {lengths.small} a turn")
    return ", ".join(facts)


_PARAMETERS: dict[type[Component], Callable[[Any, Lengths], str]] = {
    Ground: lambda c, u: "",
    RigidBody: _body,
    JointComponent: _joint,
    MotionDrive: lambda c, u: f"{_signal(c.signal)} rad or m",
    EffortDrive: lambda c, u: f"{_signal(c.signal)} N·m or N",
    Spring: lambda c, u: f"{number(c.stiffness)} N·m/rad or N/m, rest {number(c.rest)} rad or m",
    Damper: lambda c, u: f"{number(c.damping)} N·m·s/rad or N·s/m",
    Friction: lambda c, u: (
        f"coefficient {number(c.kinetic)}, {number(c.static)} at rest; {number(c.effort)} N·m or N without load, "
        f"{number(c.static_effort)} at rest"
    ),
    EndStop: lambda c, u: f"{number(c.lower)} to {number(c.upper)} rad or m, restitution {number(c.restitution)}",
    Servo: lambda c, u: f"target {_signal(c.target)} rad or m, {_controller(c.controller)}",
    DcMotor: lambda c, u: (
        f"{number(c.resistance)} Ω, {number(c.inductance)} H, {number(c.constant)} N·m/A, gear {number(c.gear)}"
        + (f", at most {number(c.current_limit)} A" if math.isfinite(c.current_limit) else "")
        + (f", rotor {number(c.rotor_inertia)} kg·m²" if c.rotor_inertia else "")
        + (f", rotor friction {number(c.rotor_friction)} N·m" if c.rotor_friction else "")
        + _efficiency(c)
    ),
    VoltageSource: lambda c, u: f"{_signal(c.signal)} V",
    VoltageController: lambda c, u: f"target {_signal(c.target)} rad or m, {_controller(c.controller)}",
    SpringDamper: lambda c, u: (
        f"{number(c.stiffness)} N/m, {number(c.damping)} N·s/m, rest {_length(c.rest, u)}, "
        f"from {u.point(c.point)} to {u.point(c.other)} {u.unit}"
    ),
    GasSpring: lambda c, u: (
        f"{number(c.force)} N at {_length(c.extended, u)}, {_length(c.column, u)} of gas to the power "
        f"{number(c.exponent)}, {number(c.damping)} N·s/m, from {u.point(c.point)} to {u.point(c.other)} {u.unit}"
    ),
    Bushing: lambda c, u: (
        f"{_triple(c.stiffness)} N/m, {_triple(c.torsion)} N·m/rad, {_triple(c.damping)} N·s/m, "
        f"{_triple(c.torsion_damping)} N·m·s/rad at {u.point(c.point)} {u.unit}"
    ),
    Gear: lambda c, u: (
        "a = " + " + ".join(f"{number(-factor)}·{port}" for port, factor in c.terms[1:]) + _efficiency(c)
    ),
    LoadComponent: lambda c, u: (
        f"{_triple(c.force)} N, {_triple(c.torque)} N·m at {u.point(c.point)} {u.unit}"
        f"{', turning with it' if c.turning else ''}"
        f"{'' if c.signal == STEADY else f', times {_signal(c.signal)}'}"
    ),
}


def _efficiency(gear: DcMotor | Gear) -> str:
    if not gear.lossy:
        return ""
    return f", efficiency {number(gear.efficiency)}, back {number(gear.efficiency_back)}"


def _length(metres: float, lengths: Lengths) -> str:
    return f"{lengths.length(metres)} {lengths.small}"


def _triple(values: Any) -> str:
    return f"({', '.join(number(float(value)) for value in values)})"
