"""Planes: what coplanar facets are, fitted to their vertices."""

from __future__ import annotations

import numpy as np

from kinform.surfaces._batch import Array

__all__ = ["fit"]


def fit(points: Array, outward: Array) -> tuple[Array, Array, Array]:
    """(normal, point, variances along the three principal directions) of points (N, 3), N at least 3.

    The normal has the sense of `outward`, which is returned instead where the points determine none.
    """
    centre = points.mean(axis=0)
    values, vectors = np.linalg.eigh(np.cov((points - centre).T, bias=True))
    normal = vectors[:, 0] * np.sign(vectors[:, 0] @ outward)
    if abs(normal @ outward) < 0.99:
        normal = outward
    return normal, centre, np.maximum(values, 0.0)
