"""Planes on planes: outward normals opposed within the alignment, gap within the tolerance."""

from __future__ import annotations

import numpy as np

from kinform.contacts.mating.charts import PlaneChart
from kinform.contacts.mating.mates import EDGE, Mate, box_centre, mean_direction
from kinform.contacts.search.placed import NearSurfaces
from kinform.model.arrays import Flags
from kinform.model.tolerances import Tolerances

__all__ = ["plane_mates"]

_LENS = 0.7
"""Mean width of a lens between an arc and its chord, over the greatest (2/3), rounded up: polygons with
different corners on one circle overlap in such lenses."""


def plane_mates(
    a: NearSurfaces, b: NearSurfaces, overlap: Flags, tolerance: float, tolerances: Tolerances
) -> list[Mate]:
    """Opposed planes of a and b among the pairs flagged in `overlap` (s, t)."""
    rows, columns = a.of_kind("plane"), b.of_kind("plane")
    opposed = np.cross(a.axes[rows][:, None], b.axes[columns][None])
    angle = np.arctan2(np.linalg.norm(opposed, axis=2), -(a.axes[rows] @ b.axes[columns].T))
    allowed = tolerances.alignment + a.axis_uncertainty[rows][:, None] + b.axis_uncertainty[columns][None]
    likely = overlap[np.ix_(rows, columns)] & (angle <= allowed)
    mates = []
    for i, j in np.argwhere(likely):
        mate = _mate(a, b, int(rows[i]), int(columns[j]), float(angle[i, j]), tolerance)
        if mate is not None:
            mates.append(mate)
    return mates


def _mate(a: NearSurfaces, b: NearSurfaces, row: int, column: int, angle: float, tolerance: float) -> Mate | None:
    """The mate of two opposed planes, unless they are apart everywhere in their common box."""
    middle, size = box_centre(a, b, row, column)
    turns = (float(a.axis_uncertainty[row]), float(b.axis_uncertainty[column]))
    normal, _, turn = mean_direction(a.axes[row], -b.axes[column], turns)
    # Heights above both planes add up to the gap, whatever the point's own height in between.
    gradient = a.axes[row] + b.axes[column]
    above_a = float((middle - a.points[row]) @ a.axes[row])
    above_b = float((middle - b.points[column]) @ b.axes[column])
    gap = above_a + above_b
    if abs(gap) > EDGE * tolerance + angle * float(np.linalg.norm(size)):
        return None
    half = middle + 0.5 * (above_b - above_a) * normal
    shift = float(a.point_uncertainty[row] + b.point_uncertainty[column])
    chord = float(a.chords[row] + b.chords[column])
    return Mate(
        rows=(row, column),
        kind="plane",
        chart=PlaneChart(normal, half),
        sign=1.0,
        axis=normal,
        point=half,
        radii=(0.0, 0.0),
        gap=gap,
        gradient=gradient,
        limit=EDGE * tolerance,
        slack=float(a.slacks[row] + b.slacks[column]) + angle * float(np.linalg.norm(size)),
        misalignment=angle,
        offset=0.0,
        uncertainty=(turn, shift),
        chord=chord,
        thin=min(_LENS * float(a.rims[row] + b.rims[column]), tolerance),
    )
