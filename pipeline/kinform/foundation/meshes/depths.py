"""How far points are from a mesh, where they come near few of its facets: FCL's models are made of facets that lie
together, each when a point first comes nearer to its box than to what is nearest so far."""

from __future__ import annotations

from functools import cached_property

import fcl
import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.constants import ABOUT_FACET, DEPTH_FACETS, PLANE_ROUNDING
from kinform.foundation.meshes.boxes import along_curve, facet_boxes
from kinform.foundation.meshes.fcl_adapter import UNIT, fcl_distance, partial_model, point_model
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh


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

    def of(self, points: Array) -> Array:
        """(n,) m distances of points (n, 3) of the part frame from the facets.

        No facet is nearer than its group's box: groups are asked from the nearest box on, until the next is no nearer
        than the nearest facet.
        """
        beyond = np.maximum(np.maximum(self._low - points[:, None], points[:, None] - self._high), 0.0)
        least = (1.0 - 1e-9) * np.sqrt((beyond * beyond).sum(axis=2))
        point, out, first = fcl.CollisionObject(point_model()), np.empty(len(points)), least.argmin(axis=1).tolist()
        for k, p in enumerate(UNIT * points):
            point.setTranslation(p)
            distance = fcl_distance(self._object(first[k]), point)
            near = (least[k] < distance).nonzero()[0]
            if len(near) > 1:
                for n in near[least[k][near].argsort(kind="stable")].tolist():
                    if n != first[k] and least[k, n] < distance:
                        distance = min(distance, fcl_distance(self._object(n), point))
            out[k] = distance
        return out

    @cached_property
    def _grouped(self) -> tuple[Ints, list[Array], list[Array]]:
        """(g, DEPTH_FACETS) facets of each group, and their boxes along each axis; the last facet fills its group."""
        order = np.concatenate(self._facets)
        facets = np.append(order, np.repeat(order[-1:], -len(order) % DEPTH_FACETS)).reshape(-1, DEPTH_FACETS)
        low, high = facet_boxes(self._mesh.vertices, self._mesh.faces)
        return facets, [column[facets] for column in low.T], [column[facets] for column in high.T]

    def beside(self, points: Array, reach: float) -> Flags:
        """(n,) which points (n, 3) of the part frame are about the box of any facet and its plane: none of the others
        is found as near as a small `reach` (m) by `of`."""
        wide = reach + ABOUT_FACET * float(np.linalg.norm(self._high.max(axis=0) - self._low.min(axis=0)))
        point, group = np.nonzero(_beside(self._low, self._high, points[:, None], wide))
        facets, low, high = self._grouped
        held = np.ones((len(point), DEPTH_FACETS), dtype=bool)
        for axis in range(3):
            place = points[point, axis, None]
            held &= low[axis].take(group, axis=0) <= place + wide
            held &= high[axis].take(group, axis=0) >= place - wide
        row, column = np.nonzero(held)
        point, facet = point[row], facets[group[row], column]
        first, second, third = (self._mesh.vertices.take(c, axis=0) for c in self._mesh.faces[facet].T)
        one, other, away = second - first, third - first, points[point] - first
        normal = cross(one, other)
        # rounding of a sliver's normal may turn it anywhere
        rounding = PLANE_ROUNDING * np.sqrt(dot(one, one) * dot(other, other) * dot(away, away))
        near = np.abs(dot(normal, away)) <= wide * np.sqrt(dot(normal, normal)) + rounding
        out = np.zeros(len(points), dtype=bool)
        out[point[near]] = True
        return out

    def _object(self, n: int) -> fcl.CollisionObject:
        known = self._objects[n]
        if known is None:
            model = partial_model(self._mesh.vertices, self._mesh.faces[self._facets[n]])
            known = self._objects[n] = fcl.CollisionObject(model)
        return known


def _beside(low: Array, high: Array, points: Array, wide: float) -> Flags:
    """Whether points (…, 3) are in boxes (…, 3), or no more than `wide` beside them along each axis."""
    out = np.asarray((points[..., 0] >= low[..., 0] - wide) & (points[..., 0] <= high[..., 0] + wide))
    for axis in (1, 2):
        out &= points[..., axis] >= low[..., axis] - wide
        out &= points[..., axis] <= high[..., axis] + wide
    return out
