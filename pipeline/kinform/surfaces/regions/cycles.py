"""Regions that gain the same polygons in every second or third round of growth, and lose them again in the next.

A layer of polygons conforms to the fit without it, and not to the fit with it. What such regions have after the next
round is known then, and needs not be asked of every polygon beside them.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.sorting import among, sorted_keys
from kinform.model.arrays import Flags, Ints
from kinform.surfaces.groups import parted
from kinform.surfaces.kinds.batch import Batch, Params

STEADY = 1e-8
"""Largest change of the parameters (rad, spans) of a region over a period: a two hundredth of the least noise."""

PERIODS = (2, 3)
"""Rounds after which regions are what they were, where they gain and lose the same polygons without end."""


class Cycles:
    """What regions had after each round."""

    def __init__(self, regions: int):
        """Of so many regions in all."""
        self._regions = regions
        self._batches: list[Batch] = []
        self._keys: list[Ints] = []
        self._fits: list[tuple[Ints, Params]] = []

    def add(self, batch: Batch, number: Ints, params: Params) -> None:
        """The next round has left this batch, of regions with these numbers (R,), ascending, by these fits."""
        self._batches.append(batch)
        self._keys.append(number[batch.region] * np.int64(batch.patchwork.count) + batch.polygon)
        self._fits.append((number, params))

    def ahead(self, number: Ints, params: Params) -> Batch | None:
        """The batch after the next round by these fits, where each of the last regions, which have these numbers (R,),
        has had during one period the polygons, and has now the fit, of the period before; else None."""
        if len(self._keys) < 2 * min(PERIODS):
            return None
        work, open_ = self._batches[-1].patchwork, np.zeros(self._regions, bool)
        open_[number] = True
        known = []
        for period in PERIODS:
            if len(self._keys) < 2 * period or not open_.any():
                continue
            then, fits = self._fits[-period]
            moved = np.abs(params - fits[then.searchsorted(number)]).max(axis=1)
            returning = open_ & self._returning(period)
            returning[number[moved > STEADY]] = False
            keys = self._keys[-period]
            known.append(keys.take(returning.take(keys // work.count).nonzero()[0]))
            if len(known[-1]) == len(keys) and returning.sum() == len(number):
                # with what sorting has found of it
                return self._batches[-period]
            open_ &= ~returning
        if open_.any():
            return None
        region, polygon = parted(sorted_keys(np.concatenate(known)), work.count)
        return Batch(work, number.searchsorted(region), polygon, len(number))

    def _returning(self, period: int) -> Flags:
        """(R,) which regions have been, for a period, what they were in the one before."""
        work, out = self._batches[-1].patchwork, np.ones(self._regions, bool)
        for now, then in zip(self._keys[-period:], self._keys[-2 * period : -period], strict=True):
            for one, other in ((now, then), (then, now)):
                out[one.take((~among(one, other)).nonzero()[0]) // work.count] = False
        return out
