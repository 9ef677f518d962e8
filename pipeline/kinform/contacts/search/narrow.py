"""The narrow phase: do both parts really have facets here, facing each other, with nothing between?

A probe stands on the common surface along its normal and is cast against both meshes as an FCL sliver.
It holds if it meets the wanted surface of each part, turned towards the other, and if no other facet of
either part lies between the two: a thin wall, or a step, in between means that these surfaces do not
touch there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.contacts.search.placed import PlacedPart
from kinform.foundation.meshes.probes import Hits
from kinform.model.arrays import Array, Flags, Ints

__all__ = ["Probes", "Verdict", "join", "verify"]


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


@dataclass(frozen=True, eq=False)
class Verdict:
    """Which probes hold, and where their facets are along the normal (m from the point)."""

    holds: Flags
    along_a: Array
    along_b: Array
    cosine: Array
    """(n,) of the angle between the outward normals of the two facets."""


def join(probes: list[Probes]) -> Probes:
    """All probes as one set, in order."""
    return Probes(
        *(
            np.concatenate([getattr(p, name) for p in probes])
            for name in ("points", "normals", "gaps", "reach", "surfaces")
        )
    )


def _cast(part: PlacedPart, probes: Probes) -> Hits:
    points, normals = part.to_part(probes.points), part.turn_to_part(probes.normals)
    return part.region.cast(points, normals, probes.reach)


def _nearest(hits: Hits, wanted: Flags, expected: Array, count: int) -> Ints:
    """For each probe the wanted hit nearest to where it is expected, or −1."""
    rows = np.nonzero(wanted)[0]
    off = np.abs(hits.along[rows] - expected[hits.probe[rows]])
    rows = rows[np.lexsort((rows, off, hits.probe[rows]))]
    probe, first = np.unique(hits.probe[rows], return_index=True)
    chosen = np.full(count, -1, dtype=np.int64)
    chosen[probe] = rows[first]
    return chosen


def _blocked(hits: Hits, own: Flags, low: Array, high: Array) -> Flags:
    """Probes between whose two facets another facet lies."""
    between = ~own & (hits.along > low[hits.probe]) & (hits.along < high[hits.probe])
    blocked = np.zeros(len(low), dtype=bool)
    blocked[hits.probe[between]] = True
    return blocked


def verify(a: PlacedPart, b: PlacedPart, probes: Probes, opposed: float, margin: float, facing: float = 0.5) -> Verdict:
    """Cast the probes against both parts.

    `opposed`: greatest cosine between the two facets' normals. `margin` (m): what lies this close to one
    of the two facets is not between them. `facing`: least cosine between a facet and the probe.
    """
    count = len(probes.points)
    chosen, owns, all_hits = [], [], []
    for part, side, sense in ((a, 0, 1.0), (b, 1, -1.0)):
        hits = _cast(part, probes)
        own = part.surfaces.labels[hits.facet] == probes.surfaces[hits.probe, side]
        wanted = own & (sense * hits.facing > facing)
        chosen.append(_nearest(hits, wanted, -0.5 * sense * probes.gaps, count))
        owns.append(own)
        all_hits.append(hits)
    holds = (chosen[0] >= 0) & (chosen[1] >= 0)
    if not holds.any():
        return Verdict(holds, np.zeros(count), np.zeros(count), np.ones(count))
    along = [np.where(holds, h.along[c], 0.0) for h, c in zip(all_hits, chosen, strict=True)]
    facets = [h.facet[c] for h, c in zip(all_hits, chosen, strict=True)]
    cosine = np.einsum("ij,ij->i", a.normals(facets[0]), b.normals(facets[1]))
    holds &= cosine < opposed
    inset = margin + 0.05 * np.abs(along[1] - along[0])
    low, high = np.minimum(*along) + inset, np.maximum(*along) - inset
    for hits, own in zip(all_hits, owns, strict=True):
        holds &= ~_blocked(hits, own, low, high)
    return Verdict(holds, along[0], along[1], cosine)
