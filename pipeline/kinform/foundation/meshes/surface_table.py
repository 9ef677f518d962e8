"""Surfaces of one mesh as arrays, so that a pair picks the few that it needs."""

from __future__ import annotations

from dataclasses import fields
from functools import cached_property
from operator import attrgetter

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.surfaces import KINDS, MeshSurfaces

_NUMBER = {kind: number for number, kind in enumerate(KINDS)}
PLANE, CYLINDER, CONE, SPHERE, TORUS = (_NUMBER[kind] for kind in ("plane", "cylinder", "cone", "sphere", "torus"))
"""Numbers of kinds in `SurfaceTable.kinds`."""

_SCALARS = (
    "radius", "minor_radius", "half_angle", "pitch", "side", "axis_uncertainty", "point_uncertainty", "chord",
    "residual", "area",
)  # fmt: skip
_scalars = attrgetter(*_SCALARS)


@dataclass(frozen=True, eq=False)
class SurfaceTable:
    """Columns over s surfaces (m, rad), of a mesh in its part frame unless said otherwise."""

    kinds: Ints
    """(s,) index into KINDS."""
    axes: Array
    """(s, 3)."""
    points: Array
    """(s, 3)."""
    radii: Array
    minor_radii: Array
    """(s,) of the tubes of tori."""
    half_angles: Array
    pitches: Array
    """(s,) a turn of helicoids."""
    sides: Array
    axis_uncertainty: Array
    point_uncertainty: Array
    slacks: Array
    """(s,) that facets may stand off the surface: chord error and residual of the fit."""
    chords: Array
    residuals: Array
    rims: Array
    """(s,) greatest chord error of the surfaces that share an edge with this one."""
    extents: Array
    """(s, 2) along the axis from the point."""
    areas: Array
    """(s,) m² of the whole surface."""

    @staticmethod
    def of(surfaces: MeshSurfaces, rims: Array) -> SurfaceTable:
        """The table of the surfaces; `rims` (s,) as above."""
        every = surfaces.surfaces
        numbers = np.array([_scalars(s) for s in every], dtype=np.float64).reshape(-1, len(_SCALARS)).T
        columns = dict(zip(_SCALARS, np.ascontiguousarray(numbers), strict=True))
        return SurfaceTable(
            kinds=np.array([_NUMBER[s.kind] for s in every], dtype=np.int64),
            axes=_rows([s.axis for s in every]),
            points=_rows([s.point for s in every]),
            radii=columns["radius"],
            minor_radii=columns["minor_radius"],
            half_angles=columns["half_angle"],
            pitches=columns["pitch"],
            sides=columns["side"],
            axis_uncertainty=columns["axis_uncertainty"],
            point_uncertainty=columns["point_uncertainty"],
            slacks=columns["chord"] + columns["residual"],
            chords=columns["chord"],
            residuals=columns["residual"],
            rims=rims,
            extents=np.array([end for s in every for end in s.extent], dtype=np.float64).reshape(-1, 2),
            areas=columns["area"],
        )

    def placed(self, ids: Ints, X_FP: Array) -> dict[str, Array]:
        """The columns of some surfaces, by name, at the pose `X_FP` (4, 4)."""
        columns = dict(zip(_NUMBERS, self._numbers.take(ids, axis=1), strict=True))
        columns["kinds"], columns["extents"] = self.kinds.take(ids), self.extents.take(ids, axis=0)
        columns["axes"] = self.axes.take(ids, axis=0) @ X_FP[:3, :3].T
        columns["points"] = self.points.take(ids, axis=0) @ X_FP[:3, :3].T + X_FP[:3, 3]
        return columns

    @cached_property
    def _numbers(self) -> Array:
        """(k, s) the columns `_NUMBERS`, so that some surfaces of all are taken at once."""
        return np.stack([getattr(self, name) for name in _NUMBERS])

    @cached_property
    def slack(self) -> float:
        """The greatest of `slacks`."""
        return float(self.slacks.max(initial=0.0))

    @cached_property
    def radius(self) -> float:
        """The greatest of `radii`."""
        return float(self.radii.max(initial=0.0))


def _rows(vectors: list[Array]) -> Array:
    """(s, 3) of vectors (3,): numpy joins arrays ten times as fast as it looks into a list of them."""
    return np.concatenate(vectors).reshape(-1, 3) if vectors else np.zeros((0, 3))


_NUMBERS = tuple(
    field.name for field in fields(SurfaceTable) if field.name not in ("kinds", "axes", "points", "extents")
)
"""Columns of one number a surface."""
