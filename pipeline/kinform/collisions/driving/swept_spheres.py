"""How far a turn or a slide certainly does not bring parts together, by one sphere about each: where two spheres touch
along the motion follows at once, for all pairs of parts in one go."""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array


def first_touch(first: Array, second: Array, turning: bool, sign: int, start: float) -> Array:
    """(n,) the first place from `start` at which spheres touch, of which the second moves to one side; inf where they
    never do. Of both (4, n): across the axis, two, and along it, where the middle is (m); radius (m)."""
    (a, b, h, r), (c, d, k, t) = first, second
    if turning:
        # the law of cosines between middles at distances p and q from the axis
        p, q = np.hypot(a, b), np.hypot(c, d)
        with np.errstate(over="ignore"):  # on the axis nothing turns towards anything: beyond any cosine
            cosine = (p * p + q * q + (h - k) ** 2 - (r + t) ** 2) / np.maximum(2.0 * p * q, TINY)
        half = np.arccos(np.clip(cosine, -1.0, 1.0))
        begin = (sign * (np.arctan2(b, a) - np.arctan2(d, c)) - half - start) % math.tau
        return np.where(cosine > 1.0, np.inf, np.where(begin + 2.0 * half >= math.tau, start, start + begin))
    square = (r + t) ** 2 - (a - c) ** 2 - (b - d) ** 2
    half = np.sqrt(np.maximum(square, 0.0))
    begin, over = sign * (h - k) - half, sign * (h - k) + half
    return np.where((square < 0.0) | (over < start), np.inf, np.maximum(begin, start))
