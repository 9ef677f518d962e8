"""The surfaces of one mesh as arrays, so that a pair picks the few that it needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.model.surfaces import KINDS, MeshSurfaces

__all__ = ["SurfaceTable"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SurfaceTable:
    """Columns over the s surfaces of a mesh, in its part frame (m, rad)."""

    kinds: Ints
    """(s,) index into KINDS."""
    axes: Array
    """(s, 3)."""
    points: Array
    """(s, 3)."""
    radii: Array
    half_angles: Array
    sides: Array
    axis_uncertainty: Array
    point_uncertainty: Array
    slacks: Array
    """(s,) m that facets may stand off the surface: chord error and residual of the fit."""
    chords: Array
    rims: Array
    """(s,) m: greatest chord error of the surfaces that share an edge with this one."""
    extents: Array
    """(s, 2) m along the axis from the point."""
    areas: Array
    """(s,) m² of the whole surface."""
    pitches: Array
    """(s,) m a turn of helicoids."""
    minor_radii: Array
    """(s,) m, of tori."""
    slack: float
    """The greatest of `slacks`."""
    radius: float
    """The greatest of `radii`."""

    @staticmethod
    def of(surfaces: MeshSurfaces, rims: Array) -> SurfaceTable:
        """The table of the surfaces; `rims` (s,) as above."""
        all_ = surfaces.surfaces
        number = {kind: k for k, kind in enumerate(KINDS)}

        def column(name: str) -> Array:
            return np.array([getattr(s, name) for s in all_], dtype=np.float64)

        def stacked(name: str, width: int) -> Array:
            return np.array([getattr(s, name) for s in all_], dtype=np.float64).reshape(-1, width)

        radii, slacks = column("radius"), column("chord") + column("residual")
        return SurfaceTable(
            kinds=np.array([number[s.kind] for s in all_], dtype=np.int64),
            axes=stacked("axis", 3),
            points=stacked("point", 3),
            radii=radii,
            half_angles=column("half_angle"),
            sides=column("side"),
            axis_uncertainty=column("axis_uncertainty"),
            point_uncertainty=column("point_uncertainty"),
            slacks=slacks,
            chords=column("chord"),
            rims=rims,
            extents=stacked("extent", 2),
            areas=column("area"),
            pitches=column("pitch"),
            minor_radii=column("minor_radius"),
            slack=float(slacks.max(initial=0.0)),
            radius=float(radii.max(initial=0.0)),
        )
