"""Regions that gain the same polygons in every second or third round of growth, and lose them again in the next.

A layer of polygons conforms to the fit without it, and not to the fit with it. What such regions have after the next
round is known then, and needs not be asked of every polygon beside them.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.sorting import sorted_keys
from kinform.model.arrays import Flags, Ints
from kinform.surfaces.constants import PERIODS
from kinform.surfaces.groups import parted
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.regions.territory import among


class Cycles:
    """What regions had after each round."""

    def __init__(self, regions: int):
        """Of so many regions in all."""
        self._regions = regions
        self._batches: list[Batch] = []
        self._keys: list[Ints] = []

    def add(self, batch: Batch, number: Ints) -> None:
        """The next round has left this batch, of regions with these numbers (R,), ascending."""
        self._batches.append(batch)
        self._keys.append(number[batch.region] * np.int64(batch.patchwork.count) + batch.polygon)

    def ahead(self, number: Ints) -> Batch | None:
        """The batch after the next round, where each of the last regions, which have these numbers (R,), was during one
        period what it was during the period before; else None."""
        if len(self._keys) < 2 * min(PERIODS):
            return None
        work, open_ = self._batches[-1].patchwork, np.zeros(self._regions, bool)
        open_[number] = True
        known = []
        for period in PERIODS:
            if len(self._keys) < 2 * period or not open_.any():
                continue
            returning = open_ & self._returning(period)
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
