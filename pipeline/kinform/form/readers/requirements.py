"""Requirements of a manifest in SI, the world and full names.

Contradictions, and requirements that would ask for nothing, are refused here, so that none of them can pass unseen:
`faults` of each kind finds them (`kinform.requirements`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from pydantic import BaseModel

from kinform.form.readers.csv_tables import path_rows
from kinform.form.readers.function import FunctionReader
from kinform.foundation.name_hints import in_quotes
from kinform.model.function import Requirement
from kinform.requirements import kind_of
from kinform.requirements.quantity import Quantity


def requirements_of(reader: FunctionReader) -> Iterator[Requirement]:
    """`[[function.require]]` of the manifest that the reader reads."""
    scope = reader.scope
    for path, table in scope.tables("function", "require"):
        for wrong, remedy, key in kind_of(table.kind).faults(table):
            at = path if key is None else (*path, key)
            scope.complain(f"requirement {in_quotes(table.name)}: {wrong}", remedy, *at)
        values = _values(reader, table, *path)
        values = {key: value for key, value in values.items() if key not in ("name", "kind") and value is not None}
        yield Requirement(scope.prefix + table.name, table.kind, values, *scope.where(*path))


def _values(reader: FunctionReader, table: BaseModel, *path: str | int) -> dict[str, Any]:
    """The values of a table by key: quantities converted, the rest as it is."""
    out: dict[str, Any] = {}
    for key, field in type(table).model_fields.items():
        value = getattr(table, key)
        quantity = next((m for m in field.metadata if isinstance(m, Quantity)), None)
        if isinstance(value, BaseModel):
            out[key] = _values(reader, value, *path, key)
        elif quantity is None or value is None or quantity.kind in ("number", "joint_effort"):
            out[key] = value
        elif quantity.kind == "path":
            file = reader.file(value, "the path", *path, key)
            out[key] = value if file is None else reader.files.shown(file)
            out["rows"] = [] if file is None else path_rows(reader.scope, file, out[key])
        else:
            out[key] = _converted(reader, quantity.kind, value, table, *path, key)
            if quantity.kind == "frame":
                out["X_WF"] = reader.scope.X_WF.tolist()
    return out


def _converted(reader: FunctionReader, kind: str, value: Any, table: BaseModel, *path: str | int) -> Any:
    """The value of a key, whose quantity is of this kind (see `Quantity`), in SI, the world and full names."""
    scope = reader.scope
    if kind in ("point", "direction"):
        if not value or isinstance(value[0], list):
            return [_converted(reader, kind, item, table, *path) for item in value]
        placed = scope.point(value) if kind == "point" else scope.direction(value, *path)
        return None if placed is None else placed.tolist()
    if kind in ("place", "joint"):
        resolve = reader.joint if kind == "joint" else reader.place
        return [resolve(name, *path) for name in value] if isinstance(value, list) else resolve(value, *path)
    if kind == "joint_rate":
        scale = reader.value_scale(scope.prefix + getattr(table, "joint", ""), *path)
        return [item * scale for item in value] if isinstance(value, list) else value * scale
    if kind == "joint_values":
        poses = [{reader.joint(joint, *path): v for joint, v in pose.items()} for pose in value]
        return [{joint: v * reader.value_scale(joint, *path) for joint, v in pose.items()} for pose in poses]
    if kind in ("length", "frame"):
        return (np.array(value) * scope.metres).tolist()
    assert kind == "angle", kind
    return math.radians(value)
