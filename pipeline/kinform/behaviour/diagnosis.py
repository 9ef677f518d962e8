"""What is wrong with a flat network, component by component: what no solver could make a motion of."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from kinform.behaviour.components import (
    Elastic,
    GasSpring,
    Gear,
    Ground,
    JointComponent,
    LoadComponent,
    RigidBody,
    System,
)
from kinform.behaviour.ports import Component
from kinform.behaviour.shafts import Actor, Controller, DcMotor, EndStop, Friction, VoltageController, VoltageSource
from kinform.behaviour.signals import LAWS, Table
from kinform.foundation.rounding import SOLVED

_SIGNALS = tuple(LAWS.values())
_UNBOUNDED = ("lower", "upper", "limit", "current_limit", "speed_limit")
"""Values that may be infinite."""


def faults(system: System) -> tuple[tuple[str, str], ...]:
    """(what the component is called, what is wrong) of a flat system, in the order of its components."""
    wrong = list(_faults_of_structure(system))
    for component in system.components:
        wrong += [(component.subject, why) for why in _faults_of_values(component)]
        wrong += [(component.subject, why) for why in _faults_of_nodes(system, component)]
    return tuple(dict.fromkeys(wrong))


def _faults_of_structure(system: System) -> Iterator[tuple[str, str]]:
    grounds = [c for c in system.components if isinstance(c, Ground)]
    if len(grounds) != 1:
        yield (grounds[1].subject if grounds else "ground"), f"a device has one ground, this one has {len(grounds)}"
    for kinds, what in (((Ground, RigidBody), "bodies"), ((JointComponent,), "joints")):
        names = Counter(c.subject for c in system.components if isinstance(c, kinds))
        yield from ((name, f"{count} {what} are called so") for name, count in names.items() if count > 1)


def _faults_of_values(component: Component) -> Iterator[str]:
    """Numbers that are none, or that cannot be."""
    for field in dataclasses.fields(component):
        value = getattr(component, field.name)
        if isinstance(component, RigidBody):
            continue  # what is not known of a body stands in the way of dynamics only
        if isinstance(value, Controller):
            yield from _numbers(value, "its ")
            if not value.speed_limit > 0.0:
                yield "the limit of its speed must be positive"
        elif isinstance(value, _SIGNALS):
            yield from _numbers(value, "its law: ")
            yield from _rows(value)
        elif isinstance(value, float | int | np.ndarray) and not isinstance(value, bool):
            yield from _number(field.name, value, "its ")
    if isinstance(component, EndStop) and not 0.0 <= component.restitution <= 1.0:
        yield f"its restitution is {component.restitution:g}: a share of the speed is between 0 and 1"
    if isinstance(component, Friction):
        yield from _faults_of_friction(component)
    if isinstance(component, EndStop) and component.lower > component.upper:
        yield f"its lower limit {component.lower:g} is above the upper {component.upper:g}"
    if isinstance(component, GasSpring) and not (component.column > 0.0 and component.exponent > 0.0):
        yield "its column of gas and its exponent must be positive"
    if isinstance(component, DcMotor) and (component.resistance <= 0.0 or component.inductance < 0.0):
        yield "its resistance must be positive, its inductance not negative"
    if isinstance(component, DcMotor) and not component.current_limit > 0.0:
        yield "the limit of its current must be positive"
    if isinstance(component, DcMotor) and (component.rotor_inertia < 0.0 or component.rotor_friction < 0.0):
        yield "the inertia and the friction of its rotor must not be negative"
    if isinstance(component, DcMotor | Gear):
        yield from _faults_of_efficiency(component)
    if isinstance(component, JointComponent):
        yield from _faults_of_geometry(component)


def _faults_of_efficiency(component: DcMotor | Gear) -> Iterator[str]:
    for name in ("efficiency", "efficiency_back"):
        if getattr(component, name) > 1.0:
            yield f"its {name.replace('_', ' ')} is {getattr(component, name):g}: at most 1"
    driven = isinstance(component, Gear) and component.efficiency_back > 0.0
    if component.efficiency <= 0.0 and not driven:
        yield f"its efficiency is {component.efficiency:g}: what cannot be driven is no gear"
    if isinstance(component, Gear) and component.lossy and component.others:
        yield "its efficiency is stated, which is simulated of gears between two joints only"


def _faults_of_friction(friction: Friction) -> Iterator[str]:
    for name in ("kinetic", "static", "effort", "static_effort", "radial"):
        if getattr(friction, name) < 0.0:
            yield f"its {name.replace('_', ' ')} is negative"
    if friction.static < friction.kinetic or friction.static_effort < friction.effort:
        yield "its friction at rest is less than that in motion"


def _faults_of_geometry(joint: JointComponent) -> Iterator[str]:
    try:
        joint.kind.chain(joint.geometry)
    except ValueError as error:
        yield f"the {joint.kind.name} joint cannot be placed: {error}"
    for name in ("axis", "axis2"):
        vector = getattr(joint.geometry, name)
        if vector is not None and np.all(np.isfinite(vector)) and abs(float(np.linalg.norm(vector)) - 1.0) > SOLVED:
            yield f"its {name} is not of length 1"


def _rows(signal: object) -> Iterator[str]:
    if not isinstance(signal, Table):
        return
    if len(signal.knots) < 2 or len(signal.knots) != len(signal.levels):
        yield f"its law: the table has {len(signal.knots)} times and {len(signal.levels)} levels, at least two each"
    elif any(later <= earlier for earlier, later in pairwise(signal.knots)):
        yield "its law: the times of its table do not increase"


def _numbers(record: object, whose: str) -> Iterator[str]:
    for field in dataclasses.fields(record):  # type: ignore[arg-type]
        value = getattr(record, field.name)
        if isinstance(value, float | int | tuple):
            yield from _number(field.name, value, whose)


def _number(name: str, value: object, whose: str) -> Iterator[str]:
    array = np.asarray(value, dtype=np.float64)
    bad = np.isnan(array) if name in _UNBOUNDED else ~np.isfinite(array)
    if bad.any():
        yield f"{whose}{name.replace('_', ' ')} is not a finite number"


def _faults_of_nodes(system: System, component: Component) -> Iterator[str]:
    """Ports that meet nothing that could answer them, or too much."""
    if isinstance(component, JointComponent | Elastic):
        for port in ("a", "b"):
            yield from _one_body(system, component, port)
    if isinstance(component, JointComponent) and component.kind.rates:
        others = [c for c in system.joints_at(component.name, "shaft") if c is not component]
        if others:
            yield f"its shaft is joined with that of {_listed(others, 'joint')}: a gear of ratio 1 does that"
    if isinstance(component, LoadComponent):
        yield from _one_body(system, component, "frame")
    if isinstance(component, Gear):
        for port, _ in component.terms:
            yield from _one_shaft(system, component, port)
    if isinstance(component, Actor | VoltageController):
        yield from _one_shaft(system, component, "shaft")
        if not 0 <= component.freedom < component.rates:
            yield f"its freedom {component.freedom} is none of its shaft's, which has {component.rates}, from 0 on"
    if isinstance(component, DcMotor):
        yield from _supplied(system, component)
    if isinstance(component, VoltageSource | VoltageController) and not any(
        isinstance(other, DcMotor) for other, _ in system.at(component.name, "terminals")
    ):
        yield "it supplies no motor"


def _one_body(system: System, component: Component, port: str) -> Iterator[str]:
    others = system.bodies_at(component.name, port)
    if len(others) != 1:
        yield f"its port {port} meets {_listed(others, 'body')}: it needs one body"


def _one_shaft(system: System, component: Component, port: str) -> Iterator[str]:
    others = system.joints_at(component.name, port)
    if len(others) != 1:
        yield f"its port {port} is on {_listed(others, 'joint')}: it needs one"


def _supplied(system: System, motor: DcMotor) -> Iterator[str]:
    sources = [c for c, _ in system.at(motor.name, "terminals") if isinstance(c, VoltageSource | VoltageController)]
    if len(sources) != 1:
        yield f"its terminals meet {_listed(sources, 'source of a voltage')}: they need one"
        return
    (supply,) = sources
    if isinstance(supply, VoltageController) and system.node(supply.name, "shaft") != system.node(motor.name, "shaft"):
        yield f'its controller "{supply.subject}" reads another shaft than its own, which is not simulated'


def _listed(components: Sequence[Component], what: str) -> str:
    return ", ".join(c.subject for c in components) or f"no {what}"
