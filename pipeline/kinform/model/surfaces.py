"""Analytic surfaces recovered from the facets of one mesh, in its part frame (m, rad)."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from kinform.frozen import dataclass
from kinform.model.arrays import Ints
from kinform.model.quantities import Direction, Metres, Place, Radians, SquareMetres, columns

SurfaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus", "helicoid", "revolution", "extrusion", "freeform"]
KINDS: tuple[SurfaceKind, ...] = get_args(SurfaceKind)
"""All kinds; tables have the index into these."""


@dataclass(frozen=True, eq=False)
class Surface:
    """One analytic surface.

    plane: `axis` is the outward normal, `point` on it. cylinder: `axis`, `point` on the axis,
    `radius`. cone: `axis` from the apex into the nappe, `point` the apex, `half_angle`.
    sphere: `point` the centre, `radius`, `axis` zero. torus: `axis`, `point` the centre, `radius` of the
    middle circle, `minor_radius` of the tube, `side` that of the tube. revolution and helicoid: `axis`, `point`
    on it, `radius` the mean distance from it. extrusion: `axis` its direction. freeform: all zero.
    """

    kind: SurfaceKind
    axis: Direction
    """(3,) unit, or zero where the kind has none."""
    point: Place
    """(3,) m; for cylinders the point of the axis beside the middle of the extent."""
    radius: Metres
    half_angle: Radians
    side: int
    """+1: material inside (shaft, ball, plane); −1: material outside (bore, socket)."""
    area: SquareMetres
    """m², of the facets."""
    extent: Annotated[tuple[float, float], "m", columns("extent_from", "extent_to")]
    """Range along `axis` from `point` (m); (0, 0) where the kind has none."""
    sweep: Radians
    """Angle about the axis that the facets cover (rad, up to 2π); 0 where the kind has none."""
    residual: Metres
    """Largest distance of a defining vertex from the surface (m)."""
    axis_uncertainty: Radians
    """rad: residual and rounding over the extent that determines the direction."""
    point_uncertainty: Metres
    """m: of `point` across the axis (centre for spheres; along the normal for planes)."""
    chord: Metres
    """m: greatest distance of a facet from the surface (sagitta)."""
    faces: Ints
    """Facet indices, ascending."""
    minor_radius: Metres = 0.0
    """m: of the tube of a torus, whose `radius` is that of the circle in the tube's middle."""
    pitch: Metres = 0.0
    """m a turn of a helicoid, right-handed positive."""


@dataclass(frozen=True, eq=False)
class MeshSurfaces:
    """The surfaces of one mesh; every facet belongs to exactly one."""

    digest: str
    """Digest of the mesh."""
    surfaces: tuple[Surface, ...]
    """In a fixed order: by descending area, then by lowest facet index."""
    labels: Ints
    """(F,) index of the surface of each facet."""
    noise: Metres
    """m: estimated scatter of the vertices about their surfaces."""
