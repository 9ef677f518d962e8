"""Concatenation that copies nothing where there is one array."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def concatenated(arrays: Sequence[NDArray[Scalar]]) -> NDArray[Scalar]:
    """The rows of one or more arrays; a single array is returned as it is."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
