"""Vectors of three in registers: what keeps the other functions, and their compilation, short."""

from __future__ import annotations

from kinform.simulation.kernel.types import Table, Vector

__all__ = ["add", "cross", "dot", "place", "put", "three", "turned"]


def three(table: Table, i: int, j: int) -> Vector:
    """Three numbers of row i from column j."""
    return table[i][j], table[i][j + 1], table[i][j + 2]


def put(table: Table, i: int, j: int, x: float, y: float, z: float) -> None:
    """Writes three numbers to row i from column j."""
    table[i][j] = x
    table[i][j + 1] = y
    table[i][j + 2] = z


def add(table: Table, i: int, j: int, x: float, y: float, z: float) -> None:
    """Adds three numbers to row i from column j."""
    table[i][j] += x
    table[i][j + 1] += y
    table[i][j + 2] += z


def cross(a: float, b: float, c: float, x: float, y: float, z: float) -> Vector:
    """(a, b, c) × (x, y, z)."""
    return b * z - c * y, c * x - a * z, a * y - b * x


def dot(a: float, b: float, c: float, x: float, y: float, z: float) -> float:
    """(a, b, c) · (x, y, z)."""
    return a * x + b * y + c * z


def turned(state: Table, i: int, x: float, y: float, z: float) -> Vector:
    """A vector of link i in world axes."""
    return (
        state[i][0] * x + state[i][1] * y + state[i][2] * z,
        state[i][3] * x + state[i][4] * y + state[i][5] * z,
        state[i][6] * x + state[i][7] * y + state[i][8] * z,
    )


def place(state: Table, i: int, x: float, y: float, z: float) -> Vector:
    """Where a point of link i is."""
    return (
        state[i][0] * x + state[i][1] * y + state[i][2] * z + state[i][9],
        state[i][3] * x + state[i][4] * y + state[i][5] * z + state[i][10],
        state[i][6] * x + state[i][7] * y + state[i][8] * z + state[i][11],
    )
