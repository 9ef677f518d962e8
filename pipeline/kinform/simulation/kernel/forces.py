"""What acts: laws of time, efforts on shafts, wrenches on links, and between points of two links.

Efforts of drives go to work[VECTORS][FORCE] and [GIVEN], wrenches to the links as less that they need.
"""

from __future__ import annotations

import math

from kinform.behaviour.components import LEAST_GAS
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Ints
from kinform.simulation.kernel.vectors import add, along, cross, dot, place, six, three

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, SIGNALS, ACTORS, LOADS, PIECES,
    POSITIONS, RATES, TWIST, WRENCH, DOES, AT_Q, AT_V, LAW, FIRST_STATE, SECOND_STATE, METERED, EFFORT, SPRING, DAMPER,
    SERVO, MOTOR, STRAIGHT, WAVE, SHAPE, FIRST_PIECE, PIECE_COUNT,
    FORCE, GIVEN, TURNING, FACTOR, ELASTIC, GAS, CUSHION, NEAR_STRAIGHT,
    MEASURE, TORSION, DAMPED, TORSION_DAMPED, TRIAD,
    Row, Table, Index, Nums, Vector,
)  # fmt: skip


def law(values: Table, pieces: Table, k: int, t: float) -> Vector:
    """(value, rate, acceleration) of signal k at time t."""
    signal = values[k]
    if signal[SHAPE] == STRAIGHT:
        return signal[0] + signal[1] * t, signal[1], 0.0
    if signal[SHAPE] == WAVE:
        offset, amplitude, speed, phase = signal[0], signal[1], signal[2], signal[3]
        s, c = math.sin(speed * t + phase), math.cos(speed * t + phase)
        return offset + amplitude * s, amplitude * speed * c, -amplitude * speed * speed * s
    low, high = int(signal[FIRST_PIECE]), int(signal[FIRST_PIECE] + signal[PIECE_COUNT])
    while high - low > 1:
        middle = (low + high) // 2
        if pieces[middle][0] <= t:
            low = middle
        else:
            high = middle
    piece = pieces[low]
    x, a, b, c, d = t - piece[0], piece[1], piece[2], piece[3], piece[4]
    return ((a * x + b) * x + c) * x + d, (3.0 * a * x + 2.0 * b) * x + c, 6.0 * a * x + 2.0 * b


def control(ints: Ints, nums: Nums, k: int, t: float, y: Row, dy: Row) -> float:
    """Output of the controller of actor k; the rate of its integral, where it has one, goes to dy."""
    actor, numbers = ints[ACTORS][k], nums[ACTORS][k]
    q, v = y[actor[AT_Q]], y[ints[COUNTS][0][POSITIONS] + actor[AT_V]]
    # kp, ki, kd, limit and that of speed are the first numbers of a servo, and come after those of a motor.
    first, at = (0, actor[FIRST_STATE]) if actor[DOES] == SERVO else (4, actor[SECOND_STATE])
    target, rate, _ = law(nums[SIGNALS], nums[PIECES], actor[LAW], t)
    limit, most, missing = numbers[first + 3], numbers[first + 4], target - q
    if most >= 0.0:
        missing = min(max(numbers[first] * (target - q) + rate, -most), most) - v
        wanted = numbers[first + 2] * missing
    else:
        wanted = numbers[first] * (target - q) + numbers[first + 2] * (rate - v)
    if at >= 0:
        wanted += numbers[first + 1] * y[at]
        # The integral rests while the output is at its limit and it would push further (anti-windup).
        stuck = (wanted > limit and missing > 0.0) or (wanted < -limit and missing < 0.0)
        dy[at] = 0.0 if stuck else missing
    return float(min(max(wanted, -limit), limit))


def meter(dy: Row, at: int, effort: float, v: float) -> None:
    """Rates of the three integrals from `at` on, of what an effort on a shaft at the rate v does."""
    dy[at] = effort * effort
    dy[at + 1] = effort * v
    dy[at + 2] = dy[at + 1] * dy[at + 1]


