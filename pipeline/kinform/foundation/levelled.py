"""Sizes of what is equally large but for the rounding of files."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeVar

AS_LARGE = 1e-3
"""Share by which parts and bodies differ in mass or size that are equal but for the rounding of their files: a bar of
56 mm, as STL 40 m from the origin, is off by up to a ten thousandth. None of them is the ground because of that."""
SIZE_BITS = 50
"""Bits in the sizes of all together, of the 53 that a float has."""


Key = TypeVar("Key", bound=str)


def levelled(sizes: Mapping[Key, float]) -> dict[Key, float]:
    """The sizes, those that are less than another by no more than files round are as large as that: whole numbers of a
    unit, a power of two, so small that nothing is lost and so large that no sum is rounded, in whatever order."""
    unit = math.ldexp(1.0, math.frexp(max(sum(sizes.values()), 1e-300))[1] - SIZE_BITS)
    out: dict[Key, float] = {}
    greatest = 0.0
    for name, size in sorted(sizes.items(), key=lambda item: (-item[1], item[0])):
        if size < (1.0 - AS_LARGE) * greatest or not out:
            greatest = size
        out[name] = round(greatest / unit) * unit
    return {name: out[name] for name in sizes}


def largest(sizes: Mapping[Key, float]) -> Key:
    """The first by name of those that are as large as the largest but for the rounding of files."""
    level = levelled(sizes)
    return min(level, key=lambda name: (-level[name], name))
