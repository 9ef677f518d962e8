"""From the facets of a file to a welded mesh in SI, and the facts about it before anything was repaired."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.form.meshes.raw import Fault, MeshError, RawMesh
from kinform.form.meshes.repeated import taken_once
from kinform.form.meshes.weld import merge_close, merge_exact, used_only
from kinform.foundation.algebra.vectors import box, dot
from kinform.foundation.constants import EPS32
from kinform.foundation.meshes.boxes import bounds
from kinform.foundation.meshes.edges import EdgeTable, unsorted_edge_table
from kinform.foundation.meshes.shells import shells_of
from kinform.foundation.processes import Crash, apart
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.foundation.words import counted
from kinform.model.arrays import Array, Ints, freeze
from kinform.model.assembly import Mesh, MeshHealth

SMALLEST_MESH = 1e-12
"""Diagonal (m) of the smallest mesh: an atom is a hundred times larger, and cubes of its lengths are still numbers."""
FAR = 8.0
"""A mesh whose middle lies this many of its diagonals from the origin of its file, along one axis, is moved to its own:
nearer ones lose no more than four bits, of the 29 that doubles have more than single precision."""


def build_mesh(raw: RawMesh, metres: float, weld: float | None, *, path: str, body: str | None, solid: bool) -> Mesh:
    """The welded mesh of a file, in metres.

    `weld` is the welding distance (m), None for 1e-6 of the diagonal or two steps of the file's numbers. A closed
    mesh that is inside out is turned; its health keeps the negative volume. Raises MeshError for empty meshes, and for
    flat ones where a solid is meant.
    """
    if not len(raw.faces):
        raise MeshError([Fault("is empty: it has no facet", "export the mesh again, or leave the body out")])
    resolution = raw.resolution * metres
    vertices, faces, origin, distance = _welded(raw, metres, weld, resolution)
    collapsed = _collapsed(faces)
    kept = faces[~collapsed] if collapsed.any() else faces
    if not len(kept):
        raise MeshError([Fault("is empty: every facet is degenerate", "export the mesh again")])
    used, kept = used_only(vertices, kept)
    shape: Array = np.ascontiguousarray(used, dtype=np.float64)
    diagonal = _diagonal(shape)
    if diagonal < SMALLEST_MESH:
        raise MeshError([Fault(f"is {diagonal:.2g} m across, less than an atom", "correct its units or its scale")])
    centred = _centred(shape)
    if solid and _thickness(centred) <= max(SOLVED * diagonal, 0.0):
        raise MeshError([Fault(
            "has zero thickness: all its vertices lie in one plane",
            "export a closed solid, or state solid = false for a part that is surfaces only",
        )])  # fmt: skip
    collapsed_facets = len(raw.faces) - len(kept)
    kept, edges, copies = taken_once(kept, unsorted_edge_table(kept, len(shape)), len(shape))
    health = _health(shape, centred, kept, edges, len(raw.faces), collapsed_facets, copies, distance)
    if health.watertight and health.consistent_winding and health.volume < 0.0:
        kept = np.ascontiguousarray(kept[:, ::-1])
    # no mesh is taken to be known better than single precision, at its own size
    usual = EPS32 * float(np.abs(shape).max())
    known = np.float64(resolution).tobytes() if resolution > usual else b""
    digest = hashlib.sha256(shape.data)
    digest.update(np.ascontiguousarray(kept).data)
    digest.update(known)
    shape.setflags(write=False)
    kept.setflags(write=False)
    return Mesh(
        shape, kept, health, path, body, digest.hexdigest(), np.asarray(freeze(origin * metres)),
        max(resolution, usual), raw.colour,
    )  # fmt: skip


def far_origin(vertices: NDArray[np.floating]) -> Array:
    """Where the part frame is to be, in file units (3,): the origin, but where the vertices (n, 3) lie far from it.

    Moving there rounds nothing: the place is a multiple of a power of two that is not below their diagonal.
    """
    if not len(vertices):
        return np.zeros(3)
    low, high = (corner.astype(np.float64) for corner in bounds(vertices))
    middle, diagonal = 0.5 * low + 0.5 * high, float(np.linalg.norm(high - low))
    if not diagonal > 0.0:
        return np.zeros(3)
    step = 2.0 ** math.ceil(math.log2(diagonal))
    return np.asarray(np.where(np.abs(middle) > FAR * diagonal, np.round(middle / step) * step, 0.0))


def _welded(raw: RawMesh, metres: float, weld: float | None, resolution: float) -> tuple[Array, Ints, Array, float]:
    """Vertices (m) from an origin of the file, faces, that origin (3,) in file units, and the distance (m) up to which
    vertices were one; the resolution in m."""
    first, place = merge_exact(raw.vertices)
    distinct = raw.vertices.take(first, axis=0)
    origin = far_origin(distinct)
    vertices = distinct.astype(np.float64)
    vertices -= origin
    vertices *= metres
    faces = place.take(raw.faces)
    # Vertices are welded within two steps of the last place of the largest coordinate, where that is more: copies of
    # one corner that were rounded apart differ by one in each direction.
    distance = max(SINGLE * _diagonal(vertices), 2.0 * resolution) if weld is None else weld
    leaders, close = merge_close(vertices, distance)
    if len(leaders) == len(vertices):
        return vertices, faces, origin, distance
    welded: Array = vertices[leaders]
    return welded, close.take(faces), origin, distance


def _diagonal(vertices: Array) -> float:
    """Of the box of the vertices (n, 3)."""
    low, high = box(vertices)
    return float(np.linalg.norm(high - low))


def _collapsed(faces: Ints) -> NDArray[np.bool_]:
    """Facets that use a vertex twice."""
    a, b, c = faces.T
    same: NDArray[np.bool_] = (a == b) | (b == c) | (c == a)
    return same


def _centred(vertices: Array) -> Array:
    """(3, n) coordinates of vertices (n, 3) from their mean, as columns."""
    columns = np.ascontiguousarray(vertices.T)
    columns -= columns.cumsum(axis=1)[:, -1:] / len(vertices)
    return columns


def _thickness(centred: Array) -> float:
    """Extent (m) in the direction in which the vertices, as columns (3, n), spread least."""
    _, axes = np.linalg.eigh(centred @ centred.T)
    return float(np.ptp(axes[:, 0] @ centred))


def _health(
    vertices: Array,
    centred: Array,
    faces: Ints,
    edges: EdgeTable,
    facets: int,
    collapsed: int,
    copies: int,
    distance: float,
) -> MeshHealth:
    """The facts about a mesh of these vertices, as rows and as columns from their mean, and faces, which were welded
    within the distance (m); the file has `facets`, some of which `collapsed`, and some are `copies` of others."""
    corners = [centred.take(faces[:, k], axis=1) for k in range(3)]
    watertight = edges.open == 0 and edges.overused == 0
    return MeshHealth(
        facets=facets,
        vertices=len(vertices),
        watertight=watertight,
        consistent_winding=not ((edges.balance != 0) & (edges.counts & 1 == 0)).any(),
        manifold_status=_manifold_status(vertices, faces, edges, copies),
        volume=float(np.cumsum(_dots(corners[0], _crossed(corners[1], corners[2])))[-1] / 6.0),
        degenerate_facets=collapsed + _slivers(corners),
        duplicate_facets=copies,
        open_edges=edges.open,
        overused_edges=edges.overused,
        shells=int(shells_of(vertices, faces, edges).max()) + 1,
        weld=distance,
    )


def _slivers(corners: Sequence[Array]) -> int:
    """Facets of next to no area; three times the columns (3, F) of their corners."""
    sides = [corners[k] - corners[k - 1] for k in range(3)]
    doubled = _crossed(sides[1], sides[2])
    first, second, third = (_dots(side, side) for side in sides)
    longest = np.maximum(np.maximum(first, second), third)
    return int(np.count_nonzero(_dots(doubled, doubled) <= ARITHMETIC**2 * longest**2))


def _crossed(a: Array, b: Array) -> Array:
    """(3, n) a × b of columns (3, n)."""
    out = np.empty(a.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[j], b[k], out=out[i])
        out[i] -= a[k] * b[j]
    return out


def _dots(a: Array, b: Array) -> Array:
    """(n,) inner products of columns (3, n)."""
    return dot(a.T, b.T)


def _manifold_status(vertices: Array, faces: Ints, edges: EdgeTable, copies: int) -> str:
    """What manifold3d says of the mesh, scaled to unit size.

    It pairs the half-edges of an edge that run against each other, and reads beyond its tables where they are not as
    many one way as the other (3.5.4, signal 11): of such a mesh, and of one with two facets at every edge and none of
    them twice, we say ourselves what it means to say. Where more than two facets meet at an edge it takes them apart,
    at length: that is tried in a process of its own.
    """
    if (edges.balance != 0).any():
        return "NotManifold"
    if not edges.overused and not copies:
        return "NoError"
    size = float(np.ptp(vertices, axis=0).max()) or 1.0
    scaled = np.ascontiguousarray((vertices - vertices.mean(axis=0)) / size)
    corners = np.ascontiguousarray(faces.astype(np.uint64))
    try:
        return apart(_asked_status, scaled, corners)
    except Crash as crash:
        raise MeshError([Fault(
            f"cannot be told to be a solid: manifold3d ended by {crash.cause} on it, and "
            f"{counted(edges.overused, 'edge')} of it are shared by more than two facets",
            "repair these edges, or export the mesh again",
        )]) from None  # fmt: skip


def _asked_status(vertices: Array, corners: NDArray[np.uint64]) -> str:
    from manifold3d import Manifold, Mesh64

    return str(Manifold(Mesh64(vert_properties=vertices, tri_verts=corners)).status().name)
