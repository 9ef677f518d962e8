"""csv: the motion as tables, SI and radians: bodies and joints, and where there are any reactions, drives, sensors."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from kinform.behaviour.joints import KINDS
from kinform.exports.exported import Exported, ExportError
from kinform.exports.model import ExportModel
from kinform.foundation.escapes import csv_cell
from kinform.function import as_intended, designers_joints
from kinform.model.arrays import Array
from kinform.model.simulation import Simulation
from kinform.simulation import amplitude_spectrum


def export(model: ExportModel) -> Exported:
    """`bodies.csv`: time, then NAME.x … NAME.qz. `joints.csv`: time, then NAME.position, .velocity, .effort.

    Joints have the names and the sense that the function gives them. One with several coordinates has them as
    NAME.angle.position and so on. `reactions.csv`: NAME on BODY.force.x … .torque.z, about the joint's point in world
    axes, on the second body. `drives.csv`: N JOINT KIND.effort, .speed, .power. `sensors.csv`: NAME.position.x and so
    on. `spectra.csv`: Hz, then the amplitudes of sensors and of efforts of drives (`kinform.simulation.spectra`), where
    there are enough outputs. What redundancy leaves open is called "(not determined)". Raises ExportError without a
    motion.
    """
    run = model.simulation
    if run is None:
        raise ExportError("there is no motion to export: nothing was simulated; see `kinform show F.h5 simulation`")
    known = designers_joints(model.assembly, model.kinematics)
    seen = as_intended(run, known)
    files = {"bodies.csv": _table(*_bodies(run)), "joints.csv": _table(*_joints(seen))}
    if len(run.F_B):
        files["reactions.csv"] = _table(*_reactions(model, seen))
    if run.drives and len(run.drive_effort):
        files["drives.csv"] = _table(*_drives(seen))
    if run.readings:
        files["sensors.csv"] = _table(*_sensors(run))
    if spectra := _spectra(seen):
        files["spectra.csv"] = _table(*spectra)
    return Exported(files)


_OPEN = " (not determined)"
"""After the name of a column that redundancy leaves open."""


def _reactions(model: ExportModel, run: Simulation) -> tuple[list[str], Array]:
    """On the second body of each derived joint; `run` has the designer's names of joints."""
    second = {joint.subject: model.system.body_at(joint.name, "b").subject for joint in model.system.joints}
    derived = [] if model.simulation is None else model.simulation.joint_names
    header, columns = ["time"], [run.time[:, None]]
    for k, (name, own) in enumerate(zip(run.joint_names, derived, strict=True)):
        loose = run.undetermined[k]
        for quantity, first in (("force", 3), ("torque", 0)):
            for n, axis in enumerate("xyz", start=first):
                header.append(f"{name} on {second[own]}.{quantity}.{axis}{_OPEN if loose[n] else ''}")
                columns.append(run.F_B[:, k, n, None])
    return header, np.hstack(columns)


def _drives(run: Simulation) -> tuple[list[str], Array]:
    header, columns = ["time"], [run.time[:, None]]
    for k, use in enumerate(run.drives):
        effort, speed = run.drive_effort[:, k, None], run.drive_speed[:, k, None]
        header += [f"{k + 1} {use.joint} {use.kind}.{what}" for what in ("effort", "speed", "power")]
        columns += [effort, speed, effort * speed]
    return header, np.hstack(columns)


def _sensors(run: Simulation) -> tuple[list[str], Array]:
    header = ["time"]
    for reading in run.readings:
        name = ".".join(filter(None, (reading.sensor, reading.quantity.replace(" ", "_"), reading.component)))
        header.append(name if reading.known else name + _OPEN)
    return header, np.hstack([run.time[:, None], run.sensed])


def _spectra(run: Simulation) -> tuple[list[str], Array] | None:
    """Of what has one."""
    named = [*zip(_sensors(run)[0][1:], run.sensed.T, strict=True)] if run.readings else []
    if run.drives and len(run.drive_effort):
        names, columns = _drives(run)
        named += [(name, column) for name, column in zip(names, columns.T, strict=True) if name.endswith(".effort")]
    found = [(name, amplitude_spectrum(run.time, values)) for name, values in named]
    kept = [(name, spectrum) for name, spectrum in found if spectrum is not None]
    if not kept:
        return None
    amplitudes = [spectrum.amplitude for _, spectrum in kept]
    return ["frequency", *(name for name, _ in kept)], np.column_stack([kept[0][1].frequency, *amplitudes])


def _bodies(run: Simulation) -> tuple[list[str], Array]:
    header = ["time"]
    columns = [run.time[:, None]]
    for k, name in enumerate(run.body_names):
        header += [f"{name}.{what}" for what in ("x", "y", "z", "qw", "qx", "qy", "qz")]
        columns += [run.p_WB[:, k], run.q_WB[:, k]]
    return header, np.hstack(columns)


def _joints(run: Simulation) -> tuple[list[str], Array]:
    header = ["time"]
    columns = [run.time[:, None]]
    for k, (name, kind) in enumerate(zip(run.joint_names, run.joint_types, strict=True)):
        first = int(run.joint_offset[k])
        coordinates = KINDS[kind].coordinates
        for n, (coordinate, _) in enumerate(coordinates):
            prefix = name if len(coordinates) == 1 else f"{name}.{coordinate}"
            header += [f"{prefix}.{what}" for what in ("position", "velocity", "effort")]
            columns += [
                values[:, first + n, None] for values in (run.joint_position, run.joint_velocity, run.joint_effort)
            ]
    return header, np.hstack(columns)


def _table(header: list[str], rows: Iterable[Array]) -> bytes:
    lines = [",".join(map(csv_cell, header)), *(",".join(repr(float(value) + 0.0) for value in row) for row in rows)]
    return "".join(f"{line}\n" for line in lines).encode("utf-8")
