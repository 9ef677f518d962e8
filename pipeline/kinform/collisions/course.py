"""How the second body of a pair moves relative to the first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Course"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Course:
    """A motion over a parameter s."""

    displacement: Callable[[float], Array]
    """(4, 4) of the world at the meshes' pose, at s."""
    travel: Callable[[float], float]
    """m that no point has travelled more than, up to s: it grows with s."""

    def when(self, travel: float, low: float, high: float) -> float:
        """The greatest parameter between two up to which points have not travelled more than `travel` (m)."""
        if self.travel(high) <= travel:
            return high
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.travel(middle) <= travel else (low, middle)
        return low
