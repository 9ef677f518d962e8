"""Vectors of three in registers: what keeps the other functions, and their compilation, short."""

from __future__ import annotations

from kinform.simulation.kernel.layout import (  # isort: skip
    Row, Vector,
)  # fmt: skip


def three(row: Row, j: int) -> Vector:
    """Three numbers of a row from column j."""
    return row[j], row[j + 1], row[j + 2]


def six(row: Row, j: int) -> tuple[float, float, float, float, float, float]:
    """Six numbers of a row from column j."""
    return row[j], row[j + 1], row[j + 2], row[j + 3], row[j + 4], row[j + 5]


def put(row: Row, j: int, x: float, y: float, z: float) -> None:
    """Writes three numbers to a row from column j."""
    row[j] = x
    row[j + 1] = y
    row[j + 2] = z


def add(row: Row, j: int, x: float, y: float, z: float) -> None:
    """Adds three numbers to a row from column j."""
    row[j] += x
    row[j + 1] += y
    row[j + 2] += z


def cross(a: float, b: float, c: float, x: float, y: float, z: float) -> Vector:
    """(a, b, c) × (x, y, z)."""
    return b * z - c * y, c * x - a * z, a * y - b * x


def dot(a: float, b: float, c: float, x: float, y: float, z: float) -> float:
    """(a, b, c) · (x, y, z)."""
    return a * x + b * y + c * z


def turned(link: Row, x: float, y: float, z: float) -> Vector:
    """A vector of a link, whose row of work[STATE] is given, in world axes."""
    return (
        link[0] * x + link[1] * y + link[2] * z,
        link[3] * x + link[4] * y + link[5] * z,
        link[6] * x + link[7] * y + link[8] * z,
    )


def along(link: Row, row: Row, j: int) -> Vector:
    """The vector of a link in the columns from j of a row, in world axes."""
    x, y, z = row[j], row[j + 1], row[j + 2]
    return (
        link[0] * x + link[1] * y + link[2] * z,
        link[3] * x + link[4] * y + link[5] * z,
        link[6] * x + link[7] * y + link[8] * z,
    )


def place(link: Row, row: Row, j: int) -> Vector:
    """Where the point of a link is that is in the columns from j of a row."""
    x, y, z = row[j], row[j + 1], row[j + 2]
    return (
        link[0] * x + link[1] * y + link[2] * z + link[9],
        link[3] * x + link[4] * y + link[5] * z + link[10],
        link[6] * x + link[7] * y + link[8] * z + link[11],
    )
