"""The polygons of a mesh and the edges between them: areas, normals, dihedrals, which edges are smooth.

A polygon is a connected set of coplanar facets; surfaces are recovered over polygons, because the
triangulation inside a plane says nothing. Facets thinner than the noise have meaningless normals:
each joins the polygon across its longest edge, in whose plane it lies to within its own thickness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces.constants import FLAT_NOISES, MOST_SLACK, SLACK_ROUNDINGS
from kinform.surfaces.groups import Ragged
from kinform.surfaces.polygons.coplanar import coplanar_facets, moments
from kinform.surfaces.polygons.facets import Facets, angles
from kinform.surfaces.polygons.noise import Scale


@dataclass(frozen=True, eq=False)
class Patchwork:
    """P polygons of a mesh in unit coordinates (diagonal 1), and the E edges between them."""

    vertices: Array
    facet_area: Array
    polygon: Ints
    """(F,) polygon of each facet."""
    count: int
    area: Array
    normal: Array
    """(P, 3) outward."""
    centre: Array
    slack: Array
    """(P,) rad by which rounding may turn the normal."""
    corners: Ragged
    """Vertices of each polygon."""
    sides: Ragged
    """Edges of each polygon."""
    a: Ints
    b: Ints
    """(E,) polygons of each edge; b is -1 at open edges."""
    ends: Ints
    """(E, 2) vertices."""
    length: Array
    angle: Array
    """(E,) dihedral, 0 for coplanar (rad)."""
    smooth: Flags
    sign: Ints
    """(E,) +1 convex, -1 concave, 0 too flat to tell."""

    def other(self, edges: Ints, polygons: Ints) -> Ints:
        """The polygon on the other side of each edge."""
        return np.where(self.a[edges] == polygons, self.b[edges], self.a[edges])

    @classmethod
    def of(cls, mesh: Facets, scale: Scale, tolerances: Tolerances) -> Patchwork:
        """Polygons and edges of a welded mesh with diagonal 1."""
        vertices = mesh.vertices
        polygon = coplanar_facets(mesh, scale, tolerances)
        area, mean, centre = moments(mesh, polygon)
        count = len(area)
        widest = np.zeros(count)
        np.maximum.at(widest, polygon, mesh.altitude)
        slack = np.minimum(SLACK_ROUNDINGS * scale.rounding / np.maximum(widest, 1e-300), MOST_SLACK)
        a = polygon[mesh.f0]
        b = np.where(mesh.inner, polygon[mesh.f1], -1)
        keep = a != b
        a, b, ends, length, inner = a[keep], b[keep], mesh.ends[keep], mesh.length[keep], mesh.inner[keep]
        angle = np.full(len(a), np.pi)
        angle[inner] = angles(mean[a[inner]], mean[b[inner]])
        turn = dot(cross(mean[a], mean[b]), vertices[ends[:, 1]] - vertices[ends[:, 0]])
        width = np.minimum(area[a], area[b]) / np.maximum(length, 1e-300)
        flat = inner & ((angle < 2 * tolerances.coplanar) | (width * angle < FLAT_NOISES * scale.noise))
        sign = np.where(flat | ~inner, 0, np.where(turn > 0, 1, -1)).astype(np.int64)
        allowed = tolerances.smooth_edge + np.minimum(np.where(inner, slack[a] + slack[b], 0.0), MOST_SLACK)
        vertex_key = np.unique(np.repeat(polygon, 3) * np.int64(len(vertices)) + mesh.faces.ravel())
        numbers = np.arange(len(a))
        closed = np.flatnonzero(b >= 0)
        return cls(
            vertices=vertices,
            facet_area=mesh.area,
            polygon=polygon,
            count=count,
            area=area,
            normal=mean,
            centre=centre,
            slack=slack,
            corners=Ragged(vertex_key // max(len(vertices), 1), vertex_key % max(len(vertices), 1), count),
            sides=Ragged(np.r_[a, b[closed]], np.r_[numbers, closed], count),
            a=a,
            b=b,
            ends=ends,
            length=length,
            angle=angle,
            smooth=inner & (angle < allowed),
            sign=sign,
        )
