"""Tables of numbers in CSV files: laws over time, and paths of points or poses, in SI and the world."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from kinform.form.constants import LARGEST_NUMBER, VALUE_LENGTH
from kinform.form.readers.open_manifest import Scope
from kinform.foundation.texts import TextError, read_text

TABLE_BYTES = 8 << 20
"""Bytes of a CSV file: half a million rows. A row of 8 bytes takes 300 as numbers, so that all take 300 MB."""


def law_rows(scope: Scope, path: Path, shown: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times (strictly ascending) and values of a file; a header line and further columns are allowed.

    What is wrong with it becomes a problem of the scope, under the name that is `shown`.
    """
    times: list[float] = []
    values: list[float] = []
    for number, row, text in _rows(scope, path, shown, 2):
        if len(row) != 2:
            scope.problems.add(f"the row {text!r} is not time and value", shown, number, "give two finite numbers")
            continue
        time, value = row
        _follows(scope, time, times[-1] if times else None, shown, number)
        times.append(time)
        values.append(value)
    if len(times) < 2:
        scope.problems.add("the table has fewer than two rows", shown, 1, "give rows of time and value")
    return tuple(times), tuple(values)


def path_rows(scope: Scope, path: Path, shown: str) -> list[list[float]]:
    """Rows of time, point (m) and perhaps quaternion wxyz, in the world; problems as in `law_rows`."""
    from scipy.spatial.transform import Rotation

    out: list[list[float]] = []
    turn = Rotation.from_matrix(scope.X_WF[:3, :3])
    for number, row, _ in _rows(scope, path, shown):
        if len(row) not in (4, 8) or (out and len(row) != len(out[0])):
            scope.problems.add("the row is not time, x, y, z, or these with a quaternion", shown, number,
                               "give 4 numbers a row, or 8")  # fmt: skip
            continue
        _follows(scope, row[0], out[-1][0] if out else None, shown, number)
        point = scope.point(row[1:4])
        assert point is not None
        pose: list[float] = []
        if len(row) == 8:
            if not np.linalg.norm(row[4:]) > 0.0:
                scope.problems.add("the quaternion is zero", shown, number, "give qw, qx, qy, qz")
                continue
            pose = (turn * Rotation.from_quat(row[4:], scalar_first=True)).as_quat(scalar_first=True).tolist()
        out.append([row[0], *point.tolist(), *pose])
    if len(out) < 2:
        scope.problems.add("the path has fewer than two rows", shown, 1, "give rows of time, x, y, z")
    return out


def _rows(scope: Scope, path: Path, shown: str, most: int | None = None) -> Iterator[tuple[int, list[float], str]]:
    """Number of the line, its first `most` cells as finite numbers, and its text; a row with anything else among
    them comes empty. Blank lines, and a first line that is no numbers, are left out. A file that cannot be read as
    such is a problem of the scope, and ends there."""
    try:
        text = read_text(path, TABLE_BYTES, "a table of numbers", scope.boundary)
    except TextError as error:
        scope.problems.add(error.message, shown, None, error.remedy or "check its permissions")
        return
    rows = csv.reader(io.StringIO(text, newline=""))
    try:
        for number, row in enumerate(rows, start=1):
            if not "".join(row).strip():
                continue
            try:
                values = [float(cell) for cell in row[:most]]
            except ValueError:
                values = []
            if not all(abs(value) <= LARGEST_NUMBER for value in values):
                values = []
            if values or number > 1:
                yield number, values, ",".join(row)[:VALUE_LENGTH]
    except csv.Error as error:
        scope.problems.add(f"is no table of numbers: {error}", shown, rows.line_num, "write rows of numbers")


def _follows(scope: Scope, time: float, before: float | None, shown: str, number: int) -> None:
    if before is not None and time <= before:
        scope.problems.add(f"time {time:g} does not follow {before:g}", shown, number, "sort the rows by time")
