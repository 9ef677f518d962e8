"""Null spaces by singular values."""

from __future__ import annotations

import numpy as np

from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array


def null_space(matrix: Array, share: float) -> Array:
    """(k, n) orthonormal rows x with matrix (m, n) · x = 0; singular values up to that share of the largest count as
    zero."""
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(values > share * max(values.max(initial=0.0), TINY)))
    return np.asarray(right[rank:])
