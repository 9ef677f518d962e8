"""Regions that grow over smooth edges, many at once, while their surface explains the next polygon.

Every region carries one hypothesis. Rounds of growth alternate with fits over what was gained, so that a
small neighbourhood, whose fit is coarse, only has to predict a region about twice its size.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.sorting import among, ascending, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import repeated
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.kind import Kind
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.regions.candidates import FACET_ROUNDING, Candidates
from kinform.surfaces.regions.constants import WIDEST
from kinform.surfaces.regions.cycles import Cycles
from kinform.surfaces.regions.territory import Territory

LOOSE = 2.5
"""Fits within which a first guess is held to its region: it comes from few polygons. Chosen, not measured."""
MAJORITY = 0.6
"""Share of a piece that must conform at the first look. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Growth:
    """R regions, some of them empty, with the surfaces that they are."""

    surfaces: Candidates
    batch: Batch
    origin: Ints
    """(R,) number of the piece, or the seed, that each comes of."""

    def each(self) -> list[Growth]:
        """The regions of each kind by themselves."""
        every = self.surfaces.kind.each(self.batch.count)
        return [Growth(self.surfaces.run(kind, run), self.batch.run(run), self.origin[run]) for kind, run in every]


def whole(
    territory: Territory, kind: Kind, batch: Batch, side: Ints, proposal: tuple[Params, Flags] | None = None
) -> Growth:  # fmt: skip
    """Regions of pieces, each of which hangs together, that are one surface for the greatest part, without growth; of
    others come empty ones or none.

    Four fits out of five end at the first look, so that comes before anything that costs more. `proposal` is that of
    the kind for the batch, where it was made before.
    """
    params, usable = proposal or kind.propose(batch)
    pieces, origin = batch.where(usable).compact()
    params = params[origin]
    side = _facing(kind, pieces, params) if kind.saddle else side[origin]
    fit = territory.scales_of(pieces).fit
    surfaces = Candidates(kind, params, side, LOOSE * fit).refine(pieces, 2)
    if not kind.saddle:
        pieces, number = pieces.select(_may_be_most(surfaces, pieces).take(pieces.region)).compact()
        surfaces, origin, fit = surfaces.of(number), origin[number], fit[number]
    fits = surfaces.conforms(pieces, surfaces.reach(pieces))
    every, conforming = pieces.size, np.bincount(pieces.region[fits], minlength=pieces.count)
    most = _most(kind, conforming, every)
    pieces, number = pieces.select(fits & most.take(pieces.region)).compact()
    kept = surfaces.of(number).within(fit[number]).refine(pieces, 2)
    kept = kept.within(_justify(kept, pieces, territory.scales_of(pieces)))
    pieces = _settle(territory, kept, pieces, every[number])
    return _credible(territory, kept.refine(pieces, 1), pieces, origin[number])


def absorb(territory: Territory, growth: Growth) -> Growth:
    """Regions with what conforms beside them, and their fits over it. Only what gained is fitted again."""
    params = growth.surfaces.params.copy()
    batch, number = growth.batch.compact()
    hopeful = _hopeful(territory, growth.surfaces.of(number), batch)
    finished = [_keys(batch.where(~hopeful), number)]
    batch, kept = batch.where(hopeful).compact()
    number = number[kept]
    surfaces = growth.surfaces.of(number)
    # rounds in which whole pieces grow. Chosen, not measured
    for _ in range(6):
        if not len(batch.region):
            break
        # a piece that is whole already gains few layers
        larger = territory.spread(surfaces, batch, surfaces.reach(batch), 64)
        gained = larger.size > batch.size
        finished.append(_keys(batch.where(~gained), number))
        batch, kept = larger.where(gained).compact()
        number = number[kept]
        if not len(number):
            break
        surfaces = surfaces.of(kept).refine(batch, 1)
        params[number] = surfaces.params
        batch = _settle(territory, surfaces, batch)
    finished.append(_keys(batch, number))
    grown = Batch.of_keys(territory.patchwork, np.sort(np.concatenate(finished)), growth.batch.count)
    return Growth(replace(growth.surfaces, params=params), grown, growth.origin)


def pursue(territory: Territory, kind: Kind, batch: Batch, side: Ints) -> Growth:
    """Fits, grows, fits again until nothing changes; of regions that fail come empty ones or none.

    A seed must conform to its own hypothesis with at least `kind.least` polygons.
    """
    params, usable = kind.propose(batch)
    batch, origin = batch.where(usable).compact()
    fit = territory.scales_of(batch).fit
    surfaces = Candidates(kind.of(origin), params[origin], side[origin], LOOSE * fit).refine(batch, 2)
    batch, surfaces = _grow(territory, surfaces, _settle(territory, surfaces, batch))
    batch, number = batch.compact()
    if not len(number):
        return Growth(surfaces.of(number), batch, origin[number])
    kept = surfaces.of(number).refine(batch, 2)
    kept = kept.within(_justify(kept, batch, territory.scales_of(batch)))
    batch = _settle(territory, kept, batch)
    return _credible(territory, kept.refine(batch, 2), batch, origin[number])


