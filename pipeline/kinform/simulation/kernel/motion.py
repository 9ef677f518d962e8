"""Poses, screws and twists of the links, in world axes about the centre of the mechanism.

One formula moves all primitives of one freedom: about the axis w through x, with slide s a radian,
p ↦ x + exp([w] q)(p − x) + s q; for a slide w is zero.
"""

from __future__ import annotations

import math

from kinform.model.arrays import Ints
from kinform.simulation.kernel.vectors import along, cross, place, put, six, turned

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, LINKS, STATE, SCREWS,
    POSITIONS, PARENT, KIND, Q, FIRST, WIDTH, SCREW, BALL, AXIS, POINT, SLIDE, POS, TWIST, GAIN,
    Row, Nums, Work,
)  # fmt: skip


def place_screw(numbers: Row, parent: Row, link: Row, screw: Row, q: float) -> None:
    """Pose and screw of a link at the value q, from the pose of its parent."""
    w0, w1, w2 = along(parent, numbers, AXIS)
    x0, x1, x2 = place(parent, numbers, POINT)
    s0, s1, s2 = along(parent, numbers, SLIDE)
    if not math.isfinite(q):
        q = math.nan  # of infinity the sine is an error outside of compiled code
    sine, versed = math.sin(q), 1.0 - math.cos(q)
    for column in range(4):
        # Columns of the rotation, then the arm from the axis, each turned about it (Rodrigues).
        if column < 3:
            d0, d1, d2 = parent[column], parent[3 + column], parent[6 + column]
        else:
            d0, d1, d2 = parent[POS] - x0, parent[POS + 1] - x1, parent[POS + 2] - x2
        c0, c1, c2 = w1 * d2 - w2 * d1, w2 * d0 - w0 * d2, w0 * d1 - w1 * d0
        d0 = d0 + sine * c0 + versed * (w1 * c2 - w2 * c1)
        d1 = d1 + sine * c1 + versed * (w2 * c0 - w0 * c2)
        d2 = d2 + sine * c2 + versed * (w0 * c1 - w1 * c0)
        if column < 3:
            link[column], link[3 + column], link[6 + column] = d0, d1, d2
        else:
            put(link, POS, x0 + d0 + s0 * q, x1 + d1 + s1 * q, x2 + d2 + s2 * q)
    put(screw, 0, w0, w1, w2)
    m0, m1, m2 = cross(x0, x1, x2, w0, w1, w2)
    put(screw, 3, m0 + s0, m1 + s1, m2 + s2)


def place_ball(ints: Ints, nums: Nums, work: Work, y: Row, i: int) -> None:
    """Pose and three screws of link i, which is a ball, at its quaternion in y."""
    row, numbers, link, screws = ints[LINKS][i], nums[LINKS][i], work[STATE][i], work[SCREWS]
    parent, k, at, forward = work[STATE][row[PARENT]], row[FIRST], row[Q], row[KIND] == BALL
    a, b, c, d = y[at], y[at + 1], y[at + 2], y[at + 3]
    twice = 2.0 / (a * a + b * b + c * c + d * d)
    x0, x1, x2 = place(parent, numbers, POINT)
    turn = 1.0 if forward else -1.0
    for column in range(3):
        # Columns of the rotation: e + twice (a v × e + v × (v × e)), v the vector part.
        unit = (1.0 if column == 0 else 0.0, 1.0 if column == 1 else 0.0, 1.0 if column == 2 else 0.0)
        c0, c1, c2 = cross(b, c, d, *unit)
        e0, e1, e2 = cross(b, c, d, c0, c1, c2)
        real = turn * a
        link[column], link[3 + column], link[6 + column] = turned(
            parent, unit[0] + twice * (real * c0 + e0), unit[1] + twice * (real * c1 + e1),
            unit[2] + twice * (real * c2 + e2),
        )  # fmt: skip
    r0, r1, r2 = along(link, numbers, POINT)
    put(link, POS, x0 - r0, x1 - r1, x2 - r2)
    frame = parent if forward else link
    for j in range(3):
        w0, w1, w2 = turn * frame[j], turn * frame[3 + j], turn * frame[6 + j]
        put(screws[k + j], 0, w0, w1, w2)
        put(screws[k + j], 3, *cross(x0, x1, x2, w0, w1, w2))


def place_links(ints: Ints, nums: Nums, work: Work, y: Row) -> None:
    """Poses of all links and screws of all rates at the positions in y."""
    links, numbers, state, screws = ints[LINKS], nums[LINKS], work[STATE], work[SCREWS]
    for i in range(1, len(links)):
        link = links[i]
        if link[KIND] == SCREW:
            place_screw(numbers[i], state[link[PARENT]], state[i], screws[link[FIRST]], y[link[Q]])
        else:
            place_ball(ints, nums, work, y, i)


def twist_links(ints: Ints, work: Work, y: Row) -> None:
    """Twists of all links at the rates in y, and their accelerations at constant rates: V × what the own
    rates add."""
    links, state, screws, first = ints[LINKS], work[STATE], work[SCREWS], ints[COUNTS][0][POSITIONS]
    for i in range(1, len(links)):
        parent, link, k, width = state[links[i][PARENT]], state[i], links[i][FIRST], links[i][WIDTH]
        w0, w1, w2, l0, l1, l2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(k, k + width):
            screw, rate = screws[j], y[first + j]
            w0, w1, w2 = w0 + screw[0] * rate, w1 + screw[1] * rate, w2 + screw[2] * rate
            l0, l1, l2 = l0 + screw[3] * rate, l1 + screw[4] * rate, l2 + screw[5] * rate
        a0, a1, a2, b0, b1, b2 = six(parent, TWIST)
        put(link, TWIST, a0 + w0, a1 + w1, a2 + w2)
        put(link, TWIST + 3, b0 + l0, b1 + l1, b2 + l2)
        g0, g1, g2, h0, h1, h2 = six(parent, GAIN)
        c0, c1, c2 = cross(a0, a1, a2, w0, w1, w2)
        put(link, GAIN, g0 + c0, g1 + c1, g2 + c2)
        c0, c1, c2 = cross(a0, a1, a2, l0, l1, l2)
        e0, e1, e2 = cross(b0, b1, b2, w0, w1, w2)
        put(link, GAIN + 3, h0 + c0 + e0, h1 + c1 + e1, h2 + c2 + e2)
