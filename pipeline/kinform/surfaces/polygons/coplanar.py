"""Facets → polygons: connected coplanar facets, because the triangulation inside a plane says nothing.

Facets thinner than the noise have meaningless normals: each joins the polygon across its longest edge, in
whose plane it lies to within its own thickness.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import normalised
from kinform.foundation.graphs.components import components
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces.groups import group_sum
from kinform.surfaces.kinds import plane
from kinform.surfaces.polygons.facets import Fabric, angles, departures

__all__ = ["Scale", "cluster", "moments"]

PEELS = 60
"""Planes taken off a cluster before the rest of it falls into its facets."""


@dataclass(frozen=True)
class Scale:
    """Lengths that decide, relative to the mesh's diagonal."""

    rounding: float
    """What storing coordinates in single precision loses, or the scatter that the mesh shows, if larger."""
    scatter: float
    """Standard deviation of vertices that scatter more than they were rounded, else 0."""
    noise: float
    """Scatter of vertices that is expected anyway."""
    fit: float
    """Distance up to which a vertex belongs to a surface."""


def _attach_slivers(cluster: Ints, thin: Flags, f0: Ints, f1: Ints, length: Array) -> Ints:
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


def _flatness(vertices: Array, faces: Ints, polygon: Ints, normal: Array, centre: Array) -> Array:
    """Greatest distance of a polygon's vertices from its plane (P,)."""
    owner = np.repeat(polygon, 3)
    offset = vertices[faces.ravel()] - centre[owner]
    height = np.abs(np.einsum("ij,ij->i", offset, normal[owner]))
    out = np.zeros(len(normal))
    np.maximum.at(out, owner, height)
    return out


def moments(polygon: Ints, area: Array, normal: Array, centroid: Array) -> tuple[Array, Array, Array]:
    """Area, unit normal and centroid of each polygon."""
    count = int(polygon.max()) + 1 if len(polygon) else 0
    total: Array = np.bincount(polygon, area, count).astype(float)
    mean = group_sum(polygon, normal * area[:, None], count)
    empty = total <= 0
    weight = np.where(empty[polygon], 1.0, area)
    centre = group_sum(polygon, centroid * weight[:, None], count)
    centre /= np.bincount(polygon, weight, count)[:, None]
    return total, normalised(mean), centre


def _peeled(of: Fabric, label: Ints, f0: Ints, f1: Ints, scale: Scale) -> Ints:
    """Labels of clusters that scattered vertices let run on into their neighbours, one plane after the other
    taken off from the largest facet of each; `f0`, `f1` are the links between facets."""
    limit, corners = scale.noise, of.vertices[of.faces]
    label = np.unique(label, return_inverse=True)[1].astype(np.int64)
    whole = np.zeros(int(label.max()) + 1, bool)
    for _ in range(PEELS):
        count = len(whole)
        open_ = np.flatnonzero(~whole[label])
        if not len(open_):
            break
        order = open_[np.lexsort((open_, -of.area[open_], label[open_]))]
        first = order[np.r_[True, label[order][1:] != label[order][:-1]]]
        normal, point, reach = np.zeros((count, 3)), np.zeros((count, 3)), np.ones(count)
        normal[label[first]], point[label[first]] = of.normal[first], corners[first].mean(axis=1)
        reach[label[first]] = np.maximum(of.altitude[first], 1e-300)
        mine, group = corners[open_], label[open_]
        for step in range(3):
            offset = mine - point[group][:, None, :]
            height = np.abs(np.einsum("ijk,ik->ij", offset, normal[group]))
            allowed = limit + 0.0 * height
            if step == 0:
                allowed = limit * (1 + np.sqrt(np.einsum("ijk,ijk->ij", offset, offset)) / reach[group][:, None])
            on = (height < allowed).all(axis=1) & (np.einsum("ij,ij->i", of.normal[open_], normal[group]) > 0.5)
            fitted, centre, _ = plane.fit(np.repeat(group[on], 3), mine[on].reshape(-1, 3), normal)
            normal, point = fitted, np.where(np.bincount(group[on], minlength=count)[:, None] > 0, centre, point)
        member = np.zeros(len(label), bool)
        member[open_[on]] = True
        member[first] = True
        same = (label[f0] == label[f1]) & (member[f0] == member[f1])
        label = components(f0[same], f1[same], len(label))
        whole = np.zeros(int(label.max()) + 1, bool) | np.isin(np.arange(int(label.max()) + 1), label[first])
        whole |= np.bincount(label) == 1
        done = ~np.isin(np.arange(len(member)), open_)
        whole[label[done]] = True
    return label


def cluster(of: Fabric, scale: Scale, tolerances: Tolerances) -> Ints:
    """Polygon of each facet: coplanar neighbours, checked against drift, then slivers."""
    vertices, faces, area, normal = of.vertices, of.faces, of.area, of.normal
    inner = np.flatnonzero(of.inner)
    f0, f1, shared, length = of.f0[inner], of.f1[inner], of.ends[inner], of.length[inner]
    count = len(faces)
    centroid = vertices[faces].mean(axis=1)
    angle = angles(normal[f0], normal[f1])
    opposite0 = faces[f0].sum(axis=1) - shared.sum(axis=1)
    opposite1 = faces[f1].sum(axis=1) - shared.sum(axis=1)
    base = vertices[shared[:, 0]]
    height = np.maximum(
        np.abs(np.einsum("ij,ij->i", normal[f0], vertices[opposite1] - base)),
        np.abs(np.einsum("ij,ij->i", normal[f1], vertices[opposite0] - base)),
    )
    thin = of.altitude < 2 * scale.noise
    solid = ~(thin[f0] | thin[f1])
    strict = solid & (angle < tolerances.coplanar) & (height < scale.fit)
    flat = strict | (solid & (height < scale.noise) & (angle < 0.06))
    lost = max(3 * scale.scatter, 0.75 * scale.rounding)
    turned = 0.06 + 4 * lost / 3 * (1 / np.maximum(of.altitude[f0], 1e-300) + 1 / np.maximum(of.altitude[f1], 1e-300))
    flat |= solid & (np.abs(departures(of, inner)) < lost) & (angle < np.minimum(turned, 0.5))
    links, limits = flat, (2 * scale.noise, scale.fit)
    label = components(f0[links], f1[links], count)
    if scale.scatter > 0:
        label = _peeled(of, label, f0[links], f1[links], scale)
        links = links & (label[f0] == label[f1])
    for stricter, limit in zip((strict, np.zeros_like(strict)), limits, strict=True):
        _, mean, centre = moments(label, area, normal, centroid)
        bent = _flatness(vertices, faces, label, mean, centre) > limit
        if not bent.any():
            break
        links = np.where(bent[label[f0]], links & stricter, links)
        label = components(f0[links], f1[links], count)
    label = _attach_slivers(label, thin, f0, f1, length)
    for _ in range(2):
        _, mean, centre = moments(label, area, normal, centroid)
        a, b = label[f0], label[f1]
        gap = np.maximum(
            np.abs(np.einsum("ij,ij->i", mean[a], centre[b] - base)),
            np.abs(np.einsum("ij,ij->i", mean[b], centre[a] - base)),
        )
        join = (a != b) & (angles(mean[a], mean[b]) < tolerances.coplanar) & (gap < scale.noise)
        if not join.any():
            break
        label = components(a[join], b[join], int(label.max()) + 1)[label]
    return label
