"""`/mass`: mass properties of parts and bodies, in the world frame at the pose of the meshes."""

from __future__ import annotations

import h5py

from kinform.model.mass import MassProperties, MassReport
from kinform.results.table import (
    flag,
    matrix,
    read_records,
    read_rows,
    real,
    text,
    vector,
    write_records,
    write_rows,
)

__all__ = ["read", "write"]

_PROPERTIES = (
    text("name"), real("mass", "kg"), real("volume", "m³"), vector("centre_of_mass", "m"),
    matrix("inertia", "kg·m²"), vector("principal_moments", "kg·m²", ("1", "2", "3")),
    matrix("principal_axes", "1"), real("mass_bound", "1"), text("origin"), text("reason"),
)  # fmt: skip
_PROBLEMS = (text("part"), text("problem"))
_SUMMARY = (flag("valid"),)


def write(group: h5py.Group, report: MassReport) -> None:
    """Write the properties of parts and bodies, and what is wrong with them."""
    write_records(group, "summary", _SUMMARY, [report])
    write_records(group, "parts", _PROPERTIES, report.parts)
    write_records(group, "bodies", _PROPERTIES, report.bodies)
    problems = [{"part": part, "problem": problem} for part, problem in report.problems]
    write_rows(group, "problems", _PROBLEMS, problems)


def read(group: h5py.Group) -> MassReport:
    """The report that `write` wrote."""
    (summary,) = read_rows(group, "summary", _SUMMARY)
    return MassReport(
        parts=read_records(group, "parts", _PROPERTIES, MassProperties),
        bodies=read_records(group, "bodies", _PROPERTIES, MassProperties),
        problems=tuple((row["part"], row["problem"]) for row in read_rows(group, "problems", _PROBLEMS)),
        **summary,
    )
