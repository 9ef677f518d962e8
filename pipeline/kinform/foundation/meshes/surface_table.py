"""Surfaces of one mesh as arrays, so that a pair picks the few that it needs."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from kinform.model.arrays import Array, Ints
from kinform.model.surfaces import KINDS, MeshSurfaces


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
    rims: Array
    """(s,) greatest chord error of the surfaces that share an edge with this one."""
    extents: Array
    """(s, 2) along the axis from the point."""
    areas: Array
    """(s,) m² of the whole surface."""

    @staticmethod
    def of(surfaces: MeshSurfaces, rims: Array) -> SurfaceTable:
        """The table of the surfaces; `rims` (s,) as above."""
        number = {kind: k for k, kind in enumerate(KINDS)}

        def column(name: str, *width: int) -> Array:
            return np.array([getattr(s, name) for s in surfaces.surfaces], dtype=np.float64).reshape(-1, *width)

        return SurfaceTable(
            kinds=np.array([number[s.kind] for s in surfaces.surfaces], dtype=np.int64),
            axes=column("axis", 3),
            points=column("point", 3),
            radii=column("radius"),
            minor_radii=column("minor_radius"),
            half_angles=column("half_angle"),
            pitches=column("pitch"),
            sides=column("side"),
            axis_uncertainty=column("axis_uncertainty"),
            point_uncertainty=column("point_uncertainty"),
            slacks=column("chord") + column("residual"),
            chords=column("chord"),
            rims=rims,
            extents=column("extent", 2),
            areas=column("area"),
        )

    def placed(self, ids: Ints, X_FP: Array) -> dict[str, Array]:
        """The columns of some surfaces, by name, at the pose `X_FP` (4, 4)."""
        columns = {field.name: getattr(self, field.name)[ids] for field in fields(SurfaceTable)}
        columns["axes"] = columns["axes"] @ X_FP[:3, :3].T
        columns["points"] = columns["points"] @ X_FP[:3, :3].T + X_FP[:3, 3]
        return columns

    @property
    def slack(self) -> float:
        """The greatest of `slacks`."""
        return float(self.slacks.max(initial=0.0))

    @property
    def radius(self) -> float:
        """The greatest of `radii`."""
        return float(self.radii.max(initial=0.0))
