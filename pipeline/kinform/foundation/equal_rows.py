"""Equal rows of an array of integers, found with hash tables instead of a sort.

Each row goes to a slot of a table by a hash of its words. The first row of a slot stays there and leads the rows that
equal it. The few others are hashed again with another hash into a smaller table. The result does not depend on the
hash: rows are equal where all their words are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Ints

_Words = Sequence[NDArray[np.unsignedinteger]]

_ODD = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
"""The first three primes of xxHash32."""
_MIX = 0x2C1B3C6D
"""A multiplier of the 32-bit hashes of C. Wellons (hash-prospector). Any odd number with mixed bits would do."""


def first_equal_rows(words: _Words) -> Ints:
    """(n,) index of the first row that equals each row. `words` are the columns (n,): unsigned integers of 32 or 64
    bits."""
    rest = np.arange(len(words[0]))
    leader = np.empty_like(rest)
    # Tables before the rest is sorted. Each leaves about one row in eight, so that 8^12 rows leave one: a sort is
    # needed only where rows are chosen against the hash.
    for turn in range(12):
        lead = _first_in_slot(_slots(words, turn))
        leader[rest] = rest.take(lead)
        other = np.flatnonzero(_differ(words, lead))
        if not len(other):
            return leader
        rest, words = rest.take(other), [column.take(other) for column in words]
    order = np.lexsort(words)
    new = np.ones(len(order), dtype=bool)
    new[1:] = _differ([column.take(order[1:]) for column in words], order[:-1], words)
    first = np.flatnonzero(new)
    leader[rest.take(order)] = rest.take(order.take(first)).take(np.cumsum(new) - 1)
    return leader


def number_equal_rows(words: _Words) -> tuple[Ints, Ints]:
    """Indices of the first row of each set of equal rows, ascending, and for every row (n,) the number of its set."""
    leader = first_equal_rows(words)
    leads = leader == np.arange(len(leader))
    return np.flatnonzero(leads), (np.cumsum(leads) - 1).take(leader)


def _slots(words: _Words, turn: int) -> Ints:
    """(n,) slots, of a table with one to two slots a row; each turn uses another hash."""
    number = words[0].dtype.type
    width = 8 * words[0].dtype.itemsize
    mixed = words[0] * number(_ODD[turn % len(_ODD)])
    for k, column in enumerate(words[1:], start=turn + 1):
        mixed += column * number(_ODD[k % len(_ODD)])
    mixed ^= mixed >> number(width // 2 - 1)
    mixed *= number(_MIX)
    mixed >>= number(max(width - len(mixed).bit_length(), 0))
    return mixed.astype(np.int64)


def _first_in_slot(slots: Ints) -> Ints:
    """(n,) the first index that has the same slot as each row. Written in reverse order, as the last write stays."""
    table = np.empty(1 << len(slots).bit_length(), np.int64)
    table[slots[::-1]] = np.arange(len(slots) - 1, -1, -1)
    return table.take(slots)


def _differ(words: _Words, lead: Ints, of: _Words | None = None) -> NDArray[np.bool_]:
    """(n,) whether each row differs from the row `lead` of the same words, or of `of`."""
    there = of or words
    apart: NDArray[np.bool_] = there[0].take(lead) != words[0]
    for column, other in zip(words[1:], there[1:], strict=True):
        apart |= other.take(lead) != column
    return apart
