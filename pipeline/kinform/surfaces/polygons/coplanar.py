"""Facets → polygons: connected coplanar facets, because the triangulation inside a plane says nothing.

Facets thinner than the noise have meaningless normals: each joins the polygon across its longest edge, in
whose plane it lies to within its own thickness.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from kinform.foundation.algebra.vectors import dot, normalised
from kinform.foundation.constants import COVERAGE, SCATTERED
from kinform.foundation.graphs.components import components
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces.constants import FLAT_NOISES, ROWS
from kinform.surfaces.groups import columns_of, group_mean, group_moments, slices, sums_of
from kinform.surfaces.polygons.facets import Facets, angles
from kinform.surfaces.polygons.noise import Scale, departures

COPLANAR_ANGLE = 0.06
"""rad up to which facets whose heights differ by no more than the noise are coplanar: 3.4°, above what noise turns
short facets by and below the steps of round strips. Chosen, not measured."""
MOST_TURNED = 0.5
"""rad beyond which facets are never coplanar, whatever the scatter. Chosen, not measured."""
PEELS = 60
"""Planes that are taken off a cluster before the rest of it falls into its facets: a limit of the work on crumpled
meshes. Chosen, not measured."""


Moments: TypeAlias = tuple[Array, Array, Array]
"""Area (P,), unit normal (P, 3) and centroid (P, 3) of polygons."""


def coplanar_facets(mesh: Facets, scale: Scale, tolerances: Tolerances) -> tuple[Ints, Moments]:
    """Polygon of each facet: coplanar neighbours, checked against drift, then slivers; and the polygons' moments."""
    inner = np.flatnonzero(mesh.inner)
    f0, f1, length = mesh.f0.take(inner), mesh.f1.take(inner), mesh.length.take(inner)
    base = mesh.at(mesh.starts(inner))
    thin = mesh.altitude < FLAT_NOISES * scale.noise
    strict, flat = _flat_edges(mesh, inner, thin, scale, tolerances)
    label = _linked(f0, f1, flat, len(mesh.faces))
    if scale.scatter > 0:
        label = _peel(mesh, label, f0[flat], f1[flat], scale)
        flat = flat & (label[f0] == label[f1])
    found = moments(mesh, label)
    for stricter, limit in ((strict, FLAT_NOISES * scale.noise), (np.zeros_like(strict), scale.fit)):
        bent = _flatness(mesh, label, found) > limit
        if not bent.any():
            break
        flat = np.where(bent[label[f0]], flat & stricter, flat)
        before, label = label, _linked(f0, f1, flat, len(mesh.faces))
        found = moments_again(mesh, label, before, found)
    before, label = label, _with_slivers(label, thin, f0, f1, length)
    found = moments_again(mesh, label, before, found)
    # what the first pass joined has better means for the second
    for _ in range(2):
        join = _joined(label.take(f0), label.take(f1), base, found, tolerances.coplanar, scale.noise)
        if not len(join):
            break
        before, label = label, components(label[f0[join]], label[f1[join]], int(label.max()) + 1)[label]
        found = moments_again(mesh, label, before, found)
    return label, found


def _linked(f0: Ints, f1: Ints, flat: Flags, count: int) -> Ints:
    """Components of the facets under the flat ones of these edges."""
    rows = np.flatnonzero(flat)
    return components(f0.take(rows), f1.take(rows), count)


def _joined(a: Ints, b: Ints, base: Array, found: Moments, turned: float, apart: float) -> Ints:
    """Edges, of which `base` is a point and `a`, `b` the polygons, whose polygons are in one plane by their means."""
    rows = np.flatnonzero(a != b)
    _, normal, centre = found
    normal, centre = np.asfortranarray(normal), np.asfortranarray(centre)
    a, b, base = a.take(rows), b.take(rows), columns_of(base, rows)
    for _ in range(2):
        gap = np.abs(dot(columns_of(normal, a), columns_of(centre, b) - base))
        near = np.flatnonzero(gap < apart)
        a, b, base, rows = b.take(near), a.take(near), columns_of(base, near), rows.take(near)
    return rows[angles(normal[a], normal[b]) < turned]


