"""Rims of either part on round surfaces of the other: a ball on the edge of a hole, the edge of a cylinder in a conical
seat, a disc on its rim on a cone.

The normal is that of the round surface. A rim about its axis touches all round, along a line; any other where it comes
nearest to it, at points. It counts where both faces beside the rim leave the surface: what lies along it mates, or is
found as a roller.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.constants import PROBE_SPARE, RIM_POINTS, TOUCH
from kinform.contacts.higher.beside import Beside, beside
from kinform.contacts.higher.circles import Rim, rims_of
from kinform.contacts.higher.constants import BALL_BORE_SAMPLES, ZONE
from kinform.contacts.higher.nearest import dips_of, evened, nearest
from kinform.contacts.higher.sharp import ConvexEdges, convex_edges_of_first, on_surface
from kinform.contacts.higher.touch_patches import TouchSamples, touch_patch
from kinform.contacts.search.pair_view import NearSurfaces, PairView
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.boxes import meeting_box
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS

_ROUND = np.isin(KINDS, ("sphere", "cylinder", "cone", "torus"))
_SEATED = np.isin(KINDS, ("sphere", "cone", "torus"))
"""By kind."""


@dataclass(frozen=True, eq=False)
class _Touch:
    """Places on a rim of the first part of a view that touch a surface of the second."""

    rim: Rim
    row: int
    """Of the surface among the near ones."""
    places: Array
    """(n, 3) m, on the rim."""
    gaps: Array
    normals: Array
    """(n, 3) out of the second part."""
    spacing: float
    """m of the rim that each stands for; 0: a point."""


def rim_contacts(pair: PairView, convex: tuple[ConvexEdges, ConvexEdges]) -> list[Patch]:
    """Where rims of either part, which are among its `convex` edges, touch round surfaces of the other, in the frame of
    the pair."""
    out = []
    for view, first, edges in ((pair, True, convex[0]), (pair.swapped, False, convex[1])):
        touches = _of_view(view, edges, np.flatnonzero(_ROUND[view.near[1].kinds]))
        out += [_patch(pair, touch, first) for touch in touches]
    return out


def seats(pair: PairView, patches: list[Patch]) -> list[Patch]:
    """Rims that go all round, on balls, cones and rings that none of the `patches` is of: what stands in a seat beside
    what guides it, as countersunk screws and valves do."""
    if not any(_SEATED[side.kinds].any() for side in pair.near):
        return []
    free = [_SEATED[side.kinds] for side in pair.near]
    for k, side in enumerate(pair.near):
        mated = {patch.surfaces[k] for patch in patches}
        free[k][[row for row in np.flatnonzero(free[k]).tolist() if int(side.ids[row]) in mated]] = False
    out = []
    for view, first, seated in ((pair, True, free[1]), (pair.swapped, False, free[0])):
        rows = np.flatnonzero(seated)
        rows = rows[_beside_any(view, rows)]
        edges = convex_edges_of_first(view) if len(rows) else None
        for touch in _of_view(view, edges, rows) if edges is not None else []:
            if touch.spacing and len(touch.places) == BALL_BORE_SAMPLES and touch.rim.closed:
                out.append(_patch(pair, touch, first))
    return out


def _of_view(view: PairView, edges: ConvexEdges, rows: Ints) -> list[_Touch]:
    """Where rims of the first part touch round surfaces of the second, at these positions among the near ones."""
    if not len(rows):
        return []
    low, high = _boxes(view, rows)
    out = []
    for rim in rims_of(view, edges, low, high):
        known = rim.shift + view.near[1].point_uncertainty[rows] <= TOUCH * view.tolerance
        beside_it = ((low <= rim.high) & (rim.low <= high)).all(axis=1)
        for row in rows[known & beside_it]:
            out += _touches(view, rim, int(row))
    return out


def _boxes(view: PairView, rows: Ints) -> tuple[Array, Array]:
    """Lowest and highest corners (n, 3) of where near surfaces of the second part may be touched."""
    near = view.near[1]
    margin = (TOUCH * view.tolerance + near.slacks[rows])[:, None]
    return near.lows[rows] - margin, near.highs[rows] + margin


def _beside_any(view: PairView, rows: Ints) -> Flags:
    """(n,) which of these near surfaces of the second part have any near facet of the first beside them."""
    own = view.near[0]
    if not len(own.ids):
        return np.zeros(len(rows), dtype=bool)
    low, high = _boxes(view, rows)
    return meeting_box(low, high, own.lows.min(axis=0), own.highs.max(axis=0))


def _touches(view: PairView, rim: Rim, row: int) -> list[_Touch]:
    """All round, or at points, or not at all."""
    near, limit = view.near[1], TOUCH * view.tolerance
    angles = 2.0 * math.pi * np.arange(RIM_POINTS) / RIM_POINTS
    round_it = beside(near, row, rim.points(angles))
    if not -limit <= float(round_it.gaps.max()) or float(round_it.gaps.min()) > limit + rim.radius * angles[1]:
        return []
    if (np.abs(round_it.gaps) <= limit).all() and _coaxial(view, rim, row):
        angles, spacing = rim.samples()
        found = [_kept(view, rim, row, angles, spacing)]
    else:
        nearest = _nearest(rim, near, row, angles, round_it, limit)
        found = [_kept(view, rim, row, nearest[[k]], 0.0) for k in range(len(nearest))]
    return [touch for touch in found if touch is not None]


def _coaxial(view: PairView, rim: Rim, row: int) -> bool:
    """Whether the axis of a surface that a rim is about, if it has one, is along that of the rim."""
    near = view.near[1]
    tilt = math.asin(min(1.0, float(np.linalg.norm(cross(near.axes[row], rim.axis)))))
    return tilt <= view.tolerances.alignment + rim.turn + float(near.axis_uncertainty[row])


def _nearest(rim: Rim, near: NearSurfaces, row: int, angles: Array, there: Beside, limit: float) -> Array:
    """(n,) angles at which a rim is nearest to a surface, within `limit` (m), and goes up on both sides; by what the
    surface is to it at equal `angles` (m,)."""
    dips = dips_of(rim, angles, there, -limit, limit)
    step = 2.0 * math.pi / len(angles)
    dips = dips.where(rim.has(dips.low + 0.5 * step, 0.5 * step))
    middle = nearest(rim, near, row, dips)
    return middle[rim.has(middle, SINGLE)]


def _kept(view: PairView, rim: Rim, row: int, angles: Array, spacing: float) -> _Touch | None:
    """The touch of those of the angles (n,) on a rim at which it touches the surface; one along a line is all round."""
    near, tolerance = view.near[1], view.tolerance
    places = rim.points(angles)
    found = beside(near, row, places)
    normals = evened(rim, angles, found.normals, KINDS[near.kinds[row]]) if spacing else found.normals
    holds = found.within & (np.abs(found.gaps) <= TOUCH * tolerance) & rim.rises(angles, normals)
    if not holds.any():
        return None
    feet, reach = places - found.gaps[:, None] * found.normals, PROBE_SPARE * tolerance
    holds &= on_surface(view.b, feet, found.normals, int(near.ids[row]), reach)
    if not holds.any():
        return None
    return _Touch(rim, row, places[holds], found.gaps[holds], normals[holds], spacing)


def _patch(pair: PairView, touch: _Touch, first: bool) -> Patch:
    """The patch of a rim of the `first` part, or the second, on a round surface of the other."""
    near, row, rim = pair.near[1 if first else 0], touch.row, touch.rim
    zone = ZONE * pair.tolerance
    shift = rim.shift + float(near.point_uncertainty[row])
    other = int(near.ids[row])
    radius = float(near.radii[row]) if KINDS[near.kinds[row]] in ("sphere", "cylinder") else rim.radius
    samples = TouchSamples(
        touch.places - 0.5 * touch.gaps[:, None] * touch.normals,
        -touch.normals if first else touch.normals,
        touch.gaps,
        2.0 * zone * touch.spacing if touch.spacing else math.pi * zone**2,
        axis=rim.axis if touch.spacing else None,
        radii=(rim.radius, radius) if first else (radius, rim.radius),
        uncertainty=(max(rim.turn, float(near.axis_uncertainty[row])), shift),
        chord=float(near.chords[row]),
    )
    return touch_patch(pair, (rim.surface, other) if first else (other, rim.surface), samples, shift)
