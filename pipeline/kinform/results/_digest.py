"""One hash for any value of the model: equal content, equal hash, on every machine."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import struct
import types
import weakref
from typing import Any

import numpy as np

__all__ = ["digest"]

_RESULTS = frozenset({"MeshSurfaces", "Contacts", "Kinematics", "MassReport", "Simulation"})
"""Classes of results of stages, by name, so that none need be imported: large, never changed, and part of the inputs
of several stages."""
_known: weakref.WeakKeyDictionary[Any, str] = weakref.WeakKeyDictionary()
"""Hashes of results that are still in use; these classes compare by identity."""


def digest(*values: Any) -> str:
    """SHA-256 (hex) of the content of the values: types, lengths and bits, nothing else.

    A mesh counts by its own digest, with its health and its file. Raises TypeError for values that are
    neither scalars, text, containers of such, arrays, nor dataclasses.
    """
    hasher = hashlib.sha256()
    for value in values:
        _feed(hasher, value)
    return hasher.hexdigest()


def _feed(hasher: Any, value: Any) -> None:
    kind = type(value)
    if kind is float:
        hasher.update(b"f" + _PACKED(value))
    elif kind is np.ndarray:
        array = value if value.dtype.str[0] in "<|" and value.flags.c_contiguous else _plain(value)
        hasher.update(f"a{array.dtype.str}{value.shape};".encode())
        hasher.update(array.data if array.size else b"")
    elif kind is str:
        encoded = value.encode(errors="surrogatepass")
        hasher.update(f"s{len(encoded)};".encode() + encoded)
    elif value is None or isinstance(value, (bool, int, np.bool_, np.integer)):
        hasher.update(f"{int(value) if value is not None else value};".encode())
    elif isinstance(value, (tuple, list)):
        hasher.update(f"t{len(value)};".encode())
        for item in value:
            _feed(hasher, item)
    elif isinstance(value, dict):
        hasher.update(f"d{len(value)};".encode())
        for key in sorted(value):
            _feed(hasher, key)
            _feed(hasher, value[key])
    elif dataclasses.is_dataclass(value):
        _feed_record(hasher, value)
    elif isinstance(value, float):
        _feed(hasher, float(value))
    elif isinstance(value, str):
        _feed(hasher, str(value))
    elif isinstance(value, np.ndarray):
        _feed(hasher, np.asarray(value))
    elif isinstance(value, types.FunctionType):  # of a kind of joint: its name stands for it
        hasher.update(f"n{value.__module__}.{value.__qualname__};".encode())
    else:
        raise TypeError(f"cannot hash a {kind.__name__}")


_PACKED = struct.Struct("<d").pack


def _plain(array: Any) -> Any:
    """The array in C order and little-endian."""
    found = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    return found.reshape(np.shape(array))


def _feed_record(hasher: Any, record: Any) -> None:
    if type(record).__name__ not in _RESULTS:
        _feed_fields(hasher, record)
        return
    if record not in _known:
        own = hashlib.sha256()
        _feed_fields(own, record)
        _known[record] = own.hexdigest()
    hasher.update(f"r{_known[record]};".encode())


def _feed_fields(hasher: Any, record: Any) -> None:
    hasher.update(f"c{type(record).__name__};".encode())
    kind: Any = type(record)
    for name in _fields(kind):
        _feed(hasher, getattr(record, name))


@functools.cache
def _fields(cls: type) -> tuple[str, ...]:
    names = tuple(field.name for field in dataclasses.fields(cls))
    return tuple(name for name in names if name not in ("vertices", "faces")) if cls.__name__ == "Mesh" else names
