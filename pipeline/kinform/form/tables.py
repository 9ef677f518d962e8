"""Rows of numbers in CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

__all__ = ["rows_of"]


def rows_of(path: Path) -> Iterator[tuple[int, list[float]]]:
    """Number of the line, and its finite numbers; a row with anything else in it comes empty. Blank lines, and a
    first line that is no numbers, are left out."""
    with path.open(newline="", encoding="utf-8-sig") as file:
        for number, row in enumerate(csv.reader(file), start=1):
            if not "".join(row).strip():
                continue
            try:
                values = [float(cell) for cell in row]
            except ValueError:
                values = []
            if not all(map(math.isfinite, values)):
                values = []
            if values or number > 1:
                yield number, values
