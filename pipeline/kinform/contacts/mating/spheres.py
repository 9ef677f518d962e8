"""Balls in sockets: convex in concave, centres as close as clearance and fit allow."""

from __future__ import annotations

import numpy as np

from kinform.contacts.mating.charts import SphereChart
from kinform.contacts.mating.mates import Mate, box_centre, mean_position, radial_limit
from kinform.contacts.search.placed import NearSurfaces
from kinform.model.arrays import Flags
from kinform.model.tolerances import Tolerances

__all__ = ["sphere_mates"]

_OFFSET = 0.5
"""Share of the contact tolerance by which mating centres may miss each other beyond the clearance."""


def sphere_mates(
    a: NearSurfaces, b: NearSurfaces, overlap: Flags, tolerance: float, tolerances: Tolerances
) -> list[Mate]:
    """Balls in sockets among the pairs flagged in `overlap` (s, t)."""
    rows, columns = a.of_kind("sphere"), b.of_kind("sphere")
    convex = a.sides[rows][:, None] * b.sides[columns][None] < 0.0
    mates = []
    for i, j in np.argwhere(overlap[np.ix_(rows, columns)] & convex):
        row, column = int(rows[i]), int(columns[j])
        radii = (float(a.radii[row]), float(b.radii[column]))
        side = float(a.sides[row])
        gap = (radii[1] - radii[0]) * side
        offset = float(np.linalg.norm(b.points[column] - a.points[row]))
        shifts = (float(a.point_uncertainty[row]), float(b.point_uncertainty[column]))
        limit = radial_limit(tolerance, min(radii))
        if abs(gap) > limit or offset > max(gap, 0.0) + min(sum(shifts), tolerance) + _OFFSET * tolerance:
            continue
        centre, shift = mean_position(a.points[row], b.points[column], shifts)
        radius = 0.5 * (radii[0] + radii[1])
        towards = box_centre(a, b, row, column)[0] - centre
        distance = float(np.linalg.norm(towards))
        pole = towards / distance if distance > 1e-3 * radius else np.array([0.0, 0.0, 1.0])
        mates.append(
            Mate(
                rows=(row, column),
                kind="sphere",
                chart=SphereChart(centre, radius, pole),
                sign=side,
                axis=np.zeros(3),
                point=centre,
                radii=radii,
                gap=gap,
                gradient=np.zeros(3),
                limit=limit,
                slack=float(a.slacks[row] + b.slacks[column]) + offset,
                misalignment=0.0,
                offset=offset,
                uncertainty=(0.0, shift),
                chord=float(a.chords[row] + b.chords[column]),
            )
        )
    return mates
