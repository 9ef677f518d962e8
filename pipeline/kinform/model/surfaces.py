"""Analytic surfaces recovered from the facets of one mesh, in its part frame (m, rad)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Array

__all__ = ["KINDS", "MeshSurfaces", "Surface"]


KINDS = (
    "plane", "cylinder", "cone", "sphere", "torus", "helicoid", "revolution", "extrusion", "freeform",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Surface:
    """One analytic surface.

    plane: `axis` is the outward normal, `point` on it. cylinder: `axis`, `point` on the axis,
    `radius`. cone: `axis` from the apex into the nappe, `point` the apex, `half_angle`.
    sphere: `point` the centre, `radius`, `axis` zero. torus: `axis`, `point` the centre, `radius` of the
    middle circle, `minor_radius` of the tube, `side` that of the tube. revolution and helicoid: `axis`, `point`
    on it, `radius` the mean distance from it. extrusion: `axis` its direction. freeform: all zero.
    """

    kind: str
    axis: Array
    """(3,) unit, or zero where the kind has none."""
    point: Array
    """(3,) m; for cylinders the point of the axis beside the middle of the extent."""
    radius: float
    half_angle: float
    side: int
    """+1: material inside (shaft, ball, plane); −1: material outside (bore, socket)."""
    area: float
    """m², of the facets."""
    extent: tuple[float, float]
    """Range along `axis` from `point` (m); (0, 0) where the kind has none."""
    sweep: float
    """Angle about the axis that the facets cover (rad, up to 2π); 0 where the kind has none."""
    residual: float
    """Largest distance of a defining vertex from the surface (m)."""
    axis_uncertainty: float
    """rad: residual and rounding over the extent that determines the direction."""
    point_uncertainty: float
    """m: of `point` across the axis (centre for spheres; along the normal for planes)."""
    chord: float
    """m: greatest distance of a facet from the surface (sagitta)."""
    faces: NDArray[np.int64]
    """Facet indices, ascending."""
    minor_radius: float = 0.0
    """m: of the tube of a torus, whose `radius` is that of the circle in the tube's middle."""
    pitch: float = 0.0
    """m a turn of a helicoid, right-handed positive."""


@dataclass(frozen=True, eq=False)
class MeshSurfaces:
    """The surfaces of one mesh; every facet belongs to exactly one."""

    digest: str
    """Digest of the mesh."""
    surfaces: tuple[Surface, ...]
    """In a fixed order: by descending area, then by lowest facet index."""
    labels: NDArray[np.int64]
    """(F,) index of the surface of each facet."""
    noise: float
    """m: estimated scatter of the vertices about their surfaces."""
