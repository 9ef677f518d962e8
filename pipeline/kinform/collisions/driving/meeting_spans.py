"""Where along a turn or a slide facets of two parts can meet: elsewhere nothing has to be followed.

A facet that turns keeps its distances from the axis and its heights, and what it turns by adds to the angles that it
spans; one that slides keeps its shadow, and goes on along the axis. Two facets whose profiles overlap meet only where
their spans do. Wide facets are divided, so that a wall is met by its corners where only these reach far enough; those
of one surface with nearly the same profile, as round a bore, are taken together, their spans as they are. Facets that
overlap within what mates may be off, on the mate itself, are no collision wherever they are, and are left out.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from kinform.collisions.driving.swept_profiles import nearest, spanned
from kinform.foundation.meshes.boxes import along_curve, triangle_boxes
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints

DIVIDED_TO = 0.02
"""Share of a turn, or of a part's length along a slide, that a facet spans at most, or it is divided. Chosen, not
measured."""
DIVIDED_ROUNDS = 2
"""So often they are asked which of them meet, and those divided further. Chosen, not measured."""
DIVIDED_AT_ONCE = 2
"""Times that they are divided into four before they are asked. Chosen, not measured."""
DIVIDED_MOST = 60_000
"""Pieces of a part at most. Chosen, not measured."""
PROFILE_CELLS = 60
"""Profiles of one surface that are the same to so many parts of where both parts are, are taken together. Chosen, not
measured."""
TESTED_MOST = 20_000_000
"""Groups of one part times those of the other, up to which they are asked. Chosen, not measured."""
SPANS_MOST = 4_000_000
"""Spans of pairs of groups in all. Chosen, not measured."""
PLACES = 8192
"""Spans begin and end at so many places of a turn, or of the length of the longer part. Chosen, not measured."""
SECTORS = 64
"""Of the motion, for each of which it is known which facets can meet in it. Chosen, not measured."""
TESTED_TOGETHER = 64
"""Groups of one that are asked at once. Chosen, not measured."""


Along = Callable[[Ints, Ints, Array, Array], Flags]
"""Which facets of surfaces (n,) of one part and of the other, that overlap in boxes (n, 2), low and high, of what they
keep, do so on a mate."""


class Spans:
    """Places of a motion, disjoint and ascending, at which something can meet; of a turn within (0, 2π)."""

    def __init__(self, low: Array, high: Array, turning: bool, sectors: tuple[Sectors, Sectors]):
        self.low, self.high, self._turning, self._sectors = low, high, turning, sectors

    @classmethod
    def of(cls, low: Array, high: Array, turning: bool, step: float, sectors: tuple[Sectors, Sectors]) -> Spans:
        """Of spans in any order, some larger: they begin and end at multiples of `step`, so that it does not matter how
        finely facets were divided or taken together."""
        first = np.floor(low / step).astype(np.int64)
        last = np.maximum(np.ceil(high / step).astype(np.int64), first + 1)
        if turning:
            around = round(math.tau / step)
            wide = np.minimum(last - first, around)
            first %= around
            last = first + wide
            over = last[last > around] - around
            first, last = np.append(first, np.zeros(len(over), np.int64)), np.append(np.minimum(last, around), over)
        begins, ends = _covered(first, last)
        return cls(np.asarray(step * begins), np.asarray(step * ends), turning, sectors)

    def facets(self, begin: float, end: float) -> tuple[Ints, Ints]:
        """Those of both parts that can meet others between two places, as they were counted."""
        first, second = (side.facets(begin, end) for side in self._sectors)
        return first, second

    def towards(self, sign: int) -> Callable[[float], tuple[bool, float]]:
        """Whether something can meet at s ≥ 0 of a motion to one side, and up to where that stays so."""
        low, high = (self.low, self.high) if sign > 0 else (-self.high[::-1], -self.low[::-1])
        if self._turning:
            first = 0 if sign > 0 else 1
            low, high = (np.concatenate([side + math.tau * k for k in range(first, first + 2)]) for side in (low, high))
        edges = np.stack([low, high], axis=1).ravel().tolist()

        def at(s: float) -> tuple[bool, float]:
            n = bisect_right(edges, s)
            return n % 2 == 1, edges[n] if n < len(edges) else math.inf

        return at


class Sectors:
    """In which of some equal sectors of the motion the facets of one part can meet others."""

    def __init__(self, groups: _Groups, group: Ints, low: Array, high: Array, turning: bool):
        """Of the spans (m,) of its groups."""
        self._groups, self._turning = groups, turning
        self._origin = 0.0 if turning else float(low.min(initial=np.inf))
        whole = math.tau if turning else float(high.max(initial=-np.inf)) - self._origin
        self._step = whole / SECTORS
        first, last = (np.floor((side - self._origin) / self._step).astype(np.int64) for side in (low, high))
        if turning:
            last = np.minimum(last - first, SECTORS - 1)
            first %= SECTORS
            last += first
        # counted in at the one and out behind the other, of a turn once more round
        columns = 2 * SECTORS + 1
        count = len(groups.low)
        change = np.bincount(group * columns + first, minlength=count * columns)
        change -= np.bincount(group * columns + last + 1, minlength=count * columns)
        met = np.cumsum(change.reshape(count, columns), axis=1) > 0
        self._met = met[:, :SECTORS] | met[:, SECTORS : 2 * SECTORS]

    def facets(self, begin: float, end: float) -> Ints:
        """Those that can meet others between two places, ascending."""
        first, last = (math.floor((s - self._origin) / self._step) for s in (begin, end))
        if self._turning:
            columns = np.arange(first, min(last, first + SECTORS - 1) + 1) % SECTORS
        else:
            columns = np.arange(max(first, 0), min(last, SECTORS - 1) + 1)
        return self._groups.facets(np.asarray(self._met[:, columns].any(axis=1)))


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of facets, of `surface` (n,) each, by their corners (n, 3, 3): across the axis and along it."""

    corners: Array
    surface: Ints
    facet: Ints
    low: Array
    high: Array
    """(n, 2) boxes of what they keep: radius and height, or shadow."""
    start: Array
    stop: Array
    """(n,) rad about the axis, or m along it, that they span; all round where they are on the axis."""

    @classmethod
    def of(cls, corners: Array, surface: Ints, facet: Ints, turning: bool, margin: float) -> Pieces:
        """Of corners (n, 3, 3)."""
        flat, height = corners[..., :2], corners[..., 2]
        bottom, top = triangle_boxes(height)
        if not turning:
            low, high = triangle_boxes(flat)
            return cls(corners, surface, facet, low - margin, high + margin, bottom - margin, top + margin)
        radius = nearest(flat)
        low = np.stack([radius, bottom], axis=1)
        high = np.stack([triangle_boxes(np.hypot(flat[..., 0], flat[..., 1]))[1], top], axis=1)
        start, stop = spanned(flat, radius, margin)
        return cls(corners, surface, facet, low - margin, high + margin, start, stop)

    def some(self, chosen: Flags) -> Pieces:
        """Some of them."""
        low, high, start, stop = (values[chosen] for values in (self.low, self.high, self.start, self.stop))
        return Pieces(self.corners[chosen], self.surface[chosen], self.facet[chosen], low, high, start, stop)

    def divided(self, wide: Flags, turning: bool, margin: float) -> Pieces:
        """Wide ones in four."""
        if not wide.any():
            return self
        a, b, c = (self.corners[wide, k] for k in range(3))
        ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        four = [np.stack(three, axis=1) for three in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        surface, facet = (np.tile(side[wide], 4) for side in (self.surface, self.facet))
        new, old = Pieces.of(np.concatenate(four), surface, facet, turning, margin), self.some(~wide)
        return Pieces(
            np.concatenate([old.corners, new.corners]), np.append(old.surface, new.surface),
            np.append(old.facet, new.facet),
            np.concatenate([old.low, new.low]), np.concatenate([old.high, new.high]),
            np.append(old.start, new.start), np.append(old.stop, new.stop),
        )  # fmt: skip


class _Groups:
    """Pieces of one surface and nearly one profile taken together."""

    def __init__(self, pieces: Pieces, origin: Array, cell: Array):
        self._pieces = pieces
        places = [np.clip((side - origin) / cell, 0, PROFILE_CELLS - 1) for side in (pieces.low, pieces.high)]
        key = pieces.surface.astype(np.int64)
        for column in np.concatenate(places, axis=1).astype(np.int64).T:
            key = key * PROFILE_CELLS + column
        self._order = np.argsort(key, kind="stable")
        ordered = key[self._order]
        self._starts = np.flatnonzero(np.append(True, ordered[1:] != ordered[:-1]))
        rank = np.repeat(np.arange(len(self._starts)), np.diff(np.append(self._starts, len(key))))
        self._rank = rank
        self.of = np.empty(len(key), dtype=np.int64)
        """(n,) the group of each piece."""
        self.of[self._order] = rank
        self.low = np.minimum.reduceat(pieces.low[self._order], self._starts)
        self.high = np.maximum.reduceat(pieces.high[self._order], self._starts)
        self.surface = pieces.surface[self._order[self._starts]]

    def facets(self, chosen: Flags) -> Ints:
        """Facets of which some groups (k,) have pieces, ascending."""
        return np.unique(self._pieces.facet[chosen[self.of]])

    def spans(self) -> tuple[Array, Array, Ints, Ints]:
        """Where the spans (k,) of all groups start and stop, disjoint in each; the first of each group, and how many it
        has."""
        start, stop = self._pieces.start[self._order], self._pieces.stop[self._order]
        # each group is shifted beyond those before it, and back
        apart = 2.0 * (float(stop.max()) - float(start.min()))
        low, high = _merged(start + apart * self._rank, stop + apart * self._rank)
        group = np.floor((low - start.min()) / apart + SOLVED).astype(np.int64)
        count = np.bincount(group, minlength=len(self.low))
        return low - apart * group, high - apart * group, np.cumsum(count) - count, count


def meeting_spans(parts: Sequence[tuple[Array, Ints]], turning: bool, margin: float, along: Along) -> Spans | None:
    """Where facets of two parts, each by corners (n, 3, 3), across the axis and along it, and surfaces (n,), can meet
    when the second turns or slides; nearer than `margin` (m) is met. None: they are too many to be told."""
    sides = [Pieces.of(corners, surfaces, np.arange(len(corners)), turning, margin) for corners, surfaces in parts]
    whole = math.tau if turning else max(margin, *(float(np.ptp(side.corners[..., 2])) for side in sides))
    origin = np.maximum(*(side.low.min(axis=0) for side in sides))
    cell = np.maximum(np.minimum(*(side.high.max(axis=0) for side in sides)) - origin, margin) / PROFILE_CELLS
    groups, pairs = _met(sides, origin, cell, margin, along)
    if groups is None:
        return None
    for _ in range(DIVIDED_ROUNDS):
        kept = [
            side.some((np.bincount(pairs[:, k], minlength=len(group.low)) > 0)[group.of])
            for k, (side, group) in enumerate(zip(sides, groups, strict=True))
        ]
        sides = kept
        for _ in range(DIVIDED_AT_ONCE):
            wide = [side.stop - side.start > DIVIDED_TO * whole for side in sides]
            sides = [side.divided(flags, turning, margin) for side, flags in zip(sides, wide, strict=True)]
        if sides == kept:
            break
        finer, met = _met(sides, origin, cell, margin, along)
        if finer is None:
            break
        groups, pairs = finer, met
    return _united(*groups, pairs, turning, whole / PLACES)


def _met(
    sides: Sequence[Pieces], origin: Array, cell: Array, margin: float, along: Along
) -> tuple[tuple[_Groups, _Groups] | None, Ints]:
    """Groups of the pieces of both, and pairs (n, 2) of groups that meet; None where they are too many."""
    none = np.zeros((0, 2), dtype=np.int64)
    if max(len(side.low) for side in sides) > DIVIDED_MOST:
        return None, none
    first, second = (_Groups(side, origin, cell) for side in sides)
    if len(first.low) * len(second.low) > TESTED_MOST:
        return None, none
    return (first, second), np.concatenate([none, *_overlapping(first, second, margin, along)])


def _overlapping(first: _Groups, second: _Groups, margin: float, along: Along) -> Iterator[Ints]:
    """(n, 2) groups of both whose boxes overlap, other than along mates, some at a time."""
    # those that lie together are asked together, of few of the others
    order = along_curve(first.low, first.high)
    left, bottom, right, top = (np.ascontiguousarray(side) for side in (*second.low.T, *second.high.T))
    for begin in range(0, len(order), TESTED_TOGETHER):
        chosen = order[begin : begin + TESTED_TOGETHER]
        low, high = first.low[chosen], first.high[chosen]
        least, most = low.min(axis=0), high.max(axis=0)
        near = np.flatnonzero((left <= most[0]) & (right >= least[0]) & (bottom <= most[1]) & (top >= least[1]))
        meets = (left[near] <= high[:, :1]) & (right[near] >= low[:, :1])
        meets &= bottom[near] <= high[:, 1:]
        meets &= top[near] >= low[:, 1:]
        i, j = np.nonzero(meets)
        i, j = chosen[i], near[j]
        box = np.maximum(first.low[i], second.low[j]) + margin, np.minimum(first.high[i], second.high[j]) - margin
        rest = ~along(first.surface[i], second.surface[j], *box)
        yield np.stack([i[rest], j[rest]], axis=1)


def _united(first: _Groups, second: _Groups, pairs: Ints, turning: bool, step: float) -> Spans | None:
    """Where the spans of pairs of groups overlap."""
    if not len(pairs):
        none = np.zeros(0)
        nowhere = np.zeros(0, dtype=np.int64)
        sectors = [Sectors(side, nowhere, none, none, True) for side in (first, second)]
        return Spans(none, none, turning, (sectors[0], sectors[1]))
    (start_a, stop_a, at_a, count_a), (start_b, stop_b, at_b, count_b) = first.spans(), second.spans()
    i, j = pairs.T
    count = count_a[i] * count_b[j]
    if count.sum() > SPANS_MOST:
        return None
    pair = np.repeat(np.arange(len(pairs)), count)
    rank = np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
    a, b = at_a[i[pair]] + rank // count_b[j[pair]], at_b[j[pair]] + rank % count_b[j[pair]]
    low, high = start_a[a] - stop_b[b], stop_a[a] - start_b[b]
    sectors = [Sectors(side, pairs[pair, k], low, high, turning) for k, side in enumerate((first, second))]
    return Spans.of(low, high, turning, step, (sectors[0], sectors[1]))


def _covered(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """Where what spans from `first` to `last` (n,) cover begins and ends, ascending; they are counted in at the one and
    out at the other."""
    if not len(first):
        return first, last
    origin, size = int(first.min()), int(last.max()) - int(first.min()) + 1
    change = np.bincount(first - origin, minlength=size) - np.bincount(last - origin, minlength=size)
    edges = np.diff((np.cumsum(change) > 0).astype(np.int8), prepend=0)
    return np.flatnonzero(edges > 0) + origin, np.flatnonzero(edges < 0) + origin


def _merged(low: Array, high: Array) -> tuple[Array, Array]:
    """Spans that overlap as one, ascending."""
    order = np.argsort(low, kind="stable")
    low, high = low[order], np.maximum.accumulate(high[order])
    begins = np.append(True, low[1:] > high[:-1])
    return low[begins], high[np.append(np.flatnonzero(begins)[1:] - 1, len(high) - 1)]
