"""Which facets of two meshes face each other within a distance, and how far apart these are: by their boxes, then
exactly."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.concatenation import concatenated
from kinform.foundation.constants import ROWS
from kinform.foundation.meshes.box_pairs import meeting_in_slabs
from kinform.foundation.meshes.boxes import meeting_box, triangle_boxes
from kinform.foundation.meshes.closest_facets import distances_between
from kinform.foundation.meshes.near_facets import near_boxes
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class Facing:
    """Facets of the first mesh that face some of the second, each as often as it does. Lengths as of the facets."""

    normals: Array
    """(k, 3) unit, out of the first."""
    others: Array
    """(k, 3) unit, out of the second."""
    gaps: Array
    """(k,) between the two facets."""
    facets: Ints
    """(k,) which of the first it is."""

    @staticmethod
    def of_none() -> Facing:
        """Where no facets face each other."""
        return Facing(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int64))


def facing(first: Array, second: Array, distance: float, opposed: float) -> Facing:
    """Facets (n, 3, 3) of the first and (m, 3, 3) of the second whose normals have at most the cosine `opposed`, which
    are in front of each other, and no farther apart than a distance. Facets that cross are apart by what their edges
    are."""
    if not len(first) or not len(second):
        return Facing.of_none()
    keep, beside = near_boxes(*triangle_boxes(first), *triangle_boxes(second), distance)
    asked = np.flatnonzero(keep)
    first, second = first.take(asked, axis=0), second[beside]
    if not len(first) or not len(second):
        return Facing.of_none()
    origin = first[0, 0].copy()
    first -= origin
    second -= origin
    low, high = triangle_boxes(first)
    one, two = _meeting((low - distance, high + distance), triangle_boxes(second))
    normals, others = _normals(first), _normals(second)
    opposing = dot(normals.take(one, axis=0), others.take(two, axis=0)) <= opposed
    one, two = one[opposing], two[opposing]
    out: list[tuple[Ints, Ints, Array]] = []
    for start in range(0, len(one), ROWS):
        i, j = one[start : start + ROWS], two[start : start + ROWS]
        mine, other = first.take(i, axis=0), second.take(j, axis=0)
        front = _in_front(mine, normals.take(i, axis=0), other, distance)
        front &= _in_front(other, others.take(j, axis=0), mine, distance)
        i, j, gaps = i[front], j[front], triangles_apart(mine[front], other[front])
        near_by = gaps <= distance
        out.append((i[near_by], j[near_by], gaps[near_by]))
    if not out:
        return Facing.of_none()
    one = concatenated([i for i, *_ in out])
    two = concatenated([j for _, j, _ in out])
    gaps = concatenated([gaps for *_, gaps in out])
    return Facing(normals.take(one, axis=0), others.take(two, axis=0), gaps, asked.take(one))


def triangles_apart(first: Array, second: Array) -> Array:
    """(k,) distances of triangles (k, 3, 3) that do not cross; of those that do, of their edges and corners."""
    corners = [distances_between(second[:, k], first) for k in range(3)]
    corners += [distances_between(first[:, k], second) for k in range(3)]
    for i in range(3):
        u = first[:, (i + 1) % 3] - first[:, i]
        for j in range(3):
            v = second[:, (j + 1) % 3] - second[:, j]
            corners.append(_segments_apart(first[:, i], u, second[:, j], v))
    return np.asarray(np.minimum.reduce(corners))


def _segments_apart(p: Array, u: Array, q: Array, v: Array) -> Array:
    """(k,) distances of segments from p along u (k, 3) from those from q along v."""
    w = p - q
    a, b, c, d, e = dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w)
    square = a * c - b * b
    s = np.clip((b * e - c * d) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    t = np.clip((b * s + e) / np.where(c > 0.0, c, 1.0), 0.0, 1.0)
    s = np.clip((b * t - d) / np.where(a > 0.0, a, 1.0), 0.0, 1.0)
    away = w + s[:, None] * u - t[:, None] * v
    return np.sqrt(dot(away, away))


def _in_front(mine: Array, normals: Array, other: Array, distance: float) -> Flags:
    """(k,) whether other triangles (k, 3, 3) come in front of the planes of these, with normals (k, 3), and within a
    distance of them."""
    heights = ((other - mine[:, :1]) * normals[:, None]).sum(axis=2)
    return np.asarray((heights.max(axis=1) >= 0.0) & (heights.min(axis=1) <= distance))


def _normals(corners: Array) -> Array:
    """(n, 3) of triangles (n, 3, 3); zero of those without area."""
    spans = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt(dot(spans, spans))
    return np.asarray(spans / np.where(length > 0.0, length, 1.0)[:, None])


def _meeting(first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Ints, Ints]:
    """All boxes (n, 3) and (m, 3) that meet: of very many, by halves of the first."""
    met = meeting_in_slabs(first, second)
    if met is not None:
        return met
    if len(first[0]) == 1:
        beside = np.flatnonzero(meeting_box(*second, first[0][0], first[1][0]))
        return np.zeros(len(beside), np.int64), beside
    half = len(first[0]) // 2
    parts = [_meeting((first[0][some], first[1][some]), second) for some in (slice(0, half), slice(half, None))]
    return concatenated([parts[0][0], parts[1][0] + half]), concatenated([parts[0][1], parts[1][1]])
