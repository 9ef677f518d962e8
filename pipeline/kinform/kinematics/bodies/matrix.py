"""The assembly's constraint matrix J with the provenance of each row.

A row says n·(velocity of b − velocity of a) at one contact sample; J V ≥ 0 is the paper's
non-penetration condition, J V = 0 keeps the contact. Only the extreme samples of a patch matter
(a linear condition holds on a patch when it holds on its hull), so few rows stand for each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.screws import Frame, rows, scaled
from kinform.foundation.algebra.vectors import perpendicular
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, ConstraintMatrix, Joint

__all__ = ["assemble", "extreme_samples", "hull"]


SECTORS = 16
"""Sectors of normals about the axis of a curved patch with many samples; of each its ends are kept."""
FEW = 12
"""Patches with no more samples than this keep them all."""
ROUND = np.stack([np.cos(np.arange(16) * np.pi / 8), np.sin(np.arange(16) * np.pi / 8)])
"""(2, 16) directions whose ends are corners of a hull."""
STRAIGHT = 1e-6
"""Corners of a hull that stand out less than this share of its size are on an edge."""


def extreme_samples(patch: Patch) -> NDArray[np.int64]:
    """Indices of the samples that bound the patch, ascending: n·v ≥ 0 at these implies it at all samples.

    Exact for planes, lines and for cylinders and cones sampled on a grid. Of other curved patches with many
    samples the ends of sectors of normals are kept.
    """
    points = patch.points
    if patch.kind == "plane":
        return hull(points, patch.axis)
    if len(points) <= FEW or not (np.any(patch.axis) or patch.kind == "sphere"):
        return np.arange(len(points), dtype=np.int64)
    if patch.kind == "sphere":
        return _rim(patch.normals)
    u, v = perpendicular(patch.axis)
    angle = np.arctan2(patch.normals @ v, patch.normals @ u)
    height = points @ patch.axis
    sector = np.floor(angle / (2.0 * np.pi / SECTORS)).astype(int)
    turn = np.round(angle / 1e-6)
    level = np.round(height / (1e-6 * max(float(np.ptp(height)), 1e-300)))
    ends = [np.lexsort((p * level, q * turn, sector)) for p in (1.0, -1.0) for q in (1.0, -1.0)]
    ends += [np.lexsort((p * level, sector)) for p in (1.0, -1.0)]
    first = np.flatnonzero(np.diff(sector[ends[0]], prepend=sector.min() - 1))
    return np.unique(np.concatenate([order[first] for order in ends])).astype(np.int64)


def hull(points: Array, axis: Array) -> NDArray[np.int64]:
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
    if float(np.abs(flat @ right[1]).max()) < STRAIGHT * size:
        along = flat @ right[0]
        return np.array(sorted((int(along.argmin()), int(along.argmax()))), dtype=np.int64)
    corners = _around(flat)
    while len(corners) > 3:
        here, before, after = flat[corners], flat[np.roll(corners, 1)], flat[np.roll(corners, -1)]
        edge, arm = after - before, here - before
        out = np.abs(edge[:, 0] * arm[:, 1] - edge[:, 1] * arm[:, 0])
        k = int(np.argmin(out))
        if out[k] > STRAIGHT * size * max(float(np.hypot(*edge[k])), STRAIGHT * size):
            break
        corners = np.delete(corners, k)
    return np.sort(corners)


def _around(flat: Array) -> NDArray[np.int64]:
    """Indices of the corners of the convex hull of points (n, 2) that are not all in line, anticlockwise: the points in
    the order of x, and of each chain those that turn left (A. M. Andrew, Inf. Proc. Letters 9, 1979)."""
    ends = (flat @ ROUND).argmax(axis=0)
    ends = ends[ends != np.roll(ends, 1)]
    edge, arm = np.roll(flat[ends], -1, axis=0) - flat[ends], flat[:, None] - flat[ends]
    inside = (edge[:, 0] * arm[..., 1] - edge[:, 1] * arm[..., 0] > 0.0).all(axis=1)
    some = np.flatnonzero(~inside)
    some = some[np.lexsort((some, flat[some, 1], flat[some, 0]))]
    places = flat[some].tolist()

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
    return some[chain(range(last + 1)) + chain(range(last, -1, -1))]


def _rim(normals: Array) -> NDArray[np.int64]:
    """Normals (n, 3) of a ball that span the same cone: the rim of a cap, or ends in directions all round."""
    mean = normals.mean(axis=0)
    along = normals @ mean / max(float(np.linalg.norm(mean)), 1e-300)
    if along.min() > 1e-3:
        return hull(normals / along[:, None], mean / np.linalg.norm(mean))
    ends = SPREAD @ normals.T
    return np.unique(ends.argmax(axis=1)).astype(np.int64)


def _spread(count: int) -> Array:
    """(count, 3) unit vectors, evenly over the sphere (a golden spiral)."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    turn = np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


SPREAD = _spread(96)
"""Directions in which the ends of a ball's normals are looked for."""


def assemble(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    patches: Sequence[Patch],
    extremes: Mapping[int, NDArray[np.int64]] | None = None,
) -> ConstraintMatrix:
    """J of all patches between different bodies; the rows that carry a joint are made exactly
    consistent with its snapped freedoms. `extremes`: of patches, by index, whose extreme samples are known."""
    known = extremes or {}
    column = {part: k for k, body in enumerate(bodies) for part in body.parts}
    owner = {index: joint for joint in joints for index in joint.patches}
    used = [k for k, p in enumerate(patches) if column[p.parts[0]] != column[p.parts[1]] and len(p.points)]
    world = Frame.of(np.concatenate([patches[k].points for k in used])) if used else Frame(np.zeros(3), 1.0)
    samples = [known[k] if k in known else extreme_samples(patches[k]) for k in used]
    bounds = np.cumsum([0, *map(len, samples)])
    none = np.zeros((0, 3))
    own = rows(
        np.concatenate([none, *(patches[k].points[chosen] for k, chosen in zip(used, samples, strict=True))]),
        np.concatenate([none, *(patches[k].normals[chosen] for k, chosen in zip(used, samples, strict=True))]),
        world,
    )
    free = {joint.name: np.linalg.qr(scaled(joint.twists.T, world))[0] for joint in joints if joint.patches}
    for k, start, end in zip(used, bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        if k in owner:
            basis, mine = free[owner[k].name], own[start:end]
            own[start:end] = mine - (mine @ basis) @ basis.T
    counts = np.diff(bounds)
    ends = np.array([[column[part] for part in patches[k].parts] for k in used], dtype=np.int64).reshape(-1, 2)
    sign = np.repeat(np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0), counts)[:, None]
    index = 6 * np.sort(ends, axis=1)[:, :, None] + np.arange(6)
    return ConstraintMatrix(
        bodies=tuple(body.name for body in bodies),
        data=np.hstack([-sign * own, sign * own]).ravel(),
        indices=np.repeat(index.reshape(-1, 12), counts, axis=0).ravel(),
        indptr=12 * np.arange(bounds[-1] + 1, dtype=np.int64),
        patch=np.repeat(np.array(used, dtype=np.int64), counts),
        sample=np.concatenate([np.zeros(0, np.int64), *samples]),
        centre=world.centre,
        length=world.length,
    )
