"""Regions that grow over smooth edges, many at once, while their surface explains the next polygon.

Every region carries one hypothesis. Rounds of growth alternate with fits over what was gained, so that a
small neighbourhood, whose fit is coarse, only has to predict a region about twice its size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import quantile, starts_of
from kinform.surfaces.kinds.kind import Batch, Kind, Params
from kinform.surfaces.polygons.patchwork import Scale
from kinform.surfaces.regions.conformity import (
    WIDEST,
    Ground,
    conforms,
    connected,
    neighbours,
    reach_of,
    spread,
    within,
)

__all__ = ["Found", "absorb", "pursue", "whole"]

FIRST_LAYERS = 2
MAJORITY = 0.6
"""Share of a piece that must conform at the first look."""


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
    reach = reach_of(kind, pieces, params)
    fits = conforms(kind, pieces, params, side, reach, loose)
    share = np.bincount(pieces.region, fits, count) / np.maximum(batch.size, 1)
    pieces, number = _compact(pieces.select(fits & (share >= MAJORITY)[pieces.region]))
    own, sides = params[number], side[number]
    own = kind.refine(pieces, own, tight[number], 2)
    tolerance = _scatter(kind, pieces, own, scale)
    pieces = _settled(ground, kind, pieces, own, sides, tolerance, whole=False)
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
    hopeful = _hopeful(ground, kind, batch, params[number], sides, tolerance[number])
    stays = ~hopeful[batch.region]
    finished = [(number[batch.region[stays]], batch.polygon[stays])]
    batch, kept = _compact(batch.select(~stays))
    sides, number = sides[kept], number[kept]
    for _ in range(6):
        if not len(batch.region):
            break
        own, held = params[number], tolerance[number]
        before = batch.size
        larger = spread(ground, kind, batch, own, sides, reach_of(kind, batch, own), held, 64)
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


def _hopeful(ground: Ground, kind: Kind, batch: Batch, params: Params, side: Ints, tolerance: Array) -> Flags:
    """Which regions have a neighbour that would conform if facets were as wide as they may ever be."""
    total = np.int64(ground.patchwork.count)
    region, polygon = neighbours(ground, batch.region, batch.polygon)
    fresh = ~within(region * total + polygon, batch.region * total + batch.polygon)
    beside = Batch(ground.patchwork, region[fresh], polygon[fresh], batch.count)
    widest = np.full(batch.count, WIDEST + 1e-3)
    fits = conforms(kind, beside, params, side, widest, tolerance)
    return np.asarray(np.bincount(beside.region[fits], minlength=batch.count) > 0)


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
        reach = reach_of(kind, batch, own)
        batch = spread(ground, kind, batch, own, sides, reach, tight, layers)
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


def _settled(
    ground: Ground, kind: Kind, batch: Batch, params: Params, side: Ints, tolerance: Array, *, whole: bool = True
) -> Batch:  # fmt: skip
    """The batch without polygons that do not conform, and without regions that became too small.

    `whole`: each region is connected as it comes, so that only those that lose polygons can fall apart.
    """
    reach = reach_of(kind, batch, params)
    fits = conforms(kind, batch, params, side, reach, tolerance)
    torn = np.bincount(batch.region, ~fits, batch.count) > 0
    if whole and not torn.any():
        kept = batch
    elif whole and not torn.all():
        loose = torn[batch.region]
        pieces = connected(ground, batch.select(fits & loose))
        intact = batch.select(~loose)
        region = np.concatenate([intact.region, pieces.region])
        order = np.argsort(region, kind="stable")
        kept = Batch(
            batch.patchwork, region[order], np.concatenate([intact.polygon, pieces.polygon])[order], batch.count
        )
    else:
        kept = connected(ground, batch.select(fits))
    return kept.select((kept.size >= kind.least)[kept.region])


def _scatter(kind: Kind, batch: Batch, params: Params, scale: Scale) -> Array:
    """The tolerance that each region's own vertices justify, between the noise and the fit."""
    region, vertex = kind.defining(batch, params, np.full(batch.count, scale.fit))
    distance = np.abs(kind.probe(params[region], batch.patchwork.vertices[vertex]).distance)
    order = np.argsort(region, kind="stable")
    assert starts_of(region[order], batch.count)[-1] == len(region)
    middle = quantile(region, distance, batch.count, 0.5)
    return np.clip(6 * middle, scale.noise, scale.fit)
