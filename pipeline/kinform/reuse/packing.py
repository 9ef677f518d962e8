"""Small records as text and back, to the last bit: what `/joints` keeps of single decisions.

JSON, with numbers as Python writes them, which reads them back the same. Nothing is made that is not among the classes
that the reader names.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from kinform.model.arrays import freeze

_ARRAY, _RECORD = "#", "@"
_KINDS = ("<f8", "<i8")


def pack(value: Any) -> str:
    """Text of None, numbers, text, tuples, arrays of reals or integers, and dataclasses of such. Raises TypeError."""
    return json.dumps(_plain(value), separators=(",", ":"))


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, np.ndarray) and value.dtype.str in _KINDS:
        return {_ARRAY: value.dtype.str, "shape": value.shape, "values": value.ravel().tolist()}
    if isinstance(value, (int, float, np.bool_, np.integer, np.floating)):
        return value.item() if isinstance(value, np.generic) else value
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
        return {_RECORD: type(value).__name__, "fields": fields}
    raise TypeError(f"cannot pack a {type(value).__name__}")


def unpack(text: str, classes: Mapping[str, type]) -> Any:
    """The value that was packed, arrays read-only. Raises ValueError, TypeError or LookupError for any other text."""
    return _valued(json.loads(text), classes)


def _valued(plain: Any, classes: Mapping[str, type]) -> Any:
    if isinstance(plain, list):
        return tuple(_valued(item, classes) for item in plain)
    if not isinstance(plain, dict):
        return plain
    if _ARRAY in plain:
        if plain[_ARRAY] not in _KINDS:
            raise ValueError(f"arrays of {plain[_ARRAY]} are not packed")
        return freeze(np.array(plain["values"], dtype=plain[_ARRAY]).reshape(plain["shape"]))
    fields = {name: _valued(item, classes) for name, item in plain["fields"].items()}
    return classes[plain[_RECORD]](**fields)


def seal(key: str, text: str) -> str:
    """Hash by which it is seen that a text is the one that was kept under this key."""
    return hashlib.sha256(f"{key} {text}".encode(errors="surrogatepass")).hexdigest()
