"""How far points are from a mesh, where they come near few of its facets: FCL's models are made of facets that lie
together, each when a point first comes nearer to its box than to what is nearest so far."""

from __future__ import annotations

from functools import cached_property

import fcl
import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.constants import ROWS
from kinform.foundation.meshes.boxes import along_curve, facet_boxes
from kinform.foundation.meshes.closest_facets import distances_between
from kinform.foundation.meshes.fcl_adapter import UNIT, fcl_distance, fcl_model, partial_model, point_model
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh

DEPTH_FACETS = 128
"""Facets of a group, for which FCL makes one model. Chosen, not measured."""
DEPTH_PART = 16
"""Facets of a part of a group, the finer step of the search for near facets. Chosen, not measured."""


class Depths:
    """The facets of a mesh, in groups that lie together."""

    def __init__(self, mesh: Mesh):
        self._mesh = mesh
        low, high = facet_boxes(mesh.vertices, mesh.faces)
        order = along_curve(low, high)
        starts = np.arange(0, len(order), DEPTH_FACETS)
        self._low = np.minimum.reduceat(low[order], starts)
        self._high = np.maximum.reduceat(high[order], starts)
        self._facets = np.split(order, starts[1:])
        self._objects: list[fcl.CollisionObject | None] = [None] * len(starts)
        self._asked = 0
        """Questions to groups so far."""

    def of(self, points: Array) -> Array:
        """(n,) m distances of points (n, 3) of the part frame from the facets.

        No facet is nearer than its group's box: groups are asked from the nearest box on, until the next is no nearer
        than the nearest facet. Points that many groups are about, as those on the axis of a thread, would ask most of
        them: where that has cost as much as a model of all facets, such a one is asked, to the same bits.
        """
        out, least = np.empty(len(points)), self._least(points)
        point = fcl.CollisionObject(point_model())
        for k, place in enumerate(UNIT * points):
            point.setTranslation(place)
            # a question to a group costs about what a model costs a facet, 8 µs each
            many = self._asked > len(self._mesh.faces)
            out[k] = fcl_distance(self._whole, point) if many else self._nearest(point, least[k])
        return out

    def up_to(self, points: Array, enough: float | Array) -> Array:
        """(n,) the same where that is less than `enough` (m), of all or each (n,), else this: all together, measured
        from those facets whose boxes come so near; but for slivers, whose planes are not known well enough."""
        out = np.full(len(points), enough)
        for begin in range(0, len(points), ROWS):
            some = slice(begin, begin + ROWS)
            point, facet = self._near(points[some], out[some])
            if not len(point):
                continue
            away = distances_between(points[some][point], self._mesh.vertices[self._mesh.faces[facet]])
            starts = heads(point).nonzero()[0]
            place = begin + point[starts]
            out[place] = np.minimum(out[place], np.minimum.reduceat(away, starts))
            beside = begin + np.unique(point[self._slivers[facet]])
            if len(beside):
                out[beside] = np.minimum(np.broadcast_to(enough, out.shape)[beside], self.of(points[beside]))
        return out

    @cached_property
    def _slivers(self) -> Flags:
        """(F,) facets whose height is no more than a small share of their longest side."""
        first, second, third = (self._mesh.vertices.take(corners, axis=0) for corners in self._mesh.faces.T)
        sides = first - second, second - third, third - first
        spanned = cross(sides[0], sides[1])
        longest = np.maximum.reduce([dot(side, side) for side in sides])
        return np.asarray(dot(spanned, spanned) <= (SINGLE * longest) ** 2)

    def _near(self, points: Array, reach: Array) -> tuple[Ints, Ints]:
        """Points (k,) by their places, ascending, and facets (k,) whose boxes come as near as `reach` (n,) m along each
        axis: of groups, of parts of these, and of facets."""
        low, high = (np.ascontiguousarray(side.T) for side in (points - reach[:, None], points + reach[:, None]))
        order, levels = self._levels
        point, place = np.nonzero(np.ones((len(points), 1), dtype=bool))
        for lows, highs in levels:
            # boxes of one in the level above are in a row
            held = np.ones((len(point), lows[0].shape[1]), dtype=bool)
            for axis in range(3):
                held &= lows[axis].take(place, axis=0) <= high[axis].take(point)[:, None]
                held &= highs[axis].take(place, axis=0) >= low[axis].take(point)[:, None]
            row, column = np.nonzero(held)
            point, place = point[row], place[row] * held.shape[1] + column
        return point, order[place]

    @cached_property
    def _levels(self) -> tuple[Ints, list[tuple[list[Array], list[Array]]]]:
        """All facets, the last one repeated to fill its group, and the boxes, axis by axis, of groups (1, g), of the
        parts of each (g, …) and of the facets of these (…, n)."""
        order = np.concatenate(self._facets)
        order = np.append(order, np.repeat(order[-1:], -len(order) % DEPTH_FACETS))
        low, high = (side[order].T for side in facet_boxes(self._mesh.vertices, self._mesh.faces))
        levels = []
        for size, row in ((DEPTH_FACETS, -1), (DEPTH_PART, DEPTH_FACETS // DEPTH_PART), (1, DEPTH_PART)):
            lows = [column.reshape(-1, size).min(axis=1).reshape(-1 if row > 0 else 1, row) for column in low]
            highs = [column.reshape(-1, size).max(axis=1).reshape(-1 if row > 0 else 1, row) for column in high]
            levels.append((lows, highs))
        return order, levels

    def _nearest(self, point: fcl.CollisionObject, least: Array) -> float:
        """m of a point, no nearer to the facets of each group than `least` (g,)."""
        first = int(least.argmin())
        distance = fcl_distance(self._object(first), point)
        self._asked += 1
        near = (least < distance).nonzero()[0]
        for n in near[least[near].argsort(kind="stable")].tolist() if len(near) > 1 else ():
            if n != first and least[n] < distance:
                distance = min(distance, fcl_distance(self._object(n), point))
                self._asked += 1
        return distance

    def _least(self, points: Array) -> Array:
        """(n, g) m that points (n, 3) keep from the box of each group at least."""
        square = np.zeros((len(points), len(self._low)))
        for axis in range(3):
            place = points[:, axis, None]
            beyond = np.maximum(self._low[:, axis] - place, place - self._high[:, axis])
            beyond = np.maximum(beyond, 0.0, out=beyond)
            square += np.square(beyond, out=beyond)
        return np.asarray((1.0 - SOLVED) * np.sqrt(square, out=square))

    @cached_property
    def _whole(self) -> fcl.CollisionObject:
        return fcl.CollisionObject(fcl_model(self._mesh.vertices, self._mesh.faces))

    def _object(self, n: int) -> fcl.CollisionObject:
        known = self._objects[n]
        if known is None:
            model = partial_model(self._mesh.vertices, self._mesh.faces[self._facets[n]])
            known = self._objects[n] = fcl.CollisionObject(model)
        return known
