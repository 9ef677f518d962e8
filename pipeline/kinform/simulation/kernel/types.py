"""Types of the kernel's arguments. Their names are what the compiled signatures are made from."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Counts", "Index", "Ints", "Nums", "Row", "Table", "Vector", "Work"]

Table: TypeAlias = NDArray[np.float64]
"""Two dimensions, C order."""
Index: TypeAlias = NDArray[np.int64]
"""Two dimensions, C order."""
Row: TypeAlias = NDArray[np.float64]
"""One dimension; compiled, it knows not its length."""
Counts: TypeAlias = NDArray[np.int64]
"""One dimension; compiled, it knows not its length."""
Ints: TypeAlias = tuple[Index, ...]
Nums: TypeAlias = tuple[Table, ...]
Work: TypeAlias = tuple[Table, ...]
Vector: TypeAlias = tuple[float, float, float]
