"""Poses, screws and twists of the links, in world axes about the centre of the mechanism.

One formula moves all primitives of one freedom: about the axis w through x, with slide s a radian,
p ↦ x + exp([w] q)(p − x) + s q; for a slide w is zero.
"""

from __future__ import annotations

import math

from kinform.simulation.kernel.layout import (
    AXIS,
    BALL,
    COUNTS,
    FIRST,
    GAIN,
    KIND,
    LINKS,
    PARENT,
    POINT,
    POS,
    POSITIONS,
    SCREW,
    SCREWS,
    SLIDE,
    STATE,
    TWIST,
    WIDTH,
    Q,
)
from kinform.simulation.kernel.types import Index, Ints, Nums, Row, Table, Work
from kinform.simulation.kernel.vectors import add, cross, place, put, three, turned

__all__ = ["place_ball", "place_links", "place_screw", "twist_links"]


def place_screw(links: Index, numbers: Table, state: Table, screws: Table, i: int, q: float) -> None:
    """Pose and screw of link i at the value q."""
    p, k = links[i][PARENT], links[i][FIRST]
    w0, w1, w2 = turned(state, p, *three(numbers, i, AXIS))
    x0, x1, x2 = place(state, p, *three(numbers, i, POINT))
    s0, s1, s2 = turned(state, p, *three(numbers, i, SLIDE))
    if not math.isfinite(q):
        q = math.nan  # of infinity the sine is an error outside of compiled code
    sine, versed = math.sin(q), 1.0 - math.cos(q)
    for column in range(4):
        # Columns of the rotation, then the arm from the axis, each turned about it (Rodrigues).
        if column < 3:
            d0, d1, d2 = state[p][column], state[p][3 + column], state[p][6 + column]
        else:
            d0, d1, d2 = three(state, p, POS)
            d0, d1, d2 = d0 - x0, d1 - x1, d2 - x2
        c0, c1, c2 = cross(w0, w1, w2, d0, d1, d2)
        e0, e1, e2 = cross(w0, w1, w2, c0, c1, c2)
        d0, d1, d2 = d0 + sine * c0 + versed * e0, d1 + sine * c1 + versed * e1, d2 + sine * c2 + versed * e2
        if column < 3:
            state[i][column], state[i][3 + column], state[i][6 + column] = d0, d1, d2
        else:
            put(state, i, POS, x0 + d0 + s0 * q, x1 + d1 + s1 * q, x2 + d2 + s2 * q)
    put(screws, k, 0, w0, w1, w2)
    put(screws, k, 3, *cross(x0, x1, x2, w0, w1, w2))
    add(screws, k, 3, s0, s1, s2)


def place_ball(
    links: Index, numbers: Table, state: Table, screws: Table, i: int, a: float, b: float, c: float, d: float
) -> None:
    """Pose and three screws of link i at the quaternion (a, b, c, d)."""
    p, k = links[i][PARENT], links[i][FIRST]
    forward = links[i][KIND] == BALL
    twice = 2.0 / (a * a + b * b + c * c + d * d)
    x0, x1, x2 = place(state, p, *three(numbers, i, POINT))
    turn = 1.0 if forward else -1.0
    for column in range(3):
        # Columns of the rotation: e + twice (a v × e + v × (v × e)), v the vector part.
        unit = (1.0 if column == 0 else 0.0, 1.0 if column == 1 else 0.0, 1.0 if column == 2 else 0.0)
        c0, c1, c2 = cross(b, c, d, *unit)
        e0, e1, e2 = cross(b, c, d, c0, c1, c2)
        along = turn * a
        r0, r1, r2 = turned(
            state, p, unit[0] + twice * (along * c0 + e0), unit[1] + twice * (along * c1 + e1),
            unit[2] + twice * (along * c2 + e2),
        )  # fmt: skip
        state[i][column], state[i][3 + column], state[i][6 + column] = r0, r1, r2
    r0, r1, r2 = turned(state, i, *three(numbers, i, POINT))
    put(state, i, POS, x0 - r0, x1 - r1, x2 - r2)
    frame = p if forward else i
    for j in range(3):
        w0, w1, w2 = turn * state[frame][j], turn * state[frame][3 + j], turn * state[frame][6 + j]
        put(screws, k + j, 0, w0, w1, w2)
        put(screws, k + j, 3, *cross(x0, x1, x2, w0, w1, w2))


def place_links(ints: Ints, nums: Nums, work: Work, y: Row) -> None:
    """Poses of all links and screws of all rates at the positions in y."""
    links, numbers, state, screws = ints[LINKS], nums[LINKS], work[STATE], work[SCREWS]
    for i in range(1, len(links)):
        at = links[i][Q]
        if links[i][KIND] == SCREW:
            place_screw(links, numbers, state, screws, i, y[at])
        else:
            place_ball(links, numbers, state, screws, i, y[at], y[at + 1], y[at + 2], y[at + 3])


def twist_links(ints: Ints, work: Work, y: Row) -> None:
    """Twists of all links at the rates in y, and their accelerations at constant rates: V × what the own
    rates add."""
    links, state, screws, first = ints[LINKS], work[STATE], work[SCREWS], ints[COUNTS][0][POSITIONS]
    for i in range(1, len(links)):
        p = links[i][PARENT]
        for j in range(6):
            own = 0.0
            for k in range(links[i][FIRST], links[i][FIRST] + links[i][WIDTH]):
                own += screws[k][j] * y[first + k]
            state[i][GAIN + j] = own
            state[i][TWIST + j] = state[p][TWIST + j] + own
        w0, w1, w2 = three(state, i, GAIN)
        l0, l1, l2 = three(state, i, GAIN + 3)
        a0, a1, a2 = three(state, p, TWIST)
        put(state, i, GAIN, *three(state, p, GAIN))
        put(state, i, GAIN + 3, *three(state, p, GAIN + 3))
        add(state, i, GAIN, *cross(a0, a1, a2, w0, w1, w2))
        add(state, i, GAIN + 3, *cross(a0, a1, a2, l0, l1, l2))
        b0, b1, b2 = three(state, p, TWIST + 3)
        add(state, i, GAIN + 3, *cross(b0, b1, b2, w0, w1, w2))
