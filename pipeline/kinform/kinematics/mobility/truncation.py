"""Least changes that satisfy equations in as many directions as count, the least singular ones left out.

Of a triangle R with singular values down to those that count and few that do not, the few singular vectors of the rest
are found by inverse iteration, from those of a triangle nearby (Golub and Van Loan, Matrix Computations, 8.2): each
step is a substitution. Without them in the right side and in the solution, a substitution more is the truncated
solution. All singular values are asked for only where that does not converge, as where no gap parts what counts from
what does not.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.model.arrays import Array

INVERSE_ITERATIONS = 8
"""Inverse iterations for the singular vectors that do not count: with a gap each gains digits by the square of it."""
CONVERGED_VECTORS = 1e-14
"""Share of a matrix that may be missing from its product with singular vectors that have converged."""
LEAST_DIAGONAL = 1e-250
"""Share of a triangle below which nothing can be divided by what is on its diagonal."""
FINEST_VALUE = 1e-12
"""Relative singular value that a full solve still uses: near a singularity of fourth order they are that small."""


def regular_solution(triangle: Array, right: Array) -> Array | None:
    """(n,) the x with triangle (n, n) · x = right (n,), where all singular values count; None where one may be less
    than `FINEST_VALUE` of the largest."""
    from scipy.linalg import solve_triangular

    size = norm(triangle)
    if float(np.abs(np.diag(triangle)).min()) <= FINEST_VALUE * size:
        return None
    inverse = solve_triangular(triangle, np.eye(len(triangle)), check_finite=False)
    # the norms of Frobenius are no less than the largest singular values of both
    if not FINEST_VALUE * size * norm(inverse) < 1.0:
        return None
    return np.asarray(solve_triangular(triangle, right, check_finite=False))


def truncated_solution(triangle: Array, right: Array, left_out: Array) -> Array | None:
    """(n,) the least x with triangle (n, n) · x = right (n,) but for its least singular values, as many as `left_out`
    (k, n) has rows: orthonormal, near their right singular vectors. None where it is not found to rounding."""
    from scipy.linalg import solve_triangular

    size = norm(triangle)
    if float(np.abs(np.diag(triangle)).min()) <= LEAST_DIAGONAL * size:
        return None
    inner = left_out.T
    for _ in range(INVERSE_ITERATIONS):
        outer = np.linalg.qr(solve_triangular(triangle, inner, trans="T", check_finite=False))[0]
        inner = np.linalg.qr(solve_triangular(triangle, outer, check_finite=False))[0]
        image, preimage = triangle @ inner, triangle.T @ outer
        missed = norm(image - outer @ (outer.T @ image)) + norm(preimage - inner @ (inner.T @ preimage))
        if missed < CONVERGED_VECTORS * size:
            break
    else:
        return None
    x = solve_triangular(triangle, right - outer @ (outer.T @ right), check_finite=False)
    x = x - inner @ (inner.T @ x)
    # a singular value that counts, but is hardly one
    return np.asarray(x) if norm(x) * FINEST_VALUE * size < norm(right) else None
