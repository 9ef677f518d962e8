"""The cylinders of all parts where they stand, and which of them line up across a plane. World frame, SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.model.assembly import Assembly, Part
from kinform.model.contacts import Patch
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

__all__ = ["Cylinders", "cylinders_of", "lined_up", "occupied"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PARALLEL = math.radians(0.5)
"""Greatest angle between two axes that line up."""
WHOLE = 0.9 * 2 * math.pi
"""Least sweep of a hole or a rim."""


@dataclass(frozen=True, eq=False)
class Cylinders:
    """n round cylinders of one part."""

    axes: Array
    points: Array
    """(n, 3) middle of each."""
    radii: Array
    halves: Array
    """(n,) m: half of the length."""
    sides: NDArray[np.int64]
    """(n,) -1: holes."""

    def chosen(self, keep: Flags) -> Cylinders:
        """Some of them."""
        return Cylinders(self.axes[keep], self.points[keep], self.radii[keep], self.halves[keep], self.sides[keep])


def cylinders_of(assembly: Assembly, surfaces: Mapping[str, MeshSurfaces]) -> dict[PartName, Cylinders]:
    """The cylinders that go all round, of every meshed part."""
    return {part.name: _placed(part, surfaces) for part in assembly.parts if part.mesh is not None}


def _placed(part: Part, surfaces: Mapping[str, MeshSurfaces]) -> Cylinders:
    assert part.mesh is not None
    found = surfaces.get(part.mesh.digest)
    round_ = [s for s in found.surfaces if s.kind == "cylinder" and s.sweep >= WHOLE] if found is not None else []
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


def _across(cylinders: Cylinders, patch: Patch, tolerance: float) -> Flags:
    """Which stand on the plane of a patch, end at it or pass through it, and are beside the patch's middle."""
    if not len(cylinders.radii):
        return np.zeros(0, bool)
    upright = np.abs(cylinders.axes @ patch.axis) > math.cos(PARALLEL)
    height = np.abs((cylinders.points - patch.point) @ patch.axis)
    reaches = height <= cylinders.halves + tolerance + 0.6 * cylinders.radii
    offset = patch.points - patch.point
    extent = float(np.sqrt((offset**2).sum(axis=1).max(initial=0.0)))
    beside = cylinders.points - patch.point
    beside = beside - (beside @ patch.axis)[:, None] * patch.axis
    return np.asarray(upright & reaches & (np.linalg.norm(beside, axis=1) <= extent + cylinders.radii))


def lined_up(
    a: Cylinders, b: Cylinders, patch: Patch, tolerance: float
) -> list[tuple[int, int, Array]]:  # fmt: skip
    """(index in a, index in b, where the axis meets the plane) of cylinders of both parts that are coaxial and
    stand on a plane patch. Each of a's with the nearest in radius of b's."""
    rows, columns = np.flatnonzero(_across(a, patch, tolerance)), np.flatnonzero(_across(b, patch, tolerance))
    if not len(rows) or not len(columns):
        return []
    parallel = np.abs(a.axes[rows] @ b.axes[columns].T) > math.cos(PARALLEL)
    gap = b.points[columns][None] - a.points[rows][:, None]
    gap = gap - np.einsum("ijk,ik->ij", gap, a.axes[rows])[:, :, None] * a.axes[rows][:, None]
    coaxial = parallel & (np.linalg.norm(gap, axis=2) <= 0.2 * tolerance)
    out = []
    for i in np.flatnonzero(coaxial.any(axis=1)):
        fits = np.flatnonzero(coaxial[i])
        j = fits[np.argmin(np.abs(b.radii[columns[fits]] - a.radii[rows[i]]))]
        axis, point = a.axes[rows[i]], a.points[rows[i]]
        height = float((patch.point - point) @ patch.axis) / float(axis @ patch.axis)
        out.append((int(rows[i]), int(columns[j]), point + height * axis))
    return out


def occupied(hole: tuple[Array, Array, float], others: list[Cylinders], tolerance: float) -> bool:
    """Whether a shaft stands in a hole: axis, a point of it, radius."""
    axis, point, radius = hole
    for shafts in others:
        if not len(shafts.radii):
            continue
        offset = shafts.points - point
        along = offset @ axis
        aside = np.linalg.norm(offset - along[:, None] * axis, axis=1)
        inside = (shafts.sides > 0) & (np.abs(shafts.axes @ axis) > 0.99) & (aside <= radius)
        if (inside & (shafts.radii <= radius + tolerance) & (np.abs(along) <= shafts.halves + radius)).any():
            return True
    return False
