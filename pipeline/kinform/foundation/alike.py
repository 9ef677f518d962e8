"""Which rows are alike: by tables of places, without a sort.

Each row goes to a slot of a table by a hash of its words; the first row of a slot stays there, and leads those that
equal it. The others, which are few, are hashed again, otherwise, into a table of their own. What comes out is not that
of the hash: two rows are alike where all their words are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Ints

HASHES = 12
"""Hashes of rows before what is left, one row in eight after each, is sorted."""


_Words = Sequence[NDArray[np.unsignedinteger]]

_ODD = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
_MIX = 0x2C1B3C6D


def first_alike(words: _Words) -> Ints:
    """(n,) place of the first row that equals each, by its words: columns (n,) of unsigned integers of 32 bits, or of
    64."""
    rest = np.arange(len(words[0]))
    leader = np.empty_like(rest)
    for turn in range(HASHES):
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


def numbered_alike(words: _Words) -> tuple[Ints, Ints]:
    """Places of the first rows of each kind, ascending, and for every row (n,) the number of its kind among them."""
    leader = first_alike(words)
    leads = leader == np.arange(len(leader))
    return np.flatnonzero(leads), (np.cumsum(leads) - 1).take(leader)


def _slots(words: _Words, turn: int) -> Ints:
    """(n,) slots, of as many as rows and up to twice as many; in each turn others."""
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
    """(n,) the first place that has the same slot as each: of numbers put into one slot the last stays."""
    table = np.empty(1 << len(slots).bit_length(), np.int64)
    table[slots[::-1]] = np.arange(len(slots) - 1, -1, -1)
    return table.take(slots)


def _differ(words: _Words, lead: Ints, of: _Words | None = None) -> NDArray[np.bool_]:
    """(n,) whether the rows differ from those at the places `lead`, of the same rows or of others."""
    there = of or words
    apart: NDArray[np.bool_] = there[0].take(lead) != words[0]
    for column, other in zip(words[1:], there[1:], strict=True):
        apart |= other.take(lead) != column
    return apart
