"""How records and arrays become HDF5 datasets that other programs read.

Tables are compound datasets of scalars (a vector takes one column a component), so that h5py, pandas,
HDFView and h5dump read them without kinform. Every dataset carries `units`: one text for an array, one
text a column for a table; "1" is a pure number and "" is text. What a dataset cannot say plainly:

- no number (None) is R's NA, a NaN whose payload is 1954: NaN for everybody, NA for R, None for kinform;
- no count or line number is -1;
- no text is the character ␀; text that HDF5 cannot hold (NUL, lone surrogates), or that begins with ␀,
  is ␀ followed by the text as JSON;
- lists of names and free-form values are JSON text.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from kinform.errors import ResultsError
from kinform.model.arrays import freeze

__all__ = [
    "FACETS",
    "TEXT",
    "Column",
    "flag",
    "integer",
    "matrix",
    "pair",
    "read_array",
    "read_columns",
    "read_ragged",
    "read_records",
    "read_rows",
    "read_texts",
    "real",
    "stored_text",
    "text",
    "texts",
    "values",
    "vector",
    "write_array",
    "write_columns",
    "write_ragged",
    "write_records",
    "write_rows",
    "write_texts",
]

Record = TypeVar("Record")

TEXT = h5py.string_dtype()
FACETS = "<i4"
"""Numbers of facets, vertices and surfaces of one mesh: most of a file, and fewer than two thousand millions."""
_NOTHING = "␀"
_MISSING_NUMBER = 0x7FF8_0000_0000_0000 | 1954
(_MISSING,) = struct.unpack("<d", struct.pack("<Q", _MISSING_NUMBER))


@dataclass(frozen=True)
class Column:
    """One field of a record, and the column or columns that hold it."""

    field: str
    """Attribute of the record."""
    labels: tuple[str, ...]
    """Names of the columns."""
    dtype: Any
    unit: str
    split: Callable[[Sequence[Any]], Sequence[Any]]
    """The field of all records → one list or array a label."""
    join: Callable[[Sequence[NDArray[Any]]], list[Any]]
    """The arrays → the field of all records."""


def stored_text(value: str | None) -> str:
    """The text as a dataset holds it."""
    if value is None:
        return _NOTHING
    if value.startswith(_NOTHING) or "\0" in value or (not value.isascii() and _has_surrogates(value)):
        return _NOTHING + json.dumps(value)
    return value


def _has_surrogates(value: str) -> bool:
    return any("\ud800" <= character <= "\udfff" for character in value)


def _read_texts(stored: NDArray[Any]) -> list[str | None]:
    found: list[str | None] = [v.decode() if isinstance(v, bytes) else v for v in stored.tolist()]
    for i, value in enumerate(found):
        if value.startswith(_NOTHING):  # type: ignore[union-attr]
            found[i] = None if value == _NOTHING else str(json.loads(value[1:]))  # type: ignore[index]
    return found


def _write_reals(values: Sequence[float | None]) -> NDArray[np.float64]:
    return np.array([_MISSING if value is None else value for value in values], dtype="<f8")


def _read_reals(stored: NDArray[np.float64]) -> list[float | None]:
    found: list[float | None] = stored.tolist()
    for i in np.flatnonzero(_missing(stored)).tolist():
        found[i] = None
    return found


def _missing(stored: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which numbers of an array say that there is none."""
    bits = np.ascontiguousarray(stored, dtype="<f8").view("<u8")
    return np.asarray(bits == _MISSING_NUMBER)


def _write_counts(values: Sequence[int | None]) -> list[int]:
    for value in values:
        if value is not None and value < 0:
            raise ResultsError(f"the count {value} is negative: the results file has no place for it")
    return [-1 if value is None else int(value) for value in values]


def _read_counts(stored: NDArray[np.int64]) -> list[int | None]:
    return [None if value == -1 else value for value in stored.tolist()]


def _write_json(value: Any) -> str:
    dumped = json.dumps(value, ensure_ascii=False, sort_keys=True)
    return json.dumps(value, sort_keys=True) if _has_surrogates(dumped) else dumped


def _each(function: Callable[[Any], Any], values: Sequence[Any]) -> list[Any]:
    """The function of each value, computed once a distinct one."""
    known: dict[Any, Any] = {}
    return [known[value] if value in known else known.setdefault(value, function(value)) for value in values]


