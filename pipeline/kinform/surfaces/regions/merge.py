"""Surfaces of one part that are one: faces split by a slot, the two halves of a bore.

Two surfaces are one when kind and side agree and the vertices of the smaller lie on the larger.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.near_points import Near
from kinform.foundation.sorting import coarse
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import columns_of, members
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.polygons.noise import Scale, Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.candidates import FACET_ROUNDING, Candidates

MERGING_FITS = 20
"""Fits within which the vertices of the smaller surface lie on the larger, before both are fitted as one. Chosen, not
measured."""
SAMPLES = 24
"""Vertices of the smaller surface that are held against the larger before all of them are: it saves work and decides
nothing."""


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
    offset = dot(normal, centre)
    # Difference of normals (rad) and offsets (spans) of planes that may be one: a first sieve, the fit decides. Chosen,
    # not measured.
    pairs = Near(np.c_[normal, offset], 5e-3).pairs
    if not len(pairs):
        return number
    larger, smaller = _by_size(pairs, area)
    above = centre.take(smaller, axis=0) - centre.take(larger, axis=0)
    height = np.abs(dot(normal.take(larger, axis=0), above))
    near = height < scale.fit
    larger, smaller = larger[near], smaller[near]
    first = np.full(count, -1)
    first[number[member][::-1]] = member[::-1]
    owner, vertex = work.corners.expand(first[smaller])
    larger_of = larger.take(owner)
    away = np.abs(dot(columns_of(normal, larger_of), work.at(vertex) - columns_of(centre, larger_of)))
    same = np.bincount(owner, away > scale.fit, len(smaller)) == 0
    root = _roots(larger[same], smaller[same], area)
    return np.where(number >= 0, root[np.maximum(number, 0)], -1)


def _by_size(pairs: Ints, size: Array | Ints) -> tuple[Ints, Ints]:
    """(larger, smaller) of each pair."""
    larger = np.where(size[pairs[:, 0]] >= size[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    return larger, pairs.sum(axis=1) - larger


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


def coincident_regions(work: Patchwork, surfaces: Candidates, polygons: list[Ints], scales: Scales) -> Ints:
    """Number of the region that each of these regions, whose surfaces are of one kind, becomes part of.

    Pairs of like shape that lie near each other are put together in clusters. All of a cluster are fitted as one
    surface first, then, where that fails, pair by pair.
    """
    count = len(polygons)
    batch = _batch(work, polygons)
    size = np.bincount(batch.region, work.area[batch.polygon], count)
    larger, smaller = _partners(surfaces, batch, size, scales.at(batch.mesh))
    root = np.arange(count)
    clusters = [m for m in members(components(larger, smaller, count)) if len(m) > 2]
    ranked = -coarse(size)
    heads = np.array([m[np.lexsort((m, ranked[m]))[0]] for m in clusters], dtype=np.int64)
    families = [np.concatenate([polygons[k] for k in cluster]) for cluster in clusters]
    whole = _one_fit(work, surfaces.of(heads), families)
    for number in np.flatnonzero(whole):
        root[clusters[number]] = heads[number]
    done = np.zeros(count, bool)
    done[heads[whole]] = True
    open_ = (root[larger] == larger) & (root[smaller] == smaller) & ~(done[larger] | done[smaller])
    larger, smaller = larger[open_], smaller[open_]
    couples = [np.concatenate([polygons[i], polygons[j]]) for i, j in zip(larger, smaller, strict=True)]
    same = _one_fit(work, surfaces.of(larger), couples)
    paired = _roots(larger[same], smaller[same], size)
    return np.where(paired != np.arange(count), paired, root)


def _batch(work: Patchwork, polygons: list[Ints]) -> Batch:
    region = np.repeat(np.arange(len(polygons)), [len(p) for p in polygons])
    return Batch(work, region, np.concatenate(polygons), len(polygons))


def _partners(surfaces: Candidates, batch: Batch, size: Array | Ints, scale: Scales) -> tuple[Ints, Ints]:
    """(larger, smaller) of the pairs of regions that may be one: each smaller one with the nearest few of like shape,
    as far as a few of its vertices lie near them."""
    kind, params, work = surfaces.kind, surfaces.params, batch.patchwork
    shape = np.c_[np.where(params[:, 7] == 0, params[:, 6], 0.0), params[:, 7], 4.0 * surfaces.side]
    pairs = np.concatenate([_alike(shape, one, scale) for one in members(batch.mesh)])
    if not len(pairs):
        return pairs[:, 0], pairs[:, 1]
    larger, smaller = _by_size(pairs, size)
    region, vertex = kind.defining(batch, params, scale.fit)
    order = np.argsort(region, kind="stable")
    region, vertex = region[order], vertex[order]
    starts = np.searchsorted(region, np.arange(batch.count + 1))
    alive = np.arange(len(larger))
    final = starts[np.searchsorted(batch.mesh, batch.mesh[smaller], side="right")] - 1
    near = MERGING_FITS * scale.fit[smaller]
    distance = np.zeros(len(larger))
    # most are far from each other at the first vertices
    for some in (range(1), range(1, 3), range(3, SAMPLES)):
        first, last = starts[smaller[alive]], starts[smaller[alive] + 1] - 1
        at = first[:, None] + (np.array(some) * np.maximum(last - first, 0)[:, None]) // (SAMPLES - 1)
        points = work.at(vertex[np.minimum(at, final[alive][:, None])].ravel())
        mine = columns_of(params, larger[alive].repeat(len(some)))
        away = np.abs(kind.probe(mine, points).distance).reshape(-1, len(some))
        distance[alive] = np.maximum(distance[alive], away.max(axis=1))
        alive = alive[distance[alive] < near[alive]]
    distance = np.where(distance < near, distance, np.inf)
    order = np.lexsort((larger, distance, smaller))
    place = np.arange(len(order)) - np.searchsorted(smaller[order], smaller[order])
    # only the two nearest larger surfaces are tried
    close = order[(place < 2) & np.isfinite(distance[order])]
    return larger[close], smaller[close]


def _alike(shape: Array, regions: Ints, scale: Scales) -> Ints:
    """(n, 2) regions, among those of one mesh, of nearly the same shape."""
    # Difference of radii (spans) and half-angles (rad) of surfaces that may be one: a first sieve, the fit decides.
    # Chosen, not measured. Or ten fits, where that is more. Chosen, not measured.
    distance = max(2e-3, 10 * float(scale.fit[regions[0]]))
    return regions[Near(shape[regions], distance).pairs]


def _one_fit(work: Patchwork, surfaces: Candidates, families: list[Ints]) -> Flags:
    """Whether one surface, fitted to all polygons of a family, explains all of them."""
    if not families:
        return np.zeros(0, bool)
    batch, fit = _batch(work, families), surfaces.tolerance
    fitted = surfaces.within(MERGING_FITS * fit).refine(batch, 2).within(fit).refine(batch, 3)
    reach = np.zeros(batch.count)
    np.maximum.at(reach, batch.region, fitted.kind.widths(batch, fitted.params))
    # 5 % wider facets than those of the parts
    good = fitted.conforms(batch, 1.05 * reach + FACET_ROUNDING)
    return np.asarray(np.bincount(batch.region, ~good, batch.count) == 0)
