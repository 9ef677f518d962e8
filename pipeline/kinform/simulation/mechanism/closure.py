"""Closes loops: Newton steps on the positions, and rates that keep them closed.

Redundant loops have dependent rows. How many are independent is decided once, at the start; every solve
afterwards uses so many singular values, never a tolerance of its own.
"""

from __future__ import annotations

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.settings import SolverSettings

REMEMBERED = 2_000_000
"""Numbers of the rows whose decomposition is kept for who asks for it next."""
EVEN = 0.1
"""Share of the singular value before it above which one goes on with those that count: of n four-bars in a row the
least are 3, 2 and 1 times 0.27/n of 3.3, and fall below 1e-4 of the largest from n = 150 on. A choice."""
FALLEN = 1e-4
"""Share of the singular value before it below which one is nothing: rounding is 1e-12, what snapping leaves 1e-8. Where
values neither go on nor fall so, the share of the largest decides alone. A choice."""


@dataclass(frozen=True, eq=False)
class Factor:
    """Singular value decomposition of closure rows for some of the rates, cut at a rank."""

    left: Array
    """(m, r)."""
    values: Array
    """(r,) descending."""
    right: Array
    """(r, k)."""
    null: Array
    """(k, k − r) basis, in rates, of the motions that keep the loops closed."""
    scale: Array
    """(k,)."""

    def solve(self, gap: Array) -> Array:
        """(k,) rates with rows · rates = gap, the smallest in scaled rates."""
        return np.asarray(self.scale * ((gap @ self.left / self.values) @ self.right))

    @property
    def margin(self) -> float:
        """Smallest singular value that counts over the largest; 1 without rows."""
        return float(self.values[-1] / self.values[0]) if len(self.values) else 1.0


def factor(rows: Array, scale: Array, rank: int) -> Factor:
    """Decompose rows (m, k) of rates with these scales at the given rank."""
    left, values, right = _decomposed(rows * scale)
    if rank and values[rank - 1] <= 0.0:
        values = np.maximum(values, 1e-300)
    return Factor(left[:, :rank], values[:rank], right[:rank], scale[:, None] * right[rank:].T, scale)


def rank_of(rows: Array, scale: Array, free: float) -> int:
    """How many rows (m, k) are independent: `counted` singular values."""
    if rows.size == 0:
        return 0
    return int(counted(_values(rows * scale), free))


def _decomposed(rows: Array) -> tuple[Array, Array, Array]:
    """Singular values of rows (m, k) with all directions of rates (k, k), and those of rows that the values need."""
    kept = _last.get("all")
    if kept is None or not np.array_equal(kept[0], rows):
        left, values, right = np.linalg.svd(rows, full_matrices=len(rows) < rows.shape[1])
        kept = _keep("all", rows, left, values, right)
    return kept[1], kept[2], kept[3]


def _values(rows: Array) -> Array:
    """Singular values alone."""
    kept = _last.get("values")
    if kept is None or not np.array_equal(kept[0], rows):
        kept = _keep("values", rows, np.asarray(np.linalg.svd(rows, compute_uv=False), dtype=np.float64))
    return kept[1]


_last: dict[str, tuple[Array, ...]] = {}
"""The rows that were decomposed last, and what came of it: where a run begins, the same ones are asked for again."""


def _keep(what: str, *arrays: Array) -> tuple[Array, ...]:
    for array in arrays:
        array.flags.writeable = False
    if arrays[0].size <= REMEMBERED:
        _last[what] = arrays
    return arrays


def counted(values: Array, free: float) -> Ints:
    """(…) how many of the singular values (…, k), descending, count: those above `free` times the largest; and where
    they go on evenly below that, as those of a long row of loops do, all before they fall to nothing."""
    found = np.asarray(np.count_nonzero(values > free * values[..., :1], axis=-1))
    some = values[..., 0] > 0.0
    found = np.where(some, found, 0)
    following = np.zeros_like(values)
    following[..., :-1] = values[..., 1:]
    even, fallen = following > EVEN * values, following < FALLEN * values
    fallen[..., -1] = False  # where they end nothing says that they have not gone on
    for place in np.argwhere(some & (found < values.shape[-1])):
        at = tuple(place)
        last = int(found[at]) - 1
        while even[at][last]:
            last += 1
        if fallen[at][last]:
            found[at] = last + 1
    return found


def settle(
    mechanism: Mechanism, q: Array, unknown: Ints, rank: int, settings: SolverSettings
) -> tuple[Array, float, float]:
    """Close the loops by moving the `unknown` rates: (positions, gap left, how far they moved).

    Gauss and Newton with steps of least size; stops when closed or when the gap shrinks no more.
    """
    scale = mechanism.scale[unknown]
    moved = np.zeros(len(unknown))
    best, before = q, np.inf
    for _ in range(settings.newton):
        X = mechanism.poses(q)
        gap = mechanism.gap(X, q)
        size = float(np.abs(gap).max(initial=0.0))
        if not size < before:
            break
        best, before = q, size
        if size < settings.closed or rank == 0:
            break
        rows = mechanism.closure(mechanism.screws(X))[:, unknown]
        step = -factor(rows, scale, rank).solve(gap)
        moved = moved + step / scale
        whole = np.zeros(mechanism.rates)
        whole[unknown] = step
        q = mechanism.advance(q, whole)
    return best, before, float(np.abs(moved).max(initial=0.0))
