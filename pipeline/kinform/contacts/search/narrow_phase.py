"""The narrow phase: do both parts really have facets here, facing each other, with nothing between?

A probe stands on the common surface along its normal and is cast against both meshes as a sliver.
It holds if it meets the wanted surface of each part, turned towards the other, and if no other facet of
either part lies between the two: a thin wall, or a step, in between means that these surfaces do not
touch there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from itertools import accumulate

import numpy as np

from kinform.contacts.constants import FACING_LEAST
from kinform.contacts.search.pair_view import PairView, SurfacePair
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.concatenation import concatenated
from kinform.foundation.meshes.probes import Cast, Hits, cast_all
from kinform.foundation.sorting import heads
from kinform.frozen import dataclass
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
    """(n,) of the angle between the outward normals of the two facets; 1 where both are not met."""

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
    together = [
        Probes(*(concatenated([getattr(p, f.name) for p in sets]) for f in fields(Probes))) for _, sets in asked
    ]
    casts = [
        Cast(part.region, part.to_part(probes.points), part.turn_to_part(probes.normals), probes.reach)
        for (pair, _), probes in zip(asked, together, strict=True)
        for part in pair.parts
    ]
    every = _Joined.of([pair for pair, _ in asked], together, cast_all(casts))
    holds, along_a, along_b, cosine = every.verdict(facing)
    ends = list(accumulate(len(p.points) for _, sets in asked for p in sets))
    own = [slice(first, end) for first, end in zip([0, *ends], ends, strict=False)]
    out, at = [], 0
    for _, sets in asked:
        rows = own[at : at + len(sets)]
        at += len(sets)
        out.append(
            Verdict(
                [holds[some] for some in rows],
                [along_a[some] for some in rows],
                [along_b[some] for some in rows],
                [cosine[some] for some in rows],
            )
        )
    return out


@dataclass(frozen=True, eq=False)
class _Joined:
    """All probes of several pairs, one after the other, and what they hit of both parts of each."""

    pairs: Sequence[PairView]
    starts: list[int]
    """Where the probes of each pair begin, and where all end."""
    surfaces: Ints
    gaps: Array
    """(n, 2), (n,) as of `Probes`."""
    hits: tuple[Hits, Hits]
    labels: tuple[Ints, Ints]
    """(h,) surface of the facet of each hit."""

    @staticmethod
    def of(pairs: Sequence[PairView], probes: list[Probes], hits: list[Hits]) -> _Joined:
        """Of the hits of the first and second part of each pair."""
        starts = [0, *accumulate(len(p.points) for p in probes)]
        sides, labels = [], []
        for side in (0, 1):
            own = hits[side::2]
            sides.append(
                Hits(
                    concatenated([hit.probe + start for hit, start in zip(own, starts, strict=False)]),
                    *(concatenated([getattr(hit, name) for hit in own]) for name in ("facet", "along", "facing")),
                )
            )
            labels.append(
                concatenated([p.parts[side].surfaces.labels.take(hit.facet) for p, hit in zip(pairs, own, strict=True)])
            )
        surfaces, gaps = (concatenated([getattr(p, name) for p in probes]) for name in ("surfaces", "gaps"))
        return _Joined(pairs, starts, surfaces, gaps, (sides[0], sides[1]), (labels[0], labels[1]))

    def verdict(self, facing: float) -> tuple[Flags, Array, Array, Array]:
        """What `Verdict` says, (n,) of all probes."""
        count = self.starts[-1]
        chosen, on_surface = [], []
        for met, labels, side, sense in zip(self.hits, self.labels, (0, 1), (1.0, -1.0), strict=True):
            wanted = labels == self.surfaces[:, side].take(met.probe)
            chosen.append(_nearest(met, wanted & (sense * met.facing > facing), -0.5 * sense * self.gaps, count))
            on_surface.append(wanted)
        holds = (chosen[0] >= 0) & (chosen[1] >= 0)
        along, cosine = [np.zeros(count), np.zeros(count)], np.ones(count)
        some = holds.nonzero()[0]
        if not len(some):
            return holds, along[0], along[1], cosine
        for side, met in enumerate(self.hits):
            along[side][some] = met.along.take(chosen[side].take(some))
        cosine[some] = dot(*(self._normals(side, chosen[side].take(some), some) for side in (0, 1)))
        counts = np.diff(self.starts)
        holds &= cosine < np.repeat([pair.tolerances.opposed for pair in self.pairs], counts)
        # Distance, in contact tolerances, from one of the two facets that a probe meets within which nothing counts as
        # between them. Chosen, not measured.
        inset = np.repeat([0.01 * pair.tolerance for pair in self.pairs], counts)
        # So is what is nearer to one of them than this share of their distance.
        inset += 0.05 * np.abs(along[1] - along[0])
        low, high = np.minimum(*along) + inset, np.maximum(*along) - inset
        for met, wanted in zip(self.hits, on_surface, strict=True):
            holds &= ~_blocked(met, wanted, low, high)
        return holds, along[0], along[1], cosine

    def _normals(self, side: int, chosen: Ints, probes: Ints) -> Array:
        """(k, 3) of the facets of hits `chosen` (k,) of `probes` (k,), ascending, in the frames of their pairs."""
        facets = self.hits[side].facet.take(chosen)
        ends = probes.searchsorted(self.starts).tolist()
        return concatenated(
            [pair.parts[side].normals(facets[i:j]) for pair, i, j in zip(self.pairs, ends, ends[1:], strict=False)]
        )
