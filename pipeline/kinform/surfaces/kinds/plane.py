"""Planes: what coplanar facets are, fitted to their vertices."""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Ints
from kinform.surfaces.groups import group_sum

__all__ = ["fit"]


def fit(group: Ints, points: Array, outward: Array) -> tuple[Array, Array, Array]:
    """(normal, point, variances along the three principal directions) of groups of points (N, 3).

    Every group has three points at least. Each normal has the sense of `outward` (count, 3), which is
    returned instead where the points determine none.
    """
    count = len(outward)
    size = np.maximum(np.bincount(group, minlength=count), 1)
    centre = group_sum(group, points, count) / size[:, None]
    offset = points - centre[group]
    covariance = group_sum(group, offset[:, :, None] * offset[:, None, :], count) / size[:, None, None]
    values, vectors = np.linalg.eigh(covariance)
    normal = vectors[:, :, 0] * np.sign(np.einsum("ij,ij->i", vectors[:, :, 0], outward))[:, None]
    vague = np.abs(np.einsum("ij,ij->i", normal, outward)) < 0.99
    normal = np.where(vague[:, None], outward, normal)
    return normal, centre, np.maximum(values, 0.0)
