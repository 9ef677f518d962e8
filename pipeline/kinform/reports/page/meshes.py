"""Meshes as they are drawn: shaded smoothly within a surface, with lines where surfaces meet at an angle.

Which facets belong together the recovered surfaces say; where there are none, the dihedral angle does.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.edges import shared_edges
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces

CREASE = math.radians(32.0)
"""rad: facets that meet at more than this are not shaded as one surface; polygons of twelve sides still are, as with
`Tolerances.smooth_edge`."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Vertices, triangles and lines, ready to be packed: vertices in the order of their first use."""

    vertices: Array
    """(V, 3) m; one for each surface that meets there."""
    faces: Ints
    """(F, 3)."""
    lines: Ints
    """(E, 2)."""

    @cached_property
    def normals(self) -> Array:
        """(V, 3) unit, from the facets around each vertex by area."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        facet = np.cross(b - a, c - a)
        count = len(self.vertices)
        out = np.stack(
            [sum(np.bincount(self.faces[:, k], facet[:, i], minlength=count) for k in range(3)) for i in range(3)],
            axis=1,
        )
        return np.asarray(out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), TINY))


def shape_of(mesh: Mesh, surfaces: MeshSurfaces | None) -> Shape:
    """The mesh in its part frame."""
    faces = mesh.faces
    if not len(faces):
        return Shape(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 2), np.int64))
    labels = np.zeros(len(faces), np.int64)
    loose = np.ones(len(faces), bool)
    if surfaces is not None and len(surfaces.labels) == len(faces):
        labels = surfaces.labels
        loose = np.array([s.kind == "freeform" for s in surfaces.surfaces], bool)[labels]
    return _split(mesh.vertices, faces, labels, loose)


def shape_of_facets(corners: Array) -> Shape:
    """Loose facets (t, 3, 3) m as a shape."""
    vertices, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.int64)
    distinct = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    faces = faces[distinct]
    return _split(vertices, faces, np.zeros(len(faces), np.int64), np.ones(len(faces), bool))


def _split(vertices: Array, faces: Ints, labels: Ints, loose: NDArray[np.bool_]) -> Shape:
    """Vertices once for each smooth region around them; `loose` facets are of no known surface."""
    first, second, ends, angle = _edges(vertices, faces)
    same = labels[first] == labels[second]
    smooth = same & (angle < CREASE)
    region = components(first[smooth], second[smooth], len(faces))
    corner = faces.astype(np.int64) * np.int64(region.max() + 1 if len(region) else 1) + region[:, None]
    keys, index = np.unique(corner.ravel(), return_inverse=True)
    at = keys // np.int64(region.max() + 1 if len(region) else 1)
    # rad: edges between two surfaces that meet at more than this are drawn. Chosen by eye: polygons of twenty sides,
    # which stand for circles, have none.
    drawn = (angle > math.radians(18.0)) & (~same | (loose[first] & (angle > CREASE)))
    # each line at the vertices of its first facet
    owner = first[drawn]
    lines = (
        np.stack([_corner_of(faces, index.reshape(-1, 3), owner, ends[drawn, k]) for k in (0, 1)], axis=1)
        if len(owner)
        else np.zeros((0, 2), np.int64)
    )
    order, renamed = _first_use(index)
    return Shape(vertices[at[order]], renamed[index].reshape(-1, 3), renamed[lines])


def _edges(vertices: Array, faces: Ints) -> tuple[Ints, Ints, Ints, Array]:
    """Edges of two facets: the facets, the ends (n, 2), the angle between their normals (rad)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), TINY)
    edges = shared_edges(faces, len(vertices))
    first, second = edges.facets.T
    cosine = np.einsum("ij,ij->i", normal[first], normal[second])
    sine = np.linalg.norm(np.cross(normal[first], normal[second]), axis=1)
    return first, second, edges.ends, np.arctan2(sine, cosine)


def _corner_of(faces: Ints, index: Ints, owner: Ints, vertex: Ints) -> Ints:
    """The split vertex of each owner facet at a vertex of the mesh."""
    column = np.argmax(faces[owner] == vertex[:, None], axis=1)
    return np.asarray(index[owner, column])


def _first_use(index: Ints) -> tuple[Ints, Ints]:
    """Old numbers in the order of first use, and the new number of each old one."""
    used, where = np.unique(index, return_index=True)
    order = used[np.argsort(where, kind="stable")]
    renamed = np.empty(int(index.max()) + 1, np.int64)
    renamed[order] = np.arange(len(order))
    return order, renamed
