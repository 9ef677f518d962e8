"""Shafts and bores of decimated meshes, whose vertices are on chords as well as on the surface.

Programs that thin meshes put the vertex that is left of an edge in its middle: on a chord, up to the chord error inside
the surface, which is far more than the vertices of a tessellator are off. Closed rounds of strips are therefore tried
once more with wider tolerances. What goes most of the way round an axis, and whose vertices are off by no more than
its facets are, is a cylinder; arcs are left alone, because a tooth's flank is nearly one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import dot, normalised
from kinform.frozen import dataclass
from kinform.model.arrays import Flags, Ints
from kinform.surfaces.describe import angles_covered
from kinform.surfaces.groups import columns_of, group_sum, quantile
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.regions.constants import WIDEST
from kinform.surfaces.regions.growth import Growth, whole
from kinform.surfaces.regions.territory import Territory

ROUND_CHORDS: float = float(np.radians(170.0))
"""Angle about its axis that it covers at least: arcs of less are flanks of teeth as well."""


@dataclass(frozen=True, eq=False)
class Rounds:
    """Pieces that may be rounds of strips, with the cylinders that they suggest."""

    batch: Batch
    side: Ints
    proposal: tuple[Params, Flags]

    @classmethod
    def of(cls, kind: Cylinder, batch: Batch, side: Ints) -> Rounds:
        """Those of the pieces that have polygons enough, and normals that differ enough."""
        # fewer strips are flats as well. Chosen, not measured
        large, number = batch.where((batch.size >= 8) & _turns(batch)).compact()
        return cls(large, side[number], kind.propose(large))


def _turns(batch: Batch) -> Flags:
    """(R,) which pieces have a normal so far off the middle one as a round has."""
    work, count = batch.patchwork, batch.count
    normal = work.normals(batch.polygon)
    middle = normalised(group_sum(batch.region, normal * work.area.take(batch.polygon)[:, None], count))
    least = np.ones(count)
    np.minimum.at(least, batch.region, dot(normal, columns_of(middle, batch.region)))
    # Angle to the middle normal of a piece that one of its normals makes at least where a round is in it: they are
    # those of the middles of strips, the outermost of which are no wider than WIDEST.
    return np.asarray(least <= np.cos((ROUND_CHORDS - WIDEST) / 2))


def decimated(territory: Territory, kind: Cylinder, rounds: Rounds, factor: float) -> Growth:
    """Cylinders among the pieces, held to `factor` times the tolerance of fits."""
    loose = territory.scales.wider(factor)
    growth = whole(replace(territory, scales=loose), kind, rounds.batch, rounds.side, rounds.proposal)
    regular = _round(kind, growth, territory.scales_of(growth.batch))
    return replace(growth, batch=growth.batch.where(regular))


def _round(kind: Cylinder, growth: Growth, scale: Scales) -> Flags:
    """(R,) which regions go most of the way round, their vertices no farther off than chords of their facets."""
    batch, params = growth.batch, growth.surfaces.params
    _, _, even = kind.evident(batch, params, scale)
    widths = kind.widths(batch, params)
    sweep = angles_covered(params, batch, widths)
    width = quantile(batch.region, widths, batch.count, 0.5)
    chord = params[:, 6] * (1.0 - np.cos(0.5 * width))
    owner, _ = batch.corners
    off = np.zeros(batch.count)
    region = batch.region[owner]
    np.maximum.at(off, region, np.abs(kind.probe(columns_of(params, region), batch.points).distance))
    # vertices are off by no more than the chordal deviation of the middle facet
    return np.asarray(even & (sweep >= ROUND_CHORDS) & (off <= chord))
