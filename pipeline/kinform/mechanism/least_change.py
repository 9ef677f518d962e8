"""The Newton step: the least change of coordinates that meets closure equations in as many directions as count.

Small blocks are solved by their singular values. Of a large one the equations are made triangular first. Where all
singular values count, a substitution is the solution. Where few do not, as of redundant loops, their singular vectors
are found by inverse iteration, from those of a triangle nearby (Golub and Van Loan, Matrix Computations, 8.2): each
step is a substitution, and without them in the right side and in the solution, a substitution more is the truncated
solution. All singular values are asked for only where that does not converge, as where no gap separates what counts
from what does not.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.mechanism.rank import Rank
from kinform.model.arrays import Array

REDUCED_RATES = 60
"""Coordinates of a block from which on its equations are made triangular before its singular values are asked: at 100
to 420 coordinates the two take 0.6 of the time of one, at 40 nine tenths."""
FINEST_VALUE = ARITHMETIC
"""Relative singular value that can still be used at all: less is rounding. Near a singularity of fourth order they are
that small."""


def least_change(jacobian: Array, missed: Array, rank: Rank) -> Array:
    """(D, n) least x with J x = missed, (D, m, n) and (D, m), in the directions whose singular values count."""
    jacobian, missed = reduced(jacobian, missed)
    count = jacobian.shape[2]
    if count < REDUCED_RATES or jacobian.shape[1] != count:
        return _by_singular_values(jacobian, missed, rank)
    if rank.number is None:
        found = [regular_solution(*equations, rank.share) for equations in zip(jacobian, missed, strict=True)]
    elif rank.free is not None:
        found = [truncated_solution(*equations, rank.free) for equations in zip(jacobian, missed, strict=True)]
        if any(solution is None for solution in found):
            found = [None] * len(found)
    else:
        found = [None] * len(jacobian)
    out = np.array([np.zeros(count) if solution is None else solution for solution in found])
    rest = [k for k, solution in enumerate(found) if solution is None]
    if rest:
        out[rest] = _by_singular_values(jacobian[rest], missed[rest], rank)
    return out


def _by_singular_values(jacobian: Array, missed: Array, rank: Rank) -> Array:
    """See `least_change`."""
    left, values, right = np.linalg.svd(jacobian, full_matrices=False)
    used = np.arange(values.shape[1]) < rank.of(values)[:, None]
    used &= values > FINEST_VALUE * values.max(axis=1, initial=TINY, keepdims=True)
    parts = np.einsum("dri,dr->di", left, missed)
    return np.asarray(np.einsum("di,din->dn", np.where(used, parts / np.where(used, values, 1.0), 0.0), right))


def reduced(jacobian: Array, residual: Array) -> tuple[Array, Array]:
    """The equations J change = residual, (D, m, n) and (D, m), in as many rows as columns where a large block has many
    more: the triangle of Householder's reflections, which keeps singular values, right singular vectors and parts of
    the residual along the left ones (Golub and Van Loan, Matrix Computations, 5.3), without these reflections
    themselves. Rows without entries, half of those of planar loops, say nothing."""
    count = jacobian.shape[2]
    if count < REDUCED_RATES or jacobian.shape[1] <= count:
        return jacobian, residual
    used = np.asarray(jacobian.any(axis=(0, 2)))
    if np.count_nonzero(used) <= count:
        used[:] = True
    equations = np.concatenate([jacobian, residual[..., None]], axis=2)[:, used]
    triangle = np.asarray(np.linalg.qr(equations, mode="r"))
    return triangle[:, :count, :count], triangle[:, :count, count]


def regular_solution(triangle: Array, right: Array, share: float = FINEST_VALUE) -> Array | None:
    """(n,) the x with triangle (n, n) · x = right (n,), where all singular values count; None where one may be less
    than `share` of the largest."""
    from scipy.linalg import solve_triangular

    size = norm(triangle)
    if float(np.abs(np.diag(triangle)).min()) <= share * size:
        return None
    inverse = solve_triangular(triangle, np.eye(len(triangle)), check_finite=False)
    # the norms of Frobenius are no less than the largest singular values of both
    if not share * size * norm(inverse) < 1.0:
        return None
    return np.asarray(solve_triangular(triangle, right, check_finite=False))


def truncated_solution(triangle: Array, right: Array, left_out: Array) -> Array | None:
    """(n,) the least x with triangle (n, n) · x = right (n,) but for its least singular values, as many as `left_out`
    (k, n) has rows: orthonormal, near their right singular vectors. None where it is not found to rounding."""
    from scipy.linalg import solve_triangular

    size = norm(triangle)
    # Share of a triangle below which nothing can be divided by what is on its diagonal: quotients stay finite.
    if float(np.abs(np.diag(triangle)).min()) <= 1e-250 * size:
        return None
    inner = left_out.T
    # Inverse iterations for the singular vectors that do not count: with a gap each gains digits by the square of it.
    for _ in range(8):
        outer = np.linalg.qr(solve_triangular(triangle, inner, trans="T", check_finite=False))[0]
        inner = np.linalg.qr(solve_triangular(triangle, outer, check_finite=False))[0]
        image, preimage = triangle @ inner, triangle.T @ outer
        missed = norm(image - outer @ (outer.T @ image)) + norm(preimage - inner @ (inner.T @ preimage))
        # Share of a matrix that may be missing from its product with singular vectors that have converged: some fifty
        # roundings, as what they leave is added to the solution.
        if missed < 1e-14 * size:
            break
    else:
        return None
    x = solve_triangular(triangle, right - outer @ (outer.T @ right), check_finite=False)
    x = x - inner @ (inner.T @ x)
    # a singular value that counts, but is hardly one
    return np.asarray(x) if norm(x) * FINEST_VALUE * size < norm(right) else None
