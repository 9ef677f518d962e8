"""Types of the kernel's arguments. Their names are what the compiled signatures are made from."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Counts", "Derivative", "Index", "Ints", "Nums", "Project", "Row", "Table", "Vector", "Work"]

Table: TypeAlias = NDArray[np.float64]
"""Two dimensions, C order."""
Index: TypeAlias = NDArray[np.int64]
"""Two dimensions, C order."""
Row: TypeAlias = NDArray[np.float64]
"""One dimension."""
Counts: TypeAlias = NDArray[np.int64]
"""One dimension."""
Ints: TypeAlias = tuple[Index, ...]
Nums: TypeAlias = tuple[Table, ...]
Work: TypeAlias = tuple[Table, ...]
Vector: TypeAlias = tuple[float, float, float]
Derivative: TypeAlias = Callable[[Ints, Nums, Work, float, Row, Row], float]
Project: TypeAlias = Callable[[Ints, Nums, Work, float, Row, float], tuple[float, float]]
