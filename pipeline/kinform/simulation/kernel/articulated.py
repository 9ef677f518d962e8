"""Accelerations of large trees in time that grows as their links: articulated bodies.

Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7: what a rate has to move is the inertia of all that it
carries, free to move at the joints further out. Rates are eliminated one by one from the tips inwards, so a ball is
three of them. The mass matrix of a long chain is as ill-conditioned as the fourth power of its links; here everything
is about a point of the link's own joint, and nothing is lost by distance. Loops add as many unknown efforts λ as there
are independent rows G, of G M⁻¹ Gᵀ λ = what is missing, each column of which is one more pass. For mechanisms of many
rates and few loops (`pivoting.choose_method`); `reduction` serves all others.

Poses, screws, twists and GAIN of `motion` are taken as they are; spatial vectors here are angular first, in world axes
about the link's REFERENCE.
"""

from __future__ import annotations

from kinform.model.arrays import Ints
from kinform.simulation.kernel.loops import back_substitute
from kinform.simulation.kernel.masses import cholesky, heavy, solve_cholesky
from kinform.simulation.kernel.vectors import add, along, cross, dot, place, put, six, three

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, LINKS, MODE, CONSTANTS, SCALE, STATE, SCREWS, ROWS, REDUCED, VECTORS, CARRIED, HANDLES,
    RANK, POSITIONS, RATES, GRAVITY, PARENT, KIND, FIRST, WIDTH, HEAVY, SCREW, POINT, SLIDE, WEIGHT, COM, TENSOR,
    TWIST, GAIN, WRENCH, INERT, ORDER, STANDING, MOVED, LED_RATE, MASSLESS_RATE,
    FORCE, ACC, NEED, GAP, TRIAL, RIGHT, KEPT, PULLED,
    REFERENCE_POINT, SPATIAL, PULL, LOADED, GOING, RUNNING, REACTION, INVERSE, SURPLUS, ROTOR, ARMATURE,
    Row, Nums, Work,
)  # fmt: skip


def own_inertia(link: Row, numbers: Row, row: Row) -> None:
    """Inertia of a link about its centre of mass, to [INERT] (as there), and about its reference, to [SPATIAL]."""
    m = numbers[WEIGHT]
    c0, c1, c2 = place(link, numbers, COM)
    x, y, z = c0 - row[REFERENCE_POINT], c1 - row[REFERENCE_POINT + 1], c2 - row[REFERENCE_POINT + 2]
    for j in range(INERT, INERT + 10):
        link[j] = 0.0
    for j in range(TENSOR, TENSOR + 12, 4):
        u0, u1, u2 = along(link, numbers, j + 1)
        heavy(link, numbers[j], u0, u1, u2)
    link[INERT] = m
    put(link, INERT + 1, x, y, z)
    xx, yy, zz, xy, xz, yz = six(link, INERT + 4)
    xy, xz, yz = xy - m * x * y, xz - m * x * z, yz - m * y * z
    put(row, SPATIAL, xx + m * (y * y + z * z), xy, xz)
    put(row, SPATIAL + 6, xy, yy + m * (x * x + z * z), yz)
    put(row, SPATIAL + 12, xz, yz, zz + m * (x * x + y * y))
    put(row, SPATIAL + 3, 0.0, -m * z, m * y)
    put(row, SPATIAL + 9, m * z, 0.0, -m * x)
    put(row, SPATIAL + 15, -m * y, m * x, 0.0)
    for j in range(3):
        put(row, SPATIAL + 18 + 6 * j, row[SPATIAL + 3 + j], row[SPATIAL + 9 + j], row[SPATIAL + 15 + j])
        row[SPATIAL + 21 + 7 * j] = m


def refer(ints: Ints, nums: Nums, work: Work) -> None:
    """Reference point of each link, screws and inertias about it."""
    links, state, carried, handles = ints[LINKS], work[STATE], work[CARRIED], work[HANDLES]
    for i in range(1, len(links)):
        row, numbers, k = carried[i], nums[LINKS][i], links[i][FIRST]
        parent = state[links[i][PARENT]]
        put(row, REFERENCE_POINT, *place(parent, numbers, POINT))
        for j in range(k, k + links[i][WIDTH]):
            put(handles[j], 0, *three(work[SCREWS][j], 0))
            put(handles[j], 3, 0.0, 0.0, 0.0)
            handles[j][ROTOR] = nums[SCALE][j][ARMATURE]
        if links[i][KIND] == SCREW:
            put(handles[k], 3, *along(parent, numbers, SLIDE))
            w0, w1, w2 = three(handles[k], 0)
            if dot(w0, w1, w2, w0, w1, w2) == 0.0:
                put(row, REFERENCE_POINT, *three(carried[links[i][PARENT]], REFERENCE_POINT))
        for c in range(SPATIAL, SPATIAL + 36):
            row[c] = 0.0
        if links[i][HEAVY] != 0:
            own_inertia(state[i], numbers, row)


