"""Facets → polygons: edges, dihedrals, coplanar clusters, smooth edges with their convexity.

A polygon is a connected set of coplanar facets; surfaces are recovered over polygons, because the
triangulation inside a plane says nothing. Facets thinner than the noise have meaningless normals:
each joins the polygon across its longest edge, in whose plane it lies to within its own thickness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.model.tolerances import Tolerances
from kinform.surfaces._batch import Array, Ints, Mask, Ragged, components, group_sum

__all__ = ["Patchwork", "Scale", "build"]


@dataclass(frozen=True)
class Scale:
    """Lengths that decide, relative to the mesh's diagonal."""

    rounding: float
    """What storing coordinates in single precision loses."""
    noise: float
    """Scatter of vertices that is expected anyway."""
    fit: float
    """Distance up to which a vertex belongs to a surface."""


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
    smooth: Mask
    sign: Ints
    """(E,) +1 convex, -1 concave, 0 too flat to tell."""

    def other(self, edges: Ints, polygons: Ints) -> Ints:
        """The polygon on the other side of each edge."""
        return np.where(self.a[edges] == polygons, self.b[edges], self.a[edges])


def _facet_edges(faces: Ints, vertex_count: int) -> tuple[Ints, Ints, Ints, Mask]:
    """(f0, f1 or -1, directed ends as f0 runs them, whether both run them oppositely) of every edge.

    Edges with more than two facets are given as open edges, one for each facet.
    """
    count = len(faces)
    half = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(count), 3)
    low, high = half.min(axis=1), half.max(axis=1)
    key = low * np.int64(vertex_count) + high
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = np.flatnonzero(np.r_[True, key[1:] != key[:-1]]) if len(key) else np.zeros(0, np.int64)
    size = np.diff(np.r_[first, len(key)])
    pairs = first[size == 2]
    f0, f1 = owner[order[pairs]], owner[order[pairs + 1]]
    ends = half[order[pairs]]
    opposed = half[order[pairs], 0] != half[order[pairs + 1], 0]
    single = np.ones(len(key), bool)
    single[pairs] = single[pairs + 1] = False
    rest = order[single]
    return (
        np.r_[f0, owner[rest]],
        np.r_[f1, np.full(len(rest), -1)],
        np.concatenate([ends, half[rest]]),
        np.r_[opposed, np.ones(len(rest), bool)],
    )


def _attach_slivers(cluster: Ints, thin: Mask, f0: Ints, f1: Ints, length: Array) -> Ints:
    """Gives every cluster that consists of slivers to a neighbour across its longest edge."""
    for _ in range(8):
        count = int(cluster.max()) + 1 if len(cluster) else 0
        solid = np.bincount(cluster, ~thin, count) > 0
        a, b = cluster[f0], cluster[f1]
        source = np.r_[a, b]
        target = np.r_[b, a]
        use = ~solid[source] & (source != target)
        if not use.any():
            break
        source, target, size = source[use], target[use], np.r_[length, length][use]
        order = np.lexsort((target, ~solid[target], -size, source))
        first = order[np.r_[True, source[order][1:] != source[order][:-1]]]
        cluster = components(source[first], target[first], count)[cluster]
    return cluster


def _angles(n0: Array, n1: Array) -> Array:
    cross = np.linalg.norm(np.cross(n0, n1), axis=1)
    return np.asarray(np.arctan2(cross, np.einsum("ij,ij->i", n0, n1)))


def _normalised(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)[:, None])


def _flatness(vertices: Array, faces: Ints, polygon: Ints, normal: Array, centre: Array) -> Array:
    """Greatest distance of a polygon's vertices from its plane (P,)."""
    owner = np.repeat(polygon, 3)
    offset = vertices[faces.ravel()] - centre[owner]
    height = np.abs(np.einsum("ij,ij->i", offset, normal[owner]))
    out = np.zeros(len(normal))
    np.maximum.at(out, owner, height)
    return out


def _moments(polygon: Ints, area: Array, normal: Array, centroid: Array) -> tuple[Array, Array, Array]:
    """Area, unit normal and centroid of each polygon."""
    count = int(polygon.max()) + 1 if len(polygon) else 0
    total: Array = np.bincount(polygon, area, count).astype(float)
    mean = group_sum(polygon, normal * area[:, None], count)
    empty = total <= 0
    weight = np.where(empty[polygon], 1.0, area)
    centre = group_sum(polygon, centroid * weight[:, None], count)
    centre /= np.bincount(polygon, weight, count)[:, None]
    return total, _normalised(mean), centre


