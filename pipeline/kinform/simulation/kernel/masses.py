"""Inertia of the links, wrenches at rest of the rates, and the mass matrix.

Recursive Newton and Euler for the wrenches, composite rigid bodies for the matrix (Featherstone, Rigid
Body Dynamics Algorithms, 2008, chapters 5 and 6), with inertias about the common centre, where they add.
"""

from __future__ import annotations

import math

from kinform.model.arrays import Ints
from kinform.simulation.kernel.vectors import add, along, cross, dot, place, put, six, three

from kinform.simulation.kernel.layout import (  # isort: skip
    LINKS, COLUMNS, CONSTANTS, SCALE, STATE, SCREWS, MASS, VECTORS,
    GRAVITY, LENGTH, PARENT, FIRST, WIDTH, HEAVY, WEIGHT, COM, TENSOR, BEFORE, TWIST, GAIN, WRENCH, INERT,
    FORCE, ARMATURE,
    Row, Table, Nums, Work,
)  # fmt: skip


def momentum(
    link: Row, w0: float, w1: float, w2: float, l0: float, l1: float, l2: float
) -> tuple[float, float, float, float, float, float]:
    """Inertia of a link (or what it carries) times the twist, about the centre."""
    m, c0, c1, c2 = link[INERT], link[INERT + 1], link[INERT + 2], link[INERT + 3]
    xx, yy, zz, xy, xz, yz = six(link, INERT + 4)
    return (
        c1 * l2 - c2 * l1 + (xx * w0 + xy * w1 + xz * w2),
        c2 * l0 - c0 * l2 + (xy * w0 + yy * w1 + yz * w2),
        c0 * l1 - c1 * l0 + (xz * w0 + yz * w1 + zz * w2),
        w1 * c2 - w2 * c1 + m * l0,
        w2 * c0 - w0 * c2 + m * l1,
        w0 * c1 - w1 * c0 + m * l2,
    )


def heavy(link: Row, m: float, x: float, y: float, z: float) -> None:
    """Adds second moments of weight m at (x, y, z) to the inertia of a link: m (|p|² − p pᵀ)."""
    add(link, INERT + 4, m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y))
    add(link, INERT + 7, -m * x * y, -m * x * z, -m * y * z)


def inertias(ints: Ints, nums: Nums, work: Work) -> None:
    """Inertia of each link about the centre, at its pose; what it turns with is three pairs of weights."""
    links, state = ints[LINKS], work[STATE]
    for i in range(1, len(links)):
        link, numbers = state[i], nums[LINKS][i]
        for j in range(INERT, INERT + 10):
            link[j] = 0.0
        if links[i][HEAVY] == 0:
            continue
        m = numbers[WEIGHT]
        c0, c1, c2 = place(link, numbers, COM)
        link[INERT] = m
        put(link, INERT + 1, m * c0, m * c1, m * c2)
        heavy(link, m, c0, c1, c2)
        for j in range(TENSOR, TENSOR + 12, 4):
            u0, u1, u2 = along(link, numbers, j + 1)
            heavy(link, numbers[j], u0, u1, u2)


def wrenches(ints: Ints, nums: Nums, work: Work) -> None:
    """Wrench that each link needs at constant rates against inertia and gravity."""
    links, state = ints[LINKS], work[STATE]
    g0, g1, g2 = three(nums[CONSTANTS][0], GRAVITY)
    for i in range(1, len(links)):
        link = state[i]
        if links[i][HEAVY] == 0:
            put(link, WRENCH, 0.0, 0.0, 0.0)
            put(link, WRENCH + 3, 0.0, 0.0, 0.0)
            continue
        w0, w1, w2, l0, l1, l2 = six(link, TWIST)
        n0, n1, n2, f0, f1, f2 = momentum(link, w0, w1, w2, l0, l1, l2)
        a0, a1, a2, b0, b1, b2 = six(link, GAIN)
        m0, m1, m2, e0, e1, e2 = momentum(link, a0, a1, a2, b0 - g0, b1 - g1, b2 - g2)
        c0, c1, c2 = cross(w0, w1, w2, n0, n1, n2)
        d0, d1, d2 = cross(l0, l1, l2, f0, f1, f2)
        put(link, WRENCH, c0 + d0 + m0, c1 + d1 + m1, c2 + d2 + m2)
        c0, c1, c2 = cross(w0, w1, w2, f0, f1, f2)
        put(link, WRENCH + 3, c0 + e0, c1 + e1, c2 + e2)


