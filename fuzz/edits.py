"""Edits of a results file, chosen by bytes, sealed again: its digest stops all others."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import h5py
import numpy as np

REALS = (0.0, -0.0, 1.0, -1.0, 1e308, -1e308, 1e160, 1e-320, float("nan"), float("inf"), -float("inf"), 2.0**53, 1e18)
COUNTS = (0, 1, -1, -2, 2, 7, 2**31 - 1, -(2**31), 2**62, -(2**63), 2**63 - 1, 100, 1000)
TEXTS = ("", "x", "␀", "␀{", "[]", "{}", "null", "[" * 50, "a\tb", "1", '{"a": 1}', "revolute", "[1, 2]", "/" * 300)


@dataclass(frozen=True)
class Edited:
    """A results file that was changed and sealed again."""

    which: int
    """Of the files that edits are made of."""
    image: bytes
    names: frozenset[str]
    """What was edited: datasets, and groups themselves."""


def edited(images: Sequence[bytes], choices: bytes) -> Edited:
    """One of the files after the edits that eight bytes each choose."""
    which = choices[0] % len(images) if choices else 0
    touched = set()
    stream = io.BytesIO(images[which])
    with h5py.File(stream, "r+") as file:
        names = _names(file)
        for start in range(1, min(len(choices), 65) - 7, 8):
            where, element, what = struct.unpack("<HHI", choices[start : start + 8])
            name = names[where % len(names)]
            if name in file:
                _edit(file, name, element, what)
                touched.add(name)
        file.flush()
    return Edited(which, _sealed(stream.getvalue()), frozenset(touched))


def groups_to_check(names: Iterable[str]) -> set[str]:
    """The groups of which a check looks at one of these datasets, their own ones among them."""
    from kinform.results import schema

    looked_at: dict[str, set[str]] = {}

    def note(column: str, *others: object) -> None:
        for other in others:
            if isinstance(other, schema.Last):
                other = other.dataset
            if isinstance(other, str):
                looked_at.setdefault(_top(other), set()).add(_top(column))

    for name, form in schema.ARRAYS.items():
        note(name, *form.shape)
    for name, (owner, form) in schema.RAGGED.items():
        note(name, owner, *form.shape)
    for name, lengths in schema.AS_LONG.items():
        note(name, *lengths)
    for column, (table, _) in schema.ROWS.items():
        note(column, table)
    for column, tables in schema.NAMES.items():
        note(column, *tables)
    touched = {_top(name) for name in names}
    return touched.union(*(looked_at.get(name, ()) for name in touched))


def _top(name: str) -> str:
    return name.partition("/")[0]


def _sealed(image: bytes) -> bytes:
    """The file with the digest of what is now in it."""
    from kinform.results import SCHEMA
    from kinform.results.seal import BLOCK, seal

    return seal(image[BLOCK:], SCHEMA)


def _names(file: h5py.File) -> list[str]:
    names: list[str] = []
    file.visit(names.append)
    return sorted(names)


def _edit(file: h5py.File, name: str, element: int, what: int) -> None:
    """One edit of a dataset or group: of a value, mostly; else of an attribute, of all of it, of its kind."""
    item, kind, value = file[name], what % 16, what // 16
    if kind == 0:
        del file[name]
    elif kind == 1 and len(item.attrs):
        key = sorted(item.attrs)[element % len(item.attrs)]
        item.attrs[key] = (TEXTS[value % len(TEXTS)], value, REALS[value % len(REALS)])[value % 3]
    elif kind == 2 and len(item.attrs):
        del item.attrs[sorted(item.attrs)[element % len(item.attrs)]]
    elif isinstance(item, h5py.Dataset):
        if kind == 3:
            _replace(file, name, np.asarray(item[()]).ravel()[: value % 5])
        elif kind == 4:
            _replace(file, name, (np.zeros(3), np.array(5), np.zeros((2, 2, 2)), np.array([b"x"]))[value % 4])
        elif kind == 5 and item.shape:
            _replace(file, name, np.concatenate([item[()], item[()]]))
        elif item.size and item.shape:
            _set(item, element % len(item), value)


def _replace(file: h5py.File, name: str, data: np.ndarray) -> None:
    dtype = file[name].dtype if data.dtype == file[name].dtype else data.dtype
    del file[name]
    file.create_dataset(name, data=data, dtype=dtype)


def _set(dataset: h5py.Dataset, index: int, value: int) -> None:
    row = dataset[index]
    if dataset.dtype.names:
        label = dataset.dtype.names[value % len(dataset.dtype.names)]
        row[label] = _value(dataset.dtype[label], value // 256)
        dataset[index] = row
    elif dataset.ndim == 1:
        dataset[index] = _value(dataset.dtype, value)
    else:
        row = np.array(row)
        row.flat[value % max(row.size, 1)] = _value(dataset.dtype, value // 256)
        dataset[index] = row


def _value(dtype: np.dtype, value: int) -> object:
    if dtype.kind == "f":
        return REALS[value % len(REALS)]
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        return int(np.clip(COUNTS[value % len(COUNTS)], limits.min, limits.max))
    if dtype.kind == "b":
        return bool(value % 2)
    return TEXTS[value % len(TEXTS)]
