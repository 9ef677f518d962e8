"""Facets → polygons: connected coplanar facets, because the triangulation inside a plane says nothing.

Facets thinner than the noise have meaningless normals: each joins the polygon across its longest edge, in
whose plane it lies to within its own thickness.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot, normalised
from kinform.foundation.graphs.components import components
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces import constants
from kinform.surfaces.groups import group_mean, group_sum
from kinform.surfaces.polygons.facets import Facets, angles
from kinform.surfaces.polygons.noise import Scale, departures


def coplanar_facets(mesh: Facets, scale: Scale, tolerances: Tolerances) -> Ints:
    """Polygon of each facet: coplanar neighbours, checked against drift, then slivers."""
    inner = np.flatnonzero(mesh.inner)
    f0, f1, length = mesh.f0[inner], mesh.f1[inner], mesh.length[inner]
    base = mesh.vertices[mesh.ends[inner, 0]]
    thin = mesh.altitude < constants.THIN_NOISES * scale.noise
    strict, flat = _flat_edges(mesh, inner, thin, scale, tolerances)
    label = components(f0[flat], f1[flat], len(mesh.faces))
    if scale.scatter > 0:
        label = _peel(mesh, label, f0[flat], f1[flat], scale)
        flat = flat & (label[f0] == label[f1])
    for stricter, limit in ((strict, constants.THIN_NOISES * scale.noise), (np.zeros_like(strict), scale.fit)):
        bent = _flatness(mesh, label) > limit
        if not bent.any():
            break
        flat = np.where(bent[label[f0]], flat & stricter, flat)
        label = components(f0[flat], f1[flat], len(mesh.faces))
    label = _with_slivers(label, thin, f0, f1, length)
    for _ in range(constants.JOININGS):
        _, mean, centre = moments(mesh, label)
        a, b = label[f0], label[f1]
        gap = np.maximum(np.abs(dot(mean[a], centre[b] - base)), np.abs(dot(mean[b], centre[a] - base)))
        join = (a != b) & (angles(mean[a], mean[b]) < tolerances.coplanar) & (gap < scale.noise)
        if not join.any():
            break
        label = components(a[join], b[join], int(label.max()) + 1)[label]
    return label


def _flat_edges(
    mesh: Facets, inner: Ints, thin: Flags, scale: Scale, tolerances: Tolerances
) -> tuple[Flags, Flags]:  # fmt: skip
    """Which inner edges join coplanar facets beyond doubt, and which do as far as noise lets one tell."""
    f0, f1, ends = mesh.f0[inner], mesh.f1[inner], mesh.ends[inner]
    shared, base = ends.sum(axis=1), mesh.vertices[ends[:, 0]]
    beyond0, beyond1 = (mesh.vertices[mesh.faces[f].sum(axis=1) - shared] - base for f in (f0, f1))
    angle = angles(mesh.normal[f0], mesh.normal[f1])
    height = np.maximum(np.abs(dot(mesh.normal[f0], beyond1)), np.abs(dot(mesh.normal[f1], beyond0)))
    solid = ~(thin[f0] | thin[f1])
    strict = solid & (angle < tolerances.coplanar) & (height < scale.fit)
    flat = strict | (solid & (height < scale.noise) & (angle < constants.COPLANAR_ANGLE))
    lost = max(constants.COPLANAR_SIGMAS * scale.scatter, constants.COPLANAR_ROUNDINGS * scale.rounding)
    narrow0, narrow1 = (1 / np.maximum(mesh.altitude[f], 1e-300) for f in (f0, f1))
    turned = constants.COPLANAR_ANGLE + constants.TURNED_SIGMAS * lost / constants.COPLANAR_SIGMAS * (narrow0 + narrow1)
    flat |= solid & (np.abs(departures(mesh, inner)) < lost) & (angle < np.minimum(turned, constants.MOST_TURNED))
    return strict, flat


def _with_slivers(label: Ints, thin: Flags, f0: Ints, f1: Ints, length: Array) -> Ints:
    """The labels of facets, with every polygon of slivers given to a neighbour across its longest edge."""
    for _ in range(constants.SLIVER_PASSES):
        count = int(label.max()) + 1 if len(label) else 0
        solid = np.bincount(label, ~thin, count) > 0
        a, b = label[f0], label[f1]
        source = np.r_[a, b]
        target = np.r_[b, a]
        use = ~solid[source] & (source != target)
        if not use.any():
            break
        source, target, size = source[use], target[use], np.r_[length, length][use]
        order = np.lexsort((target, ~solid[target], -size, source))
        first = order[np.r_[True, source[order][1:] != source[order][:-1]]]
        label = components(source[first], target[first], count)[label]
    return label


def _flatness(mesh: Facets, polygon: Ints) -> Array:
    """Greatest distance of a polygon's vertices from its plane (P,)."""
    _, normal, centre = moments(mesh, polygon)
    owner = np.repeat(polygon, 3)
    out = np.zeros(len(normal))
    np.maximum.at(out, owner, np.abs(dot(mesh.vertices[mesh.faces.ravel()] - centre[owner], normal[owner])))
    return out