def energies(ints: Ints, nums: Nums, work: Work) -> float:
    """J: the energy of the motion, and that of all weights in a fall as high as the mechanism."""
    links, state, constants, total = ints[LINKS], work[STATE], nums[CONSTANTS][0], 0.0
    g0, g1, g2 = three(constants, GRAVITY)
    fall = math.sqrt(dot(g0, g1, g2, g0, g1, g2)) * constants[LENGTH]
    for i in range(1, len(links)):
        if links[i][HEAVY] == 0:
            continue
        link, numbers = state[i], nums[LINKS][i]
        w0, w1, w2, l0, l1, l2 = six(link, TWIST)
        c0, c1, c2 = place(link, numbers, COM)
        a0, a1, a2 = cross(w0, w1, w2, c0, c1, c2)
        x, y, z = l0 + a0, l1 + a1, l2 + a2
        total += numbers[WEIGHT] * (0.5 * dot(x, y, z, x, y, z) + fall)
        for j in range(TENSOR, TENSOR + 12, 4):
            u0, u1, u2 = along(link, numbers, j + 1)
            a0, a1, a2 = cross(w0, w1, w2, u0, u1, u2)
            total += 0.5 * numbers[j] * dot(a0, a1, a2, a0, a1, a2)
    return total


def mass_matrix(ints: Ints, nums: Nums, work: Work, with_forces: bool) -> None:
    """Lower triangle of the mass matrix, rotors included; with forces the wrenches of the links leave the efforts too.
    What links carry is added to their inertias and wrenches."""
    links, before = ints[LINKS], ints[COLUMNS]
    state, screws, matrix, force = work[STATE], work[SCREWS], work[MASS], work[VECTORS][FORCE]
    for i in range(len(links) - 1, 0, -1):
        link, p = state[i], links[i][PARENT]
        for k in range(links[i][FIRST], links[i][FIRST] + links[i][WIDTH]):
            row = matrix[k]
            w0, w1, w2, l0, l1, l2 = six(screws[k], 0)
            if with_forces:
                n0, n1, n2, f0, f1, f2 = six(link, WRENCH)
                force[k] = force[k] - w0 * n0 - w1 * n1 - w2 * n2 - l0 * f0 - l1 * f1 - l2 * f2
            n0, n1, n2, f0, f1, f2 = momentum(link, w0, w1, w2, l0, l1, l2)
            j = k
            while j >= 0:
                w0, w1, w2, l0, l1, l2 = six(screws[j], 0)
                row[j] = dot(w0, w1, w2, n0, n1, n2) + dot(l0, l1, l2, f0, f1, f2)
                j = before[j][BEFORE]
            row[k] += nums[SCALE][k][ARMATURE]
        if p > 0:
            parent = state[p]
            for c in range(INERT, INERT + 10):
                parent[c] += link[c]
            if with_forces:
                for c in range(WRENCH, WRENCH + 6):
                    parent[c] += link[c]


def cholesky(matrix: Table, n: int) -> bool:
    """Lᵀ L of the lower triangle, in place, from the last row up: zeros of a tree stay zeros. False when
    a pivot is not positive."""
    for k in range(n - 1, -1, -1):
        row = matrix[k]
        if not row[k] > 0.0:
            return False
        pivot = math.sqrt(row[k])
        row[k] = pivot
        for i in range(k):
            row[i] /= pivot
        for i in range(k):
            factor, above = row[i], matrix[i]
            if factor != 0.0:
                for j in range(i + 1):
                    above[j] -= factor * row[j]
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
