"""How the second body of a pair moves relative to the first."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence

import numpy as np

from kinform.collisions.pair.passages import Path
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class Course:
    """A motion over a parameter s."""

    displacement: Callable[[float], Array]
    """(4, 4) of the world at the meshes' pose, at s."""
    travel: Callable[[float], float]
    """m that no point has travelled more than, up to s: it grows with s."""
    nodes: Array | None = None
    """(T,) parameters, ascending, at which displacements cost little."""

    ways: Sequence[float] | None = None
    """(T,) m travelled up to each of the nodes, if it grows evenly from one to the next."""

    meets: Callable[[float], tuple[bool, float]] | None = None
    """Whether facets that count can meet at s, and up to where that stays so; None: not known."""

    path: Path | None = None
    """The turn or slide that it is; None: it is neither."""

    def apart(self, low: float, high: float) -> bool:
        """Whether it is known that nothing that counts can meet between two parameters."""
        if self.meets is None:
            return False
        meets, until = self.meets(low)
        return not meets and until >= high

    def middle(self, low: float, high: float) -> float:
        """A parameter about half way between two: a node where there is one; without nodes one of a grid, the same
        from wherever it is come near to."""
        middle = 0.5 * (low + high)
        if self.nodes is None:
            return _on_grid(low, middle, high)
        n = int(np.searchsorted(self.nodes, middle))
        near = [float(s) for s in self.nodes[max(n - 1, 0) : n + 1] if low < s < high]
        return min(near, key=lambda s: abs(s - middle), default=middle)

    def when(self, travel: float, low: float, high: float) -> float:
        """About the greatest parameter between two up to which points have not travelled more than `travel` (m)."""
        if self.travel(high) <= travel:
            return high
        if self.nodes is not None and self.ways is not None:
            return self._reached(self.nodes, self.ways, travel, low, high)
        start = low
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.travel(middle) <= travel else (low, middle)
        if self.nodes is None:
            return low
        node = float(self.nodes[max(int(np.searchsorted(self.nodes, low, side="right")) - 1, 0)])
        return node if node > start else low

    @staticmethod
    def _reached(nodes: Array, ways: Sequence[float], travel: float, low: float, high: float) -> float:
        """The last node after `low` up to which points have not travelled more; without one, where they have."""
        n = min(max(bisect_right(ways, travel) - 1, 0), len(ways) - 2)
        node, following = float(nodes[n]), float(nodes[n + 1])
        if node > low:
            return node
        share = (travel - ways[n]) / max(ways[n + 1] - ways[n], TINY)
        return min(max(node + share * (following - node), low), high)


def _on_grid(low: float, middle: float, high: float) -> float:
    """A multiple of a power of two between two parameters, of the largest power, the nearest to their middle."""
    step = 2.0 ** math.floor(math.log2(high - low))
    for _ in range(2):
        place = step * round(middle / step)
        if low < place < high:
            return place
        step *= 0.5
    return middle


def narrowed(left: float, right: float, fine: float, met: Callable[[float], bool]) -> tuple[float, float]:
    """Where what is not met at `left`, and is at `right`, is first met, to within `fine`."""
    while right - left > fine:
        middle = 0.5 * (left + right)
        if middle in (left, right):
            break
        left, right = (left, middle) if met(middle) else (middle, right)
    return left, right
