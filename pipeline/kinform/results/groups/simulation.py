"""`/simulation`: trajectories, under the names that the results contract fixes."""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np

from kinform.model.arrays import freeze
from kinform.model.simulation import DriveUse, Simulation
from kinform.results.groups import collisions as _collisions
from kinform.results.table import (
    TEXT,
    read_array,
    read_columns,
    read_records,
    read_rows,
    read_texts,
    real,
    text,
    write_array,
    write_columns,
    write_records,
    write_rows,
    write_texts,
)

__all__ = ["read", "write"]

_SUMMARY = (text("status"), text("reason"), text("level"))
_FAILURES = (text("subject"), text("reason"))
_ARRAYS = {
    "time": "s", "p_WB": "m", "q_WB": "1", "joint_position": "rad or m", "joint_velocity": "rad/s or m/s",
    "joint_effort": "N·m or N", "energy": "J",
}  # fmt: skip
_LATER = {
    "joint_acceleration": "rad/s² or m/s²", "F_A": "N·m, N", "F_B": "N·m, N", "balance_bodies": "1", "balance_shafts": "1",
    "gear_effort": "N·m or N", "gear_force": "N",
}  # fmt: skip
"""Arrays that files of the same schema may lack."""
_DRIVES = (
    text("joint"), text("kind"), real("peak", "N·m or N"), real("rms", "N·m or N"), real("peak_power", "W"),
    real("work", "J"),
)  # fmt: skip
_NAMES = ("body_names", "joint_names", "joint_types")


def write(group: h5py.Group, simulation: Simulation) -> None:
    """Write the run; coordinates of joint j are joint_offset[j] to joint_offset[j+1]."""
    write_records(group, "summary", _SUMMARY, [simulation])
    for name, unit in (_ARRAYS | _LATER).items():
        write_array(group, name, getattr(simulation, name), unit)
    group["energy"].attrs.create("columns", ["kinetic", "potential", "work"], dtype=TEXT)
    for name in _NAMES:
        write_texts(group, name, getattr(simulation, name))
    write_array(group, "joint_offset", simulation.joint_offset, "1", "<i8")
    monitors = {
        "residual": ("m or rad", simulation.residual.astype("<f8")),
        "rank": ("1", simulation.rank.astype("<i8")),
        "balance": ("1", simulation.balance.astype("<f8")),
    }
    write_columns(group, "monitors", monitors)
    write_array(group, "undetermined", simulation.undetermined, "1", "|u1")
    write_texts(group, "gear_names", simulation.gear_names)
    write_records(group, "drives", _DRIVES, simulation.drives)
    write_texts(group, "assumptions", simulation.assumptions)
    failures = [{"subject": subject, "reason": reason} for subject, reason in simulation.failures]
    write_rows(group, "failures", _FAILURES, failures)
    _collisions.write(group, simulation)


def read(group: h5py.Group) -> Simulation:
    """The run that `write` wrote."""
    (summary,) = read_rows(group, "summary", _SUMMARY)
    monitors = read_columns(group, "monitors")
    known: dict[str, Any] = {name: read_array(group, name) for name in _ARRAYS}
    known |= {name: read_array(group, name) for name in _LATER if name in group}
    known |= {name: read_texts(group, name) for name in _NAMES}
    if "balance" in monitors.dtype.names:
        known["balance"] = freeze(monitors["balance"].copy())
    if "undetermined" in group:
        known["undetermined"] = freeze(read_array(group, "undetermined").astype(np.bool_))
    if "gear_names" in group:
        known["gear_names"] = read_texts(group, "gear_names")
    if "drives" in group:
        known["drives"] = read_records(group, "drives", _DRIVES, DriveUse)
    return Simulation(
        **summary,
        **known,
        joint_offset=read_array(group, "joint_offset"),
        residual=freeze(monitors["residual"].copy()),
        rank=freeze(monitors["rank"].copy()),
        assumptions=read_texts(group, "assumptions"),
        failures=tuple((row["subject"], row["reason"]) for row in read_rows(group, "failures", _FAILURES)),
        **_collisions.read(group),
    )