def text(field: str) -> Column:
    """A text, or None."""
    return Column(field, (field,), TEXT, "", lambda v: ([stored_text(x) for x in v],), lambda s: _read_texts(s[0]))


def integer(field: str, unit: str = "1", *, optional: bool = False) -> Column:
    """An integer; with `optional`, a count or a line number, or None."""
    if optional:
        return Column(field, (field,), "<i8", unit, lambda v: (_write_counts(v),), lambda s: _read_counts(s[0]))
    return Column(field, (field,), "<i8", unit, lambda v: ([int(x) for x in v],), lambda s: s[0].tolist())


def real(field: str, unit: str) -> Column:
    """A float, or None."""
    return Column(field, (field,), "<f8", unit, lambda v: (_write_reals(v),), lambda s: _read_reals(s[0]))


def flag(field: str) -> Column:
    """A bool."""
    return Column(field, (field,), np.bool_, "1", lambda v: ([bool(x) for x in v],), lambda s: s[0].tolist())


def texts(field: str) -> Column:
    """A tuple of texts, as a JSON list."""
    return Column(
        field, (field,), TEXT, "",
        lambda v: (_each(lambda x: _write_json(list(x)), [tuple(x) for x in v]),),
        lambda s: _each(lambda x: tuple(json.loads(x)), s[0].tolist()),
    )  # fmt: skip


def values(field: str) -> Column:
    """A dict of free-form values, as JSON."""
    return Column(
        field, (field,), TEXT, "",
        lambda v: ([_write_json(x) for x in v],), lambda s: [json.loads(x) for x in s[0].tolist()],
    )  # fmt: skip


def pair(field: str, kind: Callable[..., Column], labels: tuple[str, ...], *unit: str) -> Column:
    """A tuple of scalars (or None) of one kind, a column each."""
    scalar, none = kind(field, *unit), (None,) * len(labels)

    def split(values: Sequence[Any]) -> Sequence[Any]:
        given = [none if value is None else value for value in values]
        return [scalar.split([value[k] for value in given])[0] for k in range(len(labels))]

    def join(stored: Sequence[NDArray[Any]]) -> list[Any]:
        return [None if v == none else v for v in zip(*(scalar.join((item,)) for item in stored), strict=True)]

    return Column(field, labels, scalar.dtype, scalar.unit, split, join)


def vector(field: str, unit: str, axes: Sequence[str] = ("x", "y", "z")) -> Column:
    """An array of one number an axis, or None."""
    return _numbers(field, unit, axes, (len(axes),))


def matrix(field: str, unit: str, axes: Sequence[str] = ("x", "y", "z")) -> Column:
    """A square array, or None; columns run through its rows."""
    return _numbers(field, unit, [a + b for a in axes for b in axes], (len(axes), len(axes)))


def _numbers(field: str, unit: str, suffixes: Sequence[str], shape: tuple[int, ...]) -> Column:
    labels = tuple(f"{field}_{suffix}" for suffix in suffixes)
    none = np.full(shape, _MISSING)

    def split(values: Sequence[Any]) -> Sequence[Any]:
        arrays = [none if value is None else np.asarray(value, dtype=np.float64) for value in values]
        for array in arrays:
            if array.shape != shape:
                raise ResultsError(f"{field} has the shape {array.shape}; expected {shape}")
        return list(np.array(arrays, dtype="<f8").reshape(len(arrays), len(labels)).T)

    def join(stored: Sequence[NDArray[Any]]) -> list[Any]:
        table = freeze(np.stack(stored, axis=1).astype(np.float64).reshape(-1, *shape))
        found: list[Any] = list(table)
        for i in np.flatnonzero(_missing(stored[0])).tolist():
            found[i] = None
        return found

    return Column(field, labels, "<f8", unit, split, join)


def write_columns(group: h5py.Group, name: str, columns: Mapping[str, tuple[str, Any]]) -> None:
    """Write a table from whole columns: label → (unit, values as an array)."""
    dtype = np.dtype([(label, data.dtype) for label, (_, data) in columns.items()])
    table = np.zeros(len(next(iter(columns.values()))[1]), dtype=dtype)
    for label, (_, data) in columns.items():
        table[label] = data
    dataset = group.create_dataset(name, data=table, dtype=dtype, track_times=False)
    dataset.attrs["units"] = np.array([unit for unit, _ in columns.values()], dtype=TEXT)


