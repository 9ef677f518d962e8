"""json: the port model as data, and reading it back. Its shape is in `port_schema`.

Numbers are doubles in shortest decimal form, so that reading gives an equal model, bit by bit.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
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
    flat,
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
from kinform.behaviour.kinds import kind_of
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
    SystemData,
    TableLaw,
    VoltageControllerData,
    VoltageData,
)
from kinform.model.arrays import Array

__all__ = ["data", "export", "network", "read", "write"]


def export(model: ExportModel) -> Exported:
    """One file with the port model."""
    starts = []
    for joint in model.system.joints:
        position, velocity = model.coordinates(joint.subject)
        starts.append({"joint": joint.name, "position": position.tolist(), "velocity": velocity.tolist()})
    text = write(model.nested, model.name, gravity=model.gravity, start=starts, missing=model.missing)
    name = identifiers([model.name], FILES)[model.name]
    return Exported({f"{name}.json": text.encode("utf-8", "replace")}, model.missing)


def write(
    system: System,
    name: str,
    *,
    gravity: Sequence[float] | Array = (0.0, 0.0, -9.81),
    start: Sequence[Mapping[str, Any]] = (),
    missing: Sequence[str] = (),
) -> str:
    """The text of the file with a system of any depth, called `name`, under gravity (3,) m/s².

    `start` and `missing` as in the schema. Raises ValueError for signals and components that are none of kinform's,
    and for laws that contain a value that is not finite.
    """
    counted = count(flat(system))
    data = {
        "schema": SCHEMA,
        "name": name,
        "gravity": [float(value) for value in gravity],
        **network(system),
        "start": list(start),
        "count": {"unknowns": counted.unknowns, "equations": counted.equations},
        "missing": list(missing),
    }
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read(text: str | bytes) -> System:
    """The components and nodes in a file that `export` or `write` wrote. Raises InputError for anything else."""
    try:
        return _read_network(PortModel.model_validate_json(text))
    except ValidationError as error:
        raise InputError(
            Problem(f"{'.'.join(map(str, one['loc']))}: {one['msg']}", remedy="see the schema of the port model")
            for one in error.errors(include_url=False)
        ) from error
    except ValueError as error:
        raise InputError([Problem(str(error), remedy="export the model again")]) from error


def network(system: System) -> dict[str, Any]:
    """Components, nodes, and the ports that the system exposes where it does."""
    ports = [{"name": port, "component": c, "port": p} for port, (c, p) in system.exposed]
    return {
        "components": [data(component) for component in system.components],
        "nodes": [
            {"size": node.size, "ports": [{"component": c, "port": p} for c, p in node.ports]} for node in system.nodes
        ],
        **({"ports": ports} if ports else {}),
    }


def _read_network(found: PortModel | SystemData, name: str = "", subject: str = "", prefixed: bool = True) -> System:
    components = tuple(_read(component) for component in found.components)
    nodes = tuple(Node(tuple((p.component, p.port) for p in node.ports), node.size) for node in found.nodes)
    exposed = tuple((port.name, (port.component, port.port)) for port in found.ports)
    return System(components, nodes, name, subject, exposed, prefixed)


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
    if not isinstance(signal, Table):
        raise ValueError(f"a signal of the kind {type(signal).__name__} is none of kinform's")
    return {"law": "table", "times": list(signal.knots), "levels": list(signal.levels)}


_WRITERS: dict[type[Component], Callable[[Any], dict[str, Any]]] = {
    Ground: lambda c: {},
    RigidBody: lambda c: {
        "mass": c.mass, "centre_of_mass": _list(c.centre_of_mass), "inertia": _list(c.inertia),
    },
    JointComponent: lambda c: {
        "type": c.kind.name, "axis": _list(c.geometry.axis), "point": _list(c.geometry.point),
        "axis2": _list(c.geometry.axis2), "pitch": c.geometry.pitch,
    },
    MotionDrive: lambda c: {"law": _law(c.signal)},
    EffortDrive: lambda c: {"law": _law(c.signal)},
    Spring: lambda c: {"stiffness": c.stiffness, "rest": c.rest},
    Damper: lambda c: {"damping": c.damping},
    Gear: lambda c: {
        "ratio": c.ratio,
        **{key: _list(getattr(c, key)) for key in ("pitch_point", "flank", "back") if getattr(c, key) is not None},
        **{key: getattr(c, key) for key in ("lower", "upper") if math.isfinite(getattr(c, key))},
    },
    EndStop: lambda c: {"lower": _finite(c.lower), "upper": _finite(c.upper)},
    Servo: lambda c: {"target": _law(c.target), "controller": _controller(c.controller)},
    DcMotor: lambda c: {
        "resistance": c.resistance, "inductance": c.inductance, "constant": c.constant,
        "gear": c.gear,
    },
    VoltageSource: lambda c: {"law": _law(c.signal)},
    VoltageController: lambda c: {
        "target": _law(c.target), "controller": _controller(c.controller),
    },
    SpringDamper: lambda c: {
        "point": _list(c.point), "other": _list(c.other), "stiffness": c.stiffness,
        "damping": c.damping, "rest": c.rest,
    },
    LoadComponent: lambda c: {
        "force": _list(c.force), "torque": _list(c.torque), "point": _list(c.point),
        "turning": c.turning,
    },
    System: lambda c: {
        "prefixed": c.prefixed, **network(c),
        "count": {"unknowns": count(c).unknowns, "equations": count(c).equations},
    },
}  # fmt: skip


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _controller(controller: Controller) -> dict[str, Any]:
    return {"kp": controller.kp, "ki": controller.ki, "kd": controller.kd, "limit": _finite(controller.limit)}


def _control(data: ControllerData) -> Controller:
    return Controller(data.kp, data.ki, data.kd, math.inf if data.limit is None else data.limit)


def data(component: Component) -> dict[str, Any]:
    """A component as JSON has it. Raises ValueError for a kind that is none of kinform's."""
    return {
        "name": component.name, "subject": component.subject, "kind": kind_of(component),
        **_WRITERS[type(component)](component),
    }  # fmt: skip


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
    if isinstance(data, SystemData):
        return _read_network(data, *named, data.prefixed)
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
        point, flank, back = (_vector(values) for values in (data.pitch_point, data.flank, data.back))
        lower = -math.inf if data.lower is None else data.lower
        return Gear(*named, data.ratio, point, flank, back, lower, math.inf if data.upper is None else data.upper)
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
