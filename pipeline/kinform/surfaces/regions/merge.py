"""Surfaces of one part that are one: faces split by a slot, the two halves of a bore.

Two surfaces are one when kind and side agree and the vertices of the smaller lie on the larger.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.near import Near
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.kinds.kind import Batch, Kind, Params
from kinform.surfaces.kinds.kind import widths as widths_of
from kinform.surfaces.polygons.patchwork import Patchwork, Scale
from kinform.surfaces.regions.conformity import conforms

__all__ = ["coincident_planes", "coincident_regions"]

PARTNERS = 2
"""Larger surfaces, the nearest ones, that each is tried to be a piece of."""
SAMPLES = 24
"""Vertices of the smaller surface that are held against the larger before all of them are."""


def coincident_planes(work: Patchwork, number: Ints, scale: Scale) -> Ints:
    """Renumbers planes (P,), -1 elsewhere, so that coplanar faces of one sense share a number."""
    count = int(number.max()) + 1 if len(number) else 0
    if count < 2:
        return number
    member = np.flatnonzero(number >= 0)
    member = member[np.argsort(number[member], kind="stable")]
    area = np.bincount(number[member], work.area[member], count)
    normal, centre = np.zeros((count, 3)), np.zeros((count, 3))
    normal[number[member]], centre[number[member]] = work.normal[member], work.centre[member]
    offset = np.einsum("ij,ij->i", normal, centre)
    pairs = Near(np.c_[normal, offset], 5e-3).pairs
    if not len(pairs):
        return number
    larger = np.where(area[pairs[:, 0]] >= area[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    smaller = pairs.sum(axis=1) - larger
    height = np.abs(np.einsum("ij,ij->i", normal[larger], centre[smaller] - centre[larger]))
    near = height < scale.fit
    larger, smaller = larger[near], smaller[near]
    first = np.full(count, -1)
    first[number[member][::-1]] = member[::-1]
    owner, vertex = work.corners.expand(first[smaller])
    away = np.abs(np.einsum("ij,ij->i", normal[larger[owner]], work.vertices[vertex] - centre[larger[owner]]))
    same = np.bincount(owner, away > scale.fit, len(smaller)) == 0
    root = _roots(larger[same], smaller[same], area)
    return np.where(number >= 0, root[np.maximum(number, 0)], -1)


def _roots(larger: Ints, smaller: Ints, size: Array | Ints) -> Ints:
    """The surface that each becomes part of: the largest that it lies on, itself no part of another."""
    root = np.arange(len(size))
    rank = np.empty(len(size), np.int64)
    rank[np.argsort(-size, kind="stable")] = np.arange(len(size))
    larger, smaller = (
        np.where(rank[larger] < rank[smaller], larger, smaller),
        np.where(rank[larger] < rank[smaller], smaller, larger),
    )
    for k in np.lexsort((rank[larger], rank[smaller])):
        big, small = larger[k], smaller[k]
        if root[small] == small and root[big] == big:
            root[small] = big
    return root


def coincident_regions(
    work: Patchwork, kind: Kind, polygons: list[Ints], params: Params, side: Ints, scale: Scale
) -> Ints:
    """Number of the region that each of these regions, all of one kind, becomes part of."""
    count = len(polygons)
    batch = _batch(work, polygons)
    size = np.bincount(batch.region, work.area[batch.polygon], count)
    shape = np.c_[np.where(params[:, 7] == 0, params[:, 6], 0.0), params[:, 7], 4.0 * side]
    pairs = Near(shape, max(2e-3, 10 * scale.fit)).pairs
    if not len(pairs):
        return np.arange(count)
    larger = np.where(size[pairs[:, 0]] >= size[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    smaller = pairs.sum(axis=1) - larger
    distance = _touching(work, kind, batch, params, larger, smaller, scale)
    order = np.lexsort((larger, distance, smaller))
    place = np.arange(len(order)) - np.searchsorted(smaller[order], smaller[order])
    close = order[(place < PARTNERS) & np.isfinite(distance[order])]
    larger, smaller = larger[close], smaller[close]
    root = np.arange(count)
    # first all that lie together as one surface, then, where that fails, pair by pair
    cluster = components(larger, smaller, count)
    members = [m for m in _groups_of(cluster) if len(m) > 2]
    heads = np.array([m[np.lexsort((m, -size[m]))[0]] for m in members], dtype=np.int64)
    whole = _one_fit(work, kind, [[polygons[i] for i in m] for m in members], params[heads], side[heads], scale)
    for number in np.flatnonzero(whole):
        root[members[number]] = heads[number]
    open_ = root[larger] == larger
    open_ &= root[smaller] == smaller
    done = np.zeros(count, bool)
    done[heads[whole]] = True
    open_ &= ~(done[larger] | done[smaller])
    larger, smaller = larger[open_], smaller[open_]
    couples = [[polygons[i], polygons[j]] for i, j in zip(larger, smaller, strict=True)]
    same = _one_fit(work, kind, couples, params[larger], side[larger], scale)
    paired = _roots(larger[same], smaller[same], size)
    return np.where(paired != np.arange(count), paired, root)


def _groups_of(label: Ints) -> list[Ints]:
    """Members of each label, ascending."""
    order = np.argsort(label, kind="stable")
    return list(np.split(order, np.flatnonzero(np.diff(label[order])) + 1))


def _batch(work: Patchwork, polygons: list[Ints]) -> Batch:
    region = np.repeat(np.arange(len(polygons)), [len(p) for p in polygons])
    return Batch(work, region, np.concatenate(polygons), len(polygons))


def _touching(
    work: Patchwork, kind: Kind, batch: Batch, params: Params, larger: Ints, smaller: Ints, scale: Scale
) -> Array:  # fmt: skip
    """Distance of a few vertices of each smaller surface from each larger one (by pairs); inf where not near."""
    region, vertex = kind.defining(batch, params, np.full(batch.count, scale.fit))
    order = np.argsort(region, kind="stable")
    region, vertex = region[order], vertex[order]
    starts = np.searchsorted(region, np.arange(batch.count + 1))
    size = np.diff(starts)
    alive = np.arange(len(larger))
    worst = np.zeros(len(larger))
    for k in range(SAMPLES):
        at = starts[smaller[alive]] + (k * np.maximum(size[smaller[alive]] - 1, 0)) // (SAMPLES - 1)
        point = work.vertices[vertex[np.minimum(at, len(vertex) - 1)]]
        worst[alive] = np.maximum(worst[alive], np.abs(kind.probe(params[larger[alive]], point).distance))
        alive = alive[worst[alive] < 20 * scale.fit]
    return np.where(worst < 20 * scale.fit, worst, np.inf)


def _one_fit(
    work: Patchwork, kind: Kind, families: list[list[Ints]], params: Params, side: Ints, scale: Scale
) -> Flags:  # fmt: skip
    """Whether one surface, fitted to all regions of a family, explains all their polygons."""
    if not families:
        return np.zeros(0, bool)
    batch = _batch(work, [np.concatenate(family) for family in families])
    tolerance = np.full(batch.count, scale.fit)
    fitted = kind.refine(batch, params, 20 * tolerance, 2)
    fitted = kind.refine(batch, fitted, tolerance, 3)
    width = widths_of(kind, batch, fitted)
    reach = np.zeros(batch.count)
    np.maximum.at(reach, batch.region, width)
    good = conforms(kind, batch, fitted, side, 1.05 * reach + 1e-3, tolerance)
    return np.asarray(np.bincount(batch.region, ~good, batch.count) == 0)
