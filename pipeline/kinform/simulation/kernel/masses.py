"""Inertia of the links, wrenches at rest of the rates, and the mass matrix.

Recursive Newton and Euler for the wrenches, composite rigid bodies for the matrix (Featherstone, Rigid
Body Dynamics Algorithms, 2008, chapters 5 and 6), with inertias about the common centre, where they add.
"""

from __future__ import annotations

import math

from kinform.simulation.kernel.layout import (
    BEFORE,
    COLUMNS,
    COM,
    CONSTANTS,
    FIRST,
    FORCE,
    GAIN,
    GRAVITY,
    HEAVY,
    INERT,
    LINKS,
    MASS,
    PARENT,
    SCREWS,
    STATE,
    TENSOR,
    TWIST,
    VECTORS,
    WEIGHT,
    WIDTH,
    WRENCH,
)
from kinform.simulation.kernel.types import Ints, Nums, Row, Table, Work
from kinform.simulation.kernel.vectors import add, cross, dot, place, put, three, turned

__all__ = ["cholesky", "heavy", "inertias", "mass_matrix", "momentum", "solve_cholesky", "wrenches"]


def momentum(
    state: Table, i: int, w0: float, w1: float, w2: float, l0: float, l1: float, l2: float
) -> tuple[float, float, float, float, float, float]:
    """Inertia of link i (or what it carries) times the twist, about the centre."""
    m = state[i][INERT]
    c0, c1, c2 = three(state, i, INERT + 1)
    xx, yy, zz = three(state, i, INERT + 4)
    xy, xz, yz = three(state, i, INERT + 7)
    n0, n1, n2 = cross(c0, c1, c2, l0, l1, l2)
    f0, f1, f2 = cross(w0, w1, w2, c0, c1, c2)
    return (
        n0 + dot(xx, xy, xz, w0, w1, w2),
        n1 + dot(xy, yy, yz, w0, w1, w2),
        n2 + dot(xz, yz, zz, w0, w1, w2),
        f0 + m * l0,
        f1 + m * l1,
        f2 + m * l2,
    )


def heavy(state: Table, i: int, m: float, x: float, y: float, z: float) -> None:
    """Adds second moments of weight m at (x, y, z) to the inertia of link i: m (|p|² − p pᵀ)."""
    add(state, i, INERT + 4, m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y))
    add(state, i, INERT + 7, -m * x * y, -m * x * z, -m * y * z)


def inertias(ints: Ints, nums: Nums, work: Work) -> None:
    """Inertia of each link about the centre, at its pose; what it turns with is three pairs of weights."""
    links, numbers, state = ints[LINKS], nums[LINKS], work[STATE]
    for i in range(1, len(links)):
        for j in range(INERT, INERT + 10):
            state[i][j] = 0.0
        if links[i][HEAVY] == 0:
            continue
        m = numbers[i][WEIGHT]
        c0, c1, c2 = place(state, i, *three(numbers, i, COM))
        state[i][INERT] = m
        put(state, i, INERT + 1, m * c0, m * c1, m * c2)
        heavy(state, i, m, c0, c1, c2)
        for j in range(3):
            u0, u1, u2 = turned(state, i, *three(numbers, i, TENSOR + 4 * j + 1))
            heavy(state, i, numbers[i][TENSOR + 4 * j], u0, u1, u2)


def wrenches(ints: Ints, nums: Nums, work: Work) -> None:
    """Wrench that each link needs at constant rates against inertia and gravity."""
    links, state = ints[LINKS], work[STATE]
    g0, g1, g2 = three(nums[CONSTANTS], 0, GRAVITY)
    for i in range(1, len(links)):
        put(state, i, WRENCH, 0.0, 0.0, 0.0)
        put(state, i, WRENCH + 3, 0.0, 0.0, 0.0)
        if links[i][HEAVY] == 0:
            continue
        w0, w1, w2 = three(state, i, TWIST)
        l0, l1, l2 = three(state, i, TWIST + 3)
        n0, n1, n2, f0, f1, f2 = momentum(state, i, w0, w1, w2, l0, l1, l2)
        add(state, i, WRENCH, *cross(w0, w1, w2, n0, n1, n2))
        add(state, i, WRENCH, *cross(l0, l1, l2, f0, f1, f2))
        add(state, i, WRENCH + 3, *cross(w0, w1, w2, f0, f1, f2))
        a0, a1, a2 = three(state, i, GAIN)
        l0, l1, l2 = three(state, i, GAIN + 3)
        n0, n1, n2, f0, f1, f2 = momentum(state, i, a0, a1, a2, l0 - g0, l1 - g1, l2 - g2)
        add(state, i, WRENCH, n0, n1, n2)
        add(state, i, WRENCH + 3, f0, f1, f2)


def mass_matrix(ints: Ints, work: Work, with_forces: bool) -> None:
    """Lower triangle of the mass matrix; with forces the wrenches of the links leave the efforts too. What
    links carry is added to their inertias and wrenches."""
    links, before = ints[LINKS], ints[COLUMNS]
    state, screws, matrix, force = work[STATE], work[SCREWS], work[MASS], work[VECTORS]
    for i in range(len(links) - 1, 0, -1):
        p = links[i][PARENT]
        for k in range(links[i][FIRST], links[i][FIRST] + links[i][WIDTH]):
            w0, w1, w2 = three(screws, k, 0)
            l0, l1, l2 = three(screws, k, 3)
            n0, n1, n2, f0, f1, f2 = momentum(state, i, w0, w1, w2, l0, l1, l2)
            j = k
            while j >= 0:
                w0, w1, w2 = three(screws, j, 0)
                l0, l1, l2 = three(screws, j, 3)
                matrix[k][j] = dot(w0, w1, w2, n0, n1, n2) + dot(l0, l1, l2, f0, f1, f2)
                j = before[j][BEFORE]
            if with_forces:
                for c in range(6):
                    force[FORCE][k] -= screws[k][c] * state[i][WRENCH + c]
        if p > 0:
            for c in range(INERT, INERT + 10):
                state[p][c] += state[i][c]
            if with_forces:
                for c in range(WRENCH, WRENCH + 6):
                    state[p][c] += state[i][c]


def cholesky(matrix: Table, n: int) -> bool:
    """Lᵀ L of the lower triangle, in place, from the last row up: zeros of a tree stay zeros. False when
    a pivot is not positive."""
    for k in range(n - 1, -1, -1):
        if not matrix[k][k] > 0.0:
            return False
        pivot = math.sqrt(matrix[k][k])
        matrix[k][k] = pivot
        for i in range(k):
            matrix[k][i] /= pivot
        for i in range(k):
            factor = matrix[k][i]
            if factor != 0.0:
                for j in range(i + 1):
                    matrix[i][j] -= factor * matrix[k][j]
    return True


def solve_cholesky(matrix: Table, n: int, x: Row) -> None:
    """Solves Lᵀ L z = x in place."""
    for k in range(n - 1, -1, -1):
        x[k] /= matrix[k][k]
        for i in range(k):
            x[i] -= matrix[k][i] * x[k]
    for k in range(n):
        for i in range(k):
            x[k] -= matrix[k][i] * x[i]
        x[k] /= matrix[k][k]