def _flat_edges(
    mesh: Facets, inner: Ints, thin: Flags, scale: Scale, tolerances: Tolerances
) -> tuple[Flags, Flags]:  # fmt: skip
    """Which inner edges join coplanar facets beyond doubt, and which do as far as noise lets one tell."""
    f0, f1 = mesh.f0.take(inner), mesh.f1.take(inner)
    base = mesh.at(mesh.starts(inner))
    beyond0, beyond1 = (mesh.at(vertex) - base for vertex in mesh.opposite(inner))
    normal0, normal1 = columns_of(mesh.normal, f0), columns_of(mesh.normal, f1)
    angle = angles(normal0, normal1)
    height = np.maximum(np.abs(dot(normal0, beyond1)), np.abs(dot(normal1, beyond0)))
    solid = ~(thin.take(f0) | thin.take(f1))
    strict = solid & (angle < tolerances.coplanar) & (height < scale.fit)
    flat = strict | (solid & (height < scale.noise) & (angle < COPLANAR_ANGLE))
    # Heights up to which facets of vertices that are only rounded are coplanar, in roundings: half of one in each
    # direction, √3 times.
    lost = max(COVERAGE * scale.scatter, 0.75 * scale.rounding)
    narrow0, narrow1 = (1 / np.maximum(mesh.altitude.take(f), TINY) for f in (f0, f1))
    turned = COPLANAR_ANGLE + SCATTERED * lost / COVERAGE * (narrow0 + narrow1)
    open_ = np.flatnonzero(solid & ~flat & (angle < np.minimum(turned, MOST_TURNED)))
    flat[open_] = np.abs(departures(mesh, inner.take(open_))) < lost
    return strict, flat


def _with_slivers(label: Ints, thin: Flags, f0: Ints, f1: Ints, length: Array) -> Ints:
    """The labels of facets, with every polygon of slivers given to a neighbour across its longest edge."""
    # slivers join their neighbours: a fan of them halves in each pass
    for _ in range(8):
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


def _flatness(mesh: Facets, polygon: Ints, found: Moments) -> Array:
    """Greatest distance of a polygon's vertices from its plane (P,), of polygons of several facets."""
    area, normal, centre = found
    several = np.flatnonzero(np.bincount(polygon, minlength=len(area)).take(polygon) > 1)
    owner = polygon.take(several)
    normal, centre = columns_of(normal, owner), columns_of(centre, owner)
    highest = np.zeros(len(several))
    for k in range(3):
        height = np.abs(dot(mesh.at(mesh.faces[:, k].take(several)) - centre, normal))
        np.maximum(highest, height, out=highest)
    out = np.zeros(len(area))
    np.maximum.at(out, owner, highest)
    return out


def moments(mesh: Facets, polygon: Ints) -> Moments:
    """Area, unit normal and centroid of each polygon, of the polygons (F,) that facets belong to."""
    return _moments(polygon, *_of_facets(mesh))


def _of_facets(mesh: Facets) -> Moments:
    """Area (F,), normal (F, 3) and middle (F, 3) of the facets."""
    return mesh.area, mesh.normal, mesh.middle


def _moments(polygon: Ints, area: Array, normal: Array, middle: Array) -> Moments:
    """Those of polygons (n,) of facets with these."""
    count = int(polygon.max()) + 1 if len(polygon) else 0
    total: Array = np.bincount(polygon, area, count).astype(float)
    sums = sums_of(polygon, count)
    mean = np.ascontiguousarray(sums(normal.T * area).T)
    weight = np.where((total <= 0)[polygon], 1.0, area)
    centre = sums(middle.T * weight) / np.maximum(sums(weight), TINY)
    return total, normalised(mean), np.ascontiguousarray(centre.T)


def moments_again(mesh: Facets, polygon: Ints, before: Ints, found: Moments) -> Moments:
    """`moments`, to the same bits, of polygons most of which are what they were `before` (F,), with what was `found`
    of those: the sums are of each polygon by itself."""
    if polygon is before:
        return found
    count = int(polygon.max()) + 1
    was = np.empty(count, np.int64)
    was[polygon] = before
    same = np.bincount(polygon, minlength=count) == np.bincount(before, minlength=len(found[0])).take(was)
    same[polygon.take((was.take(polygon) != before).nonzero()[0])] = False
    kept, fresh = same.nonzero()[0], (~same).nonzero()[0]
    number = np.full(count, -1)
    number[fresh] = np.arange(len(fresh))
    mine = number.take(polygon)
    facets = (mine >= 0).nonzero()[0]
    again = _moments(mine.take(facets), *(columns.T.take(facets, axis=-1).T for columns in _of_facets(mesh)))
    out = []
    for old, new in zip(found, again, strict=True):
        both = np.empty((count, *old.shape[1:]))
        both[kept], both[fresh] = old.take(was.take(kept), axis=0), new
        out.append(both)
    area, normal, centre = out
    return area, normal, centre


