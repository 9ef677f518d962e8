"""Where arrays are in memory: what compiled functions get in their place. See `native` for the other side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["address", "addresses"]


def address(array: NDArray[Any]) -> int:
    """Of the first number of an array of float64 or int64 in C order; TypeError for any other."""
    if not (array.flags.c_contiguous and array.dtype in (np.float64, np.int64)):
        raise TypeError("the kernel takes arrays of float64 or int64 in C order")
    return int(array.ctypes.data)


def addresses(tables: Sequence[NDArray[Any]]) -> NDArray[np.int64]:
    """(3 k,) address, rows and columns of each of k tables. Holds for as long as they do."""
    return np.array([n for table in tables for n in (address(table), *table.shape)], dtype=np.int64)
