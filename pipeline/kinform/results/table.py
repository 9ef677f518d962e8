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
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from functools import partial
from operator import is_
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from kinform.errors import ResultsError
from kinform.frozen import dataclass
from kinform.model.arrays import freeze
from kinform.results import datasets
from kinform.results.datasets import TEXT
from kinform.results.held import HeldDataset, HeldGroup
from kinform.results.texts import has_surrogates, stored_text

FACETS = "<i4"
"""Numbers of facets, vertices and surfaces of one mesh: most of a file, and fewer than two thousand millions."""
# NA of R (see above)
_MISSING_NUMBER = 0x7FF8_0000_0000_0000 | 1954
_IS_NONE = partial(is_, None)
_DECODER = json.JSONDecoder()
(_MISSING,) = struct.unpack("<d", struct.pack("<Q", _MISSING_NUMBER))


class DatasetError(ValueError):
    """A dataset is not what results hold; the message names it."""

    def __init__(self, dataset: str, fault: str):
        super().__init__(f"{dataset.lstrip('/')} {fault}")


@dataclass(frozen=True)
class Column:
    """One field of a record, and the column or columns that hold it."""

    field: str
    """Attribute of the record."""
    labels: tuple[str, ...]
    """Names of the columns."""
    dtypes: tuple[Any, ...]
    """Of each column, as NumPy names them."""
    units: tuple[str, ...]
    split: Callable[[Sequence[Any]], Sequence[Any]]
    """The field of all records → one list or array a label."""
    join: Callable[[Sequence[Any]], list[Any]]
    """The arrays, or texts, of each label → the field of all records."""
    optional: bool = True
    """Whether a record may be without it."""
    later: frozenset[str] = frozenset()
    """Labels that files from before they were added lack: they stand for None there."""


def _write_reals(values: Sequence[float | None]) -> NDArray[np.float64]:
    return np.array([_MISSING if value is None else value for value in values], dtype="<f8")


def _read_reals(stored: NDArray[np.float64]) -> list[float | None]:
    values: list[float | None] = stored.tolist()
    for i in np.flatnonzero(missing(stored)).tolist():
        values[i] = None
    return values


