"""Motions under which patches of polygons slide on themselves.

At a point q with the normal n the twist (ω; v) moves the surface along its normal by (q × n) · ω + n · v. The motion
that does so least, in the mean over the polygons' areas, is the eigenvector of Σ w [q × n; n][q × n; n]ᵀ with the least
eigenvalue (line complexes: Pottmann and Randrup, Rotational and helical surface approximation, 1998; slippage: Gelfand
and Guibas, Shape segmentation using local slippage analysis, 2004). A surface of revolution turns into itself, an
extrusion shifts, a helicoid screws; planes, spheres and cylinders do it in several ways, freeform surfaces in none.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross_columns, dot
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.surfaces.groups import columns_of, group_mean, sums_of
from kinform.surfaces.polygons.patchwork import Patchwork


@dataclass(frozen=True, eq=False)
class Slippage:
    """The most sliding motion of each of n patches, scaled to radius 1 about its middle."""

    middle: Array
    """(n, 3)"""
    size: Array
    """(n,) root mean square distance from the middle: the radius that is 1 in the motion."""
    angular: Array
    linear: Array
    """(n, 3) each; together of length one."""
    speed: Array
    """(n,) root mean square of the speed along the normals."""
    next_speed: Array
    """(n,) that of the motion which slides best among those across it."""


def slippage(work: Patchwork, patch: Ints, polygon: Ints, count: int) -> Slippage:
    """The motions of `count` patches, given as pairs (patch, polygon)."""
    normal, centre, weight = work.normals(polygon), work.middles(polygon), work.area.take(polygon)
    sums = sums_of(patch, count)
    total = np.maximum(sums(weight), TINY)
    middle = group_mean(patch, centre, count, weight)
    offset = centre - columns_of(middle, patch)
    size = np.maximum(np.sqrt(sums(weight * dot(offset, offset)) / total), ARITHMETIC)
    rows = np.concatenate([cross_columns(offset / size.take(patch)[:, None], normal).T, normal.T])
    matrix: Array = np.empty((count, 6, 6))
    for i in range(6):
        matrix[:, i, i:] = matrix[:, i:, i] = (sums(weight * rows[i] * rows[i:]) / total).T
    values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
    speed = np.sqrt(np.maximum(values, 0.0))
    return Slippage(middle, size, vectors[:, :3, 0], vectors[:, 3:, 0], speed[:, 0], speed[:, 1])