def _peel(mesh: Facets, label: Ints, f0: Ints, f1: Ints, scale: Scale) -> Ints:
    """Labels of clusters that scattered vertices let run on into their neighbours, one plane after the other
    taken off from the largest facet of each, as long as planes make a cluster up; `f0`, `f1` are the links between
    facets."""
    label = np.unique(label, return_inverse=True)[1].astype(np.int64)
    whole = np.zeros(int(label.max()) + 1, bool)
    most = np.zeros(len(label), np.int64)
    for number in range(1, PEELS + 1):
        open_ = np.flatnonzero(~whole[label])
        if not len(open_):
            break
        order = open_[np.lexsort((-mesh.area[open_], label[open_]))]
        first = order[heads(label[order])]
        group = np.searchsorted(label[first], label[open_])
        on = open_[_in_planes(mesh, first, open_, group, scale)]
        member = np.zeros(len(label), bool)
        member[on] = member[first] = True
        same = (label[f0] == label[f1]) & (member[f0] == member[f1])
        label = components(f0[same], f1[same], len(label))
        size = np.bincount(label)
        most[open_] = np.maximum(most[open_], size[label[first]][group])
        whole = size == 1
        whole[label[first]] = True
        done = np.ones(len(member), bool)
        done[open_] = False
        whole[label[done]] = True
        # every eighth plane it is checked whether planes make up the cluster
        if number % 8 == 0:
            # Share of a cluster that the rest of the planes would take if all were as large as the largest of those, at
            # least: what is less is curved.
            vain = most * (PEELS - number) < 0.1 * size[label]
            whole[label[vain]] = True
            most[:] = 0
    return label


def _in_planes(mesh: Facets, first: Ints, facets: Ints, group: Ints, scale: Scale) -> Flags:
    """Which of the facets are in the plane of their group, fitted to what is in that of the facet `first` of each."""
    normal, point = mesh.normal[first], mesh.vertices[mesh.faces[first]].mean(axis=1)
    reach = np.maximum(mesh.altitude[first], TINY)
    on: Flags = np.empty(len(facets), bool)
    # fitted to the facet first, then to what lies in its plane
    for step in range(3):
        for rows in slices(len(facets), ROWS):
            mine, faces = group[rows], facets[rows]
            offset = mesh.vertices[mesh.faces[faces]] - point[mine][:, None, :]
            height = np.abs(np.einsum("ijk,ik->ij", offset, normal[mine]))
            allowed: float | Array = scale.noise
            if step == 0:
                far = np.sqrt(np.einsum("ijk,ijk->ij", offset, offset))
                allowed = scale.noise * (1 + far / reach[mine][:, None])
            # facets of a plane are within 60° of it, however their vertices scatter
            facing = dot(mesh.normal[faces], normal[mine]) > 0.5
            on[rows] = (height < allowed).all(axis=1) & facing
        fitting = group[on]
        corners = mesh.vertices[mesh.faces[facets[on]]].reshape(-1, 3)
        normal, centre, _ = fit_planes(np.repeat(fitting, 3), corners, normal)
        point = np.where(np.bincount(fitting, minlength=len(first))[:, None] > 0, centre, point)
    return on


def fit_planes(group: Ints, points: Array, outward: Array) -> tuple[Array, Array, Array]:
    """(normal, point, variances along the three principal directions) of groups of points (N, 3).

    Every group has three points at least. Each normal has the sense of `outward` (count, 3), which is
    returned instead where the points determine none.
    """
    count = len(outward)
    size = np.maximum(np.bincount(group, minlength=count), 1)
    centre = group_mean(group, points, count)
    offset = points - columns_of(centre, group)
    covariance = group_moments(group, offset.T, count) / size[:, None, None]
    values, vectors = np.linalg.eigh(covariance)
    normal = vectors[:, :, 0] * np.sign(dot(vectors[:, :, 0], outward))[:, None]
    # Least cosine between the plane through the vertices and the mean normal of the facets: below, the vertices of a
    # sliver determine no plane. Chosen, not measured.
    vague = np.abs(dot(normal, outward)) < 0.99
    return np.where(vague[:, None], outward, normal), centre, np.maximum(values, 0.0)
