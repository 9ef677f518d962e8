"""How many equations of loops are independent, and solutions with so many.

Loops say many things more than once: three of the six equations of a planar loop, all along its motion. Their singular
values are zero for exact axes, and for axes of a mesh file the misfit that is left. How many singular values count is
decided by their size (`counted`), or was decided before and is a number (`Rank`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

RANK_SHARE = 1e-4
"""Share of the largest singular value below which one is zero, all along a motion, as `Tolerances.free` for contacts:
the misfit of axes that went through single precision leaves up to 1e-5, and a loop nearer than this to a singular pose
is not told from one that is there."""
EVEN = 0.1
"""Share of the singular value before it above which one goes on with those that count: of n four-bars in a row the
least are 3, 2 and 1 times 0.27/n of 3.3, and fall below 1e-4 of the largest from n = 150 on. A choice."""
FALLEN = 1e-4
"""Share of the singular value before it below which one is nothing: rounding is 1e-12, what snapping leaves 1e-8. Where
values neither go on nor fall so, the share of the largest decides alone. A choice."""
REMEMBERED = 2_000_000
"""Numbers of the rows whose decomposition is kept for who asks for it next: 16 MB."""


@dataclass(frozen=True, eq=False)
class Rank:
    """Which singular values of closure equations count."""

    share: float = RANK_SHARE
    """Of the largest, above which one counts (`counted`); not asked where there is a `number`."""
    number: int | None = None
    """So many count, as was decided before."""
    free: Array | None = None
    """(k, n) orthonormal rates near those that the equations leave free at that number: large blocks begin with them
    (`least_change`)."""

    def of(self, values: Array) -> Ints:
        """(…) how many of the singular values (…, k), descending, count."""
        if self.number is None:
            return counted(values, self.share)
        return np.full(values.shape[:-1], min(self.number, values.shape[-1]))


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
        values = np.maximum(values, TINY)
    return Factor(left[:, :rank], values[:rank], right[:rank], scale[:, None] * right[rank:].T, scale)


def rank_of(rows: Array, scale: Array, share: float = RANK_SHARE) -> int:
    """How many rows (m, k) of rates with these scales are independent: `counted` singular values."""
    if rows.size == 0:
        return 0
    return int(counted(_values(rows * scale), share))


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


def counted(values: Array, share: float = RANK_SHARE) -> Ints:
    """(…) how many of the singular values (…, k), descending, count: those above `share` times the largest; and where
    they go on evenly below that, as those of a long row of loops do, all before they fall to nothing."""
    found = np.asarray(np.count_nonzero(values > share * values[..., :1], axis=-1))
    each, rows = found.reshape(-1), values.reshape(found.size, -1)
    for k, number in enumerate(each.tolist()):
        if 0 < number < rows.shape[1]:
            each[k] = _evenly(rows[k].tolist(), number)
    return found


def _evenly(values: Sequence[float], found: int) -> int:
    """How many of the values, descending, of which `found` are large enough, count where they go on evenly."""
    last = found - 1
    while last + 1 < len(values) and values[last + 1] > EVEN * values[last]:
        last += 1
    # where they end nothing says that they have not gone on
    return last + 1 if last + 1 < len(values) and values[last + 1] < FALLEN * values[last] else found
