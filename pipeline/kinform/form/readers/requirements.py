"""Requirements of a manifest in SI, the world and full names; what one key of them says about another.

Contradictions, and requirements that would ask for nothing, are refused here, so that none of them can pass unseen.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from pydantic import BaseModel

from kinform.form.manifest import requirements as tables
from kinform.form.manifest.common import Quantity
from kinform.form.readers.csv_tables import path_rows
from kinform.form.readers.function import FunctionReader
from kinform.foundation.name_hints import in_quotes
from kinform.model.function import Requirement


def requirements_of(reader: FunctionReader) -> Iterator[Requirement]:
    """`[[function.require]]` of the manifest that the reader reads."""
    scope = reader.scope
    for path, table in scope.tables("function", "require"):
        for wrong, remedy, key in _faults(table):
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
        elif quantity is None or value is None:
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
    if kind == "joint_value":
        scale = reader.value_scale(scope.prefix + getattr(table, "joint", ""), *path)
        return [item * scale for item in value] if isinstance(value, list) else value * scale
    if kind == "joint_values":
        poses = [{reader.joint(joint, *path): v for joint, v in pose.items()} for pose in value]
        return [{joint: v * reader.value_scale(joint, *path) for joint, v in pose.items()} for pose in poses]
    if kind in ("length", "frame"):
        return (np.array(value) * scope.metres).tolist()
    assert kind == "angle", kind
    return math.radians(value)


Fault = tuple[str, str, str | None]
"""What is wrong, the remedy, and the key at which it is."""


def _faults(table: Any) -> Iterator[Fault]:
    """Everything that is wrong with one `[[function.require]]`."""
    if isinstance(table, tables.Mass | tables.Inertia | tables.Fit):
        yield from _bound_faults(table)
    elif isinstance(table, tables.Reach):
        yield from _reach_faults(table)
    elif isinstance(table, tables.Reaction):
        if table.force is None and table.torque is None:
            yield "it limits neither force nor torque", "add force, in N, or torque, in N·m", None
    elif isinstance(table, tables.Balance):
        yield from _balance_faults(table)
    elif isinstance(table, tables.TorqueSpeed):
        yield from _curve_faults(table)
    if isinstance(table, tables.Clear | tables.Fit) and table.between is not None and len(set(table.between)) < 2:
        yield f"both sides are {in_quotes(table.between[0])}", "name two different ones", "between"


def _curve_faults(table: tables.TorqueSpeed) -> Iterator[Fault]:
    if len(table.speeds) != len(table.efforts):
        given = f"it has {len(table.speeds)} speeds and {len(table.efforts)} efforts"
        yield given, "give an effort for each of the speeds", "efforts"
    if table.speeds[0] != 0.0 or any(b <= a for a, b in pairwise(table.speeds)):
        yield "its speeds do not ascend from 0", "begin with 0, the stalled drive, and list each speed once", "speeds"
    if 0.0 in table.efforts[:-1] or any(b > a for a, b in pairwise(table.efforts)):
        wrong = "its efforts grow with speed, or are 0 before its greatest speed"
        yield wrong, "give what the drive can do at each speed, up to the greatest", "efforts"


def _bound_faults(table: tables.Mass | tables.Inertia | tables.Fit) -> Iterator[Fault]:
    low, high = table.minimum, table.maximum
    if low is None and high is None:
        yield "it states neither minimum nor maximum", "add one of them", None
    elif low is not None and high is not None and low > high:
        yield f"its minimum, {low:g}, is above its maximum, {high:g}", "exchange them", "minimum"


def _reach_faults(table: tables.Reach) -> Iterator[Fault]:
    if (table.point is None) == (table.direction is None):
        yield "it needs either a point or a direction", "state one of them", None
        return
    pointing, region = table.direction is not None, table.region
    what, other = ("directions", "points") if pointing else ("points", "directions")
    if isinstance(region, tables.Poses):
        if not getattr(region, what):
            yield f"the poses list no {what}", f"add {what} to the region", "region"
        if getattr(region, other) is not None:
            yield f"the poses list {other}, and it is {what} that are asked for", f"remove {other}", "region"
    elif pointing == isinstance(region, tables.Box):
        wrong = "a box is a region of points" if pointing else "a cone is a region of directions"
        yield wrong, f"state a {'point' if pointing else 'direction'}, or another region", "region"
    if isinstance(region, tables.Box) and any(a > b for a, b in zip(region.lower, region.upper, strict=True)):
        yield "the lower corner of the box is not below its upper one", "exchange what is the wrong way round", "region"
    stray = "tolerance" if pointing else "angle_tolerance"
    if getattr(table, stray) is not None:
        yield f"{stray} says nothing about {what}", f"state {'angle_tolerance' if pointing else 'tolerance'}", stray


def _balance_faults(table: tables.Balance) -> Iterator[Fault]:
    line = (table.axis is not None, table.point is not None)
    if table.joint is not None and any(line):
        yield "it names a joint, and axis or point too", "keep the joint, or axis and point", "joint"
    elif table.joint is None and not all(line):
        yield "it names neither a joint nor axis and point", "name a joint, or give axis and point", None
