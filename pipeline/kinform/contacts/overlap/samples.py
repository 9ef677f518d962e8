"""Depths of points on the boundary of either of two solids below that of the other, and what depth their surfaces
explain."""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.overlap.coarse_facets import CoarseFacets
from kinform.contacts.presses import beyond_press
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch

SHELL_INSET = 0.98
"""Points just inside the corners of a facet are at this share of the way to them from its middle. Chosen, not
measured."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Points on the boundary of one part inside the other: depth, and the surfaces on both sides."""

    points: Array
    depth: Array
    surfaces: Ints
    """(n, 2) of the first and the second part."""

    def where(self, rows: Flags) -> Samples:
        """Some of them."""
        return Samples(self.points[rows], self.depth[rows], self.surfaces[rows])


@dataclass(frozen=True, eq=False)
class Allowance:
    """What depth the surfaces explain: chord errors and uncertainty, and which of them mate."""

    chords: tuple[Array, Array]
    """Chord error and residual of each surface of both parts (m)."""
    mates: dict[tuple[int, int], Patch]
    floor: float
    tolerance: float
    facets: CoarseFacets

    @staticmethod
    def of(pair: PairView, patches: list[Patch], floor: float) -> Allowance:
        """What the surfaces of a pair explain, with its patches, beside `floor` (m)."""
        return Allowance(
            chords=(_part_chords(pair.a), _part_chords(pair.b)),
            mates={p.surfaces: p for p in patches if not p.one_sided},
            floor=floor,
            tolerance=pair.tolerance,
            facets=CoarseFacets(pair.a, pair.b, floor, pair.tolerances),
        )

    def chords_of(self, samples: Samples) -> Array:
        """(n,) m: depth that the chord errors of the surfaces on both sides explain."""
        i, j = samples.surfaces.T
        return np.asarray(self.chords[0][i] + self.chords[1][j] + self.floor)

    def judged(self, every: list[Samples]) -> list[tuple[Flags, float, bool]]:
        """Of each piece, the samples deeper than what chord errors of their surfaces explain, how thick (m) it may be,
        and whether there are such samples and coarse facets explain them all."""
        deep = [samples.depth > self._allowed(samples) for samples in every]
        thin = [float(self.chords_of(samples).max(initial=0.0)) for samples in every]
        asked = [k for k, rows in enumerate(deep) if rows.any()]
        by_facets = [False] * len(every)
        if asked:
            told = self.facets.explain([(every[k].points[deep[k]], every[k].depth[deep[k]]) for k in asked])
            for k, explained in zip(asked, told, strict=True):
                by_facets[k] = explained
                if explained:
                    thin[k] = max(thin[k], float(every[k].depth[deep[k]].max()))
        return list(zip(deep, thin, by_facets, strict=True))

    def _mates_of(self, samples: Samples) -> list[Patch]:
        """Those between surfaces of the samples."""
        i, j = samples.surfaces.T
        present = (set(i.tolist()), set(j.tolist()))
        return [p for (s, t), p in self.mates.items() if s in present[0] and t in present[1]]

    def _allowed(self, samples: Samples) -> Array:
        """(n,) m: depth that the surfaces nearest to samples of one piece explain, and mates among them."""
        allowed = self.chords_of(samples)
        for patch in self._mates_of(samples):
            allowed = np.maximum(allowed, patch.chord + patch.uncertainty[1] + self.floor)
        return allowed

    def at_mates(self, samples: Samples, deep: Flags) -> bool:
        """Whether the deep samples of a piece all lie at mates that can be pressed."""
        mates = self._mates_of(samples)
        at_mate = np.array([pair in self.mates for pair in map(tuple, samples.surfaces.tolist())], bool)
        pressed = max((p.chord - min(p.gap, 0.0) + p.offset for p in mates), default=-1.0) + self.floor
        mated = bool(mates) and not any(beyond_press(patch) for patch in mates)
        mated &= bool(
            (
                (samples.depth[deep] <= MATING_REACH * self.tolerance)
                & (at_mate[deep] | (samples.depth[deep] <= pressed))
            ).all()
        )
        return mated


def _part_chords(part: PartView) -> Array:
    """(s,) m that each surface may be off its facets."""
    return part.table.slacks + part.table.point_uncertainty


def measured(owner: PartView, other: PartView, points: Array, facets: Ints, first: bool) -> Samples:
    """Depth of points on the owner's facets below the surface of the other part."""
    depth, nearest = other.depths(points)
    sides = [owner.surfaces.labels[facets], other.surfaces.labels[nearest]]
    return Samples(points, depth, np.stack(sides if first else sides[::-1], axis=1))


def measured_on(a: PartView, b: PartView, points: Array, part: Ints, facet: Ints) -> Samples:
    """Depths of points on facets of either part (0, 1)."""
    return joined_samples(
        [
            measured(a, b, points[part == 0], facet[part == 0], True),
            measured(b, a, points[part == 1], facet[part == 1], False),
        ]
    )


def joined_samples(samples: list[Samples]) -> Samples:
    """All samples as one set."""
    return Samples(
        np.concatenate([s.points for s in samples]),
        np.concatenate([s.depth for s in samples]),
        np.concatenate([s.surfaces for s in samples]),
    )


def inset(corners: Array, middle: Array) -> Array:
    """(4 n, 3) the middles (n, 3) of facets (n, 3, 3), and points just inside their corners."""
    return np.concatenate([middle, (SHELL_INSET * corners + (1.0 - SHELL_INSET) * middle[:, None]).reshape(-1, 3)])
