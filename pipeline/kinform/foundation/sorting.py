"""Orders of integers, and medians. With its place in its last bits each key is the only one of its value, and numpy
sorts integers faster than it finds their order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.constants import MANY
from kinform.model.arrays import Array, Flags, Ints

DIGIT = 16
"""Bits of numbers that numpy sorts by counting (radix sort of 16-bit integers)."""

FEW_BITS = 31
"""Bits of numbers that fit into 32-bit integers, which numpy sorts in half of the time."""


def ascending(keys: Ints, below: int) -> Ints:
    """(n,) the order that sorts keys from 0 to less than `below`, equal ones as they come."""
    bits = len(keys).bit_length()
    if below <= 1 << DIGIT:
        return np.argsort(keys.astype(np.uint16), kind="stable")
    # an int64 without its sign has 63 bits
    if below.bit_length() + bits > 63:
        return np.argsort(keys, kind="stable")
    placed = keys.astype(np.int64) << bits
    placed |= np.arange(len(keys))
    placed.sort()
    placed &= (1 << bits) - 1
    return placed


def sorted_keys(keys: Ints) -> Ints:
    """The keys (n,) themselves, sorted; none is below 0."""
    if len(keys) < MANY or int(keys.max()) >> FEW_BITS:
        return np.sort(keys)
    few = keys.astype(np.int32)
    few.sort()
    return few.astype(np.int64)


def heads(ordered: Ints | NDArray[np.complex128]) -> Flags:
    """(n,) which of the ordered keys are the first of their value."""
    out = np.empty(len(ordered), bool)
    out[:1] = True
    np.not_equal(ordered[1:], ordered[:-1], out=out[1:])
    return out


def distinct(keys: Ints) -> Ints:
    """The distinct keys, ascending: sorting integers is faster than numpy's hashing."""
    ordered = sorted_keys(keys)
    return ordered.take(heads(ordered).nonzero()[0])


def among(keys: Ints, ordered: Ints) -> Flags:
    """Whether each key is one of the ordered ones."""
    if not len(ordered):
        return np.zeros(len(keys), bool)
    return np.asarray(ordered.take(ordered.searchsorted(keys), mode="clip") == keys)


def occurrences(keys: Ints) -> tuple[Ints, Ints]:
    """The distinct keys, ascending, and how often each occurs."""
    ordered = sorted_keys(keys)
    first = heads(ordered).nonzero()[0]
    times = np.empty(len(first), np.int64)
    np.subtract(first[1:], first[:-1], out=times[:-1])
    times[-1:] = len(ordered) - first[-1:]
    return ordered.take(first), times


def numbered(keys: Ints, below: int) -> tuple[Ints, Ints]:
    """The distinct keys from 0 to less than `below`, ascending, and for each key its place among them (n,)."""
    order = ascending(keys, below)
    ordered = keys.take(order)
    first = heads(ordered)
    places = np.empty(len(keys), np.int64)
    places[order] = first.cumsum() - 1
    return ordered.take(first.nonzero()[0]), places


def coarse(values: Array | Ints) -> Array:
    """Values (n,) to 26 bits, to sort by: those that are equal but for rounding are equal, on every processor."""
    mantissa, exponent = np.frexp(values)
    return np.asarray(np.ldexp(np.rint(np.ldexp(mantissa, 26)), exponent - 26))


def median(values: Array | Sequence[float]) -> float:
    """The median of values (n,), n ≥ 1, to the same bits as numpy's, which would load its masked arrays."""
    ordered, half = np.sort(values), len(values) // 2
    return float(ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2.0)
