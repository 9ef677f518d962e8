"""The facets of a mesh and the edges between them: normals, areas, altitudes, neighbours."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import cross_columns, dot
from kinform.foundation.meshes.edges import edge_table
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class Facets:
    """F facets and E edges of a welded mesh in unit coordinates."""

    vertices: Array
    faces: Ints
    area: Array
    normal: Array
    """(F, 3) outward; zero for facets without area. In memory column by column, as `middle` is."""
    middle: Array
    """(F, 3)"""
    altitude: Array
    """(F,) the least."""
    f0: Ints
    f1: Ints
    """(E,) facets of each edge; f1 is -1 at open edges. Where more than two facets meet each has an open edge."""
    ends: Ints
    """(E, 2) vertices as f0 runs them."""
    length: Array
    inner: Flags
    """(E,) two facets that run the edge oppositely."""

    @classmethod
    def of(cls, vertices: Array, faces: Ints) -> Facets:
        """Those of faces (F, 3) over vertices (n, 3)."""
        columns = np.ascontiguousarray(vertices.T)
        first, second, third = (columns.take(faces[:, k], axis=1).T for k in range(3))
        along, back = second - first, third - first
        across = cross_columns(along, back)
        twice = np.sqrt(dot(across, across))
        beyond = second - third
        longest = np.sqrt(np.maximum(np.maximum(dot(along, along), dot(back, back)), dot(beyond, beyond)))
        middle = (first + second + third) / 3.0
        table = edge_table(faces, len(vertices), by_corner=True)
        paired = table.starts[table.counts == 2]
        alone = np.ones(len(table.half_edges), bool)
        alone[paired] = alone[paired + 1] = False
        one, other = table.half_edges[paired], table.half_edges[paired + 1]
        leading = np.concatenate([one, table.half_edges[alone]])
        ends = np.stack([faces.ravel()[leading], faces[:, [1, 2, 0]].ravel()[leading]], axis=1)
        along = (columns.take(ends[:, 0], axis=1) - columns.take(ends[:, 1], axis=1)).T
        inner = np.zeros(len(leading), bool)
        inner[: len(one)] = table.forward[one] != table.forward[other]
        return cls(
            vertices=vertices,
            faces=faces,
            area=twice / 2,
            normal=across / np.maximum(twice, TINY)[:, None],
            middle=middle,
            altitude=twice / np.maximum(longest, TINY),
            f0=leading // 3,
            f1=np.concatenate([other // 3, np.full(len(leading) - len(one), -1)]),
            ends=ends,
            length=np.sqrt(dot(along, along)),
            inner=inner,
        )

    def at(self, vertices: Ints) -> Array:
        """(n, 3) coordinates of these vertices, in memory column by column."""
        return self._columns.take(vertices, axis=1).T

    @cached_property
    def _columns(self) -> Array:
        return np.ascontiguousarray(self.vertices.T)

    def opposite(self, edges: Ints) -> tuple[Ints, Ints]:
        """The vertices of the two facets of each of these inner edges that are not on it."""
        return self._beyond[0].take(edges), self._beyond[1].take(edges)

    @cached_property
    def _beyond(self) -> tuple[Ints, Ints]:
        total = self.faces[:, 0] + self.faces[:, 1] + self.faces[:, 2]
        shared = self.ends[:, 0] + self.ends[:, 1]
        return total.take(self.f0) - shared, total.take(self.f1) - shared

    def starts(self, edges: Ints) -> Ints:
        """The first ends of these edges."""
        return self._ends[0].take(edges)

    def finishes(self, edges: Ints) -> Ints:
        """The second ends of these edges."""
        return self._ends[1].take(edges)

    @cached_property
    def _ends(self) -> tuple[Ints, Ints]:
        return np.ascontiguousarray(self.ends[:, 0]), np.ascontiguousarray(self.ends[:, 1])


def angles(n0: Array, n1: Array) -> Array:
    """Angle between unit vectors (n, 3), good for small ones too (rad)."""
    across = cross_columns(n0, n1)
    return np.asarray(np.arctan2(np.sqrt(dot(across, across)), dot(n0, n1)))
