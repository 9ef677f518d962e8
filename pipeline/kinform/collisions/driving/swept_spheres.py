"""How far a turn or a slide certainly does not bring two parts together, by spheres about their facets: of two spheres,
the places of the motion at which they touch follow at once, however near they pass each other."""

from __future__ import annotations

import math

import numpy as np

from kinform.collisions.constants import SPHERES_TOGETHER
from kinform.collisions.parts.spheres import Spheres
from kinform.model.arrays import Array, Ints

TURN = 2.0 * math.pi


class SweptSpheres:
    """Spheres of a part where z is the axis of a turn or slide, `X_KP` (4, 4) the pose of the part there."""

    def __init__(self, spheres: Spheres, X_KP: Array, turning: bool):
        self.turning, self._first = turning, spheres.first
        self._levels = [_about_axis(*level, X_KP, turning) for level in (spheres.coarse, spheres.fine)]
        self.whole: Array = _about_axis(*spheres.whole, X_KP, turning)[:, 0]
        """(4,) one about all, as `first_touch` has it."""

    def apart_until(self, second: SweptSpheres, sign: int, start: float, end: float) -> float:
        """Up to which place from `start` to `end` nothing of the second part, that moves to one side, meets this
        one."""
        count = [part._levels[0].shape[1] for part in (self, second)]
        i, j = np.divmod(np.arange(count[0] * count[1]), count[1])
        first = self._meets(second, 0, (i, j), sign, start)
        order = np.argsort(first, kind="stable")
        order = order[: int(np.searchsorted(first[order], end))]
        best = end
        for begin in range(0, len(order), SPHERES_TOGETHER):
            pairs = order[begin : begin + SPHERES_TOGETHER]
            if first[pairs[0]] >= best:
                break
            best = min(best, float(self._meets(second, 1, self._parts(second, i[pairs], j[pairs]), sign, start).min()))
        return best

    def _parts(self, second: SweptSpheres, i: Ints, j: Ints) -> tuple[Ints, Ints]:
        """Of pairs of coarse spheres, all pairs of the fine ones that they consist of."""
        wide = self._first[i + 1] - self._first[i], second._first[j + 1] - second._first[j]
        count = wide[0] * wide[1]
        pair = np.repeat(np.arange(len(i)), count)
        step = np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
        return self._first[i[pair]] + step // wide[1][pair], second._first[j[pair]] + step % wide[1][pair]

    def _meets(self, second: SweptSpheres, level: int, pairs: tuple[Ints, Ints], sign: int, start: float) -> Array:
        """(n,) the first place from `start` at which each pair touches; inf where none is."""
        first, other = (part._levels[level][:, which] for part, which in zip((self, second), pairs, strict=True))
        return first_touch(first, other, self.turning, sign, start)


def first_touch(first: Array, second: Array, turning: bool, sign: int, start: float) -> Array:
    """(n,) the first place from `start` at which spheres of two parts touch, of which the second moves to one side; inf
    where none is. Of each (4, n): distance from the axis, angle and height, or where it is along three axes; radius."""
    (a, b, h, r), (c, d, k, t) = first, second
    if turning:
        # the law of cosines between middles at distances a and c from the axis
        cosine = (a * a + c * c + (h - k) ** 2 - (r + t) ** 2) / np.maximum(2.0 * a * c, 1e-300)
        half = np.arccos(np.clip(cosine, -1.0, 1.0))
        begin = (sign * (b - d) - half - start) % TURN
        touches = np.where(begin + 2.0 * half >= TURN, start, start + begin)
        return np.where(cosine > 1.0, np.inf, touches)
    square = (r + t) ** 2 - (a - c) ** 2 - (b - d) ** 2
    half = np.sqrt(np.maximum(square, 0.0))
    begin, over = sign * (h - k) - half, sign * (h - k) + half
    return np.where((square < 0.0) | (over < start), np.inf, np.maximum(begin, start))


def _about_axis(middle: Array, radius: Array, X_KP: Array, turning: bool) -> Array:
    x, y, z = X_KP[:3, :3] @ middle.T + X_KP[:3, 3:]
    return np.stack([np.hypot(x, y), np.arctan2(y, x), z, radius] if turning else [x, y, z, radius])
