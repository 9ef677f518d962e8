"""What the numbers of a record measure, said where its fields are declared.

`area: Annotated[float, "m²"]` is a float to everybody; whoever writes records down reads the unit from the annotation,
and where one field holds several numbers, what each of them is called (`Columns`). The types below are those that occur
often. A field without a unit is a text, a flag, a count, or a pure number that is said to be one ("1").

Nothing here knows how or where records are written: that is `kinform.results`.
"""

from __future__ import annotations

from typing import Annotated

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.names import PartName


@dataclass(frozen=True)
class Columns:
    """Names of the numbers, texts or fields that one field holds; * stands for the name of the field."""

    labels: tuple[str, ...]
    shape: tuple[int, ...]
    """Of an array; its numbers run through the last axis first."""


def columns(*labels: str, shape: tuple[int, ...] = ()) -> Columns:
    """The names of what a field holds; `shape` of an array of more than one axis."""
    return Columns(labels, shape or (len(labels),))


XYZ = columns("*_x", "*_y", "*_z")
MATRIX = columns(*(f"*_{a}{b}" for a in "xyz" for b in "xyz"), shape=(3, 3))

Metres = Annotated[float, "m"]
SquareMetres = Annotated[float, "m²"]
Radians = Annotated[float, "rad"]
Ratio = Annotated[float, "1"]
"""A pure number: a share, or one over another of the same unit."""
Lead = Annotated[float, "m a turn"]
"""Advance of a screw, right-handed positive."""
JointValue = Annotated[float, "rad or m"]
"""Of a turn or of a slide."""

Place = Annotated[Array, "m", XYZ]
"""(3,) of a point."""
Direction = Annotated[Array, "1", XYZ]
"""(3,) of an axis or a normal."""
Inertia = Annotated[Array, "kg·m²", MATRIX]
"""(3, 3)."""

PartPair = Annotated[tuple[PartName, PartName], columns("part_a", "part_b")]
"""Two parts, sorted by name."""

Reason = Annotated[tuple[str, str], columns("subject", "reason")]
"""What cannot be had, and why."""
