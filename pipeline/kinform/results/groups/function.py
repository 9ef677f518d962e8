"""`/assembly/function` and `/assembly/simulation`: what the designer wants, and what is to be simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import h5py

from kinform.model.function import Drive, Function, Law, Load, SimulationRequest
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Ragged, Row, Rows, Table, Texts
from kinform.results.records import columns_of, defaults, hint, hints, record_values
from kinform.results.table import read_rows, text, write_rows

_NAMED = (("type", text("law_type")), ("file", text("law_file")))
_OF_LAW = columns_of(hint(Law), frozenset({"type", "file", "times", "values"}))
_NUMBERS = tuple(replace(column, optional=True) for column in _OF_LAW)
"""Nothing needs to have a law."""


class _WithLaws:
    """One row a record with the numbers of its law; the points of tables are ragged."""

    def __init__(self, field: str, record: type, points: str, *, later: bool = False):
        """`points`: how the names of the datasets of tables begin; `later`: files of older versions have no laws."""
        self.dataset, self.fields, self._record = field, (field,), record
        self._own = columns_of(hint(record), frozenset(hints(record)), _plain(record))
        self._columns = (*self._own, _NAMED[0][1], _NAMED[1][1], *_NUMBERS)
        own = {column.field for column in self._own}
        self._later = {column.field for column in self._columns} - own if later else set()
        self._points = (Ragged(f"{points}_times", "times"), Ragged(f"{points}_values", "values"))

    def write(self, group: h5py.Group, cls: type, records: Sequence[Function]) -> None:
        found = getattr(records[0], self.dataset)
        laws = [*(name for name, _ in _NAMED), *(column.field for column in _NUMBERS)]
        own = [record_values(hint(self._record), found, column) for column in self._own]
        of_laws = [[getattr(one.law, field, None) for one in found] for field in laws]
        write_rows(group, self.dataset, self._columns, own + of_laws)
        for points in self._points:
            points.write(group, Law, [one.law or Law("constant") for one in found])

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        found = read_rows(group, self.dataset, self._columns, defaults(self._record) | self._later)
        laws: Rows = [{name: row.pop(column.field, None) for name, column in _NAMED} for row in found]
        for row, law in zip(found, laws, strict=True):
            law.update({column.field: row.pop(column.field, None) for column in _NUMBERS})
        if not self._later or self._points[0].dataset in group:
            for points in self._points:
                points.read(group, Law, laws)
        made = [None if law["type"] is None else Law(**law) for law in laws]
        rows[0][self.dataset] = tuple(self._record(**row, law=law) for row, law in zip(found, made, strict=True))


def _plain(record: type) -> tuple[str, ...]:
    """Fields of a record but for its law."""
    return tuple(name for name in hints(record) if name != "law")


FUNCTION = Layout(
    Function,
    Row("header", "mobility", "mobility_line"),
    Table("joints"),
    Table("couplings"),
    _WithLaws("drives", Drive, "law"),
    _WithLaws("loads", Load, "load_law", later=True),
    Table("springs"),
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
