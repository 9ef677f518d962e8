"""Where regions may grow: polygons, the smooth edges between them, and which of the polygons are free."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from kinform.foundation.graphs.components import components
from kinform.foundation.sorting import among, distinct, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import Ragged, parted
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.candidates import Candidates


@dataclass(frozen=True, eq=False)
class Territory:
    """The polygons of one or more meshes while regions grow on them."""

    patchwork: Patchwork
    scales: Scales
    """Of the meshes."""
    links: Ragged
    """Smooth edges of each polygon."""
    beside: Ragged
    """Polygons across them."""
    free: Flags
    """(P,) in no region yet; written as regions are chosen."""

    @classmethod
    def of(cls, patchwork: Patchwork, scales: Scales) -> Territory:
        """The territory of a patchwork, all of it free."""
        edges = np.flatnonzero(patchwork.smooth)
        rows = np.r_[patchwork.a[edges], patchwork.b[edges]]
        links = Ragged(rows, np.r_[edges, edges], patchwork.count)
        owner = np.arange(patchwork.count).repeat(np.diff(links.starts))
        beside = links.carrying(patchwork.other(links.items, owner))
        return cls(patchwork, scales, links, beside, np.ones(patchwork.count, bool))

    def scales_of(self, batch: Batch) -> Scales:
        """(R,) of the mesh of each region."""
        return self.scales.at(batch.mesh)

    @property
    def smooth(self) -> Ints:
        """Smooth edges between free polygons."""
        edges, a, b = self._open
        rows = (self.free.take(a) & self.free.take(b)).nonzero()[0]
        if len(rows) < len(edges):
            self._open[:] = edges.take(rows), a.take(rows), b.take(rows)
        return self._open[0]

    @cached_property
    def _open(self) -> list[Ints]:
        """Smooth edges that were between free polygons when that was asked last, and the polygons on either side: what
        is taken is never free again."""
        edges = self.patchwork.smooth.nonzero()[0]
        return [edges, self.patchwork.a.take(edges), self.patchwork.b.take(edges)]

    @cached_property
    def rank(self) -> Ints:
        """(E,) place of each smooth edge among all by its length, from the shortest, equal ones as they come."""
        edges = self.patchwork.smooth.nonzero()[0]
        out = np.full(len(self.patchwork.a), -1)
        out[edges[np.argsort(self.patchwork.length[edges], kind="stable")]] = np.arange(len(edges))
        return out

    def neighbours(self, keys: Ints) -> Ints:
        """Keys of the free polygons one smooth link away from those of the `keys`, each once, by region."""
        region, polygon = parted(keys, self.patchwork.count)
        return self._neighbours(region * np.int64(self.patchwork.count), polygon)

    def _neighbours(self, first: Ints, polygon: Ints) -> Ints:
        """The same of polygons whose regions have keys from `first` on."""
        base, target = self.beside.expand(polygon, first)
        open_ = self.free.take(target).nonzero()[0]
        return distinct(base.take(open_) + target.take(open_))

    def spread(self, surfaces: Candidates, batch: Batch, reach: Array, layers: int) -> Batch:
        """The batch with up to `layers` layers of conforming neighbours added."""
        front = np.sort(batch.keys)
        gained = [front]
        # what is beside a layer, and not of those two steps, is beside no earlier layer
        before, tried = front[:0], front
        keys = self.neighbours(front) if layers else before
        for layer in range(layers):
            seen = among(keys, tried)
            if len(before):
                seen |= among(keys, before)
            keys = keys.take((~seen).nonzero()[0])
            if not len(keys):
                break
            trial = Batch.of_keys(self.patchwork, keys, batch.count)
            rows = surfaces.conforms(trial, reach).nonzero()[0]
            if not len(rows):
                break
            gained.append(keys.take(rows))
            before, tried = tried, keys
            if layer + 1 < layers:
                polygon = trial.polygon.take(rows)
                keys = self._neighbours(gained[-1] - polygon, polygon)
        if len(gained) == 1:
            return batch
        return Batch.of_keys(self.patchwork, np.sort(np.concatenate(gained)), batch.count)

    def connected(self, batch: Batch) -> Flags:
        """(pairs,) the largest connected piece of each region (ties: the piece of the lowest polygon)."""
        work = self.patchwork
        if not len(batch.region):
            return np.ones(0, bool)
        keys = batch.keys
        owner, edge = self.links.expand(batch.polygon)
        target = batch.region[owner] * np.int64(work.count) + work.other(edge, batch.polygon[owner])
        inside = among(target, keys)
        label = components(owner[inside], np.searchsorted(keys, target[inside]), len(keys))
        # pieces are numbered by their first polygon, and so region by region
        size, region = np.bincount(label), np.zeros(int(label.max()) + 1, np.int64)
        region[label] = batch.region
        order = np.lexsort((-size, region))
        head = order.take(heads(region.take(order)).nonzero()[0])
        best = np.full(batch.count, -1)
        best[region.take(head)] = head
        return np.asarray(best[batch.region] == label)
