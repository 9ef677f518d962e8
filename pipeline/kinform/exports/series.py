"""csv: the motion as two tables, `bodies.csv` and `joints.csv`, SI and radians."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable

import numpy as np

from kinform.behaviour.joints import KINDS
from kinform.exports.exported import Exported, ExportError
from kinform.exports.model import ExportModel
from kinform.function import as_intended, designers_joints
from kinform.model.arrays import Array
from kinform.model.simulation import Simulation


def export(model: ExportModel) -> Exported:
    """`bodies.csv`: time, then NAME.x … NAME.qz. `joints.csv`: time, then NAME.position, .velocity, .effort.

    Joints have the names and the sense that the function gives them. One with several coordinates has them as
    NAME.angle.position and so on. Raises ExportError without a motion.
    """
    run = model.simulation
    if run is None:
        raise ExportError("there is no motion to export: nothing was simulated; see `kinform show F.h5 simulation`")
    known = designers_joints(model.assembly, model.kinematics)
    return Exported({"bodies.csv": _table(*_bodies(run)), "joints.csv": _table(*_joints(as_intended(run, known)))})


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
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([repr(float(value) + 0.0) for value in row] for row in rows)
    return out.getvalue().encode("utf-8")
