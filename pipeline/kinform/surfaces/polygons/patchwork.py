"""Facets → polygons: edges, dihedrals, coplanar clusters, smooth edges with their convexity.

A polygon is a connected set of coplanar facets; surfaces are recovered over polygons, because the
triangulation inside a plane says nothing. Facets thinner than the noise have meaningless normals:
each joins the polygon across its longest edge, in whose plane it lies to within its own thickness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces.groups import Ragged
from kinform.surfaces.polygons.coplanar import Scale, cluster, moments
from kinform.surfaces.polygons.facets import Fabric, angles

__all__ = ["Patchwork", "Scale", "build"]


@dataclass(frozen=True, eq=False)
class Patchwork:
    """P polygons of a mesh in unit coordinates (diagonal 1), and the E edges between them."""

    vertices: Array
    faces: Ints
    facet_area: Array
    facet_normal: Array
    polygon: Ints
    """(F,) polygon of each facet."""
    count: int
    area: Array
    normal: Array
    """(P, 3) outward."""
    centre: Array
    slack: Array
    """(P,) rad by which rounding may turn the normal."""
    facets: Ints
    """(P,) number of facets."""
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


def build(of: Fabric, scale: Scale, tolerances: Tolerances) -> Patchwork:
    """Polygons and edges of a welded mesh with diagonal 1."""
    vertices, faces, facet_area = of.vertices, of.faces, of.area
    f0, ends, length, inner = of.f0, of.ends, of.length, of.inner
    polygon = cluster(of, scale, tolerances)

    area, mean, centre = moments(polygon, facet_area, of.normal, vertices[faces].mean(axis=1))
    count = len(area)
    widest = np.zeros(count)
    np.maximum.at(widest, polygon, of.altitude)
    slack = np.minimum(2 * scale.rounding / np.maximum(widest, 1e-300), 0.3)

    a = polygon[f0]
    b = np.where(inner, polygon[of.f1], -1)
    keep = a != b
    a, b, ends, length, inner = a[keep], b[keep], ends[keep], length[keep], inner[keep]
    angle = np.full(len(a), np.pi)
    angle[inner] = angles(mean[a[inner]], mean[b[inner]])
    turn = np.einsum("ij,ij->i", cross(mean[a], mean[b]), vertices[ends[:, 1]] - vertices[ends[:, 0]])
    width = np.minimum(area[a], area[b]) / np.maximum(length, 1e-300)
    flat = inner & ((angle < 2 * tolerances.coplanar) | (width * angle < 2 * scale.noise))
    sign = np.where(flat | ~inner, 0, np.where(turn > 0, 1, -1)).astype(np.int64)
    allowed = tolerances.smooth_edge + np.minimum(np.where(inner, slack[a] + slack[b], 0.0), 0.3)
    vertex_key = np.unique(np.repeat(polygon, 3) * np.int64(len(vertices)) + faces.ravel())
    numbers = np.arange(len(a))
    two = np.flatnonzero(b >= 0)
    return Patchwork(
        vertices=vertices,
        faces=faces,
        facet_area=facet_area,
        facet_normal=of.normal,
        polygon=polygon,
        count=count,
        area=area,
        normal=mean,
        centre=centre,
        slack=slack,
        facets=np.bincount(polygon, minlength=count),
        corners=Ragged(vertex_key // max(len(vertices), 1), vertex_key % max(len(vertices), 1), count),
        sides=Ragged(np.r_[a, b[two]], np.r_[numbers, two], count),
        a=a,
        b=b,
        ends=ends,
        length=length,
        angle=angle,
        smooth=inner & (angle < allowed),
        sign=sign,
    )
