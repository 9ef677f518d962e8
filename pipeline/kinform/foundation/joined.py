"""Rows of several arrays as one array."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def joined(arrays: Sequence[NDArray[Scalar]]) -> NDArray[Scalar]:
    """All rows of some arrays, at least one; that array itself where it is one."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
