"""The facets of a mesh and the edges between them: normals, areas, altitudes, neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.meshes.edges import edge_table
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class Facets:
    """F facets and E edges of a welded mesh in unit coordinates."""

    vertices: Array
    faces: Ints
    area: Array
    normal: Array
    """(F, 3) outward; zero for facets without area."""
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
        corners = vertices[faces]
        sides = corners - corners[:, [1, 2, 0]]
        across = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        twice = np.sqrt(dot(across, across))
        longest = np.sqrt(np.einsum("ijk,ijk->ij", sides, sides).max(axis=1, initial=0.0))
        table = edge_table(faces, len(vertices), by_corner=True)
        paired = table.starts[table.counts == 2]
        alone = np.ones(len(table.half_edges), bool)
        alone[paired] = alone[paired + 1] = False
        first, second = table.half_edges[paired], table.half_edges[paired + 1]
        leading = np.r_[first, table.half_edges[alone]]
        ends = np.stack([faces.ravel()[leading], faces[:, [1, 2, 0]].ravel()[leading]], axis=1)
        along = vertices[ends[:, 0]] - vertices[ends[:, 1]]
        inner = np.zeros(len(leading), bool)
        inner[: len(first)] = table.forward[first] != table.forward[second]
        return cls(
            vertices=vertices,
            faces=faces,
            area=twice / 2,
            normal=across / np.maximum(twice, 1e-300)[:, None],
            middle=corners.mean(axis=1),
            altitude=twice / np.maximum(longest, 1e-300),
            f0=leading // 3,
            f1=np.r_[second // 3, np.full(len(leading) - len(first), -1)],
            ends=ends,
            length=np.sqrt(dot(along, along)),
            inner=inner,
        )


def angles(n0: Array, n1: Array) -> Array:
    """Angle between unit vectors (n, 3), good for small ones too (rad)."""
    across = cross(n0, n1)
    return np.asarray(np.arctan2(np.sqrt(dot(across, across)), dot(n0, n1)))
