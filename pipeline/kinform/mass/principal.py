"""Principal moments and axes of an inertia tensor, and whether a rigid body can have it."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.model.arrays import Array


def principal(inertia: Array) -> tuple[Array, Array]:
    """Moments (3,) ascending and axes (3, 3) as columns, right-handed, each with the canonical sign
    except that the last follows from the first two.

    Where moments are equal their axes are free: the ones nearest to the world's axes are taken, so
    that rounding does not decide.
    """
    if not np.all(np.isfinite(inertia)):
        return np.full(3, np.nan), np.full((3, 3), np.nan)
    moments, axes = np.linalg.eigh(inertia)
    same = SOLVED * float(np.abs(moments).max())
    start = 0
    for end in range(1, 4):
        if end == 3 or moments[end] - moments[end - 1] > same:
            if end - start > 1:
                axes[:, start:end] = _nearest_to_world(axes[:, start:end])
            start = end
    first, second = canonical(axes[:, 0]), canonical(axes[:, 1])
    return moments, np.column_stack([first, second, cross(first, second)])


def impossible(mass: float, inertia: Array) -> str:
    """Why no rigid body has this mass (kg) and inertia (3, 3) about its centre; "" when one can.

    Points and thin rods, whose inertia is only positive semidefinite, are limits of bodies and pass.
    """
    if not (np.isfinite(mass) and np.all(np.isfinite(inertia))):
        return "mass or inertia is not a number"
    if mass <= 0.0:
        return f"the mass is {mass:.6g} kg, not positive"
    size = float(np.abs(inertia).max())
    if float(np.abs(inertia - inertia.T).max()) > SINGLE * size:
        return "the inertia tensor is not symmetric"
    low, middle, high = np.linalg.eigvalsh(0.5 * (inertia + inertia.T))
    if low < -SINGLE * size:
        return f"the inertia tensor has a negative principal moment ({low:.6g} kg·m²)"
    if low + middle < (1.0 - SINGLE) * high:
        return f"the principal moments break the triangle inequality ({low:.6g} + {middle:.6g} < {high:.6g} kg·m²)"
    return ""


def _nearest_to_world(space: Array) -> Array:
    """Orthonormal basis (3, k) of the space (3, k): the world's axes projected on it, nearest first."""
    basis: list[Array] = []
    for _ in range(space.shape[1]):
        rest = space @ space.T
        for vector in basis:
            rest = rest - np.outer(vector, vector)
        length = np.linalg.norm(rest, axis=0)
        # How much shorter the projection of a world's axis may be than the longest, where x goes before y before z, as
        # in the sign of an axis.
        column = int(np.flatnonzero(length >= length.max() - 1e-3)[0])
        basis.append(rest[:, column] / length[column])
    return np.column_stack(basis)
