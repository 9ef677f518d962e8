"""The cylinders of all parts where they stand, and which holes of two parts line up across a plane. World frame, SI."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import fields

import numpy as np

from kinform.contacts.constants import ROUND_SWEEP
from kinform.contacts.fastening.constants import AXES_PARALLEL
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Part
from kinform.model.contacts import Patch
from kinform.model.surfaces import MeshSurfaces

AXES_COAXIAL = 0.2
"""Distance, in contact tolerances, of axes that count as one. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Cylinders:
    """n round cylinders."""

    axes: Array
    points: Array
    """(n, 3) middle of each."""
    radii: Array
    halves: Array
    """(n,) m: half of the length."""
    sides: Ints
    """(n,) -1: holes."""

    def chosen(self, keep: Flags) -> Cylinders:
        """Some of them."""
        return Cylinders(self.axes[keep], self.points[keep], self.radii[keep], self.halves[keep], self.sides[keep])


@dataclass(frozen=True, eq=False)
class Holes:
    """n holes that go through a plane between two parts, on distinct axes."""

    axes: Array
    places: Array
    """(n, 3) where each axis meets the plane."""
    radii: Array
    """(n,) m: the larger of both sides."""


def cylinders_of(part: Part, surfaces: Mapping[str, MeshSurfaces]) -> Cylinders:
    """The cylinders of a meshed part that go all round."""
    assert part.mesh is not None
    recovered = surfaces.get(part.mesh.digest)
    every = recovered.surfaces if recovered is not None else ()
    round_ = [s for s in every if s.kind == "cylinder" and s.sweep >= ROUND_SWEEP]
    R_WP, p_WP = part.X_WP[:3, :3], part.X_WP[:3, 3]
    axes = np.array([s.axis for s in round_]).reshape(-1, 3)
    middles = np.array([s.point + 0.5 * sum(s.extent) * s.axis for s in round_]).reshape(-1, 3)
    return Cylinders(
        axes=axes @ R_WP.T,
        points=middles @ R_WP.T + p_WP,
        radii=np.array([s.radius for s in round_]),
        halves=np.array([0.5 * (s.extent[1] - s.extent[0]) for s in round_]),
        sides=np.array([s.side for s in round_], dtype=np.int64),
    )


def all_cylinders(parts: Iterable[Cylinders]) -> Cylinders:
    """All cylinders of several parts."""
    every = [c for c in parts if len(c.radii)]
    if not every:
        return Cylinders(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64))
    return Cylinders(*(np.concatenate([getattr(c, f.name) for c in every]) for f in fields(Cylinders)))


def aligned_holes(a: Cylinders, b: Cylinders, planes: Iterable[Patch], tolerance: float) -> Holes:
    """Holes of part a that go on in part b across one of their plane contacts."""
    if not ((a.sides < 0).any() and (b.sides < 0).any()):
        return Holes(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    axes: list[Array] = []
    places: list[Array] = []
    radii: list[float] = []
    first, second = a.chosen(a.sides < 0), b.chosen(b.sides < 0)
    for patch in planes:
        below = first.chosen(_opens(first, patch, tolerance, 1.0))
        above = second.chosen(_opens(second, patch, tolerance, -1.0))
        for i, j in _coaxial(below, above, AXES_COAXIAL * tolerance):
            axis, point = below.axes[i], below.points[i]
            place = point + float((patch.point - point) @ patch.axis) / float(axis @ patch.axis) * axis
            if all(_apart(axis, place, *other) > tolerance for other in zip(axes, places, strict=True)):
                axes.append(axis)
                places.append(place)
                radii.append(max(float(below.radii[i]), float(above.radii[j])))
    return Holes(np.array(axes).reshape(-1, 3), np.array(places).reshape(-1, 3), np.array(radii))


def _opens(holes: Cylinders, patch: Patch, tolerance: float, sense: float) -> Flags:
    """Which stand on the plane of a patch, open at it from below (`sense` 1, part a) or above, and lie in the
    circle round the patch."""
    if not len(holes.radii):
        return np.zeros(0, bool)
    upright = np.abs(holes.axes @ patch.axis) > math.cos(AXES_PARALLEL)
    depth = -sense * ((holes.points - patch.point) @ patch.axis)
    # Depth of a chamfer or countersink between a plane and the hole behind it, in radii of the hole: countersinks of
    # ISO 10642 and DIN 74 are about as deep as half of the hole. Chosen, not measured.
    starts = np.abs(depth - holes.halves) <= tolerance + 0.6 * holes.radii
    starts |= (np.abs(depth) < holes.halves) & (depth + holes.halves > tolerance)
    low, high = patch.points.min(axis=0), patch.points.max(axis=0)
    beside = holes.points - 0.5 * (low + high)
    beside = beside - (beside @ patch.axis)[:, None] * patch.axis
    reach = 0.5 * float(np.linalg.norm(high - low))
    return np.asarray(upright & starts & (np.linalg.norm(beside, axis=1) <= reach + holes.radii))


def _coaxial(a: Cylinders, b: Cylinders, distance: float) -> list[tuple[int, int]]:
    """Each of a's with the nearest in radius of b's on its axis."""
    if not len(a.radii) or not len(b.radii):
        return []
    gap = b.points[None] - a.points[:, None]
    gap = gap - np.einsum("ijk,ik->ij", gap, a.axes)[:, :, None] * a.axes[:, None]
    on = (np.abs(a.axes @ b.axes.T) > math.cos(AXES_PARALLEL)) & (np.linalg.norm(gap, axis=2) <= distance)
    unlike = np.where(on, np.abs(b.radii[None] - a.radii[:, None]), np.inf)
    return [(int(i), int(np.argmin(unlike[i]))) for i in np.flatnonzero(on.any(axis=1))]


def _apart(axis: Array, place: Array, other_axis: Array, other_place: Array) -> float:
    """Distance of two places across their axis: steps of a hole, and a hole through two walls, are one."""
    if abs(float(axis @ other_axis)) < math.cos(AXES_PARALLEL):
        return math.inf
    return aside(place, other_place, axis)


def aside(place: Array, other: Array, axis: Array) -> float:
    """Distance of two places across an axis."""
    offset = other - place
    return float(np.linalg.norm(offset - float(offset @ axis) * axis))


def occupied(holes: Holes, cylinders: Cylinders, tolerance: float) -> Flags:
    """(n,) whether one of these cylinders is a shaft that stands in the hole."""
    shafts = cylinders.chosen(cylinders.sides > 0)
    if not len(shafts.radii) or not len(holes.radii):
        return np.zeros(len(holes.radii), bool)
    offset = shafts.points[None] - holes.places[:, None]
    along = np.einsum("ijk,ik->ij", offset, holes.axes)
    off = np.linalg.norm(offset - along[:, :, None] * holes.axes[:, None], axis=2)
    # a hole and the shaft in it are within 8° of parallel
    inside = (np.abs(holes.axes @ shafts.axes.T) > 0.99) & (off <= holes.radii[:, None])
    inside &= shafts.radii[None] <= holes.radii[:, None] + tolerance
    return np.asarray((inside & (np.abs(along) <= shafts.halves[None] + holes.radii[:, None])).any(axis=1))
