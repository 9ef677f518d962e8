"""Samples that bound a patch: a linear condition holds on all of it when it holds at these.

So few rows stand for each patch in the constraint matrix, and in the cones of what contact allows.
"""

from __future__ import annotations

import functools
from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import norm, perpendicular, turning_frame
from kinform.foundation.rounding import SINGLE, TINY
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch

NORMAL_SECTORS = 16
"""Sectors of normals about the axis of a curved patch with many samples; of each its ends are kept. Chosen, not
measured."""
FIRST_SECTOR = 0.2
"""Sectors by which the first begins before the first sample, so that the patch turns with its sectors, and none of the
samples, which are evenly spaced, is at a border."""
FEW_SAMPLES = 12
"""Patches with no more samples than this keep them all. Chosen, not measured."""
HULL_DIRECTIONS = 16
"""Directions whose ends are corners of a hull: what lies inside of these corners is left out at once. Chosen, not
measured."""
MOST_STACKED_SAMPLES = 8_000
"""Samples of patches that are looked at together: a few MB at a time, and no further gain from more."""
CAP = 1e-3
"""Cosine with the mean above which all normals of a ball are those of a cap, whose rim spans them. Chosen, not
measured."""
BALL_DIRECTIONS = 96
"""Directions in which the ends of a ball's normals are looked for. Chosen, not measured."""


_TURN = 2.0 * np.pi * np.arange(HULL_DIRECTIONS) / HULL_DIRECTIONS
_ROUND = np.stack([np.cos(_TURN), np.sin(_TURN)])
"""(2, 16) directions whose ends are corners of a hull."""


