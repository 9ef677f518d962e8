"""Where points of a part pass through facets of another along a turn or a slide: between two such places they are
inside of it or not, and need not be asked.

A point that turns goes along a circle, which meets the plane of a facet at two places at most: where the point is as
high above it as the plane's distance asks for, A cos ψ + B sin ψ = C. A point that slides meets it at one.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.meshes.boxes import FlatBoxes, triangle_boxes
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh


@dataclass(frozen=True, eq=False)
class Path:
    """A turn about an axis or a slide along it, to one side (`sign`)."""

    frame: Array
    """(4, 4) displacement of the world to where the axis is z."""
    turning: bool
    sign: int


@dataclass(frozen=True, eq=False)
class Passages:
    """Places at which points pass through facets."""

    place: Array
    """(k,) rad or m."""
    point: Ints
    outward: Flags
    """(k,) whether to the outer side of the facet."""
    closed: Flags
    """(n,) of all points, whether what they pass through has an inside: they come out as often as in."""

    @classmethod
    def joined(cls, first: Passages, second: Passages) -> Passages:
        """Those of some points, and of others counted on."""
        return cls(
            np.append(first.place, second.place), np.append(first.point, len(first.closed) + second.point),
            np.append(first.outward, second.outward), np.append(first.closed, second.closed),
        )  # fmt: skip

    def reversed(self) -> Passages:
        """As the motion goes the other way."""
        return Passages(-self.place, self.point, ~self.outward, self.closed)

    def ordered(self, path: Path) -> Passages:
        """To the side of a path, from those to the positive one, ascending; of a turn, for two of them."""
        forward = self if path.sign > 0 else self.reversed()
        place, point, outward = forward.place, forward.point, forward.outward
        if path.turning:
            place = np.append(place % math.tau, place % math.tau + math.tau)
            point, outward = np.tile(point, 2), np.tile(outward, 2)
        order = np.lexsort((point, place))
        return Passages(place[order], point[order], outward[order], self.closed)

    def last(self, begin: float, end: float) -> Array:
        """(n,) the last place after `begin`, up to `end`, at which each point passes; nan where it does not."""
        first, last = np.searchsorted(self.place, [begin, end], side="right")
        out = np.full(len(self.closed), np.nan)
        out[self.point[first:last]] = self.place[first:last]
        return out

    def maybe_inside(self, begin: float) -> Flags:
        """(n,) which points may be inside at a place: they pass outward next, or what they pass is not closed. Those
        that never pass are what they are wherever they go."""
        first = int(np.searchsorted(self.place, begin, side="right"))
        out = np.zeros(len(self.closed), dtype=bool)
        out[self.point[first:][::-1]] = self.outward[first:][::-1]
        return np.asarray(out | ~self.closed)


def passages(points: Array, corners: Array, turning: bool, mesh: Mesh) -> Passages:
    """Where points (n, 3) pass through triangles (m, 3, 3) of a mesh, as they turn about z or slide along it."""
    kept = np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]]) if turning else points[:, :2]
    low, high = _kept(corners, turning)
    point, facet = FlatBoxes(low, high).around(kept)
    first, second, third = (corners[facet, k] for k in range(3))
    normal = cross(second - first, third - first)
    height = dot(normal, first)
    start = points[point]
    if turning:
        place, at = _met_by_turn(start, normal, height)
        point, facet = np.tile(point, 2), np.tile(facet, 2)
        first, second, third, normal = (np.tile(side, (2, 1)) for side in (first, second, third, normal))
        outward = normal[:, 1] * at[:, 0] > normal[:, 0] * at[:, 1]
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            place = (height - dot(normal, start)) / normal[:, 2]
        at = start + np.stack([np.zeros_like(place), np.zeros_like(place), place], axis=1)
        outward = normal[:, 2] > 0.0
    with np.errstate(invalid="ignore"):
        within = np.isfinite(place)
        least = -SOLVED * dot(normal, normal)
        for one, other in ((first, second), (second, third), (third, first)):
            within &= dot(normal, cross(other - one, at - one)) >= least
    health = mesh.health
    closed = np.full(len(points), health.watertight and health.consistent_winding)
    # of what is inside out, out is in
    return Passages(place[within], point[within], outward[within] == (health.volume >= 0.0), closed)


def _kept(corners: Array, turning: bool) -> tuple[Array, Array]:
    """Boxes (m, 2) of what points of triangles (m, 3, 3) keep, some larger: radius and height, or the shadow."""
    if not turning:
        return triangle_boxes(corners[..., :2])
    bottom, top = triangle_boxes(corners[..., 2])
    nearest, furthest = triangle_boxes(np.hypot(corners[..., 0], corners[..., 1]))
    low, high = triangle_boxes(corners[..., :2])
    # no point of it is further from all corners than its longest side over the root of three
    wide = 0.6 * np.hypot(*(high - low).T)
    return np.stack([nearest - wide, bottom], axis=1), np.stack([furthest, top], axis=1)


def _met_by_turn(start: Array, normal: Array, height: Array) -> tuple[Array, Array]:
    """(2 n,) rad, to the places (2 n, 3) at which points meet planes; nan where they do not."""
    radius = np.hypot(start[:, 0], start[:, 1])
    reach = radius * np.hypot(normal[:, 0], normal[:, 1])
    middle = np.arctan2(normal[:, 1], normal[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        half = np.arccos((height - normal[:, 2] * start[:, 2]) / reach)
    angle = np.append(middle + half, middle - half)
    radius, level = np.tile(radius, 2), np.tile(start[:, 2], 2)
    at = np.stack([radius * np.cos(angle), radius * np.sin(angle), level], axis=1)
    return angle - np.tile(np.arctan2(start[:, 1], start[:, 0]), 2), at
