"""Arithmetic over many small groups at once: ragged rows, grouped sums, grouped least squares.

Knows nothing of geometry. Groups are runs of consecutive rows, given by their starts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import TypeAlias

import numpy as np

from kinform.foundation.constants import MANY
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.foundation.sorting import ascending, heads
from kinform.model.arrays import Array, Ints

Sums: TypeAlias = Callable[[Array], Array]
"""Gives the sums (…, count) by group of values (…, n)."""


class Ragged:
    """Rows of different length: the items of row i are items[starts[i]:starts[i + 1]]."""

    def __init__(self, rows: Ints, items: Ints, count: int):
        order = ascending(rows, count)
        self.items: Ints = items.take(order)
        self.starts: Ints = starts_of(rows.take(order), count)

    @classmethod
    def of_ordered(cls, rows: Ints, items: Ints, count: int) -> Ragged:
        """Those of rows that ascend."""
        out = cls.__new__(cls)
        out.items, out.starts = items, starts_of(rows, count)
        return out

    @classmethod
    def joined(cls, parts: Sequence[Ragged], offsets: Sequence[int]) -> Ragged:
        """The rows of all the parts, one part after the other, with an offset added to the items of each."""
        out = cls.__new__(cls)
        out.items = np.concatenate([part.items + offset for part, offset in zip(parts, offsets, strict=True)])
        first = np.cumsum([0, *(len(part.items) for part in parts)])
        starts = [part.starts[:-1] + at for part, at in zip(parts, first, strict=False)]
        out.starts = np.concatenate([*starts, first[-1:]])
        return out

    def carrying(self, items: Ints) -> Ragged:
        """Rows as long as these, of other items."""
        out = type(self).__new__(type(self))
        out.items, out.starts = items, self.starts
        return out

    def lengths(self, rows: Ints) -> Ints:
        """Number of items of each of these rows."""
        return self._lengths.take(rows)

    def expand(self, rows: Ints, values: Ints | None = None) -> tuple[Ints, Ints]:
        """(position in `rows`, or value of the row, item) for every item of every row asked for, in order."""
        lengths = self._lengths.take(rows)
        first = self.starts.take(rows)
        first -= lengths.cumsum()
        first += lengths
        at = first.repeat(lengths)
        at += np.arange(len(at))
        return (np.arange(len(rows)) if values is None else values).repeat(lengths), self.items.take(at)

    @cached_property
    def _lengths(self) -> Ints:
        return np.diff(self.starts)


def slices(count: int, size: int) -> Iterator[slice]:
    """Rows 0 to `count`, so many at a time: what is computed row by row takes less memory so, and gives the same."""
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))


def starts_of(groups: Ints, count: int) -> Ints:
    """Start of each of `count` groups in a sorted list of group numbers (count + 1 entries)."""
    out = np.zeros(count + 1, np.int64)
    np.cumsum(np.bincount(groups, minlength=count), out=out[1:])
    return out


def in_order(groups: Ints, values: Array, count: int) -> Ints:
    """The order that sorts values by their group, from 0 to `count`, then by size; equal ones come in any."""
    if len(values) < MANY:
        return np.lexsort((values, groups))
    order = np.argsort(values)
    return order.take(ascending(groups.take(order), count))


def renumbered(numbers: Ints, count: int) -> tuple[Ints, int]:
    """Numbers from 0 to `count` without gaps, in the same order, and how many there are."""
    seen = np.zeros(count, bool)
    seen[numbers] = True
    return (seen.cumsum() - 1).take(numbers), int(np.count_nonzero(seen))


def columns_of(table: Array, rows: Ints) -> Array:
    """These rows of a table, in memory column by column: what reads single columns afterwards is twice as fast."""
    if len(rows) < len(table) and not table.flags.f_contiguous:
        return np.asfortranarray(table.take(rows, axis=0))
    return table.T.take(rows, axis=1).T


def repeated(table: Array, sizes: Ints) -> Array:
    """The rows (n, k) of a table, each so many times (n,), in memory column by column: as `columns_of` of numbers that
    ascend, at two thirds of the price."""
    return table.T.repeat(sizes, axis=1).T


def parted(keys: Ints, count: int) -> tuple[Ints, Ints]:
    """Quotient and remainder of keys that are not negative; the remainder by a product, which is faster."""
    first = keys // count
    return first, keys - first * count


def sums_of(groups: Ints, count: int) -> Sums:
    """What gives the sums (…, count) of any values (…, n) by their group, from 0 to `count`.

    Of groups that follow each other, which takes a tenth of the time of np.bincount; others are put in order first. The
    sum of a group is of its own values in their order, pairwise, whatever other groups and rows of values there are.
    """
    order = None if ascend(groups) else ascending(groups, count)
    ordered = groups if order is None else groups.take(order)
    first = heads(ordered).nonzero()[0]
    every = len(first) == count
    present = None if every else ordered.take(first)

    def sums(values: Array) -> Array:
        if every and count:
            return np.add.reduceat(values if order is None else values.take(order, axis=-1), first, axis=-1)
        out = np.zeros((*values.shape[:-1], count))
        if len(first):
            runs = np.add.reduceat(values if order is None else values.take(order, axis=-1), first, axis=-1)
            out[..., present] = runs
        return out

    return sums


def ascend(groups: Ints) -> bool:
    """Whether the group numbers are in order."""
    return not bool((groups[1:] < groups[:-1]).any())


def group_sum(groups: Ints, values: Array, count: int) -> Array:
    """Sum of `values` (n, ...) for each group number: (count, ...)."""
    flat = values.reshape(len(values), int(np.prod(values.shape[1:], dtype=int)))
    return np.ascontiguousarray(sums_of(groups, count)(flat.T).T).reshape((count, *values.shape[1:]))


def group_moments(groups: Ints, columns: Array, count: int, weight: Array | None = None) -> Array:
    """(count, k, k) sum of w x xᵀ of the rows of each group, x given as k columns (k, n)."""
    size, sums = len(columns), sums_of(groups, count)
    out: Array = np.empty((count, size, size))
    for i in range(size):
        weighed = columns[i] if weight is None else weight * columns[i]
        of_row = sums(weighed * columns[: i + 1]).T
        out[:, i, : i + 1] = out[:, : i + 1, i] = of_row
    return out


def group_mean(groups: Ints, values: Array, count: int, weight: Array | None = None) -> Array:
    """Mean of the rows of `values` (n, k) for each group number: (count, k); zero for groups without."""
    if weight is None:
        size = np.maximum(np.bincount(groups, minlength=count), 1)
        return np.asarray(group_sum(groups, values, count) / size[:, None])
    total = np.maximum(sums_of(groups, count)(weight), TINY)
    return np.asarray(group_sum(groups, values * weight[:, None], count) / total[:, None])


def group_mean_of(groups: Ints, columns: Sequence[Array], rows: Ints, count: int) -> Array:
    """`group_mean` of these rows of k columns, one column at a time."""
    size, sums = np.maximum(np.bincount(groups, minlength=count), 1), sums_of(groups, count)
    return np.stack([sums(column.take(rows)) / size for column in columns], axis=1)


def group_range(groups: Ints, values: Array, count: int) -> tuple[Array, Array]:
    """Least and greatest value of each group number, (count,) each; ∞ and −∞ for groups without."""
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, groups, values)
    np.maximum.at(high, groups, values)
    return low, high


def members(numbers: Ints) -> list[Ints]:
    """Positions (n,) of each number that occurs, ascending; those of numbers below 0 are left out."""
    numbered = np.flatnonzero(numbers >= 0)
    if not len(numbered):
        return []
    named = numbers.take(numbered)
    order = ascending(named, int(named.max()) + 1)
    ordered = numbered.take(order)
    starts = [*heads(named.take(order)).nonzero()[0].tolist(), len(ordered)]
    return [ordered[i:j] for i, j in zip(starts, starts[1:], strict=False)]


def spheres_through(groups: Ints, points: Array, count: int, *more: Array) -> tuple[Array, Array]:
    """Centre (count, d) and squared radius (count,) of the sphere, or circle, through the points (n, d) of each group.

    |q|² = 2 q·c + k is linear in the centre c and in k = r² − |c|²; `more` columns take up what else the squared
    distance depends on.
    """
    return spheres_of(groups, list(points.T), count, *more)


def spheres_of(groups: Ints, coordinates: Sequence[Array], count: int, *more: Array) -> tuple[Array, Array]:
    """As `spheres_through`, of points as d columns (n,), which takes half of the memory."""
    size = len(coordinates)
    square = coordinates[0] ** 2
    for column in coordinates[1:]:
        square += column**2
    columns = [*coordinates, np.ones(len(square)), *more]
    matrix, right = normal_equations(sums_of(groups, count), np.array(columns), square)
    solution = solve_normal(matrix, right)
    centre = solution[:, :size] / 2
    return centre, solution[:, size] + (centre**2).sum(axis=1)


def normal_equations(sums: Sums, columns: Array, residual: Array) -> tuple[Array, Array]:
    """JᵀJ (count, k, k) and Jᵀr (count, k) of each group, of the columns (k, n) of a Jacobian; in memory entry by
    entry."""
    k, product = len(columns), np.empty(columns.shape)
    right = sums(np.multiply(columns, residual, out=product)).T
    matrix: Array = np.empty((k, k, len(right)))
    for i in range(k):
        matrix[i, i:] = matrix[i:, i] = sums(np.multiply(columns[i], columns[i:], out=product[i:]))
    return matrix.transpose(2, 0, 1), right


def solve_normal(matrix: Array, right: Array, damping: float = ARITHMETIC) -> Array:
    """Solutions (count, k) of scaled, slightly damped symmetric systems; never raises."""
    count, k = right.shape
    entries = matrix.transpose(1, 2, 0)
    scale = 1.0 / np.sqrt(np.maximum(entries.diagonal().T, TINY))
    scaled = np.multiply(entries, scale[:, None], order="C")
    scaled *= scale
    scaled.reshape(k * k, count)[:: k + 1] += damping
    wanted = right.T * scale
    # the damping keeps every matrix regular that is finite
    if not (np.isfinite(scaled).all() and np.isfinite(wanted).all()):
        scaled[:, :, ~np.isfinite(scaled).all(axis=(0, 1))] = np.eye(k)[:, :, None]
        wanted = np.nan_to_num(wanted)
    found = np.linalg.solve(scaled.transpose(2, 0, 1), wanted.T[:, :, None])[:, :, 0]
    return np.asarray(found * scale.T)


def quantile(groups: Ints, values: Array, count: int, share: float) -> Array:
    """The lower `share` quantile of the values of each group; 0 for empty groups."""
    order = in_order(groups, values, count)
    return ordered_quantile(np.bincount(groups, minlength=count), values.take(order), share)


def ordered_quantile(size: Ints, values: Array, share: float) -> Array:
    """`quantile` of groups of so many values each, sorted by group, then by size."""
    at = size.cumsum() - size + (share * np.maximum(size - 1, 0)).astype(np.int64)
    if size.all():
        return values.take(at)
    out, filled = np.zeros(len(size)), size > 0
    out[filled] = values[at[filled]]
    return out