def extreme_samples(patches: Sequence[Patch]) -> list[Ints]:
    """Of each patch the indices of the samples that bound it, ascending: n·v ≥ 0 at these implies it at all samples.

    Exact for planes, lines and for cylinders and cones sampled on a grid. Of other curved patches with many
    samples the ends of sectors of normals are kept. Patches of as many samples take little longer than one of them.
    """
    out: list[Ints | None] = [None] * len(patches)
    alike: dict[tuple[Callable[[Sequence[Patch]], list[Ints]], int], list[int]] = defaultdict(list)
    for k, patch in enumerate(patches):
        count = len(patch.points)
        if patch.kind == "plane":
            alike[_corners, count].append(k)
        elif count <= FEW_SAMPLES or not (patch.kind == "sphere" or any(patch.axis.tolist())):
            out[k] = np.arange(count, dtype=np.int64)
        elif patch.kind == "sphere":
            out[k] = _rim(patch.normals)
        else:
            alike[_ends_of_sectors, count].append(k)
    for (bounds, count), members in alike.items():
        step = max(1, MOST_STACKED_SAMPLES // max(count, 1))
        for first in range(0, len(members), step):
            chosen = members[first : first + step]
            for k, samples in zip(chosen, bounds([patches[k] for k in chosen]), strict=True):
                out[k] = samples
    return [samples for samples in out if samples is not None]


def _ends_of_sectors(patches: Sequence[Patch]) -> list[Ints]:
    """Of curved patches of as many samples, those at the ends of the sectors of normals about their axes."""
    angle, height = (np.empty((len(patches), len(patches[0].points))) for _ in range(2))
    for row, along, patch in zip(angle, height, patches, strict=True):
        u, v = perpendicular(patch.axis)
        np.arctan2(patch.normals @ v, patch.normals @ u, out=row)
        row -= row[0] - FIRST_SECTOR * 2.0 * np.pi / NORMAL_SECTORS
        row %= 2.0 * np.pi
        np.matmul(patch.points, patch.axis, out=along)
    sector = np.floor(angle / (2.0 * np.pi / NORMAL_SECTORS)).astype(int)
    turn = np.round(angle / SINGLE)
    tall = np.ptp(height, axis=1, keepdims=True)
    level = np.round(height / np.where(tall > TINY, SINGLE * tall, 1.0))
    ends = [np.lexsort((p * level, q * turn, sector)) for p in (1.0, -1.0) for q in (1.0, -1.0)]
    ends += [np.lexsort((p * level, sector)) for p in (1.0, -1.0)]
    ordered = np.take_along_axis(sector, ends[0], axis=1)
    first = np.ones(sector.shape, dtype=np.bool_)
    first[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
    of_patch, place = np.nonzero(first)
    bounds = np.zeros(sector.shape, dtype=np.bool_)
    for order in ends:
        bounds[of_patch, order[of_patch, place]] = True
    return [np.flatnonzero(bound).astype(np.int64) for bound in bounds]


def _corners(patches: Sequence[Patch]) -> list[Ints]:
    """Of planes of as many samples, those at the corners of their convex hulls."""
    return _hulls([(patch.points, patch.axis) for patch in patches])


def hull(points: Array, axis: Array) -> Ints:
    """Indices, ascending, of the corners of the convex hull of the points (n, 3) seen along the axis."""
    return _hulls([(points, axis)])[0]


def _hulls(views: Sequence[tuple[Array, Array]]) -> list[Ints]:
    """As `hull`, of several groups of as many points (n, 3), each seen along its axis (3,)."""
    count = len(views[0][0])
    if count <= 2:
        return [np.arange(count, dtype=np.int64) for _ in views]
    flat = np.empty((len(views), count, 2))
    for across, (points, axis) in zip(flat, views, strict=True):
        u, v = perpendicular(axis)
        across[:, 0], across[:, 1] = points @ u, points @ v
    flat = flat - flat.mean(axis=1, keepdims=True)
    size = np.abs(flat).max(axis=(1, 2))
    wide = _wide(flat, size)
    inside = _inside(flat)
    corners = _convex(flat, size, inside) & wide
    return [
        np.flatnonzero(~within) if sure else _hull(places, large, spread, within)
        for sure, places, large, spread, within in zip(corners, flat, size.tolist(), wide.tolist(), inside, strict=True)
    ]


def _wide(flat: Array, size: Array) -> Flags:
    """(m,): which of the groups of points (m, n, 2) about their means, as large as `size` (m,), are in no line for
    certain: twice the least root mean square of their distances from one is more than what a line may be off."""
    x, y = flat[..., 0], flat[..., 1]
    xx, yy, xy = (x * x).mean(axis=1), (y * y).mean(axis=1), (x * y).mean(axis=1)
    least = 0.5 * (xx + yy - np.sqrt((xx - yy) ** 2 + 4.0 * xy**2))
    return np.asarray(least > (2.0 * SINGLE * size) ** 2)


def _hull(flat: Array, size: float, wide: bool, inside: Flags) -> Ints:
    """Indices, ascending, of the corners of the hull of points (n, 2) about their mean, as large as `size`; `wide`:
    in no line for certain; `inside` (n,): of it for certain."""
    if size == 0.0:
        return np.zeros(1, dtype=np.int64)
    if not wide:
        _, _, right = np.linalg.svd(flat, full_matrices=False)
        if float(np.abs(flat @ right[1]).max()) < SINGLE * size:
            along = flat @ right[0]
            return np.array(sorted((int(along.argmin()), int(along.argmax()))), dtype=np.int64)
    corners = _around(flat, np.flatnonzero(~inside))
    while len(corners) > 3:
        here = flat[corners]
        before, after = here[_before(len(here))], here[_after(len(here))]
        edge, arm = after - before, here - before
        out = np.abs(edge[:, 0] * arm[:, 1] - edge[:, 1] * arm[:, 0])
        k = int(np.argmin(out))
        if out[k] > SINGLE * size * max(float(np.hypot(*edge[k])), SINGLE * size):
            break
        corners = np.delete(corners, k)
    return np.sort(corners)


def _inside(flat: Array) -> Flags:
    """(m, n): which points of (m, n, 2) lie inside of the polygon of those that are farthest in `HULL_DIRECTIONS`."""
    ends = (flat @ _ROUND).argmax(axis=1)
    corners = np.take_along_axis(flat, ends[..., None], axis=1)
    edge = corners[:, _after(ends.shape[1])] - corners
    inside = (ends == ends[:, _after(ends.shape[1])])[:, None]
    for_x, for_y = (flat[..., k, None] - corners[:, None, :, k] for k in (0, 1))
    return np.asarray((inside | (edge[:, None, :, 0] * for_y - edge[:, None, :, 1] * for_x > 0.0)).all(axis=2))


def _convex(flat: Array, size: Array, inside: Flags) -> Flags:
    """(m,): of which groups of points (m, n, 2) all that are not `inside` (m, n) are corners of the hull for certain:
    each stands out from its neighbours, in the order about the mean, twice as far as a corner has to."""
    sure = np.zeros(len(flat), dtype=np.bool_)
    counts = np.count_nonzero(~inside, axis=1)
    for count in set(counts.tolist()) - {0, 1, 2}:
        members = np.flatnonzero(counts == count)
        outer = flat[members][~inside[members]].reshape(-1, count, 2)
        order = np.arctan2(outer[..., 1], outer[..., 0]).argsort(axis=1)
        here = np.take_along_axis(outer, order[..., None], axis=1)
        before, after = here[:, _before(count)], here[:, _after(count)]
        edge, arm = after - before, here - before
        out = arm[..., 0] * edge[..., 1] - arm[..., 1] * edge[..., 0]
        straight = SINGLE * size[members, None]
        far = out > 2.0 * straight * np.maximum(np.hypot(edge[..., 0], edge[..., 1]), straight)
        sure[members] = far.all(axis=1)
    return sure


def _around(flat: Array, outer: Ints) -> Ints:
    """Indices of the corners of the convex hull of points (n, 2) that are not all in line, anticlockwise, which are
    among the `outer`: the points in the order of x, and of each chain those that turn left (A. M. Andrew, Inf. Proc.
    Letters 9, 1979)."""
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
    """Normals (n, 3) of a ball that span the same cone: the rim of a cap, or ends in directions all round, which turn
    with the normals."""
    mean = normals.mean(axis=0)
    along = normals @ mean / max(norm(mean), TINY)
    if along.min() > CAP:
        return hull(normals / along[:, None], mean / norm(mean))
    ends = (_SPREAD @ turning_frame(normals)) @ normals.T
    return np.unique(ends.argmax(axis=1)).astype(np.int64)


def _spread(count: int) -> Array:
    """(count, 3) unit vectors, evenly over the sphere (a golden spiral)."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    turn = np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


_SPREAD = _spread(BALL_DIRECTIONS)
"""Directions in which the ends of a ball's normals are looked for."""
