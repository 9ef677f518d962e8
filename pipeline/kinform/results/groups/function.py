"""`/assembly/function` and `/assembly/simulation`: what the designer wants, and what is to be simulated."""

from __future__ import annotations

from typing import Any

import h5py

from kinform.model.function import (
    Coupling,
    Drive,
    Function,
    InitialValue,
    IntendedJoint,
    Law,
    Load,
    Requirement,
    SimulationRequest,
)
from kinform.results.table import (
    integer,
    pair,
    read_ragged,
    read_records,
    read_rows,
    real,
    text,
    texts,
    values,
    vector,
    write_ragged,
    write_records,
    write_rows,
)

__all__ = ["read", "read_request", "write", "write_request"]

_AS_STATED = "unit of the manifest"
_PLACE = (text("file"), integer("line", optional=True))
_HEADER = (integer("mobility", optional=True), integer("mobility_line", optional=True))
_JOINTS = (
    text("name"), pair("between", text, ("between_a", "between_b")), text("type"), vector("axis", "1"),
    vector("axis2", "1"), vector("point", "m"), real("pitch", "m"),
    pair("range", real, ("range_lower", "range_upper"), "rad or m"), *_PLACE,
)  # fmt: skip
_COUPLINGS = (pair("joints", text, ("joint_a", "joint_b")), real("ratio", "1"), *_PLACE)
_LAW = tuple(
    real(name, unit)
    for name, unit in (
        ("value", _AS_STATED), ("amplitude", _AS_STATED), ("frequency", "Hz"), ("phase", "deg"),
        ("offset", _AS_STATED), ("rate", f"{_AS_STATED} a second"),
    )
)  # fmt: skip
_DRIVES = (
    text("joint"), text("kind"), values("parameters"), real("metres_per_unit", "m"), *_PLACE,
    text("law_type"), text("law_file"), *_LAW,
)  # fmt: skip
_LOADS = (
    text("part"), vector("force", "N"), vector("torque", "N·m"), vector("point", "m"), text("frame"), *_PLACE,
)  # fmt: skip
_REQUIREMENTS = (text("name"), text("kind"), values("values"), *_PLACE)
_REQUEST = (
    text("level"), real("duration", "s"), real("step", "s"), vector("gravity", "m/s²"), *_PLACE, texts("assumed"),
)  # fmt: skip
_INITIAL = (
    text("joint"), real("position", _AS_STATED), real("velocity", f"{_AS_STATED} a second"),
    real("metres_per_unit", "m"), *_PLACE,
)  # fmt: skip


def write(group: h5py.Group, function: Function) -> None:
    """Write all of `[function]`."""
    write_records(group, "header", _HEADER, [function])
    write_records(group, "joints", _JOINTS, function.joints)
    write_records(group, "couplings", _COUPLINGS, function.couplings)
    write_rows(group, "drives", _DRIVES, [_drive_row(drive) for drive in function.drives])
    laws = [drive.law or Law("") for drive in function.drives]
    write_ragged(group, "law_times", [law.times for law in laws], "s")
    write_ragged(group, "law_values", [law.values for law in laws], _AS_STATED)
    write_records(group, "loads", _LOADS, function.loads)
    write_records(group, "requirements", _REQUIREMENTS, function.requirements)


def read(group: h5py.Group) -> Function:
    """The function that `write` wrote."""
    (header,) = read_rows(group, "header", _HEADER)
    return Function(
        **header,
        joints=read_records(group, "joints", _JOINTS, IntendedJoint),
        couplings=read_records(group, "couplings", _COUPLINGS, Coupling),
        drives=_read_drives(group),
        loads=read_records(group, "loads", _LOADS, Load),
        requirements=read_records(group, "requirements", _REQUIREMENTS, Requirement),
    )


def write_request(group: h5py.Group, request: SimulationRequest) -> None:
    """Write `[simulation]`."""
    write_records(group, "request", _REQUEST, [request])
    write_records(group, "initial", _INITIAL, request.initial)


def read_request(group: h5py.Group) -> SimulationRequest:
    """The request that `write_request` wrote."""
    (row,) = read_rows(group, "request", _REQUEST, added=("assumed",))
    return SimulationRequest(**row, initial=read_records(group, "initial", _INITIAL, InitialValue))


def _drive_row(drive: Drive) -> dict[str, Any]:
    law = drive.law
    numbers = {column.field: None if law is None else getattr(law, column.field) for column in _LAW}
    kind, file = (None, None) if law is None else (law.type, law.file)
    return vars(drive) | numbers | {"law_type": kind, "law_file": file}


def _read_drives(group: h5py.Group) -> tuple[Drive, ...]:
    times, table = read_ragged(group, "law_times"), read_ragged(group, "law_values")
    drives = []
    for i, row in enumerate(read_rows(group, "drives", _DRIVES)):
        kind, file = row.pop("law_type"), row.pop("law_file")
        numbers = {column.field: row.pop(column.field) for column in _LAW}
        points: dict[str, Any] = {"times": tuple(times[i].tolist()), "values": tuple(table[i].tolist())}
        drives.append(Drive(**row, law=None if kind is None else Law(kind, file=file, **numbers, **points)))
    return tuple(drives)
