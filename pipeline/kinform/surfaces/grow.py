"""Regions that grow over smooth edges, many at once, while their surface explains the next polygon.

Every region carries one hypothesis. Rounds of growth alternate with fits over what was gained, so that a
small neighbourhood, whose fit is coarse, only has to predict a region about twice its size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.surfaces._batch import Array, Ints, Mask, Ragged, components, quantile, starts_of
from kinform.surfaces.kind import Batch, Kind, Params
from kinform.surfaces.kind import widths as widths_of
from kinform.surfaces.topology import Patchwork, Scale

__all__ = ["Found", "Ground", "absorb", "conforms", "pursue", "whole"]

FIRST_LAYERS = 2
MAJORITY = 0.6
"""Share of a piece that must conform at the first look."""
WIDER = 1.6
"""A polygon this much wider than the next narrower one of a region is a flat on it, not a facet of it."""


@dataclass(frozen=True, eq=False)
class Ground:
    """Where regions may grow: smooth links between polygons, and which polygons are free."""

    patchwork: Patchwork
    scale: Scale
    links: Ragged
    """Smooth edges of each polygon."""
    free: Mask

    @classmethod
    def of(cls, patchwork: Patchwork, scale: Scale, free: Mask) -> Ground:
        """The ground of a patchwork."""
        edges = np.flatnonzero(patchwork.smooth)
        rows = np.r_[patchwork.a[edges], patchwork.b[edges]]
        return cls(patchwork, scale, Ragged(rows, np.r_[edges, edges], patchwork.count), free)


@dataclass(frozen=True, eq=False)
class Found:
    """Regions with their surfaces: `batch` holds pairs for `count` regions, some of them empty."""

    kind: Kind
    batch: Batch
    params: Params
    side: Ints
    """(R,) +1 convex, -1 concave."""
    tolerance: Array
    """(R,) to which the vertices were held."""


def conforms(kind: Kind, batch: Batch, params: Params, side: Ints, reach: Array, tolerance: Array) -> Mask:
    """Whether each pair's polygon is a piece of its region's surface, tessellated no coarser than `reach`."""
    fits = [_conforms(kind, part, params, side, reach, tolerance) for part in batch.parts()]
    return np.concatenate(fits)


def _conforms(kind: Kind, batch: Batch, params: Params, side: Ints, reach: Array, tolerance: Array) -> Mask:
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
    widest = np.minimum(0.5 * reach[region] + 5e-3 + work.slack[polygon], 1.2)
    fits: Mask = ~bad & (cosine > np.cos(widest))
    return fits


def _reach(kind: Kind, batch: Batch, params: Params) -> Array:
    """Greatest angle that a facet of each region may subtend, judged by the facets it has."""
    width = widths_of(kind, batch, params)
    typical = quantile(batch.region, width, batch.count, 0.75)
    order = np.lexsort((width, batch.region))
    region, sorted_width = batch.region[order], width[order]
    following = np.r_[sorted_width[1:], 0.0]
    last = np.r_[region[1:] != region[:-1], True] if len(region) else np.zeros(0, bool)
    gap = ~last & (sorted_width >= typical[region]) & (following > WIDER * sorted_width)
    top = np.full(batch.count, np.inf)
    np.minimum.at(top, region[gap], sorted_width[gap])
    largest = np.zeros(batch.count)
    np.maximum.at(largest, region, sorted_width)
    reach: Array = np.minimum(WIDER * np.minimum(top, largest), 1.2) + 1e-3
    return reach


def _neighbours(ground: Ground, batch_region: Ints, polygon: Ints) -> tuple[Ints, Ints]:
    """(region, polygon) pairs one smooth link away, free, each once."""
    work = ground.patchwork
    owner, edge = ground.links.expand(polygon)
    region = batch_region[owner]
    target = work.other(edge, polygon[owner])
    open_ = ground.free[target]
    key = np.unique(region[open_] * np.int64(work.count) + target[open_])
    return key // work.count, key % work.count


def _spread(
    ground: Ground, kind: Kind, batch: Batch, params: Params, side: Ints, reach: Array, tolerance: Array,
    layers: int,
) -> Batch:  # fmt: skip
    """The batch with up to `layers` layers of conforming neighbours added."""
    work = ground.patchwork
    total = np.int64(work.count)
    seen = np.sort(batch.region * total + batch.polygon)
    gained = [seen]
    front_region, front_polygon = batch.region, batch.polygon
    recent = seen
    for _ in range(layers):
        region, polygon = _neighbours(ground, front_region, front_polygon)
        key = region * total + polygon
        fresh = ~_within(key, seen) & ~_within(key, recent)
        trial = Batch(work, region[fresh], polygon[fresh], batch.count)
        if not len(trial.region):
            break
        good = conforms(kind, trial, params, side, reach, tolerance)
        front_region, front_polygon = trial.region[good], trial.polygon[good]
        if not len(front_region):
            break
        layer = front_region * total + front_polygon
        gained.append(layer)
        recent = np.sort(np.concatenate(gained[-2:]))
    key = np.sort(np.concatenate(gained))
    return Batch(work, key // total, key % total, batch.count)


def _within(keys: Ints, ordered: Ints) -> Mask:
    if not len(ordered):
        return np.zeros(len(keys), bool)
    at = np.minimum(np.searchsorted(ordered, keys), len(ordered) - 1)
    return np.asarray(ordered[at] == keys)


def _connected(ground: Ground, batch: Batch) -> Batch:
    """The largest connected piece of each region (ties: the piece of the lowest polygon)."""
    work = ground.patchwork
    if not len(batch.region):
        return batch
    total = np.int64(work.count)
    key = batch.region * total + batch.polygon
    owner, edge = ground.links.expand(batch.polygon)
    region = batch.region[owner]
    target = region * total + work.other(edge, batch.polygon[owner])
    ok = _within(target, key)
    label = components(owner[ok], np.searchsorted(key, target[ok]), len(key))
    size = np.bincount(label)
    first = np.full(len(size), len(key))
    np.minimum.at(first, label, np.arange(len(key)))
    order = np.lexsort((first[label], -size[label], batch.region))
    head = order[np.r_[True, batch.region[order][1:] != batch.region[order][:-1]]]
    best = np.full(batch.count, -1)
    best[batch.region[head]] = label[head]
    return batch.select(best[batch.region] == label)


def _thin_out(batch: Batch) -> Batch:
    """Empties regions most of whose polygons belong to a larger region as well."""
    if not len(batch.region):
        return batch
    order = np.lexsort((batch.region, -batch.size[batch.region], batch.polygon))
    polygon = batch.polygon[order]
    head = np.r_[True, polygon[1:] != polygon[:-1]]
    own = np.bincount(batch.region[order][head], minlength=batch.count)
    keep = own > 0.4 * batch.size
    return batch.select(keep[batch.region])


def whole(ground: Ground, kind: Kind, batch: Batch, side: Ints) -> Found:
    """Regions of pieces that are one surface for the greatest part, without growth; the others come back empty.

    Four fits out of five end at the first look, so that comes before anything that costs more.
    """
    scale, count = ground.scale, batch.count
    params, usable = kind.propose(batch)
    pieces = batch.select(usable[batch.region])
    if kind.saddle:
        side = _facing(kind, pieces, params)
    loose, tight = np.full(count, 2.5 * scale.fit), np.full(count, scale.fit)
    params = kind.refine(pieces, params, loose, 2)
    reach = _reach(kind, pieces, params)
    fits = conforms(kind, pieces, params, side, reach, loose)
    share = np.bincount(pieces.region, fits, count) / np.maximum(batch.size, 1)
    pieces, number = _compact(pieces.select(fits & (share >= MAJORITY)[pieces.region]))
    own, sides = params[number], side[number]
    own = kind.refine(pieces, own, tight[number], 2)
    tolerance = _scatter(kind, pieces, own, scale)
    pieces = _settled(ground, kind, pieces, own, sides, tolerance)
    own = kind.refine(pieces, own, tolerance, 1)
    pieces = pieces.select(kind.credible(pieces, own, scale)[pieces.region])
    params[number], tight[number] = own, tolerance
    return Found(kind, Batch(ground.patchwork, number[pieces.region], pieces.polygon, count), params, side, tight)


def _facing(kind: Kind, batch: Batch, params: Params) -> Ints:
    """+1 where the polygons face as the normals of the surfaces, -1 where they face against them."""
    work = batch.patchwork
    normal = kind.probe(params[batch.region], work.centre[batch.polygon]).normal
    agreement = np.einsum("ij,ij->i", normal, work.normal[batch.polygon]) * work.area[batch.polygon]
    return np.where(np.bincount(batch.region, agreement, batch.count) >= 0, 1, -1).astype(np.int64)


def absorb(ground: Ground, found: Found) -> Found:
    """Regions with what conforms beside them, and their fits over it. Only what gained is fitted again."""
    kind, params, tolerance = found.kind, found.params.copy(), found.tolerance.copy()
    batch, number = _compact(found.batch)
    sides = found.side[number]
    finished: list[tuple[Ints, Ints]] = []
    for _ in range(6):
        if not len(batch.region):
            break
        own, held = params[number], tolerance[number]
        before = batch.size
        larger = _spread(ground, kind, batch, own, sides, _reach(kind, batch, own), held, 64)
        gained = larger.size > before
        same = ~gained[batch.region]
        finished.append((number[batch.region[same]], batch.polygon[same]))
        batch, kept = _compact(larger.select(gained[larger.region]))
        sides, number, held = sides[kept], number[kept], held[kept]
        own = kind.refine(batch, params[number], held, 1)
        params[number] = own
        batch = _settled(ground, kind, batch, own, sides, held)
        finished_empty = batch.size == 0
        if finished_empty.all():
            break
    finished.append((number[batch.region], batch.polygon))
    region, polygon = (np.concatenate(column) for column in zip(*finished, strict=True))
    order = np.lexsort((polygon, region))
    grown = Batch(ground.patchwork, region[order], polygon[order], found.batch.count)
    return Found(kind, grown, params, found.side, tolerance)


def pursue(ground: Ground, kind: Kind, batch: Batch, side: Ints, majority: float = 0.0) -> Found:
    """Fits, grows, fits again until nothing changes; regions that fail come back empty.

    A seed must conform to its own hypothesis: at least `kind.least` polygons and the share `majority`.
    """
    scale, count = ground.scale, batch.count
    params, usable = kind.propose(batch)
    batch = batch.select(usable[batch.region])
    loose, tight = np.full(count, 2.5 * scale.fit), np.full(count, scale.fit)
    params = kind.refine(batch, params, loose, 2)
    seeded = batch.size
    batch = _settled(ground, kind, batch, params, side, loose)
    batch = batch.select((batch.size >= majority * seeded)[batch.region])
    batch, params = _grown(ground, kind, batch, params, side)
    batch, number = _compact(batch)
    own, sides, tight = params[number], side[number], tight[number]
    own = kind.refine(batch, own, tight, 2)
    tolerance = _scatter(kind, batch, own, scale)
    batch = _settled(ground, kind, batch, own, sides, tolerance)
    own = kind.refine(batch, own, tolerance, 2)
    keep = kind.credible(batch, own, scale)
    batch = batch.select(keep[batch.region])
    params[number], tight = own, np.full(count, scale.fit)
    tight[number] = tolerance
    return Found(kind, Batch(ground.patchwork, number[batch.region], batch.polygon, count), params, side, tight)


def _grown(ground: Ground, kind: Kind, batch: Batch, params: Params, side: Ints) -> tuple[Batch, Params]:
    """Rounds of fitting and growing. A region that did not change in a round is finished and leaves, so
    that the later rounds work on the few that still grow."""
    scale, count, params = ground.scale, batch.count, params.copy()
    finished: list[tuple[Ints, Ints]] = []
    batch, number = _compact(batch)
    own, sides = params[number], side[number]
    layers = FIRST_LAYERS
    for stage in range(14):
        if not len(batch.region):
            break
        tight = np.full(batch.count, scale.fit)
        before = batch.size
        own = kind.refine(batch, own, 2.5 * tight if stage == 0 else tight, 2)
        batch = _thin_out(_settled(ground, kind, batch, own, sides, tight))
        reach = _reach(kind, batch, own)
        batch = _spread(ground, kind, batch, own, sides, reach, tight, layers)
        layers = min(layers * 2, 512)
        params[number] = own
        still = batch.size == before if stage else np.zeros(batch.count, bool)
        settled = still[batch.region]
        finished.append((number[batch.region[settled]], batch.polygon[settled]))
        batch, kept = _compact(batch.select(~settled))
        own, sides, number = own[kept], sides[kept], number[kept]
    finished.append((number[batch.region], batch.polygon))
    region, polygon = (np.concatenate(column) for column in zip(*finished, strict=True))
    order = np.lexsort((polygon, region))
    return Batch(ground.patchwork, region[order], polygon[order], count), params


def _compact(batch: Batch) -> tuple[Batch, Ints]:
    """The batch with its regions numbered without gaps, and the old number of each."""
    number = np.flatnonzero(batch.size)
    new = np.full(batch.count, -1)
    new[number] = np.arange(len(number))
    return Batch(batch.patchwork, new[batch.region], batch.polygon, len(number)), number


def _settled(ground: Ground, kind: Kind, batch: Batch, params: Params, side: Ints, tolerance: Array) -> Batch:
    """The batch without polygons that do not conform, and without regions that became too small."""
    reach = _reach(kind, batch, params)
    batch = batch.select(conforms(kind, batch, params, side, reach, tolerance))
    batch = _connected(ground, batch)
    return batch.select((batch.size >= kind.least)[batch.region])


def _scatter(kind: Kind, batch: Batch, params: Params, scale: Scale) -> Array:
    """The tolerance that each region's own vertices justify, between the noise and the fit."""
    region, vertex = kind.defining(batch, params, np.full(batch.count, scale.fit))
    distance = np.abs(kind.probe(params[region], batch.patchwork.vertices[vertex]).distance)
    order = np.argsort(region, kind="stable")
    assert starts_of(region[order], batch.count)[-1] == len(region)
    middle = quantile(region, distance, batch.count, 0.5)
    return np.clip(6 * middle, scale.noise, scale.fit)
