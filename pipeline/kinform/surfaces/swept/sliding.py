"""Surfaces of revolution, extrusions and helicoids among what no simpler surface explains.

They are the surfaces that slide on themselves in one way: a turn, a translation, a screw. For patches of
polygons that motion is the null vector of Σ w [q × n; n][q × n; n]ᵀ over middles q and normals n (Pottmann and
Randrup 1998; Gelfand and Guibas 2004). Several ways at once mean a simpler kind that was refused before; none
means freeform.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.components import components
from kinform.model.arrays import Array, Ints
from kinform.surfaces.describe import COVERAGE, Description, canonical
from kinform.surfaces.groups import group_sum
from kinform.surfaces.polygons.patchwork import Patchwork, Scale

__all__ = ["sliding"]

LEAST = 12
"""Polygons that show a motion, at least."""
STILL = 6e-3
"""Root mean square of the normals' share of the motion's speed (patch of radius 1) below which it slides."""
UNIQUE = 5.0
"""Ratio to the next motion, at least: what slides in two ways nearly is too flat to tell."""
TURNS = 0.15
"""Share of turning in a motion (patch of radius 1) above which it is a turn."""
AGREE = 0.6
"""Share of their common box, along each axis, that two patches of one thread share."""
ADVANCE = 0.01
"""Advance a radian, in radii of the patch about the axis, below which a turn is no screw."""


@dataclass(frozen=True, eq=False)
class _Motions:
    """The most sliding motion of each of n patches."""

    middle: Array
    size: Array
    angular: Array
    linear: Array
    """(n, 3), of a patch of radius 1 about its middle."""
    speed: Array
    next_speed: Array


def _motions(work: Patchwork, patch: Ints, polygon: Ints, count: int) -> _Motions:
    normal, weight = work.normal[polygon], work.area[polygon]
    total = np.maximum(np.bincount(patch, weight, count), 1e-300)
    middle = group_sum(patch, work.centre[polygon] * weight[:, None], count) / total[:, None]
    offset = work.centre[polygon] - middle[patch]
    size = np.sqrt(np.bincount(patch, weight * np.einsum("ij,ij->i", offset, offset), count) / total)
    size = np.maximum(size, 1e-12)
    rows = np.concatenate([cross(offset / size[patch][:, None], normal), normal], axis=1)
    matrix: Array = np.empty((count, 6, 6))
    for i in range(6):
        for j in range(i, 6):
            matrix[:, i, j] = matrix[:, j, i] = np.bincount(patch, weight * rows[:, i] * rows[:, j], count) / total
    values, vectors = np.linalg.eigh(np.nan_to_num(matrix))
    speed = np.sqrt(np.maximum(values, 0.0))
    return _Motions(middle, size, vectors[:, :3, 0], vectors[:, 3:, 0], speed[:, 0], speed[:, 1])


def sliding(work: Patchwork, number: Ints, scale: Scale) -> list[Description]:
    """Patches of polygons (P,), -1 for none, that slide on themselves in one way; the others are left out."""
    member = np.flatnonzero(number >= 0)
    _, patch, size = np.unique(number[member], return_inverse=True, return_counts=True)
    large = size[patch] >= LEAST
    member, patch = member[large], patch[large]
    if not len(member):
        return []
    _, patch = np.unique(patch, return_inverse=True)
    out, left = [], []
    for own in _split(patch, member):
        straight = _straight(work, own)
        if straight is not None:
            out.append(_extruded(work, own, *straight, scale))
        else:
            left.append(own)
    single = _turned(work, left, scale)
    out += [found for found in single if found is not None]
    # the flanks of a thread are each too narrow to tell a screw from a tilt: together they do
    rest = [own for own, found in zip(left, single, strict=True) if found is None]
    pooled = [np.sort(np.concatenate([rest[k] for k in group])) for group in _together(work, rest)]
    out += [found for found in _turned(work, pooled, scale) if found is not None and found.kind == "helicoid"]
    return out


def _split(patch: Ints, polygon: Ints) -> list[Ints]:
    order = np.argsort(patch, kind="stable")
    return list(np.split(polygon[order], np.flatnonzero(np.diff(patch[order])) + 1))


def _straight(work: Patchwork, polygons: Ints) -> tuple[Array, float, float] | None:
    """(direction, how nearly all normals stand across it, how far they are from lying in one plane with it)."""
    normal, weight = work.normal[polygons], work.area[polygons]
    values, vectors = np.linalg.eigh((normal * weight[:, None]).T @ normal / weight.sum())
    speed = np.sqrt(np.maximum(values, 0.0))
    return (vectors[:, 0], float(speed[0]), float(speed[1])) if speed[0] < STILL and speed[1] > 0.1 else None


def _extruded(work: Patchwork, polygons: Ints, axis: Array, speed: float, spread: float, scale: Scale) -> Description:
    axis = axis * canonical(axis)
    weight = work.area[polygons]
    middle = weight @ work.centre[polygons] / weight.sum()
    _, vertex = work.corners.expand(polygons)
    span = (work.vertices[vertex] - middle) @ axis
    length = max(float(np.ptp(span)), 1e-12)
    angular = float(min(COVERAGE * (speed + scale.rounding / length) / spread, np.pi / 2))
    return Description(
        "extrusion", polygons, axis, middle, extent=(float(span.min()), float(span.max())),
        axis_uncertainty=angular, point_uncertainty=angular * length,
    )  # fmt: skip


def _turned(work: Patchwork, patches: list[Ints], scale: Scale) -> list[Description | None]:
    """What turns or screws into itself in one way only, for each of the patches."""
    if not patches:
        return []
    patch = np.repeat(np.arange(len(patches)), [len(own) for own in patches])
    found = _motions(work, patch, np.concatenate(patches), len(patches))
    unique = (found.speed < STILL) & (found.next_speed > UNIQUE * np.maximum(found.speed, STILL / 2))
    return [_described(work, own, found, k, scale) if unique[k] else None for k, own in enumerate(patches)]


def _together(work: Patchwork, patches: list[Ints]) -> list[list[int]]:
    """Sets of two or more patches whose boxes nearly agree."""
    if len(patches) < 2:
        return []
    low = np.array([work.centre[own].min(axis=0) for own in patches])
    high = np.array([work.centre[own].max(axis=0) for own in patches])
    shared = np.minimum(high[:, None], high[None]) - np.maximum(low[:, None], low[None])
    joint = np.maximum(high[:, None], high[None]) - np.minimum(low[:, None], low[None])
    agree = (shared > AGREE * joint).all(axis=2)
    a, b = np.nonzero(np.triu(agree, 1))
    label = components(a, b, len(patches))
    return [np.flatnonzero(label == k).tolist() for k in np.unique(label) if (label == k).sum() > 1]


def _described(work: Patchwork, polygons: Ints, found: _Motions, k: int, scale: Scale) -> Description | None:
    """What a motion makes of a patch: its kind with axis, point, pitch, and uncertainty."""
    turning = float(np.linalg.norm(found.angular[k]))
    gained = max(float(found.next_speed[k]), 1e-12)
    angular = float(min(COVERAGE * (found.speed[k] + scale.rounding / found.size[k]) / gained, np.pi / 2))
    linear = angular * float(found.size[k])
    facets = work.normal[polygons]
    if turning < TURNS:
        return None
    axis, moment = found.angular[k] / turning, found.linear[k] / turning
    advance = float(axis @ moment)
    point = found.middle[k] + np.cross(axis, moment) * found.size[k]
    sense = canonical(axis)
    axis = axis * sense
    arm = work.centre[polygons] - point
    span = arm @ axis
    radial = arm - span[:, None] * axis
    rho = np.linalg.norm(radial, axis=1)
    radius = float(np.average(rho, weights=work.area[polygons]))
    outward = float(
        np.average(np.einsum("ij,ij->i", facets, radial) / np.maximum(rho, 1e-300), weights=work.area[polygons])
    )
    pitch = advance * found.size[k]
    kind = "helicoid" if abs(pitch) > ADVANCE * radius else "revolution"
    return Description(
        kind, polygons, axis, point, radius=radius, side=1 if outward >= 0 else -1,
        extent=(float(span.min()), float(span.max())), axis_uncertainty=angular, point_uncertainty=linear,
        pitch=2 * np.pi * pitch if kind == "helicoid" else 0.0,
    )  # fmt: skip
