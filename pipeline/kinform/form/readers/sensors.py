"""`[[simulation.sensor]]` of the top manifest, in the world and with full names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from kinform.form.readers.function import FunctionReader
from kinform.foundation.name_hints import in_quotes
from kinform.model.sensors import Sensor


def sensors_of(reader: FunctionReader) -> Iterator[Sensor]:
    """The sensors; a problem for each name that is taken and each place that is not there."""
    taken: set[str] = set()
    for path, table in reader.scope.tables("simulation", "sensor"):
        if table.name in taken:
            reader.scope.complain(f"two sensors are called {in_quotes(table.name)}", "rename one", *path, "name")
        taken.add(table.name)
        yield _sensor(reader, table, *path)


def _sensor(reader: FunctionReader, table: Any, *path: str | int) -> Sensor:
    def place(key: str) -> str:
        stated = getattr(table, key, None)
        return reader.place(stated, *path, key) if stated is not None else ""

    scope = reader.scope
    between = getattr(table, "between", None)
    part, other = reader.pair(between, reader.place, *path, "between") if between else (place("part"), "")
    points = getattr(table, "points", None) or [getattr(table, "point", None), None]
    axis = scope.direction(getattr(table, "axis", None), *path, "axis")
    stated = getattr(table, "joint", None)
    joint = reader.joint(stated, *path, "joint") if stated is not None else ""
    point, other_point = (scope.point(one) for one in points)
    file, line = scope.where(*path)
    return Sensor(table.name, table.kind, part, other, point, other_point, axis, joint, place("frame"), file, line)