def read_columns(group: h5py.Group, name: str, labels: Sequence[str] | None = None) -> Any:
    """The table as a structured array: all of it, or only these columns."""
    return group[name][()] if labels is None else group[name].fields(list(labels))[()]


def write_rows(group: h5py.Group, name: str, columns: Sequence[Column], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a table from rows: field → value."""
    rows = list(rows)
    _write_fields(group, name, columns, [[row[column.field] for row in rows] for column in columns])


def _write_fields(group: h5py.Group, name: str, columns: Sequence[Column], fields: Sequence[Sequence[Any]]) -> None:
    """Write a table from the fields of all records, a list a column."""
    table: dict[str, tuple[str, Any]] = {}
    for column, found in zip(columns, fields, strict=True):
        for label, stored in zip(column.labels, column.split(found), strict=True):
            table[label] = (column.unit, np.array(stored, dtype=column.dtype))
    write_columns(group, name, table)


def read_rows(
    group: h5py.Group, name: str, columns: Sequence[Column], added: Sequence[str] = ()
) -> list[dict[str, Any]]:
    """The rows that `write_rows` wrote. Fields named in `added` came later: files without them give rows without."""
    table = read_columns(group, name)
    known = set(table.dtype.names or ())
    columns = [column for column in columns if column.field not in added or known.issuperset(column.labels)]
    fields = [column.field for column in columns]
    if not fields:
        return [{} for _ in table]
    found = [column.join([table[label] for label in column.labels]) for column in columns]
    return [dict(zip(fields, row, strict=True)) for row in zip(*found, strict=True)]


def write_records(group: h5py.Group, name: str, columns: Sequence[Column], records: Iterable[object]) -> None:
    """Write a table with one row a record; fields are attributes."""
    records = list(records)
    _write_fields(group, name, columns, [[getattr(record, column.field) for record in records] for column in columns])


def read_records(
    group: h5py.Group, name: str, columns: Sequence[Column], cls: Callable[..., Record]
) -> tuple[Record, ...]:
    """The records that `write_records` wrote."""
    return tuple(cls(**row) for row in read_rows(group, name, columns))


def write_array(group: h5py.Group, name: str, array: NDArray[Any], unit: str, dtype: str = "<f8") -> h5py.Dataset:
    """Write one array, contiguous and uncompressed."""
    data = np.ascontiguousarray(array, dtype=dtype).reshape(np.shape(array))
    dataset = group.create_dataset(name, data=data, track_times=False)
    dataset.attrs["units"] = unit
    return dataset


def read_array(group: h5py.Group, name: str) -> NDArray[Any]:
    """One array, read-only."""
    return freeze(np.asarray(group[name][()]))


def write_texts(group: h5py.Group, name: str, items: Sequence[str]) -> None:
    """Write a list of texts."""
    data = np.array([stored_text(item) for item in items], dtype=object)
    dataset = group.create_dataset(name, shape=data.shape, dtype=TEXT, track_times=False)
    if len(items):
        dataset[...] = data
    dataset.attrs["units"] = ""


def read_texts(group: h5py.Group, name: str) -> tuple[Any, ...]:
    """The texts that `write_texts` wrote."""
    return tuple(_read_texts(group[name][()]))


def write_ragged(
    group: h5py.Group, name: str, arrays: Sequence[Any], unit: str, *, width: int = 0, dtype: str = "<f8"
) -> None:
    """Write arrays of different lengths one after the other: item i is NAME[NAME_offset[i] : NAME_offset[i+1]].

    `width` is the number of columns of each, 0 for one-dimensional ones.
    """
    empty = np.zeros((0, width) if width else (0,), dtype=dtype)
    parts = [np.asarray(array) if len(array) else empty for array in arrays]
    write_array(group, name, np.concatenate([empty, *parts], dtype=dtype, casting="same_kind"), unit, dtype)
    offset = np.cumsum([0, *(len(part) for part in parts)])
    write_array(group, f"{name}_offset", offset, "1", "<i8")


def read_ragged(group: h5py.Group, name: str) -> list[NDArray[Any]]:
    """The arrays that `write_ragged` wrote, read-only; whole numbers have eight bytes, however they are kept."""
    data, offset = read_array(group, name), read_array(group, f"{name}_offset")
    if data.dtype.kind == "i":
        data = freeze(data.astype(np.int64, copy=False))
    bounds = offset.tolist()
    return [data[start:end] for start, end in zip(bounds[:-1], bounds[1:], strict=True)]
