"""Which datasets a group of the results file has, and in which order, said once for writing and reading.

A `Layout` names a class and, in the order of the file, what holds its fields; units, labels and kinds follow from the
class (`records`):

    Layout(
        Kinematics,
        Table("bodies"),                                    # one row a body, all of its fields
        Table(
            "joints",
            Ragged("twists", width=6),                      # an array of its own length for each joint
            Table("blockers", owner="joint"),               # one row a blocker, with the row of its joint
            Row("held", "held", "extremes", "held_reason"), # some fields of each joint in a table of their own
        ),
        Table("misfit"),                                    # one record: one row
    )

Whatever holds fields is given all records that have them: one for the group as a whole, many inside of a `Table`. What
an older file lacks leaves a field to its default; where there is none, the file is damaged (KeyError). What is None is
not written.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import is_dataclass
from typing import Any, Protocol

import h5py
import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import freeze
from kinform.results.held import HeldGroup
from kinform.results.records import Hint, columns_of, defaults, hint, hints, record_maker, record_values
from kinform.results.table import (
    DatasetError,
    integer,
    read_array,
    read_columns,
    read_ragged,
    read_rows,
    read_texts,
    write_array,
    write_columns,
    write_ragged,
    write_rows,
    write_texts,
)

Rows = list[dict[str, Any]]
"""Fields of records as they are read, by name."""


class Holder(Protocol):
    """Holds some fields of records in datasets of a group."""

    @property
    def fields(self) -> tuple[str, ...]:
        """Those that are held here."""

    @property
    def dataset(self) -> str:
        """The dataset without which none of it is in the file."""

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        """Write the fields of all records, which are of one class."""

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        """Add the fields to each row."""


class Layout:
    """What holds the fields of one record of a class."""

    def __init__(self, cls: type, *holders: Holder):
        self._cls, self._holders = cls, holders

    def write(self, group: h5py.Group, record: object) -> None:
        """Write the record."""
        for holder in self._holders:
            holder.write(group, self._cls, [record])

    def read_fields(self, group: HeldGroup) -> dict[str, Any]:
        """The fields that are held, by name."""
        rows: Rows = [{}]
        _read_all(self._holders, group, self._cls, rows)
        return rows[0]

    def read(self, group: HeldGroup) -> Any:
        """The record that `write` wrote."""
        return self._cls(**self.read_fields(group))


def _read_all(holders: Sequence[Holder], group: HeldGroup, cls: type, rows: Rows) -> None:
    for holder in holders:
        if holder.dataset in group or not defaults(cls).issuperset(holder.fields):
            holder.read(group, cls, rows)


class Row:
    """Some fields of each record, in a table with one row a record."""

    def __init__(self, dataset: str, *fields: str):
        self.dataset, self.fields = dataset, fields

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        columns = columns_of(hint(cls), frozenset(hints(cls)), self.fields)
        write_rows(group, self.dataset, columns, [record_values(hint(cls), records, column) for column in columns])

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        columns = columns_of(hint(cls), frozenset(hints(cls)), self.fields)
        found = read_rows(group, self.dataset, columns, defaults(cls))
        _check_count(group, self.dataset, len(found), len(rows))
        for row, more in zip(rows, found, strict=True):
            row |= more


def _check_count(group: HeldGroup, dataset: str, found: int, expected: int) -> None:
    """Raise DatasetError where a dataset has not as many rows or items as there are records."""
    if found != expected:
        raise DatasetError(f"{group.name}/{dataset}", f"has {found} rows; expected {expected}")


@dataclass(frozen=True)
class _Owned:
    """What a `Table` is about: the records of one field of others."""

    record: Hint
    several: bool


class Table:
    """The records in one field of each owner: a tuple of records or of tuples, or one record or None.

    One row a record. `owner` is the column that says in which row its owner is; it is left out where there is one owner
    only. `first` are columns that come first in the file. `holders` hold what has no place in a row.
    """

    def __init__(
        self,
        dataset: str,
        *holders: Holder,
        field: str | None = None,
        owner: str | None = None,
        first: tuple[str, ...] = (),
        if_any: bool = False,
    ):
        self.dataset, self._field, self._owner, self._if_any = dataset, field or dataset, owner, if_any
        self._holders, self._first = holders, first

    @property
    def fields(self) -> tuple[str, ...]:
        return (self._field,)

    def _owned(self, cls: type) -> _Owned:
        said = hints(cls)[self._field]
        return _Owned(said.item or said, said.item is not None)

    def _columns(self, record: Hint) -> tuple[Any, ...]:
        return columns_of(record, frozenset(name for holder in self._holders for name in holder.fields), self._first)

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        owned = self._owned(cls)
        values = [getattr(record, self._field) for record in records]
        if self._owner is None and (values[0] is None or (self._if_any and not values[0])):
            return
        lists = values if owned.several else [[] if value is None else [value] for value in values]
        inner = [item for items in lists for item in items]
        columns = self._columns(owned.record)
        fields = [record_values(owned.record, inner, column) for column in columns]
        if self._owner is not None:
            columns = (integer(self._owner), *columns)
            fields = [[place for place, items in enumerate(lists) for _ in items], *fields]
        write_rows(group, self.dataset, columns, fields)
        for holder in self._holders:
            holder.write(group, owned.record.type, inner)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        owned = self._owned(cls)
        columns = self._columns(owned.record)
        made_of = owned.record.type
        later = defaults(made_of) if is_dataclass(made_of) else ()
        inner = read_rows(
            group, self.dataset, columns if self._owner is None else (integer(self._owner), *columns), later
        )
        owners = [0] * len(inner) if self._owner is None else [row.pop(self._owner) for row in inner]
        if self._holders:
            _read_all(self._holders, group, made_of, inner)
        make = record_maker(owned.record)
        lists: list[list[Any]] = [[] for _ in rows]
        wrong = next((place for place in owners if not 0 <= place < len(rows)), None)
        if wrong is not None:
            fault = f"has a row of owner {wrong}, of {len(rows)}"
            raise DatasetError(f"{group.name}/{self.dataset}", fault)
        for place, row in zip(owners, inner, strict=True):
            lists[place].append(make(**row))
        for row, items in zip(rows, lists, strict=True):
            row[self._field] = tuple(items) if owned.several else _only(group, self.dataset, items)


def _only(group: HeldGroup, dataset: str, items: Sequence[Any]) -> Any:
    """The one item, or None; DatasetError where there are several."""
    _check_count(group, dataset, len(items), min(len(items), 1))
    return items[0] if items else None


class Ragged:
    """An array of its own length for each record, one after the other; or a tuple of numbers as such an array."""

    def __init__(self, dataset: str, field: str | None = None, *, width: int = 0, dtype: str | None = None):
        self.dataset, self.fields = dataset, (field or dataset,)
        self._width, self._dtype = width, dtype

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        said = hints(cls)[self.fields[0]]
        number = said.item or said
        whole = number.type is int or number.number is np.int64
        arrays = [getattr(record, self.fields[0]) for record in records]
        dtype = self._dtype or ("<i8" if whole else "<f8")
        write_ragged(group, self.dataset, arrays, number.unit or "1", width=self._width, dtype=dtype)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        of_tuples = hints(cls)[self.fields[0]].item is not None
        arrays = read_ragged(group, self.dataset)
        _check_count(group, self.dataset, len(arrays), len(rows))
        for row, array in zip(rows, arrays, strict=True):
            row[self.fields[0]] = tuple(array.tolist()) if of_tuples else array


class Numbers:
    """An array of one record, as a dataset of its name."""

    def __init__(self, dataset: str):
        self.dataset, self.fields = dataset, (dataset,)

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        said = hints(cls)[self.dataset]
        dtype = {np.int64: "<i8", np.bool_: "|u1"}.get(said.number, "<f8")
        write_array(group, self.dataset, getattr(records[0], self.dataset), said.unit or "1", dtype)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        array = read_array(group, self.dataset)
        is_flags = hints(cls)[self.dataset].number is np.bool_
        rows[0][self.dataset] = freeze(array.astype(np.bool_)) if is_flags else array


class Texts:
    """The texts of one record, as a dataset of its name: a tuple of them, or one."""

    def __init__(self, dataset: str):
        self.dataset, self.fields = dataset, (dataset,)

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        value = getattr(records[0], self.dataset)
        write_texts(group, self.dataset, [value] if hints(cls)[self.dataset].type is str else value)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        items = read_texts(group, self.dataset)
        rows[0][self.dataset] = _only(group, self.dataset, items) if hints(cls)[self.dataset].type is str else items


class WholeColumns:
    """Arrays of one record, all of one length, as the columns of a table."""

    def __init__(self, dataset: str, *fields: str):
        self.dataset, self.fields = dataset, fields

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        columns = {}
        for name in self.fields:
            said = hints(cls)[name]
            dtype = "<i8" if said.number is np.int64 else "<f8"
            columns[name] = (said.unit or "1", getattr(records[0], name).astype(dtype))
        write_columns(group, self.dataset, columns)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        table = read_columns(group, self.dataset)
        lacking = defaults(cls).difference(table.dtype.names or ())
        rows[0].update({name: freeze(table[name].copy()) for name in self.fields if name not in lacking})


class Subgroup:
    """One record in a group of its own."""

    def __init__(self, name: str, layout: Layout):
        self.dataset, self.fields, self._layout = name, (name,), layout

    def write(self, group: h5py.Group, cls: type, records: Sequence[Any]) -> None:
        value = getattr(records[0], self.dataset)
        if value is not None:
            self._layout.write(group.create_group(self.dataset), value)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        optional = hints(cls)[self.dataset].optional and self.dataset not in group
        rows[0][self.dataset] = None if optional else self._layout.read(group.group(self.dataset))
