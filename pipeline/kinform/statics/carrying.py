"""What one-sided contact without friction can carry: the wrenches Σ λ r with λ ≥ 0 of the rows r of its points.

A joint made of such contacts holds both ways only where they enclose something; where they do not, a wrench
outside of this cone would take a pull, or a moment beyond the edge of a patch. Whether a wrench is inside is
decided by non-negative least squares (Lawson and Hanson 1974): what is left over is what contact cannot give.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array


def pushes_at(points: Array, normals: Array, centre: Array, length: float) -> Array:
    """(n, 6) unit pushes along normals at points (n, 3), about the centre, torques over the length."""
    return np.hstack([cross(points - centre, normals) / length, normals])


def uncarried(pushes: Array, both_ways: Array, wrench: Array) -> Array:
    """(6,) part of the wrench (torque over the length; force) that neither the pushes (n, 6), with factors from zero
    up, nor what acts both ways (m, 6), as a drive does, can make up: the least there is. Of several contacts at
    once everything is as many times as long."""
    from scipy.optimize import nnls

    size = float(np.linalg.norm(wrench))
    if size == 0.0:
        return np.zeros(len(wrench))
    if len(both_ways):
        # What drives give is free: only what is across of it has to be pushed.
        left, values, _ = np.linalg.svd(both_ways.T, full_matrices=True)
        across = left[:, int(np.count_nonzero(values > SOLVED * values[0])) :]
    else:
        across = np.eye(len(wrench))
    wanted, columns = across.T @ wrench / size, across.T @ pushes.T
    if not columns.shape[1]:
        return np.asarray(across @ wanted * size)
    factors, _ = nnls(columns, wanted, maxiter=20 * columns.shape[1] + 100)
    return np.asarray(across @ (wanted - columns @ factors) * size)
