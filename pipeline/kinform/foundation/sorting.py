"""Orders of integers. With its place in its last bits each key is the only one of its value, and numpy sorts integers
faster than it finds their order."""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Ints

BITS = 63
"""Of a whole number without its sign."""


def ascending(keys: Ints, below: int) -> Ints:
    """(n,) the order that sorts keys from 0 to less than `below`, equal ones as they come."""
    bits = len(keys).bit_length()
    if below.bit_length() + bits > BITS:
        return np.argsort(keys, kind="stable")
    placed = keys.astype(np.int64) << bits
    placed |= np.arange(len(keys))
    placed.sort()
    placed &= (1 << bits) - 1
    return placed


def coarse(values: Array | Ints) -> Array:
    """Values (n,) to 26 bits, to sort by: those that are equal but for rounding are equal, on every processor."""
    mantissa, exponent = np.frexp(values)
    return np.asarray(np.ldexp(np.rint(np.ldexp(mantissa, 26)), exponent - 26))
