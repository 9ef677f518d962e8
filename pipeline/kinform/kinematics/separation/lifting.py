"""Do all contacts of a block open when its bodies are lifted off each other along one direction, as a stack of links
on parallel pins comes apart?

Then a linear program over all twists would say no more. Each contact that opens along the direction asks how much
farther one of its bodies has to be lifted than the other; that can be where these demands go round no circle, and the
longest path of demands says how far each body goes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.separation.constants import CONE_HELD, HIGHS_FEASIBLE
from kinform.kinematics.separation.contact_rows import Cone
from kinform.model.arrays import Array, Ints

LARGEST_TWIST = 1.0 / CONE_HELD
"""Bound of twist components where a pair opens by 1: what opens slower does not open for certain."""

_AT_REST = HIGHS_FEASIBLE / LARGEST_TWIST
"""Speed of a row, of a slide of 1, that is none: moved as far as allowed, the row misses by what HiGHS admits."""


_Ends = tuple[int, int]


def lifts_apart(
    nodes: int, held: Sequence[_Ends], loose: Sequence[tuple[_Ends, Cone]], directions: Sequence[Array]
) -> bool:
    """Whether slides of the bodies along one of these unit directions (3,) open every loose contact, one at least, by 1
    or more, with none longer than `LARGEST_TWIST`, and without moving those that are held. A cone is that of the second
    body of a contact relative to the first."""
    fixed = np.concatenate([cone.fixed[:, 3:] for _, cone in loose])
    normals = np.concatenate([cone.rows[:, 3:] for _, cone in loose])
    counts = np.array([len(cone.rows) for _, cone in loose])
    together = UnionFind(nodes)
    for ends in held:
        together.union(*ends)
    apart = [(together.find(a), together.find(b)) for (a, b), _ in loose]
    for direction in directions:
        if np.abs(fixed @ direction).max(initial=0.0) > _AT_REST:
            continue
        speeds = _opening(normals @ direction, counts)
        if speeds is not None and _reach(nodes, apart, speeds) <= LARGEST_TWIST:
            return True
    return False


def _opening(speeds: Array, counts: Ints) -> list[float] | None:
    """The mean speed of each contact, which has so many of the speeds (n,) of rows; None where one does not open."""
    start = np.cumsum(counts) - counts
    least, most = np.minimum.reduceat(speeds, start), np.maximum.reduceat(speeds, start)
    mean = np.add.reduceat(speeds, start) / counts
    opens = (least > -_AT_REST) & (mean > CONE_HELD) | (most < _AT_REST) & (mean < -CONE_HELD)
    return mean.tolist() if opens.all() else None


def _reach(nodes: int, ends: Sequence[_Ends], speeds: Sequence[float]) -> float:
    """How far one node has to go beyond another where the second end of each contact goes beyond the first, or, where
    its speed is negative, the first beyond the second, by the inverse of the speed; infinite where that is a circle."""
    after: dict[int, list[tuple[int, float]]] = defaultdict(list)
    waits = [0] * nodes
    for (a, b), speed in zip(ends, speeds, strict=True):
        low, high = (a, b) if speed > 0.0 else (b, a)
        after[low].append((high, 1.0 / abs(speed)))
        waits[high] += 1
    height = [0.0] * nodes
    ready = [n for n in range(nodes) if not waits[n]]
    for low in ready:
        for high, more in after[low]:
            height[high] = max(height[high], height[low] + more)
            waits[high] -= 1
            if not waits[high]:
                ready.append(high)
    return max(height) if len(ready) == nodes else float("inf")
