"""Sizes that differ only by the rounding of files are made equal, so that the largest part does not depend on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeVar

from kinform.foundation.rounding import TINY

AS_LARGE = 1e-3
"""Relative difference in mass or size that the rounding of files can cause: a bar of 56 mm, as STL 40 m from the
origin, is off by up to 1e-4, and ten times that is far below what tells a frame from an arm."""


Key = TypeVar("Key", bound=str)


def tied_sizes(sizes: Mapping[Key, float]) -> dict[Key, float]:
    """The sizes, where those within `AS_LARGE` of a larger one are equal to it. All are whole multiples of a power of
    two, chosen so that sums of them are exact in any order."""
    # Bits of the sum of all sizes, of the 53 that a double has: sums of whole multiples of 2^-50 of it are exact.
    unit = math.ldexp(1.0, math.frexp(max(sum(sizes.values()), TINY))[1] - 50)
    out: dict[Key, float] = {}
    greatest = 0.0
    for name, size in sorted(sizes.items(), key=lambda item: (-item[1], item[0])):
        if size < (1.0 - AS_LARGE) * greatest or not out:
            greatest = size
        out[name] = round(greatest / unit) * unit
    return {name: out[name] for name in sizes}


def largest(sizes: Mapping[Key, float]) -> Key:
    """The first name, in alphabetical order, of the sizes that tie for the largest."""
    level = tied_sizes(sizes)
    return min(level, key=lambda name: (-level[name], name))
