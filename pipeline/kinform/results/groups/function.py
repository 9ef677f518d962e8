"""`/assembly/function` and `/assembly/simulation`: what the designer wants, and what is to be simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import h5py

from kinform.model.function import Drive, Function, Law, SimulationRequest
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Ragged, Row, Rows, Table, Texts
from kinform.results.records import columns_of, defaults, hint
from kinform.results.table import read_rows, text, write_rows


class _Drives:
    """One row a drive with the numbers of its law; the points of tables are ragged."""

    dataset, fields = "drives", ("drives",)
    of_drive = columns_of(hint(Drive), frozenset({"law"}))
    named = (("type", text("law_type")), ("file", text("law_file")))
    of_law = columns_of(hint(Law), frozenset({"type", "file", "times", "values"}))
    numbers = tuple(replace(column, optional=True) for column in of_law)  # a drive may have no law
    columns = (*of_drive, named[0][1], named[1][1], *numbers)
    points = (Ragged("law_times", "times"), Ragged("law_values", "values"))

    def write(self, group: h5py.Group, cls: type, records: Sequence[Function]) -> None:
        drives = records[0].drives
        laws = [*(name for name, _ in self.named), *(column.field for column in self.numbers)]
        of_drives = [[getattr(drive, column.field) for drive in drives] for column in self.of_drive]
        of_laws = [[getattr(drive.law, field, None) for drive in drives] for field in laws]
        write_rows(group, "drives", self.columns, of_drives + of_laws)
        for points in self.points:
            points.write(group, Law, [drive.law or Law("") for drive in drives])

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        drives = read_rows(group, "drives", self.columns, defaults(Drive))
        laws: Rows = [{name: row.pop(column.field) for name, column in self.named} for row in drives]
        for row, law in zip(drives, laws, strict=True):
            law.update({column.field: row.pop(column.field) for column in self.numbers})
        for points in self.points:
            points.read(group, Law, laws)
        made = [None if law["type"] is None else Law(**law) for law in laws]
        rows[0]["drives"] = tuple(Drive(**row, law=law) for row, law in zip(drives, made, strict=True))


FUNCTION = Layout(
    Function,
    Row("header", "mobility", "mobility_line"),
    Table("joints"),
    Table("couplings"),
    _Drives(),
    Table("loads"),
    Table("requirements"),
    Table("frictions"),
    Texts("complete"),
)
REQUEST = Layout(
    SimulationRequest,
    Row(
        "request", "level", "duration", "step", "gravity", "file", "line", "partial", "stops", "restitution", "assumed"
    ),
    Table("initial"),
    Table("sensors"),
)
