"""The polygons of a mesh and the edges between them: areas, normals, dihedrals, which edges are smooth.

A polygon is a connected set of coplanar facets; surfaces are recovered over polygons, because the
triangulation inside a plane says nothing. Facets thinner than the noise have meaningless normals:
each joins the polygon across its longest edge, in whose plane it lies to within its own thickness.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from kinform.foundation.algebra.vectors import cross_columns, dot
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import distinct
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces.constants import FLAT_NOISES
from kinform.surfaces.groups import Ragged, columns_of, parted
from kinform.surfaces.polygons.coplanar import coplanar_facets
from kinform.surfaces.polygons.facets import Facets, angles
from kinform.surfaces.polygons.noise import Scale

MOST_SLACK = 0.3
"""rad by which rounding may turn a normal, at most: beyond, the normal means nothing. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Patchwork:
    """P polygons of a mesh in unit coordinates (span 1), and the E edges between them; or of several meshes, one
    after the other, each in its own unit coordinates: then what is done for all takes fewer and larger steps."""

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
    mesh: Ints
    """(P,) number of the mesh of each polygon."""
    total: Array
    """(M,) area of each of the meshes."""

    def at(self, vertices: Ints) -> Array:
        """(N, 3) coordinates of these vertices, in memory column by column."""
        return self.columns.take(vertices, axis=1).T

    def along(self, edges: Ints) -> Array:
        """(N, 3) from the first to the second end of these edges, in memory column by column."""
        return self._along.take(edges, axis=1).T

    def halfway(self, edges: Ints) -> Array:
        """(N, 3) middles of these edges, in memory column by column."""
        return self._halfway.take(edges, axis=1).T

    def middles(self, polygons: Ints) -> Array:
        """(N, 3) centroids of these polygons, in memory column by column."""
        return self._centres.take(polygons, axis=1).T

    def normals(self, polygons: Ints) -> Array:
        """(N, 3) normals of these polygons, in memory column by column."""
        return self._normals.take(polygons, axis=1).T

    def places(self, polygons: Ints, vertices: Ints) -> Array:
        """(N, 3) centroids of these polygons, and after them these vertices, in memory column by column."""
        return self._places.take(np.concatenate([polygons, vertices + self.count]), axis=1).T

    @cached_property
    def _places(self) -> Array:
        return np.concatenate([self._centres, self.columns], axis=1)

    @cached_property
    def _halfway(self) -> Array:
        return (self.columns.take(self.ends[:, 0], axis=1) + self.columns.take(self.ends[:, 1], axis=1)) / 2

    @cached_property
    def _along(self) -> Array:
        return self.columns.take(self.ends[:, 1], axis=1) - self.columns.take(self.ends[:, 0], axis=1)

    @cached_property
    def _normals(self) -> Array:
        return np.ascontiguousarray(self.normal.T)

    @cached_property
    def _centres(self) -> Array:
        return np.ascontiguousarray(self.centre.T)

    @cached_property
    def columns(self) -> Array:
        """(3, V) coordinates of the vertices."""
        return np.ascontiguousarray(self.vertices.T)

    def other(self, edges: Ints, polygons: Ints) -> Ints:
        """The polygon on the other side of each edge."""
        return self._sums.take(edges) - polygons

    @cached_property
    def _sums(self) -> Ints:
        return self.a + self.b

    @classmethod
    def of(cls, mesh: Facets, scale: Scale, tolerances: Tolerances) -> Patchwork:
        """Polygons and edges of a welded mesh with span 1."""
        vertices = mesh.vertices
        polygon, (area, mean, centre) = coplanar_facets(mesh, scale, tolerances)
        count = len(area)
        widest = np.zeros(count)
        np.maximum.at(widest, polygon, mesh.altitude)
        # Roundings, over the altitude, by which the normal of a polygon may be turned: one at either end.
        slack = np.minimum(2 * scale.rounding / np.maximum(widest, TINY), MOST_SLACK)
        a = polygon[mesh.f0]
        b = np.where(mesh.inner, polygon[mesh.f1], -1)
        keep = np.flatnonzero(a != b)
        a, b, ends = a.take(keep), b.take(keep), mesh.ends.take(keep, axis=0)
        length, inner = mesh.length.take(keep), mesh.inner.take(keep)
        mean_a, mean_b = columns_of(mean, a), columns_of(mean, b)
        angle = np.where(inner, angles(mean_a, mean_b), np.pi)
        turn = dot(cross_columns(mean_a, mean_b), mesh.at(ends[:, 1]) - mesh.at(ends[:, 0]))
        width = np.minimum(area[a], area[b]) / np.maximum(length, TINY)
        flat = inner & ((angle < 2 * tolerances.coplanar) | (width * angle < FLAT_NOISES * scale.noise))
        sign = np.where(flat | ~inner, 0, np.where(turn > 0, 1, -1)).astype(np.int64)
        allowed = tolerances.smooth_edge + np.minimum(np.where(inner, slack[a] + slack[b], 0.0), MOST_SLACK)
        vertex_key = distinct(np.repeat(polygon, 3) * np.int64(len(vertices)) + mesh.faces.ravel())
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
            corners=Ragged.of_ordered(*parted(vertex_key, max(len(vertices), 1)), count),
            sides=Ragged(np.r_[a, b[closed]], np.r_[numbers, closed], count),
            a=a,
            b=b,
            ends=ends,
            length=length,
            angle=angle,
            smooth=inner & (angle < allowed),
            sign=sign,
            mesh=np.zeros(count, np.int64),
            total=np.array([area.sum()]),
        )

    @classmethod
    def joined(cls, works: Sequence[Patchwork]) -> Patchwork:
        """Those of several meshes as one."""
        if len(works) == 1:
            return works[0]
        vertices = _offsets([len(work.vertices) for work in works])
        facets = _offsets([work.count for work in works])
        edges = _offsets([len(work.a) for work in works])

        def together(name: str) -> Any:
            return np.concatenate([getattr(work, name) for work in works])

        def shifted(name: str, offsets: list[int]) -> Ints:
            return np.concatenate([getattr(work, name) + at for work, at in zip(works, offsets, strict=True)])

        b = together("b")
        return cls(
            vertices=together("vertices"),
            facet_area=together("facet_area"),
            polygon=shifted("polygon", facets),
            count=sum(work.count for work in works),
            area=together("area"),
            normal=together("normal"),
            centre=together("centre"),
            slack=together("slack"),
            corners=Ragged.joined([work.corners for work in works], vertices),
            sides=Ragged.joined([work.sides for work in works], edges),
            a=shifted("a", facets),
            b=np.where(b < 0, b, shifted("b", facets)),
            ends=shifted("ends", vertices),
            length=together("length"),
            angle=together("angle"),
            smooth=together("smooth"),
            sign=together("sign"),
            mesh=np.repeat(np.arange(len(works)), [work.count for work in works]),
            total=together("total"),
        )


def _offsets(counts: Sequence[int]) -> list[int]:
    """Where each of several runs begins that follow each other."""
    return [int(end) - count for end, count in zip(np.cumsum(counts), counts, strict=True)]
