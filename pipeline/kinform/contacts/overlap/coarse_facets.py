"""Whether points that two solids share are beyond what facets may stand off, facet by facet.

Solids overlap for sure at a point that is deeper in each of them than its facets stand off: no facet nearer than that
may lie off the surface that it stands for by as much. A point on the boundary of one, at the depth d in the other, can
be moved inwards until that holds of the first, and then d has to be more than what both stand off. The facet that
counts is not the nearest one where a coarse socket ends at a fine bore: it is the one that is nearest beside what it
may stand off, so that for each solid the least distance less that is asked for.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from kinform.contacts.search.pair_view import PartView, near_facets
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.constants import STANDOFF_EDGES
from kinform.foundation.meshes.box_pairs import Boxes, meeting_boxes
from kinform.foundation.meshes.boxes import meeting_box
from kinform.foundation.meshes.closest_facets import distances_between
from kinform.foundation.meshes.surface_table import PLANE
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

BEYOND_FACETS = 2.5
"""Times what a facet stands off by which its surface may go on beside it, as where it ends at another at 22°."""
COARSE_AT_ONCE = 4_000_000
"""Points times facets near all of them of which it is asked at once which are near each other: 0.1 s, 0.1 GB."""


_FREE = [KINDS.index(kind) for kind in ("helicoid", "revolution", "extrusion", "freeform")]
"""Kinds whose chord errors are estimates."""


class CoarseFacets:
    """The facets of two parts about what they share."""

    def __init__(self, a: PartView, b: PartView, floor: float, tolerances: Tolerances):
        """Of parts `a` and `b`; `floor` (m) is no overlap."""
        self.parts, self.floor, self.tolerances = (a, b), floor, tolerances

    @cached_property
    def sides(self) -> tuple[_Side, _Side]:
        """Both parts, the coarser one first: what its facets stand off says how far to look for those of the other."""
        a, b = (_Side(part, self.floor, self.tolerances) for part in self.parts)
        return (a, b) if a.most >= b.most else (b, a)

    def explain(self, pieces: list[tuple[Array, Array]]) -> list[bool]:
        """Of each piece that both share, of which there are points (n, 3) on the boundary of either part at depths (n,)
        m in the other, whether none of these is in an overlap for sure."""
        deepest = [int(np.argmax(depth)) for _, depth in pieces]
        first = zip(pieces, deepest, strict=True)
        points, depths = zip(*[(points[k], depth[k]) for (points, depth), k in first], strict=True)
        out: list[bool] = self._within(np.array(points), np.array(depths)).tolist()
        left = [k for k, told in enumerate(out) if told]
        if left:
            every = self._within(*(np.concatenate(columns) for columns in zip(*(pieces[k] for k in left), strict=True)))
            ends = np.cumsum([len(pieces[k][1]) for k in left])[:-1]
            for k, told in zip(left, np.split(every, ends), strict=True):
                out[k] = bool(told.all())
        return out

    def _within(self, points: Array, depth: Array) -> Flags:
        """(n,) which points may be in no overlap."""
        first, second = self.sides
        out = np.zeros(len(points), bool)
        left = np.flatnonzero(depth <= first.most + second.most + self.floor)
        one = first.clearances(points[left], np.full(len(left), second.most + self.floor))
        near = one <= second.most + self.floor
        left, one = left[near], one[near]
        out[left] = one + second.clearances(points[left], self.floor - one) <= self.floor
        return out


class _Side:
    """One of the parts."""

    def __init__(self, part: PartView, floor: float, tolerances: Tolerances):
        self.part, self.floor, self.tolerances = part, floor, tolerances
        table = part.table
        self.free = np.isin(table.kinds, _FREE)
        self.slacks = np.where(table.kinds == PLANE, 0.0, table.slacks)
        self.bounds = self.slacks + np.where(self.free, (STANDOFF_EDGES - 1.0) * table.chords, 0.0)
        self.most = float(self.bounds.max(initial=0.0))

    def clearances(self, points: Array, beyond: Array) -> Array:
        """(n,) m: least distance of each point (n, 3) from a facet less what that may stand off; inf where that is
        more than `beyond` (n,)."""
        out = np.full(len(points), np.inf)
        if not len(points):
            return out
        # the nearest facet is no farther beside what it may stand off, and so none counts that is
        beyond = np.minimum(beyond, self.part.depths(points)[0] + self.floor)
        low, high = points - np.abs(beyond)[:, None], points + np.abs(beyond)[:, None]
        margin = (1.0 + BEYOND_FACETS) * self.most
        facets, least, most = near_facets(self.part, low.min(axis=0) - margin, high.max(axis=0) + margin)
        reach = (1.0 + BEYOND_FACETS) * self.bounds[self.part.surfaces.labels[facets]][:, None]
        boxes = least - reach, most + reach
        for at, beside in _meeting((low, high), boxes, np.arange(len(points)), np.arange(len(facets))):
            np.minimum.at(out, at, self._beyond(points[at], facets[beside], beyond[at]))
        return out

    def _beyond(self, points: Array, facets: Ints, beyond: Array) -> Array:
        """(k,) m: distance of points (k, 3) from facets (k,) less what these may stand off; inf where that is more than
        `beyond` (k,)."""
        part, out = self.part, np.full(len(points), np.inf)
        corners = part.vertices.take(part.faces[facets], axis=0)
        away = distances_between(points, corners)
        bounds = self.bounds[part.surfaces.labels[facets]]
        near = np.flatnonzero(away <= (1.0 + BEYOND_FACETS) * bounds + beyond)
        away, height = away[near], np.abs(dot(points[near] - corners[near, 0], part.normals(facets[near])))
        # how facets bend is not asked where it does not matter
        some = _less(away, height, bounds[near]) <= beyond[near]
        near = near[some]
        out[near] = _less(away[some], height[some], self._standing(facets[near]))
        return out

    def _standing(self, facets: Ints) -> Array:
        """(k,) m that facets (k,) may stand off."""
        part = self.part
        labels = part.surfaces.labels[facets]
        out = self.slacks[labels]
        for number in np.unique(labels[self.free[labels]]).tolist():
            rows = np.flatnonzero(labels == number)
            own = part.index.standoffs(part.surfaces, number, self.tolerances)
            out[rows] = np.maximum(out[rows], own[np.searchsorted(part.surfaces.surfaces[number].faces, facets[rows])])
        return out


def _meeting(first: Boxes, second: Boxes, one: Ints, two: Ints) -> Iterator[tuple[Ints, Ints]]:
    """All pairs of boxes `one` (n,) of the first and `two` (m,) of the second that meet, not many at once."""
    low, high = first[0].take(one, axis=0), first[1].take(one, axis=0)
    two = two[meeting_box(second[0].take(two, axis=0), second[1].take(two, axis=0), low.min(axis=0), high.max(axis=0))]
    if not len(two):
        return
    if len(one) == 1:
        yield np.repeat(one, len(two)), two
        return
    if len(one) * len(two) <= COARSE_AT_ONCE:
        met = meeting_boxes((low, high), (second[0].take(two, axis=0), second[1].take(two, axis=0)))
        if met is not None:
            yield one[met[0]], two[met[1]]
            return
    order = np.argsort(low[:, int(np.argmax(np.ptp(low, axis=0)))], kind="stable")
    for half in np.array_split(one[order], 2):
        yield from _meeting(first, second, half, two)


def _less(away: Array, height: Array, standing: Array) -> Array:
    """(k,) m: distances of points from facets less what these stand off; `height` is that above their planes, in which
    their surfaces go on beside them."""
    beside = np.sqrt(np.maximum(away * away - height * height, 0.0)) - BEYOND_FACETS * standing
    return np.asarray(np.hypot(height, np.maximum(beside, 0.0)) - standing)
