"""Which facets a turn or slide can bring together: those that sweep over the same profile.

A facet that turns about an axis keeps its distances from the axis and its heights along it, one that slides keeps its
shadow: facets whose boxes in these coordinates are apart never meet, over the whole motion.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.foundation.meshes.boxes import along_curve, bounds, facet_boxes
from kinform.foundation.meshes.near_facets import near_boxes
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

CHUNK = 64
"""Facets that lie together and are asked as one whether any of them can meet any of others. Chosen, not measured."""


Sides = tuple[Array, Array]
"""Lower and upper."""


class Profile:
    """What vertices (n, 3) and facets (m, 3) of a part, in the world, keep along a unit twist (6,) (ω; v at the
    origin)."""

    def __init__(self, vertices: Array, faces: Ints, twist: Array):
        self._faces = faces
        self._turning = bool(twist[:3] @ twist[:3] > 0.25)
        axis = twist[:3] if self._turning else twist[3:]
        across = np.stack(perpendicular(axis), axis=1)
        self.frame = np.eye(4)
        """(4, 4) displacement of the world to where the axis is z."""
        self.frame[:3, :3] = np.column_stack([across, axis]).T
        if self._turning:
            self.frame[:3, 3] = -self.frame[:3, :3] @ cross(axis, twist[3:])
        away = vertices - cross(axis, twist[3:]) if self._turning else vertices
        self._flat = away @ across
        self._radius = np.linalg.norm(self._flat, axis=1)
        self._heights = away @ axis
        self.largest: float = float(self._radius.max(initial=0.0))
        """m: greatest distance from the axis of a turn."""
        rounding = ARITHMETIC * max(self.largest, float(np.linalg.norm(twist[3:])))
        self._level = self._turning and abs(float(twist[:3] @ twist[3:])) < rounding

    @cached_property
    def sphere(self) -> Array:
        """(4,) a sphere about it: where its middle is, across the axis and along it, and its radius (m)."""
        (x, y), height = self._flat.T, self._heights
        low, high = bounds(self._flat)
        bottom, top = self.span
        middle = 0.5 * (low + high), 0.5 * (bottom + top)
        away = (x - middle[0][0]) ** 2 + (y - middle[0][1]) ** 2 + (height - middle[1]) ** 2
        return np.array([*middle[0], middle[1], (1.0 + ARITHMETIC) * math.sqrt(float(away.max()))])

    @cached_property
    def span(self) -> tuple[float, float]:
        """Lowest and highest place (m) along the axis."""
        return float(self._heights.min()), float(self._heights.max())

    @property
    def bounds(self) -> tuple[Array, Array]:
        """(3,) box of all `boxes`; some larger."""
        low, high = np.zeros(3), np.zeros(3)
        if not self._turning:
            low[:2], high[:2] = bounds(self._flat)
        else:
            high[0] = self.largest
        if self._level:
            low[1], high[1] = self.span
        return low, high

    def boxes(self, facets: Ints) -> tuple[Array, Array]:
        """Boxes (n, 3) of what facets keep: radius and height of a turn, radius of a screw, shadow of a slide."""
        corners = self._faces[facets]
        low, high = np.zeros((len(facets), 3)), np.zeros((len(facets), 3))
        if not self._turning:
            for k in range(2):
                low[:, k], high[:, k] = facet_boxes(self._flat[:, k], corners)
            return low, high
        high[:, 0] = facet_boxes(self._radius, corners)[1]
        low[:, 0] = nearest(self._flat[corners])
        if self._level:
            low[:, 1], high[:, 1] = facet_boxes(self._heights, corners)
        return low, high

    def between(self, facets: Ints, low: float, high: float) -> Ints:
        """Those of some facets that may be between two heights (m) where these are kept; all, where they are not."""
        if not self._level:
            return facets
        bottom, top = facet_boxes(self._heights, self._faces[facets])
        return facets[(bottom <= high) & (top >= low)]

    @property
    def turns(self) -> bool | None:
        """Whether it is a turn or a slide; None: a screw, of which heights are not kept."""
        return self._turning if self._level or not self._turning else None

    def corners(self, facets: Ints) -> Array:
        """(n, 3, 3) m of facets' corners: across the axis and along it."""
        return np.concatenate([self._flat, self._heights[:, None]], axis=1)[self._faces[facets]]

    def along(self, facets: Ints, margin: float) -> Sides:
        """From where to where (n,) facets are along a turn (rad; from 0 to a whole turn where they may go round the
        axis) or a slide (m), `margin` (m) more."""
        corners = self._faces[facets]
        if not self._turning:
            low, high = facet_boxes(self._heights, corners)
            return low - margin, high + margin
        flat = self._flat[corners]
        return spanned(flat, nearest(flat), margin)

    def radius(self, facets: Ints) -> float:
        """m: greatest distance of some facets from the axis of a turn."""
        return float(self._radius[self._faces[facets]].max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Meeting:
    """Facets of two parts that a motion of the second can bring together somewhere."""

    facets: tuple[Ints, Ints]
    kept: tuple[Sides, Sides]
    """Boxes (n, 3) of what they keep."""
    profiles: tuple[Profile, Profile]
    turning: bool
    unit: float
    """m that a radian is counted as."""
    margin: float
    """m: nearer than this is met."""

    @cached_property
    def _along(self) -> tuple[Sides, Sides] | None:
        """From where to where (n,) they are along the motion, rad of a turn, m of a slide; None for screws."""
        first, second = self.profiles
        if first.turns is None:
            return None
        one, other = first.along(self.facets[0], self.margin), second.along(self.facets[1], self.margin)
        if not (self.turning and len(one[0])):
            return one, other
        # cut open opposite of the first
        middle = 0.5 * (one[0] + one[1])
        cut = math.atan2(-np.sin(middle).sum(), -np.cos(middle).sum())
        return (one[0] - cut, one[1] - cut), (other[0] - cut, other[1] - cut)

    def within(self, begin: float, end: float) -> tuple[Ints, Ints]:
        """Those that can meet while the second moves from `begin` to `end` (rad or m).

        What a facet sweeps over meanwhile is its box, drawn out along the motion; where these boxes are apart, facets
        do not meet. Of a turn, boxes across the cut are cut in two.
        """
        if self._along is None:
            return self.facets
        (start, stop), (first, last) = self._along
        sides, owners = [], []
        for some, (low, high), (from_, to) in zip(
            self._possible(begin, end), self.kept, ((start, stop), (first + begin, last + end)), strict=True
        ):
            if some is not None:
                from_, to = from_[some], to[some]
            owner, from_, to = _cut(from_, to) if self.turning else (np.arange(len(from_)), from_, to)
            if some is not None:
                owner = some[owner]
            sides.append(
                (
                    np.column_stack([low[owner, :2], self.unit * from_]),
                    np.column_stack([high[owner, :2], self.unit * to]),
                )
            )
            owners.append(owner)
        chosen = _near(sides[0], sides[1], self.margin)
        return self._some(0, owners[0][chosen[0]]), self._some(1, owners[1][chosen[1]])

    def _possible(self, begin: float, end: float) -> tuple[Ints | None, Ints | None]:
        """Places of the facets of both that lie together with some that can meet some there; None: any may."""
        if max(map(len, self.facets)) <= CHUNK:
            return None, None
        low, high, pairs, orders = self._together
        meet = low <= end
        meet &= high >= begin
        if self.turning:
            # a whole number of turns from there
            meet = np.floor((high - begin) / math.tau) * math.tau >= low - end
        chosen = pairs[meet]
        out = []
        for k, order in enumerate(orders):
            flags = np.zeros(len(order), dtype=bool)
            flags[chosen[:, k]] = True
            some = order[flags].ravel()
            out.append(some[some >= 0])
        return out[0], out[1]

    @cached_property
    def _together(self) -> tuple[Array, Array, Ints, tuple[Ints, Ints]]:
        """Chunks of facets of both that lie together: from where to where of the motion (m,) pairs of them (m, 2) can
        meet, and the places of the facets (c, CHUNK) of each, −1 where there is none."""
        assert self._along is not None
        orders, boxes = [], []
        for (low, high), (from_, to) in zip(self.kept, self._along, strict=True):
            low = np.column_stack([low[:, :2], self.unit * from_])
            high = np.column_stack([high[:, :2], self.unit * to])
            order = along_curve(low, high)
            starts = np.arange(0, len(order), CHUNK)
            boxes.append((np.minimum.reduceat(low[order], starts), np.maximum.reduceat(high[order], starts)))
            padded = np.full(len(starts) * CHUNK, -1)
            padded[: len(order)] = order
            orders.append(padded.reshape(-1, CHUNK))
        (low, high), (from_, to) = boxes
        meets = np.ones((len(low), len(from_)), dtype=bool)
        for axis in range(2):
            meets &= low[:, axis, None] <= to[:, axis] + self.margin
            meets &= high[:, axis, None] >= from_[:, axis] - self.margin
        i, j = np.nonzero(meets)
        begins, ends = (low[i, 2] - to[j, 2]) / self.unit, (high[i, 2] - from_[j, 2]) / self.unit
        return begins, ends, np.stack([i, j], axis=1), (orders[0], orders[1])

    def _some(self, side: int, chosen: Ints) -> Ints:
        """Facets of one part by their places, ascending, each once."""
        kept = np.zeros(len(self.facets[side]), dtype=bool)
        kept[chosen] = True
        return self.facets[side][kept]


def _near(first: Sides, second: Sides, margin: float) -> tuple[Ints, Ints]:
    """Which boxes (n, 3) of two kinds come near any of the other: none that does is missed."""
    sides = [first, second]
    chosen = [np.arange(len(first[0])), np.arange(len(second[0]))]
    for k in (0, 1, 0):
        # near_boxes asks about all that it is given
        low, high = sides[1 - k]
        if not len(low):
            return chosen[0][:0], chosen[1][:0]
        near = np.ones(len(chosen[k]), dtype=bool)
        for axis in range(3):
            near &= sides[k][0][:, axis] <= high[:, axis].max() + margin
            near &= sides[k][1][:, axis] >= low[:, axis].min() - margin
        if not near.all():
            sides[k], chosen[k] = (sides[k][0][near], sides[k][1][near]), chosen[k][near]
    kept = near_boxes(*sides[0], *sides[1], margin)
    return chosen[0][kept[0]], chosen[1][kept[1]]


def _cut(start: Array, stop: Array) -> tuple[Ints, Array, Array]:
    """Where facets (n,) are on a turn (rad) that is cut open at 0: of each piece (m,) the facet, and from where to
    where."""
    wide = np.minimum(stop - start, math.tau)
    start = np.where(wide >= math.tau, 0.0, start % math.tau)
    over = np.flatnonzero(start + wide > math.tau)
    rest = start[over] + wide[over] - math.tau
    ends = np.append(np.minimum(start + wide, math.tau), rest)
    return np.append(np.arange(len(start)), over), np.append(start, np.zeros(len(over))), ends


def meeting(first: Profile, second: Profile, facets_first: Ints, facets_second: Ints, margin: float) -> Meeting:
    """The facets of some of one part and of another that can meet when the second moves along the twist."""
    spans = [(low - margin, high + margin) for low, high in (first.span, second.span)]
    facets = [first.between(facets_first, *spans[1]), second.between(facets_second, *spans[0])]
    kept = [first.boxes(facets[0]), second.boxes(facets[1])]
    chosen = _near(kept[0], kept[1], margin)
    facets = [side[near] for side, near in zip(facets, chosen, strict=True)]
    kept = [(low[near], high[near]) for (low, high), near in zip(kept, chosen, strict=True)]
    unit = min(first.largest, second.largest) if first.turns else 1.0
    return Meeting((facets[0], facets[1]), (kept[0], kept[1]), (first, second), bool(first.turns), unit, margin)


def spanned(flat: Array, radius: Array, margin: float) -> Sides:
    """(n,) rad from where to where flat triangles (n, 3, 2), no nearer to the origin than `radius` (n,), are about it,
    `margin` (m) more; a whole turn where they may go round it."""
    first, *others = (np.arctan2(flat[:, corner, 1], flat[:, corner, 0]) for corner in range(3))
    low, high = np.zeros(len(flat)), np.zeros(len(flat))
    for angle in others:
        apart = (angle - first + math.pi) % math.tau - math.pi
        low, high = np.minimum(low, apart), np.maximum(high, apart)
    wide = margin / np.maximum(radius, TINY)
    start, stop = first + low - wide, first + high + wide
    whole = (stop - start >= math.pi) | (wide > 1.0)
    return np.where(whole, 0.0, start % math.tau), np.where(whole, math.tau, start % math.tau + stop - start)


def nearest(flat: Array) -> Array:
    """(n,) distance of flat triangles (n, 3, 2) from the origin; 0 where it is inside."""
    corners = [
        (np.ascontiguousarray(flat[:, corner, 0]), np.ascontiguousarray(flat[:, corner, 1])) for corner in range(3)
    ]
    square = np.full(len(flat), np.inf)
    left, right = np.ones(len(flat), dtype=bool), np.ones(len(flat), dtype=bool)
    for (x, y), (next_x, next_y) in zip(corners, corners[1:] + corners[:1], strict=True):
        u, v = next_x - x, next_y - y
        share = np.clip(-(u * x + v * y) / np.maximum(u * u + v * v, TINY), 0.0, 1.0)
        square = np.minimum(square, (x + share * u) ** 2 + (y + share * v) ** 2)
        turn = x * v - y * u
        left &= turn > 0.0
        right &= turn < 0.0
    return np.where(left | right, 0.0, np.sqrt(square))