def moments(mesh: Facets, polygon: Ints) -> tuple[Array, Array, Array]:
    """Area, unit normal and centroid of each polygon, of the polygons (F,) that facets belong to."""
    count = int(polygon.max()) + 1 if len(polygon) else 0
    total: Array = np.bincount(polygon, mesh.area, count).astype(float)
    mean = group_sum(polygon, mesh.normal * mesh.area[:, None], count)
    weight = np.where((total <= 0)[polygon], 1.0, mesh.area)
    return total, normalised(mean), group_mean(polygon, mesh.middle, count, weight)


def _peel(mesh: Facets, label: Ints, f0: Ints, f1: Ints, scale: Scale) -> Ints:
    """Labels of clusters that scattered vertices let run on into their neighbours, one plane after the other
    taken off from the largest facet of each; `f0`, `f1` are the links between facets."""
    corners = mesh.vertices[mesh.faces]
    label = np.unique(label, return_inverse=True)[1].astype(np.int64)
    whole = np.zeros(int(label.max()) + 1, bool)
    for _ in range(constants.PEELS):
        count = len(whole)
        open_ = np.flatnonzero(~whole[label])
        if not len(open_):
            break
        order = open_[np.lexsort((open_, -mesh.area[open_], label[open_]))]
        first = order[np.r_[True, label[order][1:] != label[order][:-1]]]
        normal, point, reach = np.zeros((count, 3)), np.zeros((count, 3)), np.ones(count)
        normal[label[first]], point[label[first]] = mesh.normal[first], corners[first].mean(axis=1)
        reach[label[first]] = np.maximum(mesh.altitude[first], 1e-300)
        mine, group = corners[open_], label[open_]
        for step in range(constants.PEEL_STEPS):
            offset = mine - point[group][:, None, :]
            height = np.abs(np.einsum("ijk,ik->ij", offset, normal[group]))
            allowed = scale.noise + 0.0 * height
            if step == 0:
                far = np.sqrt(np.einsum("ijk,ijk->ij", offset, offset))
                allowed = scale.noise * (1 + far / reach[group][:, None])
            on = (height < allowed).all(axis=1) & (dot(mesh.normal[open_], normal[group]) > constants.FACING)
            fitted, centre, _ = fit_planes(np.repeat(group[on], 3), mine[on].reshape(-1, 3), normal)
            normal, point = fitted, np.where(np.bincount(group[on], minlength=count)[:, None] > 0, centre, point)
        member = np.zeros(len(label), bool)
        member[open_[on]] = True
        member[first] = True
        same = (label[f0] == label[f1]) & (member[f0] == member[f1])
        label = components(f0[same], f1[same], len(label))
        whole = np.bincount(label) == 1
        whole[label[first]] = True
        done = ~np.isin(np.arange(len(member)), open_)
        whole[label[done]] = True
    return label


def fit_planes(group: Ints, points: Array, outward: Array) -> tuple[Array, Array, Array]:
    """(normal, point, variances along the three principal directions) of groups of points (N, 3).

    Every group has three points at least. Each normal has the sense of `outward` (count, 3), which is
    returned instead where the points determine none.
    """
    count = len(outward)
    size = np.maximum(np.bincount(group, minlength=count), 1)
    centre = group_mean(group, points, count)
    offset = points - centre[group]
    covariance = group_sum(group, offset[:, :, None] * offset[:, None, :], count) / size[:, None, None]
    values, vectors = np.linalg.eigh(covariance)
    normal = vectors[:, :, 0] * np.sign(dot(vectors[:, :, 0], outward))[:, None]
    vague = np.abs(dot(normal, outward)) < constants.OUTWARD
    return np.where(vague[:, None], outward, normal), centre, np.maximum(values, 0.0)
