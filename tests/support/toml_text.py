"""TOML of what manifests hold: tables, arrays of them, and values that come back to the last bit."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def toml(tables: Mapping[str, Any]) -> str:
    """A TOML text: one line a value, one a table of an array."""
    lines = [f"{key} = {_value(value)}" for key, value in tables.items() if not isinstance(value, (Mapping, list))]
    for key, value in tables.items():
        if isinstance(value, list):
            lines += [f"{key} = [", *(f"    {_value(item)}," for item in value), "]"]
    for key, value in tables.items():
        if isinstance(value, Mapping):
            lines += [f"[{key}]", *(f"{name} = {_value(item)}" for name, item in value.items())]
    return "\n".join(lines) + "\n"


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(key)} = {_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return repr(float(value)) if isinstance(value, float) else json.dumps(value)