def drive(ints: Ints, nums: Nums, vectors: Table, t: float, y: Row, dy: Row) -> float:
    """Efforts on the shafts, into [FORCE] and [GIVEN]; rates of the actors' states go to dy. The power that they put
    in, springs apart, which store."""
    actors, power = ints[ACTORS], 0.0
    for k in range(ints[COUNTS][0][RATES]):
        vectors[FORCE][k] = 0.0
        vectors[GIVEN][k] = 0.0
    for k in range(len(actors)):
        actor, number = actors[k], nums[ACTORS][k]
        q, v = y[actor[AT_Q]], y[ints[COUNTS][0][POSITIONS] + actor[AT_V]]
        does, current_at = actor[DOES], actor[FIRST_STATE]
        effort = 0.0
        if does == EFFORT:
            effort, _, _ = law(nums[SIGNALS], nums[PIECES], actor[LAW], t)
        elif does == SPRING:
            effort = number[0] * (number[1] - q)
        elif does == DAMPER:
            effort = -number[0] * v
        elif does == SERVO:
            effort = control(ints, nums, k, t, y, dy)
        elif does >= MOTOR:
            if does == MOTOR:
                voltage, _, _ = law(nums[SIGNALS], nums[PIECES], actor[LAW], t)
            else:
                voltage = control(ints, nums, k, t, y, dy)
            constant, most = number[2] * number[3], number[9]
            if current_at >= 0:
                current = y[current_at]
                rate = (voltage - number[0] * current - constant * v) / number[1]
                limited = abs(current) >= most and rate * current > 0.0
                dy[current_at] = 0.0 if limited else rate
            else:
                current = (voltage - constant * v) / number[0]
                limited = abs(current) > most
            current = min(max(current, -most), most)
            # No integral grows that asks for more current than there is (anti-windup).
            if limited and actor[SECOND_STATE] >= 0 and dy[actor[SECOND_STATE]] * current > 0.0:
                dy[actor[SECOND_STATE]] = 0.0
            effort = constant * current
        vectors[FORCE][actor[AT_V]] += effort
        vectors[GIVEN][actor[AT_V]] += effort
        if actor[METERED] >= 0:
            meter(dy, actor[METERED], effort, v)
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


def loads(ints: Ints, nums: Nums, state: Table, t: float) -> float:
    """Given forces and torques on links; the power that they put in."""
    power, table = 0.0, ints[LOADS]
    for k in range(len(table)):
        link, load = state[table[k][0]], nums[LOADS][k]
        # Vectors that do not turn with the link are those of the ground, link 0.
        frame = link if table[k][TURNING] == 1 else state[0]
        f0, f1, f2 = along(frame, load, 0)
        n0, n1, n2 = along(frame, load, 3)
        if table[k][FACTOR] >= 0:
            factor, _, _ = law(nums[SIGNALS], nums[PIECES], table[k][FACTOR], t)
            f0, f1, f2 = factor * f0, factor * f1, factor * f2
            n0, n1, n2 = factor * n0, factor * n1, factor * n2
        x, y, z = place(link, load, 6)
        push(link, x, y, z, f0, f1, f2)
        power += pace(link, x, y, z, f0, f1, f2)
        add(link, WRENCH, -n0, -n1, -n2)
        w0, w1, w2 = three(link, TWIST)
        power += dot(w0, w1, w2, n0, n1, n2)
    return power


def onto(link: Row, row: Row, j: int, x: float, y: float, z: float) -> float:
    """(x, y, z) along the direction of a link in the columns from j of a row."""
    d0, d1, d2 = along(link, row, j)
    return dot(d0, d1, d2, x, y, z)


