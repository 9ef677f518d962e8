"""Surfaces that regions are tried for, and which polygons conform to them."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.sorting import heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.constants import NORMAL_SLACK
from kinform.surfaces.groups import columns_of, in_order, ordered_quantile, quantile
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.kind import Kind
from kinform.surfaces.regions.constants import WIDEST

FACET_ROUNDING = 1e-3
"""Angle that is added to the greatest that a facet may subtend: what rounding makes of equal facets."""
WIDER = 1.6
"""A polygon this much wider than the next narrower one of a region is a flat on it, not one of its facets. Chosen, not
measured."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """R surfaces of one kind, each the hypothesis of the region of the same number."""

    kind: Kind
    params: Params
    side: Ints
    """(R,) +1 convex, -1 concave."""
    tolerance: Array
    """(R,) to which the vertices are held."""

    def of(self, numbers: Ints) -> Candidates:
        """Some of them, in this order."""
        side, tolerance = self.side.take(numbers), self.tolerance.take(numbers)
        return Candidates(self.kind.of(numbers), self.params.take(numbers, axis=0), side, tolerance)

    def run(self, kind: Kind, regions: slice) -> Candidates:
        """A run of them, which are of this kind."""
        return Candidates(kind, self.params[regions], self.side[regions], self.tolerance[regions])

    def within(self, tolerance: Array) -> Candidates:
        """The same surfaces, held to another tolerance."""
        return Candidates(self.kind, self.params, self.side, tolerance)

    def refine(self, batch: Batch, steps: int) -> Candidates:
        """Fitted again to their regions."""
        params = self.kind.refine(batch, self.params, self.tolerance, steps)
        return Candidates(self.kind, params, self.side, self.tolerance)

    def reach(self, batch: Batch) -> Array:
        """(R,) greatest angle that a facet of each region may subtend, judged by the facets it has."""
        width = self.kind.widths(batch, self.params)
        # regions are in order already
        region, ascending = batch.region, width.take(in_order(batch.region, width, batch.count))
        # three quarters are narrower than a typical polygon: cuts leave narrow pieces of facets
        typical = ordered_quantile(batch.size, ascending, 0.75)
        last = heads(region[::-1])[::-1].nonzero()[0]
        gap = ascending >= typical.take(region)
        gap[:-1] &= ascending[1:] > WIDER * ascending[:-1]
        gap[last] = False
        rows = gap.nonzero()[0]
        top, largest = np.full(batch.count, np.inf), np.zeros(batch.count)
        np.minimum.at(top, region.take(rows), ascending.take(rows))
        largest[region.take(last)] = np.maximum(ascending.take(last), 0.0)
        return np.asarray(np.minimum(WIDER * np.minimum(top, largest), WIDEST) + FACET_ROUNDING)

    def conforms(self, batch: Batch, reach: Array) -> Flags:
        """Whether each pair's polygon is a piece of its region's surface, tessellated no coarser than `reach`."""
        parts = batch.parts()
        if len(parts) == 1:
            return self._conforms(batch, reach)
        return np.concatenate([self._conforms(part, reach) for part in parts])

    def _conforms(self, batch: Batch, reach: Array) -> Flags:
        """A polygon conforms where its vertices lie on the surface, its middle no deeper than a chord of the widest
        facet, and its normal is that of the surface to within half a facet."""
        work, region, polygon = batch.patchwork, batch.region, batch.polygon
        count, owner = len(region), batch.corners[0]
        group, held = self.kind.held(batch, self.params)
        limit, chord = batch.for_seen(self.tolerance[:, None])[:, 0], 1 - np.cos(np.minimum(reach, np.pi) / 2)
        # a flat has all its vertices on the surface, but is wider than the facets of it
        least = chord.take(region)
        least *= held.curvature_radius[:count]
        least += limit[:count]
        fits: Flags = ~(held.distance[:count] <= np.negative(least, out=least))
        cosine = dot(held.normal[:count], work.normals(polygon))
        cosine *= self.side.take(region)
        widest = (0.5 * reach + NORMAL_SLACK).take(region)
        widest += work.slack.take(polygon)
        fits &= cosine > np.cos(np.minimum(widest, WIDEST, out=widest), out=widest)
        corner, allowed = held.distance[count:], limit[count:]
        fits[owner.take((corner >= allowed).nonzero()[0])] = False
        low = (corner <= -allowed).nonzero()[0]
        mine = owner.take(low)
        if self.kind.saddle or not len(low):
            fits[mine] = False
            return fits
        at = low + count
        depth = chord.take(group.take(at))
        depth *= held.curvature_radius.take(at)
        depth += allowed.take(low)
        cut = np.zeros(count, bool)
        cut[mine] = True
        fits[mine.take((corner.take(low) <= np.negative(depth, out=depth)).nonzero()[0])] = False
        rows = (cut & fits).nonzero()[0]
        if len(rows):
            fits[rows] = self.kind.cuts(batch, self.params, rows, limit.take(rows))
        return fits

    def scatter(self, batch: Batch) -> Array:
        """(R,) middle distance of each region's vertices from its surface."""
        region, vertex = self.kind.defining(batch, self.params, self.tolerance)
        distance = np.abs(self.kind.probe(columns_of(self.params, region), batch.patchwork.at(vertex)).distance)
        return quantile(region, distance, batch.count, 0.5)
