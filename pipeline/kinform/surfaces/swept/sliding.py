"""Surfaces of revolution, extrusions and helicoids among what no simpler surface explains.

They are the surfaces that slide on themselves in one way: a turn, a translation, a screw (see `slippage`). Several
ways at once mean a simpler kind that was refused before; none means freeform.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import canonical_sign, cross, dot
from kinform.foundation.constants import COVERAGE
from kinform.foundation.graphs.components import components
from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.model.arrays import Array, Ints
from kinform.surfaces.describe import Description
from kinform.surfaces.groups import group_moments, members, sums_of
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.slippage import Slippage, slippage

STILL = 6e-3
"""Root mean square of the normals' share of the speed of a motion (patch of radius 1) below which the patch slides
along itself: 0.3°, which the normals of facets scatter by. Chosen, not measured."""
ACROSS = 0.1
"""Least spread of the normals of an extrusion about its direction: less is flat. Chosen, not measured."""
TURNS = 0.15
"""Share of rotation in a motion (patch of radius 1) above which it is a rotation. Chosen, not measured."""


def sliding(work: Patchwork, number: Ints, scales: Scales) -> list[Description]:
    """Patches of polygons (P,) of one or more meshes, -1 for none, that slide on themselves in one way; the others are
    left out."""
    rounding = scales.rounding[work.mesh]
    # fewer polygons show no motion
    large = [patch for patch in members(number) if len(patch) >= 12]
    extrusions = _extrusions(work, large, rounding)
    out = [extrusion for extrusion in extrusions if extrusion]
    left = [patch for patch, extrusion in zip(large, extrusions, strict=True) if not extrusion]
    single = _turning(work, left, rounding)
    out += [surface for surface in single if surface is not None]
    # the flanks of a thread are each too narrow to tell a screw from a tilt: together they do
    rest = [patch for patch, surface in zip(left, single, strict=True) if surface is None]
    pooled = [np.sort(np.concatenate([rest[k] for k in group])) for group in _together(work, rest)]
    return out + [surface for surface in _turning(work, pooled, rounding) if surface and surface.kind == "helicoid"]


def _extrusions(work: Patchwork, patches: list[Ints], rounding: Array) -> list[Description | None]:
    """Those of the patches that are extrusions: all normals stand across one direction, and lie in no plane with it."""
    if not patches:
        return []
    count, polygon = len(patches), np.concatenate(patches)
    patch = np.repeat(np.arange(count), [len(polygons) for polygons in patches])
    normal, weight = work.normals(polygon), work.area[polygon]
    sums = sums_of(patch, count)
    total = sums(weight)
    values, vectors = np.linalg.eigh(group_moments(patch, normal.T, count, weight) / total[:, None, None])
    spread = np.sqrt(np.maximum(values[:, 1], 0.0))
    # the root of the least value would be that of its rounding where normals stand exactly across
    along = dot(normal, vectors[:, :, 0].take(patch, axis=0))
    speed = np.sqrt(sums(weight * along * along) / total)
    slides = (speed < STILL) & (spread > ACROSS)
    return [
        _extrusion(work, polygons, vectors[k, :, 0], float(speed[k]), float(spread[k]), float(rounding[polygons[0]]))
        if slides[k]
        else None
        for k, polygons in enumerate(patches)
    ]


def _extrusion(
    work: Patchwork, polygons: Ints, direction: Array, speed: float, spread: float, rounding: float
) -> Description:
    """The patch as an extrusion along this direction, where its normals have these deviations along it and across."""
    axis, weight = direction * canonical_sign(direction), work.area[polygons]
    middle = weight @ work.centre[polygons] / weight.sum()
    _, vertex = work.corners.expand(polygons)
    span = (work.vertices[vertex] - middle) @ axis
    length = max(float(np.ptp(span)), ARITHMETIC)
    angular = float(min(COVERAGE * (speed + rounding / length) / spread, np.pi / 2))
    return Description(
        "extrusion", polygons, axis, middle, extent=(float(span.min()), float(span.max())),
        axis_uncertainty=angular, point_uncertainty=angular * length,
    )  # fmt: skip


def _turning(work: Patchwork, patches: list[Ints], rounding: Array) -> list[Description | None]:
    """What turns or screws into itself in one way only, for each of the patches."""
    if not patches:
        return []
    patch = np.repeat(np.arange(len(patches)), [len(polygons) for polygons in patches])
    motion = slippage(work, patch, np.concatenate(patches), len(patches))
    # Least ratio to the next motion: what nearly slides in two ways is too flat to tell. Chosen, not measured.
    unique = (motion.speed < STILL) & (motion.next_speed > 5.0 * np.maximum(motion.speed, STILL / 2))
    return [
        _surface_of_turn(work, polygons, motion, k, float(rounding[polygons[0]])) if unique[k] else None
        for k, polygons in enumerate(patches)
    ]


def _together(work: Patchwork, patches: list[Ints]) -> list[Ints]:
    """Sets of two or more patches of one mesh whose boxes nearly agree."""
    of_mesh = work.mesh[[polygons[0] for polygons in patches]] if patches else np.zeros(0, np.int64)
    return [mine[group] for mine in members(of_mesh) for group in _agreeing(work, [patches[k] for k in mine])]


def _agreeing(work: Patchwork, patches: list[Ints]) -> list[Ints]:
    """The same among patches of one mesh."""
    if len(patches) < 2:
        return []
    low = np.array([work.centre[polygons].min(axis=0) for polygons in patches])
    high = np.array([work.centre[polygons].max(axis=0) for polygons in patches])
    shared = np.minimum(high[:, None], high[None]) - np.maximum(low[:, None], low[None])
    joint = np.maximum(high[:, None], high[None]) - np.minimum(low[:, None], low[None])
    # two patches of one thread share most of their box along each axis
    agree = (shared > 0.6 * joint).all(axis=2)
    a, b = np.nonzero(np.triu(agree, 1))
    return [group for group in members(components(a, b, len(patches))) if len(group) > 1]


def _surface_of_turn(work: Patchwork, polygons: Ints, motion: Slippage, k: int, rounding: float) -> Description | None:
    """What the k-th motion makes of its patch: its kind with axis, point, pitch, and uncertainty."""
    turning, size = float(np.linalg.norm(motion.angular[k])), float(motion.size[k])
    if turning < TURNS:
        return None
    gained = max(float(motion.next_speed[k]), ARITHMETIC)
    angular = float(min(COVERAGE * (motion.speed[k] + rounding / size) / gained, np.pi / 2))
    axis, moment = motion.angular[k] / turning, motion.linear[k] / turning
    point = motion.middle[k] + cross(axis, moment) * size
    advance = float(axis @ moment) * size
    axis = axis * canonical_sign(axis)
    arm = work.centre[polygons] - point
    span = arm @ axis
    radial = arm - span[:, None] * axis
    rho = np.linalg.norm(radial, axis=1)
    radius = float(np.average(rho, weights=work.area[polygons]))
    outward = np.average(dot(work.normal[polygons], radial) / np.maximum(rho, TINY), weights=work.area[polygons])
    # Advance a radian, in radii of the patch about the axis, below which a rotation is no screw. Chosen, not measured.
    screws = abs(advance) > 0.01 * radius
    return Description(
        "helicoid" if screws else "revolution", polygons, axis, point, radius=radius, side=1 if outward >= 0 else -1,
        extent=(float(span.min()), float(span.max())), axis_uncertainty=angular, point_uncertainty=angular * size,
        pitch=2 * np.pi * advance if screws else 0.0,
    )  # fmt: skip