def cushion(a: Row, b: Row, bushing: Row) -> float:
    """A bushing: forces against the shift, torques against the turn of b in the axes that a carries; the power of its
    dampers. The forces of both act where the point of b is."""
    x, y, z = place(a, bushing, 0)
    u, v, w = place(b, bushing, 3)
    p0, p1, p2 = along(b, bushing, TRIAD)
    q0, q1, q2 = along(b, bushing, TRIAD + 3)
    s0, s1, s2 = along(b, bushing, TRIAD + 6)
    r0 = 0.5 * (onto(a, bushing, TRIAD + 6, q0, q1, q2) - onto(a, bushing, TRIAD + 3, s0, s1, s2))
    r1 = 0.5 * (onto(a, bushing, TRIAD, s0, s1, s2) - onto(a, bushing, TRIAD + 6, p0, p1, p2))
    r2 = 0.5 * (onto(a, bushing, TRIAD + 3, p0, p1, p2) - onto(a, bushing, TRIAD, q0, q1, q2))
    diagonal = onto(a, bushing, TRIAD, p0, p1, p2) + onto(a, bushing, TRIAD + 3, q0, q1, q2)
    diagonal += onto(a, bushing, TRIAD + 6, s0, s1, s2)
    sine = math.sqrt(dot(r0, r1, r2, r0, r1, r2))
    angle = math.atan2(sine, 0.5 * (diagonal - 1.0))
    # The rotation vector, and its torque as the gradient of the energy in it.
    scale, share = 1.0, 1.0 / 12.0
    if angle > NEAR_STRAIGHT:
        scale = angle / max(sine, TINY)
        share = (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / (angle * angle)
    r0, r1, r2 = scale * r0, scale * r1, scale * r2
    k0, k1, k2 = three(bushing, TORSION)
    k0, k1, k2 = k0 * r0, k1 * r1, k2 * r2
    c0, c1, c2 = cross(r0, r1, r2, k0, k1, k2)
    e0, e1, e2 = cross(r0, r1, r2, c0, c1, c2)
    torque = (k0 + 0.5 * c0 + share * e0, k1 + 0.5 * c1 + share * e1, k2 + 0.5 * c2 + share * e2)
    a0, a1, a2 = three(a, TWIST)
    b0, b1, b2 = three(b, TWIST)
    power = 0.0
    for k in range(3):
        d0, d1, d2 = along(a, bushing, TRIAD + 3 * k)
        speed = pace(b, u, v, w, d0, d1, d2) - pace(a, u, v, w, d0, d1, d2)
        force = bushing[MEASURE + k] * dot(d0, d1, d2, u - x, v - y, w - z) + bushing[DAMPED + k] * speed
        turning = dot(d0, d1, d2, b0 - a0, b1 - a1, b2 - a2)
        moment = torque[k] + bushing[TORSION_DAMPED + k] * turning
        power -= bushing[DAMPED + k] * speed * speed + bushing[TORSION_DAMPED + k] * turning * turning
        push(a, u, v, w, force * d0, force * d1, force * d2)
        push(b, u, v, w, -force * d0, -force * d1, -force * d2)
        add(a, WRENCH, -moment * d0, -moment * d1, -moment * d2)
        add(b, WRENCH, moment * d0, moment * d1, moment * d2)
    return power


def between(table: Index, numbers: Table, state: Table) -> float:
    """Springs, gas springs and bushings between points of two links; the power of their dampers."""
    power = 0.0
    for k in range(len(table)):
        a, b, spring = state[table[k][0]], state[table[k][1]], numbers[k]
        if table[k][ELASTIC] == CUSHION:
            power += cushion(a, b, spring)
            continue
        x, y, z = place(a, spring, 0)
        u, v, w = place(b, spring, 3)
        d0, d1, d2 = u - x, v - y, w - z
        length = math.sqrt(dot(d0, d1, d2, d0, d1, d2))
        if length == 0.0:
            continue
        d0, d1, d2 = d0 / length, d1 / length, d2 / length
        speed = pace(b, u, v, w, d0, d1, d2) - pace(a, x, y, z, d0, d1, d2)
        if table[k][ELASTIC] == GAS:
            left = max(spring[9] - (spring[8] - length), LEAST_GAS * spring[9])
            pull = -spring[6] * math.pow(spring[9] / left, spring[10]) + spring[7] * speed
        else:
            pull = spring[6] * (length - spring[8]) + spring[7] * speed
        power -= spring[7] * speed * speed
        push(a, x, y, z, pull * d0, pull * d1, pull * d2)
        push(b, u, v, w, -pull * d0, -pull * d1, -pull * d2)
    return power
