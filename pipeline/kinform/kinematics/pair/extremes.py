"""Samples that bound a patch: a linear condition holds on all of it when it holds at these.

So few rows stand for each patch in the constraint matrix, and in the cones of what contact allows.
"""

from __future__ import annotations

import functools

import numpy as np

from kinform.foundation.algebra.vectors import norm, perpendicular
from kinform.kinematics import constants
from kinform.model.arrays import Array, Ints
from kinform.model.contacts import Patch

_TURN = 2.0 * np.pi * np.arange(constants.HULL_DIRECTIONS) / constants.HULL_DIRECTIONS
_ROUND = np.stack([np.cos(_TURN), np.sin(_TURN)])
"""(2, 16) directions whose ends are corners of a hull."""


def extreme_samples(patch: Patch) -> Ints:
    """Indices of the samples that bound the patch, ascending: n·v ≥ 0 at these implies it at all samples.

    Exact for planes, lines and for cylinders and cones sampled on a grid. Of other curved patches with many
    samples the ends of sectors of normals are kept.
    """
    points = patch.points
    if patch.kind == "plane":
        return hull(points, patch.axis)
    if len(points) <= constants.FEW_SAMPLES or not (np.any(patch.axis) or patch.kind == "sphere"):
        return np.arange(len(points), dtype=np.int64)
    if patch.kind == "sphere":
        return _rim(patch.normals)
    u, v = perpendicular(patch.axis)
    angle = np.arctan2(patch.normals @ v, patch.normals @ u)
    height = points @ patch.axis
    sector = np.floor(angle / (2.0 * np.pi / constants.NORMAL_SECTORS)).astype(int)
    turn = np.round(angle / constants.SAME_PLACE)
    level = np.round(height / (constants.SAME_PLACE * max(float(np.ptp(height)), 1e-300)))
    ends = [np.lexsort((p * level, q * turn, sector)) for p in (1.0, -1.0) for q in (1.0, -1.0)]
    ends += [np.lexsort((p * level, sector)) for p in (1.0, -1.0)]
    ordered = sector[ends[0]]
    first = np.flatnonzero(np.concatenate([[True], ordered[1:] != ordered[:-1]]))
    bounds = np.zeros(len(points), dtype=np.bool_)
    for order in ends:
        bounds[order[first]] = True
    return np.flatnonzero(bounds).astype(np.int64)


def hull(points: Array, axis: Array) -> Ints:
    """Indices, ascending, of the corners of the convex hull of the points (n, 3) seen along the axis."""
    if len(points) <= 2:
        return np.arange(len(points), dtype=np.int64)
    u, v = perpendicular(axis)
    flat = np.stack([points @ u, points @ v], axis=1)
    flat = flat - flat.mean(axis=0)
    size = float(np.abs(flat).max())
    if size == 0.0:
        return np.zeros(1, dtype=np.int64)
    _, _, right = np.linalg.svd(flat, full_matrices=False)
    if float(np.abs(flat @ right[1]).max()) < constants.STRAIGHT_EDGE * size:
        along = flat @ right[0]
        return np.array(sorted((int(along.argmin()), int(along.argmax()))), dtype=np.int64)
    corners = _around(flat)
    while len(corners) > 3:
        here = flat[corners]
        before, after = here[_before(len(here))], here[_after(len(here))]
        edge, arm = after - before, here - before
        out = np.abs(edge[:, 0] * arm[:, 1] - edge[:, 1] * arm[:, 0])
        k = int(np.argmin(out))
        if out[k] > constants.STRAIGHT_EDGE * size * max(float(np.hypot(*edge[k])), constants.STRAIGHT_EDGE * size):
            break
        corners = np.delete(corners, k)
    return np.sort(corners)


def _around(flat: Array) -> Ints:
    """Indices of the corners of the convex hull of points (n, 2) that are not all in line, anticlockwise: the points in
    the order of x, and of each chain those that turn left (A. M. Andrew, Inf. Proc. Letters 9, 1979).

    Points inside of the polygon of those that lie farthest in `HULL_DIRECTIONS` are left out before they are sorted.
    """
    ends = (flat @ _ROUND).argmax(axis=0)
    ends = ends[ends != ends[_before(len(ends))]]
    corners = flat[ends]
    edge, arm = corners[_after(len(ends))] - corners, flat[:, None] - corners
    inside = (edge[:, 0] * arm[..., 1] - edge[:, 1] * arm[..., 0] > 0.0).all(axis=1)
    outer = np.flatnonzero(~inside)
    outer = outer[np.lexsort((outer, flat[outer, 1], flat[outer, 0]))]
    places = flat[outer].tolist()

    def chain(order: range) -> list[int]:
        out: list[int] = []
        for k in order:
            x, y = places[k]
            while len(out) > 1:
                (ax, ay), (bx, by) = places[out[-2]], places[out[-1]]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                out.pop()
            out.append(k)
        return out[:-1]

    last = len(places) - 1
    return outer[chain(range(last + 1)) + chain(range(last, -1, -1))]


@functools.cache
def _before(count: int) -> Ints:
    """(count,) the place before each of a round: np.roll of an array of a few takes ten times as long as this."""
    return (np.arange(count) - 1) % count


@functools.cache
def _after(count: int) -> Ints:
    """(count,) the place after each of a round."""
    return (np.arange(count) + 1) % count


def _rim(normals: Array) -> Ints:
    """Normals (n, 3) of a ball that span the same cone: the rim of a cap, or ends in directions all round."""
    mean = normals.mean(axis=0)
    along = normals @ mean / max(norm(mean), 1e-300)
    if along.min() > constants.CAP:
        return hull(normals / along[:, None], mean / norm(mean))
    ends = _SPREAD @ normals.T
    return np.unique(ends.argmax(axis=1)).astype(np.int64)


def _spread(count: int) -> Array:
    """(count, 3) unit vectors, evenly over the sphere (a golden spiral)."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    turn = np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


_SPREAD = _spread(constants.BALL_DIRECTIONS)
"""Directions in which the ends of a ball's normals are looked for."""
