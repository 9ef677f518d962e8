"""How far points are from a mesh, where they come near few of its facets: FCL's models are made of facets that lie
together, each when a point first comes nearer to its box than to what is nearest so far."""

from __future__ import annotations

from functools import cached_property

import fcl
import numpy as np

from kinform.foundation.constants import ABOUT_FACET, DEPTH_FACETS
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
    def _corners(self) -> Ints:
        """(3, g, DEPTH_FACETS) vertices of the facets of each group; the last of all fills its group."""
        order = np.concatenate(self._facets)
        order = np.append(order, np.repeat(order[-1:], -len(order) % DEPTH_FACETS))
        return np.ascontiguousarray(self._mesh.faces[order].T).reshape(3, -1, DEPTH_FACETS)

    def beside(self, points: Array, reach: float) -> Flags:
        """(n,) which points (n, 3) of the part frame are about the box of any facet: none of the others is found as
        near as a small `reach` (m) by `of`."""
        wide = reach + ABOUT_FACET * float(np.linalg.norm(self._high.max(axis=0) - self._low.min(axis=0)))
        point, group = np.nonzero(_beside(self._low, self._high, points[:, None], wide))
        one, two, three = (self._mesh.vertices.take(c, axis=0) for c in self._corners.take(group, axis=1))
        low, high = (f(f(one, two), three) for f in (np.minimum, np.maximum))
        near = _beside(low, high, points[point, None], wide).any(axis=1)
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
