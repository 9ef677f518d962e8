"""Laws of time, evaluated from tables."""

from __future__ import annotations

import math

from kinform.simulation.kernel.layout import STRAIGHT, WAVE
from kinform.simulation.kernel.types import Table, Vector

__all__ = ["law"]


def law(values: Table, pieces: Table, k: int, t: float) -> Vector:
    """(value, rate, acceleration) of signal k at time t."""
    signal = values[k]
    if signal[4] == STRAIGHT:
        return signal[0] + signal[1] * t, signal[1], 0.0
    if signal[4] == WAVE:
        offset, amplitude, speed, phase = signal[0], signal[1], signal[2], signal[3]
        s, c = math.sin(speed * t + phase), math.cos(speed * t + phase)
        return offset + amplitude * s, amplitude * speed * c, -amplitude * speed * speed * s
    low, high = int(signal[5]), int(signal[5] + signal[6])
    while high - low > 1:
        middle = (low + high) // 2
        if pieces[middle][0] <= t:
            low = middle
        else:
            high = middle
    piece = pieces[low]
    x, a, b, c, d = t - piece[0], piece[1], piece[2], piece[3], piece[4]
    return ((a * x + b) * x + c) * x + d, (3.0 * a * x + 2.0 * b) * x + c, 6.0 * a * x + 2.0 * b
