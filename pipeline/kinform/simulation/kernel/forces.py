"""What acts: on shafts, on links, and between points of two links.

Efforts of drives go to work[VECTORS][FORCE] and [GIVEN], wrenches to the links as less that they need.
"""

from __future__ import annotations

import math

from kinform.simulation.kernel.layout import (
    AT_Q,
    AT_V,
    DAMPER,
    DOES,
    EFFORT,
    FIRST_STATE,
    FORCE,
    GIVEN,
    LAW,
    MOTOR,
    SECOND_STATE,
    SERVO,
    SPRING,
    TWIST,
    WRENCH,
)
from kinform.simulation.kernel.signals import law
from kinform.simulation.kernel.types import Counts, Index, Row, Table
from kinform.simulation.kernel.vectors import add, along, cross, dot, place, six, three

__all__ = ["between", "controlled", "drive", "loads", "pace", "push"]


def controlled(
    actor: Counts,
    numbers: Row,
    values: Table,
    pieces: Table,
    first: int,
    at: int,
    held: float,
    t: float,
    q: float,
    v: float,
    dy: Row,
) -> float:
    """Output of the controller whose kp, ki, kd, limit begin in column `first` of the actor."""
    target, rate, _ = law(values, pieces, actor[LAW], t)
    wanted = numbers[first] * (target - q) + numbers[first + 2] * (rate - v)
    limit = numbers[first + 3]
    if at >= 0:
        wanted += numbers[first + 1] * held
        # The integral rests while the output is at its limit and it would push further (anti-windup).
        stuck = (wanted > limit and target > q) or (wanted < -limit and target < q)
        dy[at] = 0.0 if stuck else target - q
    return float(min(max(wanted, -limit), limit))


def drive(
    actors: Index,
    numbers: Table,
    values: Table,
    pieces: Table,
    force: Table,
    t: float,
    y: Row,
    dy: Row,
    first: int,
    n: int,
) -> float:
    """Efforts on the shafts; rates of the actors' states go to dy. The power that they put in, springs
    apart, which store."""
    power = 0.0
    for k in range(n):
        force[FORCE][k] = 0.0
        force[GIVEN][k] = 0.0
    for k in range(len(actors)):
        actor, number = actors[k], numbers[k]
        q, v = y[actor[AT_Q]], y[first + actor[AT_V]]
        does, one, two = actor[DOES], actor[FIRST_STATE], actor[SECOND_STATE]
        effort = 0.0
        if does == EFFORT:
            effort, _, _ = law(values, pieces, actor[LAW], t)
        elif does == SPRING:
            effort = number[0] * (number[1] - q)
        elif does == DAMPER:
            effort = -number[0] * v
        elif does == SERVO:
            effort = controlled(actor, number, values, pieces, 0, one, y[one], t, q, v, dy)
        elif does >= MOTOR:
            if does == MOTOR:
                voltage, _, _ = law(values, pieces, actor[LAW], t)
            else:
                voltage = controlled(actor, number, values, pieces, 4, two, y[two], t, q, v, dy)
            constant = number[2] * number[3]
            if one >= 0:
                current = y[one]
                dy[one] = (voltage - number[0] * current - constant * v) / number[1]
            else:
                current = (voltage - constant * v) / number[0]
            effort = constant * current
        force[FORCE][actor[AT_V]] += effort
        force[GIVEN][actor[AT_V]] += effort
        if does != SPRING:
            power += effort * v
    return power


def push(link: Row, x: float, y: float, z: float, f0: float, f1: float, f2: float) -> None:
    """The force f on a link at the point (x, y, z) of the world."""
    n0, n1, n2 = cross(x, y, z, f0, f1, f2)
    add(link, WRENCH, -n0, -n1, -n2)
    add(link, WRENCH + 3, -f0, -f1, -f2)


def pace(link: Row, x: float, y: float, z: float, d0: float, d1: float, d2: float) -> float:
    """Velocity of the point (x, y, z) of a link times d."""
    w0, w1, w2, l0, l1, l2 = six(link, TWIST)
    v0, v1, v2 = cross(w0, w1, w2, x, y, z)
    return dot(v0 + l0, v1 + l1, v2 + l2, d0, d1, d2)


def loads(table: Index, numbers: Table, state: Table) -> float:
    """Given forces and torques on links; the power that they put in."""
    power = 0.0
    for k in range(len(table)):
        link, load = state[table[k][0]], numbers[k]
        # Vectors that do not turn with the link are those of the ground, link 0.
        frame = link if table[k][1] == 1 else state[0]
        f0, f1, f2 = along(frame, load, 0)
        n0, n1, n2 = along(frame, load, 3)
        x, y, z = place(link, load, 6)
        push(link, x, y, z, f0, f1, f2)
        power += pace(link, x, y, z, f0, f1, f2)
        add(link, WRENCH, -n0, -n1, -n2)
        w0, w1, w2 = three(link, TWIST)
        power += dot(w0, w1, w2, n0, n1, n2)
    return power


def between(table: Index, numbers: Table, state: Table) -> float:
    """Springs and dampers between points of two links; the power of their dampers."""
    power = 0.0
    for k in range(len(table)):
        a, b, spring = state[table[k][0]], state[table[k][1]], numbers[k]
        x, y, z = place(a, spring, 0)
        u, v, w = place(b, spring, 3)
        d0, d1, d2 = u - x, v - y, w - z
        length = math.sqrt(dot(d0, d1, d2, d0, d1, d2))
        if length == 0.0:
            continue
        d0, d1, d2 = d0 / length, d1 / length, d2 / length
        speed = pace(b, u, v, w, d0, d1, d2) - pace(a, x, y, z, d0, d1, d2)
        pull = spring[6] * (length - spring[8]) + spring[7] * speed
        power -= spring[7] * speed * speed
        push(a, x, y, z, pull * d0, pull * d1, pull * d2)
        push(b, u, v, w, -pull * d0, -pull * d1, -pull * d2)
    return power
