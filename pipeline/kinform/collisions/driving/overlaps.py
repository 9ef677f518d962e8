"""Parts that overlap as they are drawn, in words: why it is not known how far a joint goes."""

from __future__ import annotations

from collections.abc import Sequence

from kinform.foundation.words import counted, length, place
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.names import PartName

Pair = tuple[PartName, PartName]


@dataclass(frozen=True, eq=False)
class Overlap:
    """Two parts that overlap from the start."""

    pair: Pair
    depth: float
    """m; 0 where it was not measured."""
    place: Array | None
    """(3,) m, world."""


def overlap_words(overlaps: Sequence[Overlap], units: str) -> str:
    """The deepest of some overlaps in an assembly of some units, and how many pairs more there are."""
    deepest = {}
    for overlap in sorted(overlaps, key=lambda overlap: overlap.depth):
        deepest[overlap.pair] = overlap
    first, *others = sorted(deepest.values(), key=lambda overlap: (-overlap.depth, overlap.pair))
    by = f" by {length(first.depth, units, 2)}" if first.depth > 0.0 else ""
    at = "" if first.place is None else f" at {place(first.place, units)}"
    more = f"; and {counted(len(others), 'pair')} more" if others else ""
    return f"{' and '.join(first.pair)} overlap{by} as modelled{at}{more}: separate them first"
