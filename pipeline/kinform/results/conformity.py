"""Whether a group of a results file is as its tables say (`schema`), checked before anything is made of it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.frozen import dataclass
from kinform.results import schema
from kinform.results.held import HeldDataset, HeldGroup
from kinform.results.schema import Form, Last, Length
from kinform.results.table import DatasetError, missing

LARGEST = 1e150
"""Of the numbers of a results file: sums of their squares are numbers too. Lengths are at most 1e18 m."""

Check = Callable[[HeldGroup, str], None]


def check_group(file: HeldGroup, group: str) -> None:
    """Raise DatasetError for the first dataset of a group that is not what the schema says, or has not the rows that
    another one needs. What is not there is left to who reads it."""
    datasets = {f"{group}/{name}" for name in file.group(group).datasets()}
    for name in sorted(datasets):
        _check_numbers(file, name)
    for name in _those(schema.ARRAYS, datasets):
        _check_array(file, name, schema.ARRAYS[name])
    for name in _those(schema.RAGGED, datasets):
        _check_ragged(file, name, *schema.RAGGED[name])
    for name in _those(schema.AS_LONG, datasets):
        _check_length(file, name, *schema.AS_LONG[name])
    for table, check in _CHECKS:
        for column in table:
            if column.partition(".")[0] in datasets:
                check(file, column)
    for name in sorted(datasets & _WITHIN.keys()):
        _check_within(file, name)


def _those(table: dict[str, Any], datasets: set[str]) -> list[str]:
    return [name for name in table if name in datasets]


def _check_numbers(file: HeldGroup, name: str) -> None:
    """Every number is one up to LARGEST, but for those that are said to be unknown or endless."""
    dataset = file.dataset(name)
    dtype = dataset.dtype
    real = [c for c in dtype.names or ("",) if (dtype[c] if c else dtype).kind == "f"]
    if not real:
        return
    data = dataset.data
    for column in real:
        place = f"{name}.{column}" if column else name
        values = np.asarray(data[column] if column else data)
        if not values.size or (float(values.min()) >= -LARGEST and float(values.max()) <= LARGEST):
            continue
        wrong = ~(np.abs(values) <= np.float64(LARGEST))
        if place.startswith(schema.AS_STATED):
            wrong &= ~np.isfinite(values)
        if place.startswith(schema.UNKNOWN):
            wrong &= ~np.isnan(values)
        if place.startswith(schema.ENDLESS):
            wrong &= ~np.isinf(values)
        if column:
            wrong &= ~missing(values)
        if wrong.any():
            fault = f"holds {values[wrong][0]}, which is no number up to {LARGEST:g}"
            raise DatasetError(place, f"row {int(np.argwhere(wrong)[0][0])} {fault}")


def _check_array(file: HeldGroup, name: str, form: Form) -> None:
    shape = file.dataset(name).shape
    if form.or_none and shape and len(shape) == len(form.shape) and shape[0] == 0:
        form = Form(form.kind, (0, *(None for _ in shape[1:])))
    _check_form(file, name, form)


def _check_form(file: HeldGroup, name: str, form: Form) -> None:
    dataset = file.dataset(name)
    dtype = dataset.dtype
    if dtype.kind != form.kind or dtype.names:
        raise DatasetError(name, f"holds {_kind(dtype)}; expected {_KINDS[form.kind]}")
    expected = tuple(_length(file, name, length) for length in form.shape)
    shape = dataset.shape or ()
    fits = len(shape) == len(expected) and all(
        want is None or have == want for have, want in zip(shape, expected, strict=True)
    )
    if not fits:
        said = ", ".join("any" if length is None else str(length) for length in expected)
        raise DatasetError(name, f"has the shape {shape}; expected ({said})")


def _length(file: HeldGroup, name: str, length: Length) -> int | None:
    if isinstance(length, Last):
        places = _whole(file, length.dataset)
        return int(places[-1]) if len(places) else None
    return rows_of(file, name, length) if isinstance(length, str) else length


def rows_of(file: HeldGroup, name: str, other: str) -> int:
    """How many rows a dataset has that `name` needs."""
    found = file.get(other)
    if not isinstance(found, HeldDataset) or not found.shape:
        raise DatasetError(name, f"needs {other}, which is not there")
    return found.shape[0]


def _check_ragged(file: HeldGroup, name: str, owner: str, form: Form) -> None:
    _check_form(file, name, form)
    offset = f"{name}_offset"
    if offset not in file:
        raise DatasetError(offset, "is not there")
    _check_form(file, offset, Form("i", (rows_of(file, name, owner) + 1,)))
    _check_steps(file, offset, len(file.dataset(name)))


def _check_steps(file: HeldGroup, name: str, end: int | None) -> None:
    """Places that begin with 0, never fall, and end where they must."""
    places = file.dataset(name).data
    if len(places) == 0 or places[0] != 0 or (np.diff(places) < 0).any() or (end is not None and places[-1] != end):
        last = "" if end is None else f" to {end}"
        raise DatasetError(name, f"must rise from 0{last}")


def _check_length(file: HeldGroup, name: str, other: str, end: str | None) -> None:
    steady = name in schema.STEADY
    rows = rows_of(file, name, other) + steady
    shape = file.dataset(name).shape
    if shape != (rows,):
        raise DatasetError(name, f"has the shape {shape}; expected ({rows},)")
    if steady:
        _check_steps(file, name, None if end is None else rows_of(file, name, end))


def _check_rows(file: HeldGroup, column: str) -> None:
    table, or_none = schema.ROWS[column]
    places = _whole(file, column)
    if len(places):
        _check_between(column, places, -1 if or_none else 0, rows_of(file, column, table), table)


def _check_between(name: str, places: NDArray[Any], low: int, counts: NDArray[Any] | int, of: str) -> None:
    wrong = np.flatnonzero((places < low) | (places >= counts))
    if len(wrong):
        count = np.broadcast_to(counts, places.shape)[wrong[0]]
        raise DatasetError(name, f"row {wrong[0]} holds {places[wrong[0]]}, of {count} in {of}")


def _check_names(file: HeldGroup, column: str) -> None:
    used = list(_named(file, column))
    if used:
        given = {name for of in schema.NAMES[column] for name in _named(file, of)}
        if not given.issuperset(used):
            wrong = next(name for name in used if name not in given)
            raise DatasetError(column, f"names {wrong!r}, which {schema.NAMES[column][0]} has not")


def _check_alone(file: HeldGroup, column: str) -> None:
    names = list(_named(file, column))
    if len(set(names)) < len(names):
        twice = next(name for k, name in enumerate(names) if name in names[:k])
        raise DatasetError(column, f"has {twice!r} twice")


def _check_words(file: HeldGroup, column: str) -> None:
    words = schema.WORDS[column]
    wrong = next((text for text in _texts(file, column) if text not in words), None)
    if wrong is not None:
        raise DatasetError(column, f"holds {wrong!r}; expected one of {', '.join(words)}")


def _check_spelling(file: HeldGroup, column: str) -> None:
    form = re.compile(schema.SPELT[column])
    wrong = next((text for text in _texts(file, column) if not form.fullmatch(text)), None)
    if wrong is not None:
        raise DatasetError(column, f"holds {wrong!r}, which kinform does not write there")


def _named(file: HeldGroup, column: str) -> Iterable[str]:
    """The names that a column has, one a row or a list of them."""
    texts = _texts(file, column)
    return _of_lists(column, texts) if column in _LISTS else texts


def _of_lists(column: str, texts: Sequence[str]) -> Iterator[str]:
    for text in texts:
        names = json.loads(text)
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise DatasetError(column, "expected lists of names")
        yield from names


def _texts(file: HeldGroup, column: str) -> Sequence[str]:
    """The texts of a column, or of an array of them; none where it is not there."""
    data = _column(file, column)
    if data is None:
        return ()
    if data.dtype.kind != "O":
        raise DatasetError(column, f"holds {_kind(data.dtype)}; expected texts")
    name, _, label = column.partition(".")
    return [text for text in file.dataset(name).texts(label) if text is not None]


def _whole(file: HeldGroup, column: str) -> NDArray[Any]:
    """The whole numbers of a column, or of an array of them."""
    data = _column(file, column)
    if data is None:
        return np.zeros(0, dtype=np.int64)
    if data.dtype.kind != "i" or data.ndim != 1:
        raise DatasetError(column, f"holds {_kind(data.dtype)}; expected whole numbers")
    return data


def _column(file: HeldGroup, column: str) -> NDArray[Any] | None:
    name, _, label = column.partition(".")
    dataset = file.get(name)
    if not isinstance(dataset, HeldDataset):
        return None
    if dataset.ndim != 1:
        raise DatasetError(name, f"has the shape {dataset.shape}; expected one row an item")
    if not label:
        return dataset.data
    return np.asarray(dataset.data[label]) if label in (dataset.dtype.names or ()) else None


@dataclass(frozen=True)
class _Within:
    """What whole numbers of an array of arrays may be."""

    lengths: NDArray[Any]
    """(n,) rows of each item."""
    counts: NDArray[Any]
    """(n,) what they stay below."""
    low: int
    of: str


def _check_within(file: HeldGroup, name: str) -> None:
    within, data = _WITHIN[name](file), file.dataset(name).data
    if not data.size:
        return
    filled = within.lengths > 0
    flat, counts = data.reshape(-1), within.counts[filled]
    starts = np.cumsum(np.append(0, within.lengths[filled][:-1])) * (data.size // len(data))
    if np.minimum.reduceat(flat, starts).min() < within.low or (np.maximum.reduceat(flat, starts) >= counts).any():
        rows, counts = data.reshape(len(data), -1), np.repeat(within.counts, within.lengths)
        _check_between(name, rows.min(axis=1), within.low, counts, within.of)
        _check_between(name, rows.max(axis=1), within.low, counts, within.of)


def _lengths(file: HeldGroup, name: str) -> NDArray[Any]:
    """Of each item of an array of arrays."""
    return np.diff(_whole(file, f"{name}_offset"))


def _corners(file: HeldGroup) -> _Within:
    faces, vertices = _lengths(file, "assembly/faces"), _lengths(file, "assembly/vertices")
    return _Within(faces, vertices, 0, "the vertices of its mesh")


def _labels(file: HeldGroup) -> _Within:
    meshes = rows_of(file, "surfaces/labels", "surfaces/meshes")
    counts = np.bincount(_whole(file, "surfaces/surfaces.mesh"), minlength=meshes)
    return _Within(_lengths(file, "surfaces/labels"), counts, -1, "the surfaces of its mesh")


def _facets(file: HeldGroup) -> _Within:
    counts = _lengths(file, "surfaces/labels")[_whole(file, "surfaces/surfaces.mesh")]
    return _Within(_lengths(file, "surfaces/faces"), counts, 0, "the facets of its mesh")


def _columns_of_bodies(file: HeldGroup) -> _Within:
    columns = 6 * rows_of(file, "constraints/indices", "constraints/bodies")
    rows = len(file.dataset("constraints/indices"))
    return _Within(np.array([rows]), np.array([columns]), 0, "six columns a body")


_WITHIN: dict[str, Callable[[HeldGroup], _Within]] = {
    "assembly/faces": _corners,
    "surfaces/labels": _labels,
    "surfaces/faces": _facets,
    "constraints/indices": _columns_of_bodies,
}
"""Whole numbers whose limit is not the same for all."""
_LISTS = frozenset(
    ("assembly/groups.parts", "joints/bodies.parts", "mobility/redundancies.joints", "mobility/certificates.joints")
)
"""Columns of lists of names."""
_CHECKS: tuple[tuple[Sequence[str] | dict[str, Any], Check], ...] = (
    (schema.ROWS, _check_rows),
    (schema.ALONE, _check_alone),
    (schema.NAMES, _check_names),
    (schema.WORDS, _check_words),
    (schema.SPELT, _check_spelling),
)
_KINDS = {"f": "numbers", "i": "whole numbers", "u": "whole numbers from 0", "b": "yes and no", "O": "texts"}


def _kind(dtype: np.dtype[Any]) -> str:
    return "a table" if dtype.names else _KINDS.get(dtype.kind, str(dtype))