def missing(stored: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which numbers of an array say that there is none."""
    bits = np.ascontiguousarray(stored, dtype="<f8").view("<u8")
    return np.asarray(bits == _MISSING_NUMBER)


def _write_counts(values: Sequence[int | None]) -> list[int]:
    for value in values:
        if value is not None and value < 0:
            raise ResultsError(f"the count {value} is negative: the results file has no place for it")
    return [-1 if value is None else int(value) for value in values]


def _read_counts(stored: NDArray[np.int64]) -> list[int | None]:
    if (stored < -1).any():
        raise ValueError(f"{stored.min()} is no count")
    values: list[int | None] = stored.tolist()
    return [None if value == -1 else value for value in values]


def _write_json(value: Any) -> str:
    dumped = json.dumps(value, ensure_ascii=False, sort_keys=True)
    return json.dumps(value, sort_keys=True) if has_surrogates(dumped) else dumped


def _each(function: Callable[[Any], Any], values: Sequence[Any]) -> list[Any]:
    """The function of each value, computed once a distinct one."""
    results: dict[Any, Any] = {}
    return [results[value] if value in results else results.setdefault(value, function(value)) for value in values]


def _scalar(
    field: str, dtype: Any, unit: str, write: Callable[..., Any], read: Callable[..., list[Any]], optional: bool = True
) -> Column:
    """One column for one value, from what writes and what reads all of them."""
    return Column(field, (field,), (dtype,), (unit,), lambda v: (write(v),), lambda s: read(s[0]), optional)


def text(field: str, *, optional: bool = True) -> Column:
    """A text, or None."""
    return _scalar(field, TEXT, "", lambda v: [stored_text(x) for x in v], list, optional)


def integer(field: str, unit: str = "1", *, optional: bool = False) -> Column:
    """An integer; with `optional`, a count or a line number, or None."""
    if optional:
        return _scalar(field, "<i8", unit, _write_counts, _read_counts)
    return _scalar(field, "<i8", unit, lambda v: [int(x) for x in v], lambda s: s.tolist())


def real(field: str, unit: str, *, optional: bool = True) -> Column:
    """A float, or None."""
    return _scalar(field, "<f8", unit, _write_reals, _read_reals, optional)


def flag(field: str, *, optional: bool = False) -> Column:
    """A bool; with `optional`, or None: then a count."""
    if optional:
        read = lambda s: [None if x is None else bool(x) for x in _read_counts(s)]
        return _scalar(field, "<i8", "1", _write_counts, read)
    return _scalar(field, np.bool_, "1", lambda v: [bool(x) for x in v], lambda s: s.tolist())


def texts(field: str, kind: type = str, *, optional: bool = False) -> Column:
    """A tuple of texts, or of integers, as a JSON list; with `optional`, or None."""
    return _scalar(
        field, TEXT, "",
        lambda v: _each(
            lambda x: stored_text(None) if x is None else _write_json(list(x)),
            [x if x is None else tuple(x) for x in v],
        ),
        lambda s: _each(lambda x: None if x is None and optional else tuple(_json(x, list, kind)), s),
        optional,
    )  # fmt: skip


def _json(stored: str | None, kind: type[list[Any]] | type[dict[Any, Any]], of: type = object) -> Any:
    """What a text says as JSON. Raises ValueError where it is of another kind, or its items are."""
    if stored is None:
        raise ValueError("no text is no JSON")
    value, end = _DECODER.raw_decode(stored)
    if end != len(stored) or not isinstance(value, kind) or not all(isinstance(item, of) for item in value):
        raise ValueError(f"{stored!r} is no {kind.__name__} of {of.__name__}")
    return value


def values(field: str, *, optional: bool = False) -> Column:
    """A dict of free-form values, as JSON; with `optional`, or None."""
    return _scalar(
        field, TEXT, "",
        lambda v: [stored_text(None) if x is None else _write_json(x) for x in v],
        lambda s: [None if x is None and optional else _json(x, dict) for x in s],
        optional,
    )  # fmt: skip


def arrays(field: str, *, optional: bool = False) -> Column:
    """A dict of tuples of numbers, as JSON; with `optional`, or None."""
    whole = values(field, optional=optional)

    def join(stored: Sequence[Any]) -> list[Any]:
        return [None if x is None else {key: _numbers(row) for key, row in x.items()} for x in whole.join(stored)]

    return Column(field, whole.labels, whole.dtypes, whole.units, whole.split, join, optional)


def _numbers(row: Any) -> tuple[float, ...]:
    if not isinstance(row, list) or not all(type(x) is float or (type(x) is int and abs(x) < 2**63) for x in row):
        raise ValueError("a list of numbers is expected")
    return tuple(map(float, row))


def inline(
    field: str,
    inner: Sequence[Column],
    labels: Sequence[str],
    get: Callable[[Any, Column], Any],
    make: Callable[[Sequence[Any]], Any],
    *,
    optional: bool,
    later: Container[str] = (),
) -> Column:
    """A tuple or record of several values under the labels of their columns; with `optional`, or None: then all are.

    Inner fields that came `later` are None where a file lacks their columns.

    `get` gives the value that an inner column holds of one such record, `make` makes one of all of them.
    """
    ends = np.cumsum([0, *(len(column.labels) for column in inner)]).tolist()

    def split(records: Sequence[Any]) -> Sequence[Any]:
        held = [[None if record is None else get(record, column) for record in records] for column in inner]
        return [data for column, of_all in zip(inner, held, strict=True) for data in column.split(of_all)]

    def join(stored: Sequence[Any]) -> list[Any]:
        held = [c.join(stored[start:end]) for c, start, end in zip(inner, ends[:-1], ends[1:], strict=True)]
        rows = list(zip(*held, strict=True))
        if not any(map(_lacks, held)):
            return [make(row) for row in rows]
        needed = [not column.optional for column in inner]
        for row in rows:
            lacking = any(need and value is None for need, value in zip(needed, row, strict=True))
            if lacking and not (optional and all(value is None for value in row)):
                raise ValueError(f"{field} is there in part")
        return [None if optional and all(value is None for value in row) else make(row) for row in rows]

    dtypes = tuple(dtype for column in inner for dtype in column.dtypes)
    units = tuple(unit for column in inner for unit in column.units)
    added = [label for k, c in enumerate(inner) if c.field in later for label in labels[ends[k] : ends[k + 1]]]
    return Column(field, tuple(labels), dtypes, units, split, join, optional, frozenset(added))


def numbers(field: str, unit: str, labels: Sequence[str], shape: tuple[int, ...], *, optional: bool = True) -> Column:
    """An array of this shape, or None: a column a number, row by row."""
    none = np.full(shape, _MISSING)

    def split(values: Sequence[Any]) -> Sequence[Any]:
        arrays = [none if value is None else np.asarray(value, dtype=np.float64) for value in values]
        for array in arrays:
            if array.shape != shape:
                raise ResultsError(f"{field} has the shape {array.shape}; expected {shape}")
        return list(np.array(arrays, dtype="<f8").reshape(len(arrays), len(labels)).T)

    def join(stored: Sequence[NDArray[Any]]) -> list[Any]:
        table = freeze(np.stack(stored, axis=1).astype(np.float64).reshape(-1, *shape))
        arrays: list[Any] = list(table)
        lacking = np.stack([missing(column) for column in stored])
        if (lacking != lacking[0]).any():
            raise ValueError(f"{field} is there in part")
        for i in np.flatnonzero(lacking[0]).tolist():
            arrays[i] = None
        return arrays

    return Column(field, tuple(labels), ("<f8",) * len(labels), (unit,) * len(labels), split, join, optional)


def write_columns(group: h5py.Group, name: str, columns: Mapping[str, tuple[str, Any]]) -> None:
    """Write a table from whole columns: label → (unit, values as an array)."""
    dtype = np.dtype([(label, data.dtype) for label, (_, data) in columns.items()])
    table = np.zeros(len(next(iter(columns.values()))[1]), dtype=dtype)
    for label, (_, data) in columns.items():
        table[label] = data
    datasets.create(group, name, table, [unit for unit, _ in columns.values()])


def read_columns(group: HeldGroup, name: str, labels: Sequence[str] | None = None) -> Any:
    """The table as a structured array, read-only, which has these columns at least."""
    dataset = _table(group, name)
    _check_labels(dataset.name, dataset.dtype, labels or ())
    return dataset.data


def row_count(group: HeldGroup, name: str) -> int:
    """How many rows a table has, without reading it."""
    return len(_table(group, name))


def _table(group: HeldGroup, name: str) -> HeldDataset:
    """A table of a group. Raises DatasetError where there is none of that name."""
    dataset = _dataset(group, name)
    if dataset.ndim != 1 or not dataset.dtype.names:
        raise DatasetError(dataset.name, "is no table")
    return dataset


def _dataset(group: HeldGroup, name: str) -> HeldDataset:
    """A dataset of a group. Raises DatasetError where there is none of that name."""
    dataset = group.get(name)
    if not isinstance(dataset, HeldDataset):
        raise DatasetError(f"{group.name}/{name}", "is not there")
    return dataset


def _check_labels(name: str, dtype: np.dtype[Any], labels: Sequence[str]) -> None:
    given = dtype.names or ()
    lacking = next((label for label in labels if label not in given), None)
    if lacking is not None:
        raise DatasetError(name, f"has no column {lacking!r}")


def write_rows(group: h5py.Group, name: str, columns: Sequence[Column], fields: Sequence[Sequence[Any]]) -> None:
    """Write a table; `fields` are what each column holds, of all rows."""
    table: dict[str, tuple[str, Any]] = {}
    for column, of_all in zip(columns, fields, strict=True):
        for label, dtype, unit, data in zip(
            column.labels, column.dtypes, column.units, column.split(of_all), strict=True
        ):
            table[label] = (unit, np.array(data, dtype=dtype))
    write_columns(group, name, table)


def read_rows(
    group: HeldGroup, name: str, columns: Sequence[Column], later: Container[str] = ()
) -> list[dict[str, Any]]:
    """The rows that `write_rows` wrote: field → value. Fields that came `later` are left out where the file lacks
    them."""
    table = _table(group, name)
    labels = set(table.dtype.names or ())
    columns = [column for column in columns if column.field not in later or labels.issuperset(column.labels)]
    fields = [column.field for column in columns]
    if not fields:
        return [{} for _ in table.data]
    place = f"{group.name}/{name}"
    held = [_values(place, table, column) for column in columns]
    return [dict(zip(fields, row, strict=True)) for row in zip(*held, strict=True)]


def _values(name: str, table: HeldDataset, column: Column) -> list[Any]:
    """What a column holds, of all rows. Raises DatasetError where its kind, or a value, is none of its own."""
    absent = column.later.difference(table.dtype.names or ())
    _check_labels(name, table.dtype, [label for label in column.labels if label not in absent])
    for label, dtype in zip(column.labels, column.dtypes, strict=True):
        if label not in absent and table.dtype[label].kind != np.dtype(dtype).kind:
            fault = f"is of the kind {table.dtype[label]}; expected {np.dtype(dtype)}"
            raise DatasetError(f"{name}.{label}", fault)
    try:
        of_label = zip(column.labels, column.dtypes, strict=True)
        held = column.join([_none(dtype, len(table)) if c in absent else _stored(table, c) for c, dtype in of_label])
    except DatasetError:
        raise
    except (ValueError, RecursionError) as error:
        raise DatasetError(f"{name}.{column.labels[0]}", f"makes no sense: {error}") from error
    if not column.optional and _lacks(held):
        place = next(k for k, value in enumerate(held) if value is None)
        raise DatasetError(f"{name}.{column.labels[0]}", f"lacks a value in row {place}")
    return held


def _stored(table: HeldDataset, label: str) -> Any:
    """What is stored under a label."""
    return table.texts(label) if table.dtype[label].kind == "O" else table.data[label]


def _none(dtype: Any, count: int) -> Any:
    """What is stored under a label of this type where so many records have nothing."""
    kind = np.dtype(dtype).kind
    return [None] * count if kind == "O" else np.full(count, _MISSING if kind == "f" else -1, dtype)


def _lacks(values: Iterable[Any]) -> bool:
    """Whether a value is None."""
    return any(map(_IS_NONE, values))


def write_array(group: h5py.Group, name: str, array: NDArray[Any], unit: str, dtype: str = "<f8") -> None:
    """Write one array, contiguous and uncompressed."""
    datasets.create(group, name, np.ascontiguousarray(array, dtype=dtype).reshape(np.shape(array)), unit)


def read_array(group: HeldGroup, name: str) -> NDArray[Any]:
    """One array, read-only."""
    dataset = _dataset(group, name)
    if dataset.dtype.names or dataset.dtype.kind not in "fiub":
        raise DatasetError(dataset.name, "holds no numbers")
    return dataset.data


def write_texts(group: h5py.Group, name: str, items: Sequence[str]) -> None:
    """Write a list of texts."""
    datasets.create(group, name, np.array([stored_text(item) for item in items], dtype=TEXT), "")


def read_texts(group: HeldGroup, name: str) -> tuple[Any, ...]:
    """The texts that `write_texts` wrote."""
    dataset = _dataset(group, name)
    if dataset.ndim != 1 or dataset.dtype.kind != "O":
        raise DatasetError(dataset.name, "holds no texts")
    texts = dataset.texts()
    if _lacks(texts):
        raise DatasetError(dataset.name, "lacks a text")
    return texts


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


def read_ragged(group: HeldGroup, name: str) -> list[NDArray[Any]]:
    """The arrays that `write_ragged` wrote, read-only; whole numbers have eight bytes, however they are kept."""
    data, offset = read_array(group, name), read_array(group, f"{name}_offset")
    if data.dtype.kind == "i":
        data = freeze(data.astype(np.int64, copy=False))
    bounds = offset.tolist()
    return [data[start:end] for start, end in zip(bounds[:-1], bounds[1:], strict=True)]