def between_references(row: Row, parent: Row) -> tuple[float, float, float]:
    """From the reference of the parent to that of the link."""
    x, y, z = three(row, REFERENCE_POINT)
    a, b, c = three(parent, REFERENCE_POINT)
    return x - a, y - b, z - c


def hand_on(row: Row, parent: Row, scratch: Row) -> None:
    """Adds what a link carries to its parent's, about the parent's reference."""
    d0, d1, d2 = between_references(row, parent)
    for c in range(SPATIAL, SPATIAL + 36, 6):
        put(scratch, c + 3, *three(row, c + 3))
        x, y, z = cross(d0, d1, d2, row[c + 3], row[c + 4], row[c + 5])
        put(scratch, c, row[c] + x, row[c + 1] + y, row[c + 2] + z)
    for c in range(SPATIAL, SPATIAL + 6):
        x, y, z = cross(d0, d1, d2, scratch[c + 18], scratch[c + 24], scratch[c + 30])
        scratch[c], scratch[c + 6], scratch[c + 12] = scratch[c] + x, scratch[c + 6] + y, scratch[c + 12] + z
    for c in range(SPATIAL, SPATIAL + 36):
        parent[c] += scratch[c]


def respond(ints: Ints, work: Work, pulled: bool) -> None:
    """Rates work[VECTORS][ACC] that the efforts [TRIAL] give, with the wrenches [PULL] on the links if `pulled`; those
    of led ones are given, and what they need goes to [NEED]. Massless rates stay at rest."""
    links, carried, handles, kinds = ints[LINKS], work[CARRIED], work[HANDLES], ints[MODE][STANDING]
    x, effort, need = work[VECTORS][ACC], work[VECTORS][TRIAL], work[VECTORS][NEED]
    for i in range(1, len(links)):
        for c in range(6):
            carried[i][LOADED + c] = carried[i][PULL + c] if pulled else 0.0
    for i in range(len(links) - 1, 0, -1):
        row, p = carried[i], links[i][PARENT]
        for k in range(links[i][FIRST] + links[i][WIDTH] - 1, links[i][FIRST] - 1, -1):
            handle = handles[k]
            if kinds[k] == MOVED:
                total = effort[k]
                for c in range(6):
                    total -= handle[c] * row[LOADED + c]
                handle[SURPLUS] = total
                total *= handle[INVERSE]
                for c in range(6):
                    row[LOADED + c] += handle[REACTION + c] * total
            elif kinds[k] == LED_RATE:
                for c in range(6):
                    for j in range(6):
                        row[LOADED + c] += row[SPATIAL + 6 * c + j] * handle[j] * x[k]
        if p > 0:
            n0, n1, n2, f0, f1, f2 = six(row, LOADED)
            d0, d1, d2 = between_references(row, carried[p])
            c0, c1, c2 = cross(d0, d1, d2, f0, f1, f2)
            add(carried[p], LOADED, n0 + c0, n1 + c1, n2 + c2)
            add(carried[p], LOADED + 3, f0, f1, f2)
    for c in range(6):
        carried[0][GOING + c] = 0.0
    for i in range(1, len(links)):
        row, parent = carried[i], carried[links[i][PARENT]]
        w0, w1, w2, l0, l1, l2 = six(parent, GOING)
        d0, d1, d2 = between_references(row, parent)
        c0, c1, c2 = cross(w0, w1, w2, d0, d1, d2)
        put(row, GOING, w0, w1, w2)
        put(row, GOING + 3, l0 + c0, l1 + c1, l2 + c2)
        for k in range(links[i][FIRST], links[i][FIRST] + links[i][WIDTH]):
            handle = handles[k]
            need[k] = 0.0
            if kinds[k] == MOVED:
                total = handle[SURPLUS]
                for c in range(6):
                    total -= handle[REACTION + c] * row[GOING + c]
                x[k] = total * handle[INVERSE]
            elif kinds[k] == LED_RATE:
                total = handle[ROTOR] * x[k] - effort[k]
                for c in range(6):
                    total += handle[c] * row[LOADED + c]
                    for j in range(6):
                        total += handle[c] * row[SPATIAL + 6 * c + j] * row[GOING + j]
                need[k] = total
            else:
                x[k] = 0.0
            for c in range(6):
                row[GOING + c] += handle[c] * x[k]


