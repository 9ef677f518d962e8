"""How deep two parts go into each other where their facets cross: at those of the middles between ends of the segments
that these share which are inside both.

Where the parts go on touching, as threads do, it is asked at every step of the way whether that is more than is
allowed: of several steps at once, as a few dozen points cost little more than one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from kinform.collisions.constants import DEPTH_MEASURED
from kinform.collisions.pair.constants import CERTAIN
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.meshes.mesh_index import MeshIndex
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array, Flags, Ints

DEPTH_ENDS = 32
"""Ends of crossing segments between which the depth is looked for: a choice. More places
take more time."""
DEPTH_FINER = 4
"""So many times as many places for a depth that is reported: twice as fine either way."""


class Penetration:
    """Two meshes; poses (4, 4) are of the second in the first. Points within `rounding` (m) of a mesh are on it."""

    def __init__(self, first: MeshIndex, second: MeshIndex, rounding: float):
        self._first, self._second, self._rounding = first, second, rounding

    def deepest(self, X: Array, segments: Array, finer: int = 1) -> float:
        """m: how deep the deepest of the middles between segments (n, 2, 3), or points (n, 3), is; of `finer` times as
        many."""
        middles = _middles(segments, finer)
        other = _seen(X, middles)
        inside = self._in_both(middles, other)
        # Of the places inside both parts, 40 at which the depth is measured: a choice.
        inside = inside[_spread(len(inside), finer * 40)]
        total = self._first.depths(middles[inside]) + self._second.depths(other[inside])
        return float(total.max(initial=0.0))

    def shallow(self, poses: Sequence[Array], segments: Sequence[Array], least: Sequence[float]) -> list[bool]:
        """Whether at each pose none of the middles between segments (n, 2, 3) is inside both and deeper than `least`
        (m): none that is near some of the segments, which are on both, nor any that is near enough to the facets."""
        points, others = [], []
        for X, some, allowed in zip(poses, segments, least, strict=True):
            middles = _middles(some)
            # 256 segments to which these ends are so near, or not, that they may be deep: a choice.
            near = 2.0 * _from_segments(middles, some[_spread(len(some), 256)])
            asked = np.flatnonzero(near > CERTAIN * allowed)
            points.append(middles[asked])
            others.append(_seen(X, middles)[asked])
        pose = np.repeat(np.arange(len(poses)), [len(some) for some in points])
        middles, other, deep = np.concatenate(points), np.concatenate(others), np.asarray(least, float)[pose]
        if len(pose) > DEPTH_MEASURED:
            chosen = self._in_both(middles, other)
            chosen = chosen[self._deep(middles[chosen], other[chosen], deep[chosen])]
        else:
            chosen = np.flatnonzero(self._deep(middles, other, deep))
            chosen = chosen[self._in_both(middles[chosen], other[chosen])] if len(chosen) else chosen
        return [bool(none) for none in np.bincount(pose[chosen], minlength=len(poses)) == 0]

    def _in_both(self, points: Array, other: Array) -> Ints:
        """Which points (n, 3), in the frame of either part, are inside both: within rounding on the surface of one, and
        inside the other, is inside. Facets that cross a flat face do so in its plane, and so do the middles between."""
        first, second = self._first.contains(points), self._second.contains(other)
        first, second = (
            first | self._on(self._first, points, second & ~first),
            second | self._on(self._second, other, first & ~second),
        )
        return np.flatnonzero(first & second)

    def _on(self, index: MeshIndex, points: Array, some: Flags) -> Flags:
        """(n,) which of some points (n, 3) are on a mesh."""
        out = np.zeros(len(points), dtype=bool)
        out[some] = index.depths_up_to(points[some], np.nextafter(self._rounding, np.inf)) <= self._rounding
        return out

    def _deep(self, points: Array, other: Array, least: Array) -> Flags:
        """(n,) which points (n, 3), in the frame of either part, are further than `least` (n,) m from both, taken
        together."""
        enough = np.nextafter(least, np.inf)
        out = self._first.depths_up_to(points, enough)
        asked = np.flatnonzero(out <= least)
        if len(asked):
            out[asked] += self._second.depths_up_to(other[asked], enough[asked])
        return np.asarray(out > least)


def _middles(segments: Array, finer: int = 1) -> Array:
    """(m, 3) between ends of segments (n, 2, 3), or points (n, 3): of near ones and far ones, as parts may be thin, or
    deep in each other."""
    points = segments.reshape(-1, 3)
    points = points[_spread(len(points), finer * DEPTH_ENDS)]
    a, b = _pairs(len(points))
    order = np.argsort(np.linalg.norm(points[a] - points[b], axis=1), kind="stable")
    # 64 places between them that are asked whether they are inside both parts: a choice.
    order = order[_spread(len(order), finer * 64)]
    return np.asarray(0.5 * (points[a[order]] + points[b[order]]))


@lru_cache(maxsize=4 * DEPTH_ENDS * DEPTH_FINER)
def _spread(count: int, most: int) -> Ints:
    """Of so many, in order, no more than `most`, spread evenly."""
    return np.unique(np.linspace(0, count - 1, most).astype(np.int64)) if count else np.zeros(0, dtype=np.int64)


@lru_cache(maxsize=DEPTH_ENDS * DEPTH_FINER)
def _pairs(count: int) -> tuple[Ints, Ints]:
    """All pairs of so many."""
    first, second = np.triu_indices(count, 1)
    return first, second


def _seen(X: Array, points: Array) -> Array:
    """Points (n, 3) in a frame of pose (4, 4)."""
    return np.asarray((points - X[:3, 3]) @ X[:3, :3])


def _from_segments(points: Array, segments: Array) -> Array:
    """(n,) m of points (n, 3) from the nearest of segments (m, 2, 3)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    from_start = [points[:, k, None] - start[:, k] for k in range(3)]
    share = sum(apart * along[:, k] for k, apart in enumerate(from_start)) / np.maximum(dot(along, along), TINY)
    share = np.clip(share, 0.0, 1.0)
    square = sum((apart - share * along[:, k]) ** 2 for k, apart in enumerate(from_start))
    return np.asarray(np.sqrt(np.min(square, axis=1, initial=np.inf)))
