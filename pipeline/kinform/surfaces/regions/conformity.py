"""One step of growth: which polygons conform to a surface, and which of those a region reaches over smooth edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.graphs.components import components
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import Ragged, distinct, ordered_quantile
from kinform.surfaces.kinds.kind import Batch, Kind, Params
from kinform.surfaces.kinds.kind import widths as widths_of
from kinform.surfaces.polygons.patchwork import Patchwork, Scale

__all__ = ["WIDEST", "Ground", "conforms", "connected", "neighbours", "reach_of", "spread", "within"]

WIDEST = 1.2
"""Greatest angle that a facet may subtend (rad)."""
WIDER = 1.6
"""A polygon this much wider than the next narrower one of a region is a flat on it, not a facet of it."""


@dataclass(frozen=True, eq=False)
class Ground:
    """Where regions may grow: smooth links between polygons, and which polygons are free."""

    patchwork: Patchwork
    scale: Scale
    links: Ragged
    """Smooth edges of each polygon."""
    free: Flags

    @classmethod
    def of(cls, patchwork: Patchwork, scale: Scale, free: Flags) -> Ground:
        """The ground of a patchwork."""
        edges = np.flatnonzero(patchwork.smooth)
        rows = np.r_[patchwork.a[edges], patchwork.b[edges]]
        return cls(patchwork, scale, Ragged(rows, np.r_[edges, edges], patchwork.count), free)


def conforms(kind: Kind, batch: Batch, params: Params, side: Ints, reach: Array, tolerance: Array) -> Flags:
    """Whether each pair's polygon is a piece of its region's surface, tessellated no coarser than `reach`."""
    fits = [_conforms(kind, part, params, side, reach, tolerance) for part in batch.parts()]
    return np.concatenate(fits)


def _conforms(kind: Kind, batch: Batch, params: Params, side: Ints, reach: Array, tolerance: Array) -> Flags:
    work = batch.patchwork
    region, polygon = batch.region, batch.polygon
    owner, _ = batch.corners
    group = region[owner]
    held = kind.probe(params[group], batch.points)
    chord = 1 - np.cos(np.minimum(reach, np.pi) / 2)
    allowed, limit = held.curvature_radius * chord[group], tolerance[group]
    bad = np.zeros(len(polygon), bool)
    deepest = limit if kind.saddle else allowed + limit
    bad[owner[(held.distance >= limit) | (held.distance <= -deepest)]] = True
    middle = kind.probe(params[region], work.centre[polygon])
    # a flat has all its vertices on the surface, but is wider than the facets of it
    bad |= middle.distance <= -middle.curvature_radius * chord[region] - tolerance[region]
    cosine = np.einsum("ij,ij->i", middle.normal, work.normal[polygon]) * side[region]
    widest = np.minimum(0.5 * reach[region] + 5e-3 + work.slack[polygon], WIDEST)
    fits: Flags = ~bad & (cosine > np.cos(widest))
    return fits


def reach_of(kind: Kind, batch: Batch, params: Params) -> Array:
    """Greatest angle that a facet of each region may subtend, judged by the facets it has."""
    width = widths_of(kind, batch, params)
    order = np.lexsort((width, batch.region))
    region, sorted_width = batch.region[order], width[order]
    typical = ordered_quantile(region, sorted_width, batch.count, 0.75)
    following = np.r_[sorted_width[1:], 0.0]
    last = np.r_[region[1:] != region[:-1], True] if len(region) else np.zeros(0, bool)
    gap = ~last & (sorted_width >= typical[region]) & (following > WIDER * sorted_width)
    top = np.full(batch.count, np.inf)
    np.minimum.at(top, region[gap], sorted_width[gap])
    largest = np.zeros(batch.count)
    largest[region[last]] = np.maximum(sorted_width[last], 0.0)
    reach: Array = np.minimum(WIDER * np.minimum(top, largest), WIDEST) + 1e-3
    return reach


def neighbours(ground: Ground, batch_region: Ints, polygon: Ints) -> tuple[Ints, Ints]:
    """(region, polygon) pairs one smooth link away, free, each once."""
    work = ground.patchwork
    owner, edge = ground.links.expand(polygon)
    region = batch_region[owner]
    target = work.other(edge, polygon[owner])
    open_ = ground.free[target]
    key = distinct(region[open_] * np.int64(work.count) + target[open_])
    return key // work.count, key % work.count


def spread(
    ground: Ground, kind: Kind, batch: Batch, params: Params, side: Ints, reach: Array, tolerance: Array,
    layers: int,
) -> Batch:  # fmt: skip
    """The batch with up to `layers` layers of conforming neighbours added."""
    total = np.int64(ground.patchwork.count)
    seen = np.sort(batch.region * total + batch.polygon)
    gained = [seen]
    front, recent = seen, seen
    for _ in range(layers):
        region, polygon = neighbours(ground, front // total, front % total)
        key = region * total + polygon
        key = key[~within(key, seen) & ~within(key, recent)]
        if not len(key):
            break
        trial = Batch(ground.patchwork, key // total, key % total, batch.count)
        front = key[conforms(kind, trial, params, side, reach, tolerance)]
        if not len(front):
            break
        gained.append(front)
        recent = np.sort(np.concatenate(gained[-2:]))
    key = np.sort(np.concatenate(gained))
    return Batch(ground.patchwork, key // total, key % total, batch.count)


def within(keys: Ints, ordered: Ints) -> Flags:
    if not len(ordered):
        return np.zeros(len(keys), bool)
    at = np.minimum(np.searchsorted(ordered, keys), len(ordered) - 1)
    return np.asarray(ordered[at] == keys)


def connected(ground: Ground, batch: Batch) -> Batch:
    """The largest connected piece of each region (ties: the piece of the lowest polygon)."""
    work = ground.patchwork
    if not len(batch.region):
        return batch
    total = np.int64(work.count)
    key = batch.region * total + batch.polygon
    owner, edge = ground.links.expand(batch.polygon)
    region = batch.region[owner]
    target = region * total + work.other(edge, batch.polygon[owner])
    ok = within(target, key)
    label = components(owner[ok], np.searchsorted(key, target[ok]), len(key))
    size = np.bincount(label)
    first = np.full(len(size), len(key))
    np.minimum.at(first, label, np.arange(len(key)))
    order = np.lexsort((first[label], -size[label], batch.region))
    head = order[np.r_[True, batch.region[order][1:] != batch.region[order][:-1]]]
    best = np.full(batch.count, -1)
    best[batch.region[head]] = label[head]
    return batch.select(best[batch.region] == label)