def rate_along(ints: Ints, work: Work, row: int) -> float:
    """Row `row` of the loops, as eliminated, times work[VECTORS][ACC]."""
    n, rank, order, numbers, x = (
        ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], ints[MODE][ORDER], work[ROWS][row], work[VECTORS][ACC]
    )  # fmt: skip
    total: float = x[order[row]]
    for c in range(rank, n):
        total += numbers[c] * x[order[c]]
    return total


def brace(ints: Ints, work: Work) -> float:
    """G M⁻¹ Gᵀ of the rows of the loops that move mass, factored, to work[REDUCED]; −1 when it is not positive."""
    n, rank = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK]
    order, kinds, rows, vectors = ints[MODE][ORDER], ints[MODE][STANDING], work[ROWS], work[VECTORS]
    small, effort, x, count = work[REDUCED], vectors[TRIAL], vectors[ACC], 0
    for d in range(rank):
        if kinds[order[d]] == MASSLESS_RATE:
            continue
        for k in range(n):
            effort[k], x[k] = 0.0, 0.0
        effort[order[d]] = 1.0
        for c in range(rank, n):
            effort[order[c]] = rows[d][c]
        respond(ints, work, False)
        at = 0
        for e in range(d + 1):
            if kinds[order[e]] != MASSLESS_RATE:
                small[count][at] = rate_along(ints, work, e)
                at += 1
        count += 1
    return 0.0 if cholesky(small, count) else -1.0


def articulate(ints: Ints, nums: Nums, work: Work) -> float:
    """Inertias of what the links carry, and what each rate moves of it; −1 when one moves no mass."""
    links, carried, handles, kinds = ints[LINKS], work[CARRIED], work[HANDLES], ints[MODE][STANDING]
    refer(ints, nums, work)
    for i in range(len(links) - 1, 0, -1):
        row, p = carried[i], links[i][PARENT]
        for k in range(links[i][FIRST] + links[i][WIDTH] - 1, links[i][FIRST] - 1, -1):
            if kinds[k] != MOVED:
                continue
            handle, moved = handles[k], handles[k][ROTOR]
            for c in range(6):
                total = 0.0
                for j in range(6):
                    total += row[SPATIAL + 6 * c + j] * handle[j]
                handle[REACTION + c] = total
                moved += handle[c] * total
            if not moved > 0.0:
                return -1.0
            handle[INVERSE] = 1.0 / moved
            for c in range(6):
                share = handle[REACTION + c] / moved
                for j in range(6):
                    row[SPATIAL + 6 * c + j] -= share * handle[REACTION + j]
        if p > 0:
            hand_on(row, carried[p], carried[0])
    return brace(ints, work)


