"""The narrow phase: do both parts really have facets here, facing each other, with nothing between?

A probe stands on the common surface along its normal and is cast against both meshes as a sliver.
It holds if it meets the wanted surface of each part, turned towards the other, and if no other facet of
either part lies between the two: a thin wall, or a step, in between means that these surfaces do not
touch there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import accumulate

import numpy as np

from kinform.contacts.constants import BETWEEN_MARGIN, BETWEEN_SHARE, FACING_LEAST
from kinform.contacts.search.pair_view import PairView, SurfacePair
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.meshes.probes import Cast, Hits, cast_all
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Flags, Ints


@dataclass(frozen=True, eq=False)
class Probes:
    """n probes in the frame of the pair: normals out of a, surfaces wanted on a and b, expected gaps."""

    points: Array
    normals: Array
    gaps: Array
    """(n,) m; facets are expected half of it to either side."""
    reach: Array
    """(n,) m to either side."""
    surfaces: Ints
    """(n, 2) index in the part's MeshSurfaces."""

    @staticmethod
    def of(points: Array, normals: Array, gaps: Array, reach: Array, surfaces: SurfacePair) -> Probes:
        """Probes of one surface of either part."""
        return Probes(points, normals, gaps, reach, np.full((len(points), 2), surfaces.ids))


@dataclass(frozen=True, eq=False)
class Verdict:
    """Set by set of probes: which of them hold, and where their facets are along the normal (m from the point)."""

    holds: list[Flags]
    along_a: list[Array]
    along_b: list[Array]
    cosine: list[Array]
    """(n,) of the angle between the outward normals of the two facets."""

    @property
    def gaps(self) -> list[Array]:
        """(n,) m from facet to facet."""
        return [b - a for a, b in zip(self.along_a, self.along_b, strict=True)]


def _nearest(hits: Hits, wanted: Flags, expected: Array, count: int) -> Ints:
    """For each probe the wanted hit nearest to where it is expected, or −1."""
    rows = np.flatnonzero(wanted)
    probe = hits.probe.take(rows)
    first = heads(probe)
    if not first.all():
        off = np.abs(hits.along[rows] - expected[probe])
        order = np.lexsort((rows, off, probe))
        rows, probe = rows[order][first], probe[first]
    chosen = np.full(count, -1, dtype=np.int64)
    chosen[probe] = rows
    return chosen


def _blocked(hits: Hits, wanted: Flags, low: Array, high: Array) -> Flags:
    """Probes between whose two facets another facet lies."""
    blocked = np.zeros(len(low), dtype=bool)
    others = np.flatnonzero(~wanted)
    if len(others):
        probe, along = hits.probe[others], hits.along[others]
        blocked[probe[(along > low[probe]) & (along < high[probe])]] = True
    return blocked


def verify(pair: PairView, sets: list[Probes], facing: float = FACING_LEAST) -> Verdict:
    """Cast sets of probes (one at least) against both parts, all together; `facing` is the least cosine between a facet
    and the probe."""
    return verify_all([(pair, sets)], facing)[0]


def verify_all(asked: Sequence[tuple[PairView, list[Probes]]], facing: float = FACING_LEAST) -> list[Verdict]:
    """The same of several pairs at once."""
    joined = [
        sets[0]
        if len(sets) == 1
        else Probes(*(np.concatenate([getattr(p, f.name) for p in sets]) for f in fields(Probes)))
        for _, sets in asked
    ]
    casts = [
        Cast(part.region, part.to_part(probes.points), part.turn_to_part(probes.normals), probes.reach)
        for (pair, _), probes in zip(asked, joined, strict=True)
        for part in pair.parts
    ]
    hits = cast_all(casts)
    return [
        _verdict(pair, sets, probes, (hits[2 * k], hits[2 * k + 1]), facing)
        for k, ((pair, sets), probes) in enumerate(zip(asked, joined, strict=True))
    ]


def _verdict(pair: PairView, sets: list[Probes], probes: Probes, hits: tuple[Hits, Hits], facing: float) -> Verdict:
    """What sets of probes of one pair, which are `probes` together, have hit of both parts."""
    count = len(probes.points)
    chosen, on_surface = [], []
    for part, met, side, sense in zip(pair.parts, hits, (0, 1), (1.0, -1.0), strict=True):
        wanted = part.surfaces.labels.take(met.facet) == probes.surfaces[:, side].take(met.probe)
        chosen.append(_nearest(met, wanted & (sense * met.facing > facing), -0.5 * sense * probes.gaps, count))
        on_surface.append(wanted)
    holds = (chosen[0] >= 0) & (chosen[1] >= 0)
    along, cosine = [np.zeros(count), np.zeros(count)], np.ones(count)
    if holds.any():
        along = [np.where(holds, h.along[c], 0.0) for h, c in zip(hits, chosen, strict=True)]
        facets = [h.facet[c] for h, c in zip(hits, chosen, strict=True)]
        cosine = dot(pair.a.normals(facets[0]), pair.b.normals(facets[1]))
        holds &= cosine < pair.tolerances.opposed
        inset = BETWEEN_MARGIN * pair.tolerance + BETWEEN_SHARE * np.abs(along[1] - along[0])
        low, high = np.minimum(*along) + inset, np.maximum(*along) - inset
        for met, wanted in zip(hits, on_surface, strict=True):
            holds &= ~_blocked(met, wanted, low, high)
    ends = list(accumulate(len(p.points) for p in sets))
    own = [slice(first, end) for first, end in zip([0, *ends], ends, strict=False)]

    def by_set(of_all: Array) -> list[Array]:
        return [of_all[rows] for rows in own]

    return Verdict([holds[rows] for rows in own], by_set(along[0]), by_set(along[1]), by_set(cosine))
