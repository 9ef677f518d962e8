"""Strips that look like a cylinder across bands round another axis.

The bands of a disc with chamfers, or of a barrel, are cut into facets between rings. What lies between two meridians is
a row of strips, whose edges are parallel and, of a barrel always and of a few equal bands by symmetry, lie on a circle.
But these edges are chords of the rings: they go on beyond the strips, at both ends and turning, where the ridges of a
shaft or a fillet end.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import distinct
from kinform.model.arrays import Flags, Ints
from kinform.surfaces.groups import Ragged
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.kinds.ruled import generators
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.growth import Growth
from kinform.surfaces.regions.territory import Territory

TURNS_ON = (0.03, 0.56)
"""Angle by which a ridge turns where it goes on round an axis: more than lines of one direction differ, and no more
than a smooth edge."""
GOES_ON = 2.05
"""Ratio of lengths up to which the next edge goes on with a ridge: a fillet is longer than the edges of its corners.
Chosen, not measured."""


def along(territory: Territory, kind: Cylinder, growth: Growth) -> tuple[Growth, Ints]:
    """The cylinders but those across bands, and the edges (n,) which are ridges of these or go on with them."""
    work, batch, params = territory.patchwork, growth.batch, growth.surfaces.params
    sweep = np.bincount(batch.region, kind.widths(batch, params), batch.count)
    # strips across bands round another axis subtend less than half a turn
    open_ = batch.where(sweep < 3.1)
    if not len(open_.region):
        return growth, np.zeros(0, np.int64)
    region, edge, inner = generators(open_, params)
    region, edge = region[inner], edge[inner]
    ridges = distinct(edge)
    onward, after = _onward(work, ridges)
    both = np.asarray(onward.all(axis=1)).take(np.searchsorted(ridges, edge))
    ridge_count = np.bincount(region, minlength=batch.count)
    across: Flags = np.asarray((ridge_count > 0) & (np.bincount(region, both, batch.count) == ridge_count))
    if not across.any():
        return growth, np.zeros(0, np.int64)
    theirs = np.zeros(len(ridges), bool)
    theirs[np.searchsorted(ridges, edge[across[region]])] = True
    of, following = after
    return replace(growth, batch=batch.where(~across)), np.concatenate([ridges[theirs], following[theirs[of]]])


def _onward(work: Patchwork, ridges: Ints) -> tuple[Flags, tuple[Ints, Ints]]:
    """(n, 2) whether each of the edges goes on at its first and at its second end, and with which: (number of the edge,
    the next)."""
    at_ridge = np.zeros(len(work.vertices), bool)
    at_ridge[work.ends[ridges]] = True
    near = work.smooth.nonzero()[0]
    first, second = work.ends.take(near, axis=0).T
    near = near.take((at_ridge.take(first) | at_ridge.take(second)).nonzero()[0])
    beside = Ragged(work.ends[near].ravel(), np.repeat(near, 2), len(work.vertices))
    place, following = beside.expand(work.ends[ridges].ravel())
    ridge = ridges[place // 2]
    apart = (following != ridge) & ~_touching(work, following, ridge)
    place, following, ridge = place[apart], following[apart], ridge[apart]
    length, longer = work.length[ridge], work.length[following]
    alike = (longer <= GOES_ON * length) & (length <= GOES_ON * longer)
    cosine = np.abs(dot(work.along(ridge), work.along(following))) / np.maximum(length * longer, TINY)
    least, most = TURNS_ON
    on = alike & (cosine >= np.cos(most)) & (cosine <= np.cos(least))
    found = np.zeros(2 * len(ridges), bool)
    found[place[on]] = True
    return found.reshape(-1, 2), (place[on] // 2, following[on])


def _touching(work: Patchwork, edges: Ints, others: Ints) -> Flags:
    """(n,) whether edges have a polygon in common with others."""
    a, b = work.a[edges], work.b[edges]
    c, d = work.a[others], work.b[others]
    return np.asarray((a == c) | (a == d) | (b == c) | (b == d))
