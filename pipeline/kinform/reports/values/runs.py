"""The port model, runs and ranges as JSON has them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from kinform.behaviour.joints import KINDS
from kinform.design import Design
from kinform.function import DesignersJoint, as_intended, designers_joints, range_as_stated
from kinform.model.arrays import Array
from kinform.model.collisions import JointRange
from kinform.model.simulation import Simulation
from kinform.reports.values.plain import fields


def behaviour_values(design: Design) -> dict[str, Any]:
    """Counts of the port model at each level, and its network."""
    from kinform.behaviour import counts
    from kinform.exports.port_model import network

    model = design.behaviour
    assert model is not None
    levels = [
        {"system": path, "unknowns": found.unknowns, "equations": found.equations, "balanced": found.balanced}
        for path, found in counts(model.nested)
    ]
    return {
        "counts": levels,
        **network(model.nested),
        "failures": [{"subject": subject, "message": why} for subject, why in model.failures],
        "forces_missing": [{"subject": subject, "message": why} for subject, why in model.forces_missing],
    }


def simulation_values(design: Design) -> dict[str, Any]:
    """What a run did, with its ranges and collisions."""
    run = design.simulation
    assert run is not None
    ran = bool(len(run.time))
    known = {} if design.kinematics is None else designers_joints(design.assembly, design.kinematics)
    return {
        "status": run.status,
        "reason": run.reason or None,
        "level": run.level or None,
        "not_dynamic": [{"subject": subject, "message": why} for subject, why in run.not_dynamic],
        "duration": run.time[-1] if ran else None,
        "samples": len(run.time),
        "bodies": run.body_names,
        "joints": _courses(run, known) if ran else [],
        "residual": run.residual.max() if len(run.residual) else None,
        "balance": run.balance.max() if run.level == "dynamic" and len(run.balance) else None,
        "drives": [fields(use, *_OF_DRIVE) for use in run.drives],
        "sensors": [
            fields(reading, "sensor", "quantity", "component", "unit", "known") | _extremes(run.sensed[:, k])
            for k, reading in enumerate(run.readings)
        ],
        "gears": [
            {
                "joint": name,
                "peak": np.abs(run.gear_effort[:, k]).max(axis=0, initial=0.0),
                "peak_force": np.abs(run.gear_force[:, k]).max(initial=0.0),
            }
            for k, name in enumerate(run.gear_names)
        ],
        "undetermined": {
            name: [label for label, flag in zip(_COMPONENTS, flags, strict=True) if flag]
            for name, flags in zip(run.joint_names, run.undetermined, strict=False)
        },
        "assumptions": run.assumptions,
        "failures": [{"subject": subject, "message": message} for subject, message in run.failures],
        "ranges": None if run.ranges is None else [_range(item, known.get(item.joint)) for item in run.ranges],
        "collisions": None
        if run.collisions is None
        else [fields(item, "parts", "time", "place", "depth") for item in run.collisions],
        "collisions_unknown": [{"parts": [a, b], "reason": why} for a, b, why in run.uncollided],
    }


_OF_DRIVE = ("joint", "freedom", "kind", "peak", "rms", "peak_power", "work", "peak_speed", "rms_power")


def _extremes(values: Array) -> dict[str, Any]:
    """Of what a sensor read where it is known; null where it never is."""
    known = values[np.isfinite(values)]
    ends = {"start": values[0], "end": values[-1]} if len(values) else {"start": None, "end": None}
    ends = {key: value if value is not None and np.isfinite(value) else None for key, value in ends.items()}
    return ends | {"lowest": known.min() if len(known) else None, "highest": known.max() if len(known) else None}


_COMPONENTS = ("tau_x", "tau_y", "tau_z", "f_x", "f_y", "f_z")


def _range(item: JointRange, one: DesignersJoint | None) -> dict[str, Any]:
    """A range as kinform has it, and with the name and in the sense that the function gives its joint."""
    of_end = ("status", "value", "parts", "place", "reason", "leaves")
    stated = None if one is None else range_as_stated(item, one)
    return {
        "joint": item.joint,
        "status": item.status,
        "lower": fields(item.lower, *of_end),
        "upper": fields(item.upper, *of_end),
        "left_out": item.left_out,
        "intended_name": None if stated is None else stated.joint,
        "intended_lower": None if stated is None else fields(stated.lower, *of_end),
        "intended_upper": None if stated is None else fields(stated.upper, *of_end),
    }


def _courses(run: Simulation, known: Mapping[str, DesignersJoint]) -> list[dict[str, Any]]:
    """Each coordinate as kinform has it, and with the name and in the sense that the function gives its joint."""
    seen = as_intended(run, known)
    out = []
    for (name, kind, unit, column), (theirs, *_) in zip(coordinates(run), coordinates(seen), strict=True):
        named = run.joint_names[int(np.searchsorted(run.joint_offset, column, side="right")) - 1] in known
        course = _course(seen, theirs, kind, unit, column)
        intended = {key: course[key] for key in ("start", "end", "lowest", "highest")} if named else None
        out.append(
            _course(run, name, kind, unit, column)
            | {"intended_name": theirs if named else None, "intended_position": intended}
        )
    return out


def _course(run: Simulation, name: str, kind: str, unit: str, column: int) -> dict[str, Any]:
    values = run.joint_position[:, column]
    return {
        "name": name,
        "type": kind,
        "unit": unit,
        "start": values[0],
        "end": values[-1],
        "lowest": values.min(),
        "highest": values.max(),
        "fastest": np.abs(run.joint_velocity[:, column]).max(),
    }


def coordinates(run: Simulation) -> Iterator[tuple[str, str, str, int]]:
    """Of each joint coordinate of a run its name ("joint", or of several "joint.angle"), the type of the
    joint, the unit (rad, m, or 1 for the quaternion of a spherical joint, whose rates are rad/s), the column.
    """
    for joint, (name, kind) in enumerate(zip(run.joint_names, run.joint_types, strict=True)):
        labels = KINDS[kind].coordinates
        for column, (label, rotational) in enumerate(labels, start=int(run.joint_offset[joint])):
            unit = "1" if kind == "spherical" else "rad" if rotational else "m"
            yield (name if len(labels) == 1 else f"{name}.{label}"), kind, unit, column