def _grow(territory: Territory, surfaces: Candidates, batch: Batch) -> tuple[Batch, Candidates]:
    """Rounds of fitting and growing. A region that did not change in a round is finished and leaves, so
    that the later rounds work on the few that still grow."""
    count, params = batch.count, surfaces.params.copy()
    fit = territory.scales_of(batch).fit
    finished = []
    cycles = Cycles(count)
    batch, number = batch.compact()
    growing = surfaces.of(number)
    # with doubled layers 14 rounds are enough for 4,000 facets in a row
    for stage in range(14):
        if not len(batch.region):
            break
        before = batch.size
        growing = growing.refine(batch, 2).within(fit[number])
        ahead = cycles.ahead(number, growing.params)
        if ahead is None:
            batch = _drop_shared(growing.kind, _settle(territory, growing, batch))
            # layers of polygons that a region gains: twice as many in each round, up to 512
            layers = min(2 << stage, 512)
            batch = territory.spread(growing, batch, growing.reach(batch), layers)
        else:
            batch = ahead
        params[number] = growing.params
        still = batch.size == before if stage else np.zeros(batch.count, bool)
        finished.append(_keys(batch.where(still), number))
        batch, kept = batch.where(~still).compact()
        growing, number = growing.of(kept), number[kept]
        cycles.add(batch, number, growing.params)
    finished.append(_keys(batch, number))
    grown = Batch.of_keys(territory.patchwork, np.sort(np.concatenate(finished)), count)
    return grown, Candidates(surfaces.kind, params, surfaces.side, fit)


def _facing(kind: Kind, batch: Batch, params: Params) -> Ints:
    """+1 where the polygons face as the normals of the surfaces, -1 where they face against them."""
    work = batch.patchwork
    normal = kind.probe(repeated(params, batch.size), work.middles(batch.polygon)).normal
    agreement = dot(normal, work.normals(batch.polygon)) * work.area.take(batch.polygon)
    return np.where(np.bincount(batch.region, agreement, batch.count) >= 0, 1, -1).astype(np.int64)


def _may_be_most(surfaces: Candidates, batch: Batch) -> Flags:
    """Which regions may conform for the greatest part: of the others so many of every second polygon do not, with
    facets as wide as they may ever be, that all the rest would be too few. Most fail here, at half of the price."""
    size = batch.size
    first = size.cumsum() - size
    rows = ((np.arange(len(batch.region)) - first.take(batch.region)) % 2 == 0).nonzero()[0]
    some = Batch(batch.patchwork, batch.region.take(rows), batch.polygon.take(rows), batch.count)
    fits = surfaces.conforms(some, np.full(batch.count, WIDEST + FACET_ROUNDING))
    refused = some.size - np.bincount(some.region[fits], minlength=batch.count)
    return _most(surfaces.kind, size - refused, size)


def _most(kind: Kind, conforming: Ints, size: Ints) -> Flags:
    """Whether so many polygons that conform, of so many in all, are the greatest part, and as many as the kind needs:
    none are gained afterwards."""
    return np.asarray((conforming / size >= MAJORITY) & kind.enough(conforming))


def _hopeful(territory: Territory, surfaces: Candidates, batch: Batch) -> Flags:
    """Which regions have a neighbour that would conform if facets were as wide as they may ever be."""
    keys = territory.neighbours(batch.keys)
    beside = Batch.of_keys(territory.patchwork, keys[~among(keys, batch.keys)], batch.count)
    fits = surfaces.conforms(beside, np.full(batch.count, WIDEST + FACET_ROUNDING))
    return np.asarray(np.bincount(beside.region[fits], minlength=batch.count) > 0)


def _keys(batch: Batch, number: Ints) -> Ints:
    """Keys of the pairs under the numbers (R,) that the regions had before."""
    return number[batch.region] * np.int64(batch.patchwork.count) + batch.polygon


def _drop_shared(kind: Kind, batch: Batch) -> Batch:
    """The batch with regions emptied most of whose polygons belong to a larger region of their kind as well."""
    if not len(batch.region):
        return batch
    polygon = batch.polygon
    for number, (_, regions) in enumerate(kind.each(batch.count)):
        if number:
            polygon = np.where(batch.region < regions.start, polygon, polygon + number * batch.patchwork.count)
    # of each polygon the largest region first, of equal ones the first
    order = ascending((batch.size.max() - batch.size).take(batch.region), int(batch.size.max()) + 1)
    order = order.take(ascending(polygon.take(order), int(polygon.max()) + 1))
    polygon = polygon.take(order)
    first = order.take(heads(polygon).nonzero()[0])
    unshared = np.bincount(batch.region.take(first), minlength=batch.count)
    # Least share of the polygons of a region that belong to no larger one: with less it is dropped. Chosen, not
    # measured.
    return batch.where(unshared > 0.4 * batch.size)


def _conforming(surfaces: Candidates, batch: Batch) -> Batch:
    return batch.select(surfaces.conforms(batch, surfaces.reach(batch)))


def _large(kind: Kind, batch: Batch) -> Batch:
    return batch.where(kind.enough(batch.size))


def _settle(territory: Territory, surfaces: Candidates, batch: Batch, whole: Ints | None = None) -> Batch:
    """The batch without polygons that do not conform, and without regions that fell apart and became too small. Regions
    of as many polygons as `whole` (R,) hang together, by default all of them."""
    kept = _conforming(surfaces, batch)
    torn = (kept.size < (batch.size if whole is None else whole))[kept.region].nonzero()[0]
    if len(torn):
        keep = np.ones(len(kept.region), bool)
        keep[torn] = territory.connected(Batch(kept.patchwork, kept.region[torn], kept.polygon[torn], kept.count))
        kept = kept.select(keep)
    return _large(surfaces.kind, kept)


def _justify(surfaces: Candidates, batch: Batch, scale: Scales) -> Array:
    """The tolerance that each region's own vertices justify, between the noise and the fit."""
    # Tolerance of a region in middle distances of its vertices: four standard deviations.
    return np.clip(6 * surfaces.scatter(batch), scale.noise, scale.fit)


def _credible(territory: Territory, surfaces: Candidates, batch: Batch, origin: Ints) -> Growth:
    """Those of the regions that there is evidence enough for."""
    credible = surfaces.kind.credible(batch, surfaces.params, territory.scales_of(batch))
    return Growth(surfaces, batch.where(credible), origin)