def _cluster(
    vertices: Array, faces: Ints, area: Array, normal: Array, altitude: Array,
    edges: tuple[Ints, Ints, Ints, Array], scale: Scale, tolerances: Tolerances,
) -> Ints:  # fmt: skip
    """Polygon of each facet: coplanar neighbours, checked against drift, then slivers."""
    f0, f1, shared, length = edges
    count = len(faces)
    centroid = vertices[faces].mean(axis=1)
    angle = _angles(normal[f0], normal[f1])
    opposite0 = faces[f0].sum(axis=1) - shared.sum(axis=1)
    opposite1 = faces[f1].sum(axis=1) - shared.sum(axis=1)
    base = vertices[shared[:, 0]]
    height = np.maximum(
        np.abs(np.einsum("ij,ij->i", normal[f0], vertices[opposite1] - base)),
        np.abs(np.einsum("ij,ij->i", normal[f1], vertices[opposite0] - base)),
    )
    thin = altitude < 2 * scale.noise
    solid = ~(thin[f0] | thin[f1])
    strict = solid & (angle < tolerances.coplanar) & (height < scale.fit)
    flat = strict | (solid & (height < scale.noise) & (angle < 0.06))
    links, limits = flat, (2 * scale.noise, scale.fit)
    cluster = components(f0[links], f1[links], count)
    for stricter, limit in zip((strict, np.zeros_like(strict)), limits, strict=True):
        _, mean, centre = _moments(cluster, area, normal, centroid)
        bent = _flatness(vertices, faces, cluster, mean, centre) > limit
        if not bent.any():
            break
        links = np.where(bent[cluster[f0]], links & stricter, links)
        cluster = components(f0[links], f1[links], count)
    cluster = _attach_slivers(cluster, thin, f0, f1, length)
    for _ in range(2):
        _, mean, centre = _moments(cluster, area, normal, centroid)
        a, b = cluster[f0], cluster[f1]
        gap = np.maximum(
            np.abs(np.einsum("ij,ij->i", mean[a], centre[b] - base)),
            np.abs(np.einsum("ij,ij->i", mean[b], centre[a] - base)),
        )
        join = (a != b) & (_angles(mean[a], mean[b]) < tolerances.coplanar) & (gap < scale.noise)
        if not join.any():
            break
        cluster = components(a[join], b[join], int(cluster.max()) + 1)[cluster]
    return cluster


def build(vertices: Array, faces: Ints, scale: Scale, tolerances: Tolerances) -> Patchwork:
    """Polygons and edges of a welded mesh, vertices (V, 3) with diagonal 1, faces (F, 3)."""
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice = np.linalg.norm(cross, axis=1)
    normal = _normalised(cross)
    sides = np.linalg.norm(corners - corners[:, [1, 2, 0]], axis=2)
    altitude = twice / np.maximum(sides.max(axis=1), 1e-300)
    f0, f1, ends, opposed = _facet_edges(faces, len(vertices))
    length = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    inner = (f1 >= 0) & opposed
    inside = (f0[inner], f1[inner], ends[inner], length[inner])
    polygon = _cluster(vertices, faces, twice / 2, normal, altitude, inside, scale, tolerances)

    area, mean, centre = _moments(polygon, twice / 2, normal, corners.mean(axis=1))
    count = len(area)
    widest = np.zeros(count)
    np.maximum.at(widest, polygon, altitude)
    slack = np.minimum(2 * scale.rounding / np.maximum(widest, 1e-300), 0.3)

    a = polygon[f0]
    b = np.where(inner, polygon[f1], -1)
    keep = a != b
    a, b, ends, length, inner = a[keep], b[keep], ends[keep], length[keep], inner[keep]
    angle = np.full(len(a), np.pi)
    angle[inner] = _angles(mean[a[inner]], mean[b[inner]])
    turn = np.einsum("ij,ij->i", np.cross(mean[a], mean[b]), vertices[ends[:, 1]] - vertices[ends[:, 0]])
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
        facet_area=twice / 2,
        facet_normal=normal,
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
