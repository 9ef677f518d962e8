"""Types of the kernel's arguments. Their names are what the compiled signatures are made from.

Not compiled, tables are lists of rows, which Python reads and writes several times faster than arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

__all__ = ["Counts", "Index", "Ints", "Nums", "Row", "Table", "Vector", "Work"]

Row: TypeAlias = list[float]
"""Compiled, it knows not its length."""
Counts: TypeAlias = list[int]
"""Compiled, it knows not its length."""
Table: TypeAlias = list[Row]
Index: TypeAlias = list[Counts]
Ints: TypeAlias = Sequence[Index]
Nums: TypeAlias = Sequence[Table]
Work: TypeAlias = Sequence[Table]
Vector: TypeAlias = tuple[float, float, float]
