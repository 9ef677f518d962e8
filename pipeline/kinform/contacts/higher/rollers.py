"""Lines along which rollers run on their races, beside the flanges that their flat ends touch.

A flange is a plane across the roller, or a bowl about a place on its axis, which leaves it free there, and the race
opposes it in one sense: alone that would be a stop. But what is round all over, as needles, rollers and wheels are, is
there to roll, and the other race presses it on this one. So these lines are kept beside such flanges, as those of cams
and teeth are beside planes across them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import PARALLEL_SINE, TOUCH
from kinform.contacts.higher.constants import ROUND_KINDS
from kinform.contacts.higher.points_and_lines import touches_between
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.meshes.surface_table import PLANE, SPHERE, SurfaceTable
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS

ROUND_PLACE = 1e-3
"""Distance from a common axis, as a share of the span of a part, within which the axes of its surfaces are one. Chosen,
not measured."""
ROUND_REST = 0.02
"""Share of the area of a round part that need not be round: a mark, a centre, a sliver of a chamfer. Chosen, not
measured."""


_ROUND = np.array([kind in ROUND_KINDS for kind in KINDS])
_RACE = np.array([kind in ("cylinder", "cone") for kind in KINDS])
"""Which kinds are round, and which are races of rollers, by their numbers."""


def lines_beside_flanges(pair: PairView, patches: Sequence[Patch]) -> list[Patch]:
    """Lines in which a part that is round all over touches a round surface of the other, in the frame of the pair,
    where all `patches` are planes across its axis or balls about a place on it; none beside others."""
    if not patches or any(patch.kind not in ("plane", "sphere") or patch.one_sided for patch in patches):
        return []
    # beside a flat wall a pin that stands on its collar may as well come to rest on it
    races = [_RACE[side.kinds] for side in pair.near]
    flags = np.zeros((len(races[0]), len(races[1])), dtype=bool)
    for k, side in enumerate(pair.near):
        for row in side.of_kind("cylinder", "cone").tolist():
            axis, place = side.axes[row], side.points[row]
            ends = all(_ends(patch, axis, place, pair.parts[k].index.mesh.size.span) for patch in patches)
            if side.sides[row] > 0 and ends and _round_all_over(pair.parts[k], int(side.ids[row])):
                flags[(row, races[1]) if k == 0 else (races[0], row)] = True
    if not flags.any():
        return []
    touches = touches_between(pair, flags & pair.overlap(pair.tolerance), play=True)
    touch = TOUCH * pair.tolerance
    # with so much play it is not known where they touch
    return [
        replace(patch, one_sided=True, bends=False) if float(np.abs(patch.gaps).max()) > touch else patch
        for patch in touches
        if patch.kind == "line"
    ]


def _ends(patch: Patch, axis: Array, place: Array, span: float) -> bool:
    """Whether a plane lies across an axis through a place, or a ball is about a place on it, as well as the roller, of
    this span (m), is known to be round."""
    if patch.kind == "plane":
        return norm(cross(patch.axis, axis)) < PARALLEL_SINE
    return norm(cross(patch.point - place, axis)) < ROUND_PLACE * span


def _round_all_over(part: PartView, surface: int) -> bool:
    """Whether the part has hardly any surface that does not turn onto itself about the axis of this one, and none that
    stands out beyond it, as the flange of a disc beyond its boss; or it is a ball."""
    table, span = part.table, part.index.mesh.size.span
    axis, point = table.axes[surface], table.points[surface]
    if table.kinds[surface] == SPHERE:
        return _area(table, np.arange(len(table.kinds)) != surface) < ROUND_REST * float(table.areas.sum())
    aside = np.linalg.norm(cross(table.points - point, axis), axis=1) < ROUND_PLACE * span
    along = np.linalg.norm(cross(table.axes, axis), axis=1) < PARALLEL_SINE
    turns: Flags = _ROUND[table.kinds] & aside & (along | (table.kinds == SPHERE))
    turns |= (table.kinds == PLANE) & along
    if _area(table, ~turns) >= ROUND_REST * float(table.areas.sum()):
        return False
    mesh = part.index.mesh
    away = np.linalg.norm(cross(mesh.vertices - point, axis), axis=1)
    widest = float(away[mesh.faces[part.surfaces.labels == surface]].max())
    return float(away.max()) <= widest + ROUND_PLACE * span


def _area(table: SurfaceTable, flags: Flags) -> float:
    return float(table.areas[flags].sum())
