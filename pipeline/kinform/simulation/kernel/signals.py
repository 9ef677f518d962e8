"""Laws of time, evaluated from tables."""

from __future__ import annotations

import math

from kinform.simulation.kernel.layout import STRAIGHT, WAVE
from kinform.simulation.kernel.types import Table, Vector

__all__ = ["law"]


def law(values: Table, pieces: Table, k: int, t: float) -> Vector:
    """(value, rate, acceleration) of signal k at time t."""
    kind = values[k][4]
    if kind == STRAIGHT:
        return values[k][0] + values[k][1] * t, values[k][1], 0.0
    if kind == WAVE:
        offset, amplitude, speed, phase = values[k][0], values[k][1], values[k][2], values[k][3]
        s, c = math.sin(speed * t + phase), math.cos(speed * t + phase)
        return offset + amplitude * s, amplitude * speed * c, -amplitude * speed * speed * s
    low, high = int(values[k][5]), int(values[k][5] + values[k][6])
    while high - low > 1:
        middle = (low + high) // 2
        if pieces[middle][0] <= t:
            low = middle
        else:
            high = middle
    x = t - pieces[low][0]
    a, b, c, d = pieces[low][1], pieces[low][2], pieces[low][3], pieces[low][4]
    return ((a * x + b) * x + c) * x + d, (3.0 * a * x + 2.0 * b) * x + c, 6.0 * a * x + 2.0 * b