def outward(w0: float, w1: float, w2: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """w × (w × (x, y, z))."""
    c0, c1, c2 = cross(w0, w1, w2, x, y, z)
    return cross(w0, w1, w2, c0, c1, c2)


def carry(link: Row, row: Row, a0: float, a1: float, a2: float) -> None:
    """Adds the wrench that a link needs, whose reference is accelerated by a relative to what falls."""
    m, x, y, z = link[INERT], link[INERT + 1], link[INERT + 2], link[INERT + 3]
    xx, yy, zz, xy, xz, yz = six(link, INERT + 4)
    w0, w1, w2 = three(link, TWIST)
    b0, b1, b2 = three(link, GAIN)
    c0, c1, c2 = cross(b0, b1, b2, x, y, z)
    e0, e1, e2 = outward(w0, w1, w2, x, y, z)
    f0, f1, f2 = m * (a0 + c0 + e0), m * (a1 + c1 + e1), m * (a2 + c2 + e2)
    c0, c1, c2 = cross(x, y, z, f0, f1, f2)
    e0, e1, e2 = cross(
        w0, w1, w2, xx * w0 + xy * w1 + xz * w2, xy * w0 + yy * w1 + yz * w2, xz * w0 + yz * w1 + zz * w2
    )
    c0 += xx * b0 + xy * b1 + xz * b2
    c1 += xy * b0 + yy * b1 + yz * b2
    c2 += xz * b0 + yz * b1 + zz * b2
    add(row, PULL, c0 + e0, c1 + e1, c2 + e2)
    add(row, PULL + 3, f0, f1, f2)


def resist(ints: Ints, nums: Nums, work: Work, y: Row) -> None:
    """Wrench that each link needs at constant rates against inertia, gravity and what [WRENCH] has, to [PULL]."""
    links, state, carried, handles = ints[LINKS], work[STATE], work[CARRIED], work[HANDLES]
    g0, g1, g2 = three(nums[CONSTANTS][0], GRAVITY)
    put(carried[0], RUNNING, 0.0, 0.0, 0.0)
    for i in range(1, len(links)):
        row, link, p = carried[i], state[i], links[i][PARENT]
        d0, d1, d2 = between_references(row, carried[p])
        w0, w1, w2 = three(state[p], TWIST)
        a0, a1, a2 = three(carried[p], RUNNING)
        b0, b1, b2 = three(state[p], GAIN)
        c0, c1, c2 = cross(b0, b1, b2, d0, d1, d2)
        e0, e1, e2 = outward(w0, w1, w2, d0, d1, d2)
        a0, a1, a2 = a0 + c0 + e0, a1 + c1 + e1, a2 + c2 + e2
        if links[i][KIND] == SCREW:
            handle, twice = handles[links[i][FIRST]], 2.0 * y[ints[COUNTS][0][POSITIONS] + links[i][FIRST]]
            c0, c1, c2 = cross(w0, w1, w2, handle[3], handle[4], handle[5])
            a0, a1, a2 = a0 + twice * c0, a1 + twice * c1, a2 + twice * c2
        put(row, RUNNING, a0, a1, a2)
        n0, n1, n2, f0, f1, f2 = six(link, WRENCH)
        c0, c1, c2 = cross(row[REFERENCE_POINT], row[REFERENCE_POINT + 1], row[REFERENCE_POINT + 2], f0, f1, f2)
        put(row, PULL, n0 - c0, n1 - c1, n2 - c2)
        put(row, PULL + 3, f0, f1, f2)
        if links[i][HEAVY] != 0:
            carry(link, row, a0 - g0, a1 - g1, a2 - g2)


def settle_tree(ints: Ints, work: Work) -> None:
    """As `reduction.settle`, by articulated bodies: [ACC] and [NEED] from [FORCE], [GAP] and led rates in [ACC], and
    from the wrenches of the links where work[VECTORS][KEPT][PULLED] says so."""
    n, rank, rows, vectors = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], work[ROWS], work[VECTORS]
    order, kinds, effort, x = ints[MODE][ORDER], ints[MODE][STANDING], vectors[TRIAL], vectors[ACC]
    gaps, missing, pulled, count = vectors[GAP], vectors[RIGHT], vectors[KEPT][PULLED] != 0.0, 0
    back_substitute(rows, ints[MODE], vectors, rank)
    for k in range(n):
        effort[k] = vectors[FORCE][k]
    for d in range(rank):
        # A rate without mass has no effort left: its row pulls as hard as what drives it.
        pull = -vectors[FORCE][order[d]]
        if kinds[order[d]] == MASSLESS_RATE and pull != 0.0:
            for c in range(rank, n):
                effort[order[c]] += rows[d][c] * pull
    respond(ints, work, pulled)
    for d in range(rank):
        if kinds[order[d]] != MASSLESS_RATE:
            missing[count] = gaps[d] - rate_along(ints, work, d)
            count += 1
    if count > 0:
        solve_cholesky(work[REDUCED], count, missing)
        count = 0
        for d in range(rank):
            if kinds[order[d]] != MASSLESS_RATE:
                effort[order[d]] += missing[count]
                for c in range(rank, n):
                    effort[order[c]] += rows[d][c] * missing[count]
                count += 1
        respond(ints, work, pulled)
    for d in range(rank):
        if kinds[order[d]] == MASSLESS_RATE:
            x[order[d]] = gaps[d] - rate_along(ints, work, d)
