"""Springs, gas springs and bushings of one manifest, in SI, the world, and with full names."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from kinform.form.readers.function import FunctionReader
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array
from kinform.model.springs import BUSHING, GAS_SPRING, SPRING, StatedSpring

_OF_AXES = ("stiffness", "torsion", "damping", "torsion_damping")


def springs_of(reader: FunctionReader) -> Iterator[StatedSpring]:
    """All three kinds, each in the order of the file."""
    makers: tuple[tuple[str, Callable[..., StatedSpring | None]], ...] = (
        (SPRING, _spring), (GAS_SPRING, _gas_spring), (BUSHING, _bushing),
    )  # fmt: skip
    for kind, make in makers:
        for path, table in reader.scope.tables("function", kind):
            name = reader.scope.prefix + (table.name or f"{kind.replace('_', ' ')} {path[-1] + 1}")
            between = reader.pair(table.between, reader.place, *path, "between")
            made = make(reader, table, name, between, *path)
            if made is not None:
                yield made


def _points(reader: FunctionReader, table: Any) -> tuple[Array, Array]:
    first, second = (reader.scope.point(point) for point in table.points)
    assert first is not None and second is not None
    return first, second


def _spring(
    reader: FunctionReader, table: Any, name: str, between: tuple[str, str], *path: str | int
) -> StatedSpring | None:
    scope, (first, second) = reader.scope, _points(reader, table)
    if not table.stiffness and not table.damping:
        scope.complain("a spring has neither stiffness nor damping", "add stiffness in N/m", *path)
    drawn = float(np.linalg.norm(second - first))
    rest = drawn if table.rest is None else table.rest * scope.metres
    numbers = {"stiffness": table.stiffness, "damping": table.damping, "rest": rest}
    return StatedSpring(SPRING, name, between, first, second, numbers, None, *scope.where(*path))


def _gas_spring(
    reader: FunctionReader, table: Any, name: str, between: tuple[str, str], *path: str | int
) -> StatedSpring | None:
    from kinform.form.meshes.health import SMALLEST_MESH  # meshes are read where there are some

    scope, (first, second) = reader.scope, _points(reader, table)
    (extended, compressed), (least, most) = table.lengths, table.forces
    if not extended > compressed:
        scope.complain("the first length of a gas spring is not the longer one", "swap them", *path, "lengths")
        return None
    if not most > least:
        scope.complain("the force of a gas spring does not grow as it is pushed in", "swap them", *path, "forces")
        return None
    stroke = (extended - compressed) * scope.metres
    if stroke < SMALLEST_MESH:
        wrong = f"the lengths of a gas spring differ by {stroke:.2g} m, less than an atom"
        scope.complain(wrong, "correct them, or their units", *path, "lengths")
        return None
    numbers = {"force": least, "extended": extended * scope.metres, "damping": table.damping}
    if table.exponent:
        # force · (column − what it is pushed in)^n is the same at both lengths.
        try:
            ratio = float((most / least) ** (1.0 / table.exponent))
        except OverflowError:
            ratio = math.inf
        if not 1.0 + SOLVED < ratio < 1.0 / SOLVED:
            wrong = f"a gas spring with exponent {table.exponent:g} has no column of gas with these forces"
            scope.complain(wrong, "give 1 (slow) to 1.4 (quick), or 0 for a straight line", *path, "exponent")
            return None
        numbers |= {"column": stroke * ratio / (ratio - 1.0), "exponent": table.exponent}
    else:
        numbers |= {"stiffness": (most - least) / stroke}
    return StatedSpring(GAS_SPRING, name, between, first, second, numbers, None, *scope.where(*path))


def _bushing(
    reader: FunctionReader, table: Any, name: str, between: tuple[str, str], *path: str | int
) -> StatedSpring | None:
    scope = reader.scope
    numbers = {
        f"{key}_{axis}": value for key in _OF_AXES for axis, value in zip("xyz", getattr(table, key), strict=True)
    }
    if not any(numbers.values()):
        scope.complain("a bushing has neither stiffness nor damping", "add stiffness = [x, y, z] in N/m", *path)
    point = scope.point(table.point)
    assert point is not None
    columns = [scope.vector(unit) for unit in np.eye(3).tolist()]
    axes = np.column_stack([column for column in columns if column is not None])
    return StatedSpring(BUSHING, name, between, point, point, numbers, axes, *scope.where(*path))
