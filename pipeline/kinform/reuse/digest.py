"""One hash for any value of the model: equal content, equal hash, on every machine."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import operator
import struct
import types
import weakref
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Chunks = list[Any]
"""Bytes, or arrays as bytes."""

_RESULTS = frozenset({"MeshSurfaces", "Contacts", "Patch", "Kinematics", "MassReport", "Simulation"})
"""Classes of results of stages, by name, so that none need be imported: large, never changed, and part of the inputs
of several stages."""
_FEW = 4096
"""Values up to which nothing is gathered before it is hashed, and an array is copied rather than given as it is.
Chosen, not measured."""
_PACKED = struct.Struct("<d").pack
_REAL, _INTEGER = np.dtype("<f8"), np.dtype("<i8")
_hashes: weakref.WeakKeyDictionary[Any, str] = weakref.WeakKeyDictionary()
"""Hashes of results that are still in use; these classes compare by identity."""


def digest(*values: Any) -> str:
    """SHA-256 (hex) of the content of the values: types, lengths and bits, nothing else.

    A mesh counts by its own digest, with its health and its file. Raises TypeError for values that are
    neither scalars, text, containers of such, arrays, nor dataclasses.
    """
    return _hashed(values)


def _hashed(values: Iterable[Any]) -> str:
    out: Chunks = []
    for value in values:
        _feeder(type(value))(out, value)
    hasher = hashlib.sha256()
    for chunk in out if len(out) < _FEW else (b"".join(out),):
        hasher.update(chunk)
    return hasher.hexdigest()


def _float(out: Chunks, value: float) -> None:
    out.append(b"f" + _PACKED(value))


def _array(out: Chunks, value: NDArray[Any]) -> None:
    kind = value.dtype
    if value.size < _FEW and (kind is _REAL or kind is _INTEGER):
        out.append(_header(kind is _REAL, value.shape))
        out.append(value.tobytes())
        return
    array = value if value.dtype.str[0] in "<|" and value.flags.c_contiguous else _plain(value)
    out.append(f"a{array.dtype.str}{value.shape};".encode())
    out.append(array.data if array.size else b"")


def _plain(array: Any) -> Any:
    """The array in C order and little-endian."""
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).reshape(np.shape(array))


@functools.lru_cache(4096)
def _header(real: bool, shape: tuple[int, ...]) -> bytes:
    return f"a<{'f' if real else 'i'}8{shape};".encode()


def _text(out: Chunks, value: str) -> None:
    out.append(_encoded(value))


@functools.lru_cache(65536)
def _encoded(value: str) -> bytes:
    encoded = value.encode(errors="surrogatepass")
    return f"s{len(encoded)};".encode() + encoded


def _count(out: Chunks, value: int | None) -> None:
    out.append(f"{int(value) if value is not None else value};".encode())


def _list(out: Chunks, value: Sequence[Any]) -> None:
    out.append(f"t{len(value)};".encode())
    for item in value:
        _feeder(type(item))(out, item)


def _dict(out: Chunks, value: dict[Any, Any]) -> None:
    out.append(f"d{len(value)};".encode())
    for key in sorted(value):
        _feeder(type(key))(out, key)
        item = value[key]
        _feeder(type(item))(out, item)


def _function(out: Chunks, value: types.FunctionType) -> None:
    """Of a kind of joint: its name stands for it."""
    out.append(f"n{value.__module__}.{value.__qualname__};".encode())


def _record(out: Chunks, value: Any) -> None:
    header, fields = _fields(type(value))
    out.append(header)
    for item in fields(value):
        kind = type(item)
        if kind is float:
            out.append(b"f" + _PACKED(item))
        else:
            _feeder(kind)(out, item)


def _result(out: Chunks, value: Any) -> None:
    """A result by its hash, which is computed once."""
    if value not in _hashes:
        content: Chunks = []
        _record(content, value)
        _hashes[value] = hashlib.sha256(b"".join(content)).hexdigest()
    out.append(f"r{_hashes[value]};".encode())


def _fields_of(cls: type) -> tuple[bytes, Callable[[Any], tuple[Any, ...]]]:
    """What stands before the fields of a class, and what gets them all."""
    names = [field.name for field in dataclasses.fields(cls)]
    if cls.__name__ == "Mesh":
        names = [name for name in names if name not in ("vertices", "faces")]
    get: Any = operator.attrgetter(*names) if names else lambda record: ()
    return f"c{cls.__name__};".encode(), get if len(names) != 1 else lambda record: (get(record),)


def _feeder_of(kind: type) -> Callable[[Chunks, Any], None]:
    """What feeds values of exactly this type."""
    if issubclass(kind, bool | int | np.bool_ | np.integer | types.NoneType):
        return _count
    if issubclass(kind, float):
        return _float
    if issubclass(kind, str):
        return _text if kind is str else lambda out, value: _text(out, str(value))
    if issubclass(kind, np.ndarray):
        return _array if kind is np.ndarray else lambda out, value: _array(out, np.asarray(value))
    if issubclass(kind, tuple | list):
        return _list
    if issubclass(kind, dict):
        return _dict
    if dataclasses.is_dataclass(kind):
        return _result if kind.__name__ in _RESULTS else _record
    if issubclass(kind, types.FunctionType):
        return _function
    raise TypeError(f"cannot hash a {kind.__name__}")


_feeder: Callable[[Any], Callable[[Chunks, Any], None]] = functools.cache(_feeder_of)
_fields: Callable[[Any], tuple[bytes, Callable[[Any], tuple[Any, ...]]]] = functools.cache(_fields_of)
