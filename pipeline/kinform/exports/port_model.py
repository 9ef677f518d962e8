"""json: the port model as data, and reading it back. Its shape is in `port_schema`.

Numbers are doubles in shortest decimal form, so that reading gives an equal model, bit by bit.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from kinform.behaviour import (
    Component,
    Constant,
    Damper,
    EffortDrive,
    Ground,
    JointComponent,
    LoadComponent,
    MotionDrive,
    Node,
    RigidBody,
    Signal,
    Spring,
    System,
    count,
)
from kinform.behaviour.components import (
    Controller,
    DcMotor,
    EndStop,
    Gear,
    Servo,
    SpringDamper,
    VoltageController,
    VoltageSource,
)
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.signals import Ramp, Sine, Table
from kinform.errors import InputError, Problem
from kinform.exports.exported import Exported
from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers
from kinform.exports.port_schema import (
    SCHEMA,
    BodyData,
    ConstantLaw,
    ControllerData,
    DamperData,
    DcMotorData,
    EffortData,
    EndStopData,
    GearData,
    GroundData,
    JointData,
    MotionData,
    PortModel,
    RampLaw,
    ServoData,
    SineLaw,
    SpringDamperData,
    SpringData,
    TableLaw,
    VoltageControllerData,
    VoltageData,
)

__all__ = ["export", "read"]

Array = NDArray[np.float64]


def export(model: ExportModel) -> Exported:
    """One file with the port model."""
    system, counted = model.system, count(model.system)
    starts = []
    for joint in system.joints:
        position, velocity = model.coordinates(joint.subject)
        starts.append({"joint": joint.name, "position": position.tolist(), "velocity": velocity.tolist()})
    data = {
        "schema": SCHEMA,
        "name": model.name,
        "gravity": model.gravity.tolist(),
        "components": [_component(component) for component in system.components],
        "nodes": [
            {"size": node.size, "ports": [{"component": c, "port": p} for c, p in node.ports]} for node in system.nodes
        ],
        "start": starts,
        "count": {"unknowns": counted.unknowns, "equations": counted.equations},
        "missing": list(model.missing),
    }
    text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    name = identifiers([model.name], FILES)[model.name]
    return Exported({f"{name}.json": text.encode("utf-8", "replace")}, model.missing)


def read(text: str | bytes) -> System:
    """The components and nodes in a file that `export` wrote. Raises InputError for anything else."""
    try:
        data = PortModel.model_validate_json(text)
        components = tuple(_read(component) for component in data.components)
        nodes = tuple(Node(tuple((p.component, p.port) for p in node.ports), node.size) for node in data.nodes)
        return System(components, nodes)
    except ValidationError as error:
        raise InputError(
            Problem(f"{'.'.join(map(str, one['loc']))}: {one['msg']}", remedy="see the schema of the port model")
            for one in error.errors(include_url=False)
        ) from error
    except ValueError as error:
        raise InputError([Problem(str(error), remedy="export the model again")]) from error


def _list(array: Array | None) -> Any:
    return None if array is None or not np.all(np.isfinite(array)) else array.tolist()


def _law(signal: Signal) -> dict[str, Any]:
    if isinstance(signal, Constant):
        return {"law": "constant", "level": signal.level}
    if isinstance(signal, Ramp):
        return {"law": "ramp", "offset": signal.offset, "slope": signal.slope}
    if isinstance(signal, Sine):
        values = {"offset": signal.offset, "amplitude": signal.amplitude, "speed": signal.speed, "phase": signal.phase}
        return {"law": "sine", **values}
    assert isinstance(signal, Table)
    return {"law": "table", "times": list(signal.knots), "levels": list(signal.levels)}


_WRITERS: dict[type[Component], Callable[[Any], dict[str, Any]]] = {
    Ground: lambda c: {"kind": "ground"},
    RigidBody: lambda c: {
        "kind": "rigid_body", "mass": c.mass, "centre_of_mass": _list(c.centre_of_mass), "inertia": _list(c.inertia),
    },
    JointComponent: lambda c: {
        "kind": "joint", "type": c.kind.name, "axis": _list(c.geometry.axis), "point": _list(c.geometry.point),
        "axis2": _list(c.geometry.axis2), "pitch": c.geometry.pitch,
    },
    MotionDrive: lambda c: {"kind": "motion", "law": _law(c.signal)},
    EffortDrive: lambda c: {"kind": "effort", "law": _law(c.signal)},
    Spring: lambda c: {"kind": "spring", "stiffness": c.stiffness, "rest": c.rest},
    Damper: lambda c: {"kind": "damper", "damping": c.damping},
    Gear: lambda c: {"kind": "gear", "ratio": c.ratio},
    EndStop: lambda c: {"kind": "end_stop", "lower": _finite(c.lower), "upper": _finite(c.upper)},
    Servo: lambda c: {"kind": "servo", "target": _law(c.target), "controller": _controller(c.controller)},
    DcMotor: lambda c: {
        "kind": "dc_motor", "resistance": c.resistance, "inductance": c.inductance, "constant": c.constant,
        "gear": c.gear,
    },
    VoltageSource: lambda c: {"kind": "voltage_source", "law": _law(c.signal)},
    VoltageController: lambda c: {
        "kind": "voltage_controller", "target": _law(c.target), "controller": _controller(c.controller),
    },
    SpringDamper: lambda c: {
        "kind": "spring_damper", "point": _list(c.point), "other": _list(c.other), "stiffness": c.stiffness,
        "damping": c.damping, "rest": c.rest,
    },
    LoadComponent: lambda c: {
        "kind": "load", "force": _list(c.force), "torque": _list(c.torque), "point": _list(c.point),
        "turning": c.turning,
    },
}  # fmt: skip


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _controller(controller: Controller) -> dict[str, Any]:
    return {"kp": controller.kp, "ki": controller.ki, "kd": controller.kd, "limit": _finite(controller.limit)}


def _control(data: ControllerData) -> Controller:
    return Controller(data.kp, data.ki, data.kd, math.inf if data.limit is None else data.limit)


def _component(component: Component) -> dict[str, Any]:
    return {"name": component.name, "subject": component.subject, **_WRITERS[type(component)](component)}


def _array(values: Any, shape: tuple[int, ...] = (3,)) -> Array:
    return np.full(shape, np.nan) if values is None else np.array(values, dtype=np.float64)


def _vector(values: Any) -> Array | None:
    return None if values is None else _array(values)


def _signal(law: ConstantLaw | RampLaw | SineLaw | TableLaw) -> Signal:
    if isinstance(law, ConstantLaw):
        return Constant(law.level)
    if isinstance(law, RampLaw):
        return Ramp(law.offset, law.slope)
    if isinstance(law, SineLaw):
        return Sine(law.offset, law.amplitude, law.speed, law.phase)
    if len(law.times) != len(law.levels) or len(law.times) < 2:
        raise ValueError("a table needs two or more times and as many levels")
    return Table(tuple(law.times), tuple(law.levels))


def _read(data: Any) -> Component:
    named = data.name, data.subject
    if isinstance(data, GroundData):
        return Ground(*named)
    if isinstance(data, BodyData):
        return RigidBody(*named, data.mass, _array(data.centre_of_mass), _array(data.inertia, (3, 3)))
    if isinstance(data, JointData):
        geometry = JointGeometry(_vector(data.axis), _vector(data.point), _vector(data.axis2), data.pitch)
        KINDS[data.type].chain(geometry)
        return JointComponent(*named, KINDS[data.type], geometry)
    if isinstance(data, MotionData):
        return MotionDrive(*named, _signal(data.law))
    if isinstance(data, EffortData):
        return EffortDrive(*named, _signal(data.law))
    if isinstance(data, SpringData):
        return Spring(*named, data.stiffness, data.rest)
    if isinstance(data, DamperData):
        return Damper(*named, data.damping)
    if isinstance(data, GearData):
        return Gear(*named, data.ratio)
    if isinstance(data, EndStopData):
        lower = -math.inf if data.lower is None else data.lower
        return EndStop(*named, lower, math.inf if data.upper is None else data.upper)
    if isinstance(data, ServoData):
        return Servo(*named, _signal(data.target), _control(data.controller))
    if isinstance(data, DcMotorData):
        return DcMotor(*named, data.resistance, data.inductance, data.constant, data.gear)
    if isinstance(data, VoltageData):
        return VoltageSource(*named, _signal(data.law))
    if isinstance(data, VoltageControllerData):
        return VoltageController(*named, _signal(data.target), _control(data.controller))
    if isinstance(data, SpringDamperData):
        return SpringDamper(*named, _array(data.point), _array(data.other), data.stiffness, data.damping, data.rest)
    return LoadComponent(*named, _array(data.force), _array(data.torque), _array(data.point), data.turning)
