"""How fast this machine is, beside the rows of the table: `python benchmarks/pace.py`.

What kinform spends its time on, on fixed data and without kinform: a change of these between two tables is one of the
machine. Machines differ, and one machine differs from hour to hour, by a factor of two.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from table import Row, processor, show


def interpreted() -> int:
    """A loop of a million steps."""
    total = 0
    for k in range(1_000_000):
        total += k * k
    return total


def small_arrays() -> float:
    """Twenty thousand products of 3 × 3 and 3."""
    matrix, vector = np.eye(3), np.ones(3)
    for _ in range(20_000):
        vector = matrix @ vector
    return float(vector[0])


def large_arrays() -> np.ndarray:
    """Two million numbers sorted."""
    return np.sort(np.random.default_rng(0).random(2_000_000))


def trees() -> object:
    """A tree of FCL of 80,000 facets."""
    import fcl

    x, y = np.meshgrid(*[np.linspace(0.0, 1.0, 201)] * 2, indexing="ij")
    points = np.stack([x, y, 0.1 * np.sin(9.0 * x * y)], axis=2).reshape(-1, 3)
    grid = np.arange(201 * 201).reshape(201, 201)
    a, b, c, d = grid[:-1, :-1].ravel(), grid[1:, :-1].ravel(), grid[1:, 1:].ravel(), grid[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    model = fcl.BVHModel()
    model.beginModel(len(faces), len(points))
    model.addSubModel(points, faces)
    model.endModel()
    return model


def rows(quick: bool) -> Iterator[Row]:
    """One of each."""
    for work in (interpreted, small_arrays, large_arrays, trees):
        seconds, _ = processor(work, 3 if quick else 7)
        words = (work.__doc__ or "").rstrip(".").lower()
        yield Row(f"pace: {words}", 1e3 * seconds, None, "ms")


def main(arguments: list[str]) -> None:
    show(rows("--quick" in arguments))


if __name__ == "__main__":
    main(sys.argv[1:])
