"""Sharp edges and corners that stand on planes: knife edges, a cube on its edge, points.

The normal is that of the plane. An edge counts where both faces beside it rise from the plane, a corner where all
its edges do; of a rim, which is an edge that bends, only the lowest place counts.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.constants import FLUSH_ANGLE, PATCH_AREA, PROBE_SPARE, TOUCH
from kinform.contacts.higher.constants import LINE_SAMPLES, ZONE
from kinform.contacts.higher.sharp import ConvexEdges, on_surface
from kinform.contacts.higher.touch_patches import TouchSamples, touch_patch
from kinform.contacts.search.pair_view import PairView, PartView
from kinform.foundation.algebra.vectors import dot, lengths
from kinform.foundation.meshes.surface_table import PLANE
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.tolerances import Tolerances

NEARLY = 1.001
"""Factor on a limit within which it is checked exactly: far more than rounding."""


@dataclass(frozen=True, eq=False)
class _Touch:
    """Points (n, 3) on one edge or corner of a part, over a plane of the other."""

    surfaces: tuple[int, int]
    """Of the part that is sharp, and the plane."""
    row: int
    """Of the plane among the near surfaces."""
    points: Array
    gaps: Array
    axis: Array | None
    """(3,) along an edge; None: a corner, or the lowest place of a rim."""
    area: float
    """m² that each point stands for."""


def edge_contacts(
    pair: PairView, convex: tuple[ConvexEdges, ConvexEdges], met: frozenset[tuple[int, int]] = frozenset()
) -> list[Patch]:
    """Edges and corners of either part, which are among its `convex` ones, on planes of the other, in the frame of the
    pair; `met`: pairs of surfaces that touch otherwise and are left out."""
    out = []
    for view, first, edges in ((pair, True, convex[0]), (pair.swapped, False, convex[1])):
        planes = view.near[1]
        large = planes.areas >= PATCH_AREA * pair.tolerance**2
        sharp = edges.where(edges.cosine < math.cos(pair.tolerances.smooth_edge))
        rows = np.flatnonzero((planes.kinds == PLANE) & large)
        for row in rows[_reached(view, sharp, rows)]:
            touches = _standing(view, sharp, int(row))
            out += [
                _patch(pair, touch, first)
                for touch in touches
                if (touch.surfaces if first else touch.surfaces[::-1]) not in met
            ]
    return out


def _reached(view: PairView, edges: ConvexEdges, rows: Ints) -> Flags:
    """(n,) which of these planes of the second part are touched by an end of an edge of the first at all, or nearly."""
    planes, ends = view.near[1], view.a.vertices[np.unique(edges.ends)]
    axes, points = planes.axes[rows], planes.points[rows]
    height = np.abs(ends @ axes.T - dot(axes, points))
    return np.asarray((height <= NEARLY * TOUCH * view.tolerance).any(axis=0))


def _bends(sharp: PartView, edges: ConvexEdges, k: int, tolerances: Tolerances) -> bool:
    """Whether one of the edges goes on into another at a slight angle."""
    meets = np.flatnonzero(np.isin(edges.ends, edges.ends[k]).any(axis=1))
    start, stop = (sharp.vertices[edges.ends[np.append(meets, k)][:, side]] for side in (0, 1))
    along = stop - start
    unit = along / np.maximum(np.linalg.norm(along, axis=1), TINY)[:, None]
    turns = np.arccos(np.minimum(1.0, np.abs(unit[:-1] @ unit[-1])))
    return bool(((turns > tolerances.coplanar) & (turns < tolerances.smooth_edge)).any())


def _standing(view: PairView, edges: ConvexEdges, row: int) -> list[_Touch]:
    """Edges and corners of the first part that stand on one plane of the second."""
    (sharp, flat), planes, limit = view.parts, view.near[1], TOUCH * view.tolerance
    normal, origin = planes.axes[row], planes.points[row]
    if not len(edges.ends) or float(planes.point_uncertainty[row]) > limit:
        return []
    height = (sharp.vertices - origin) @ normal
    inside = np.abs(height.take(edges.ends)) <= limit
    some = (inside[:, 0] | inside[:, 1]).nonzero()[0]
    if not len(some):
        return []
    slope, ends, inside = math.sin(view.tolerances.alignment), edges.ends.take(some, axis=0), inside.take(some, axis=0)
    starts, stops = (sharp.vertices.take(side, axis=0) for side in ends.T)
    vectors = stops - starts
    length = lengths(vectors)
    one, two = height.take(ends).T
    lying = inside[:, 0] & inside[:, 1] & (np.abs(one - two) <= slope * length)
    lines = lying.nonzero()[0]
    if len(lines):
        lines = lines[_rises(sharp, edges.where(some.take(lines)), height)]
    corners = np.setdiff1d(ends[inside], ends[lying])
    if len(corners):
        corners = corners[_lowest(sharp, corners, height, slope)]
    # more edges and corners on one plane are a rough surface
    if not 0 < len(lines) + len(corners) <= 64:
        return []
    spots: list[tuple[Ints, Array, Array | None]] = [
        (
            edges.facets[at, 0],
            _between(sharp, edges.ends[at], 1 if _bends(sharp, edges, at, view.tolerances) else LINE_SAMPLES),
            vectors[k] / length[k],
        )
        for k, at in zip(lines.tolist(), some.take(lines).tolist(), strict=True)
    ]
    spots += [
        (edges.facets[int((edges.ends == v).any(axis=1).nonzero()[0][-1]), 0], sharp.vertices[[v]], None)
        for v in corners
    ]
    out = []
    for facet, points, axis in spots:
        ids = (int(sharp.surfaces.labels[facet]), int(planes.ids[row]))
        gaps = (points - origin) @ normal
        on, up = points - gaps[:, None] * normal, np.tile(normal, (len(points), 1))
        holds = on_surface(flat, on, up, ids[1], PROBE_SPARE * view.tolerance)
        if holds.any():
            area = math.pi * (ZONE * view.tolerance) ** 2
            if len(points) > 1:
                area = 2.0 * ZONE * view.tolerance * float(np.linalg.norm(points[1] - points[0]))
            line = axis if len(points) > 1 else None
            out.append(_Touch(ids, row, points[holds], gaps[holds], line, area))
    return out


def _rises(sharp: PartView, edges: ConvexEdges, height: Array) -> Flags:
    """Whether both faces beside each edge rise from it, and not as good as flat."""
    out = np.ones(len(edges.ends), dtype=bool)
    base = height[edges.ends].mean(axis=1)
    for column in (0, 1):
        corners = sharp.faces[edges.facets[:, column]]
        third = corners.sum(axis=1) - edges.ends.sum(axis=1)
        reach = sharp.vertices[third] - sharp.vertices[edges.ends[:, 0]]
        along = sharp.vertices[edges.ends[:, 1]] - sharp.vertices[edges.ends[:, 0]]
        along = along / np.maximum(lengths(along), TINY)[:, None]
        away = lengths(reach - dot(reach, along)[:, None] * along)
        out &= height[third] - base > math.sin(FLUSH_ANGLE) * away
    return out


def _lowest(sharp: PartView, corners: Ints, height: Array, slope: float) -> Flags:
    """Whether everything around each corner rises from it, at least at this slope; rims rise slowly."""
    out, place = np.ones(len(corners), dtype=bool), np.full(len(sharp.vertices), -1)
    place[corners] = np.arange(len(corners))
    of = place.take(sharp.faces)
    beside = (np.maximum(np.maximum(of[:, 0], of[:, 1]), of[:, 2]) >= 0).nonzero()[0]
    faces, of = sharp.faces.take(beside, axis=0), of.take(beside, axis=0)
    for k in range(3):
        there = (of[:, k] >= 0).nonzero()[0]
        number, vertex = of[there, k], faces[there, k]
        for other in ((k + 1) % 3, (k + 2) % 3):
            around = faces[there, other]
            away = lengths(sharp.vertices.take(around, axis=0) - sharp.vertices.take(vertex, axis=0))
            rises = height.take(around) - height.take(vertex) > slope * away
            out[number[~(rises | (around == vertex))]] = False
    return out


def _between(sharp: PartView, ends: Ints, count: int) -> Array:
    """(count, 3) points evenly along an edge."""
    share = (np.arange(count) + 0.5) / count
    start, stop = sharp.vertices[ends]
    return np.asarray(start + share[:, None] * (stop - start))


def _patch(pair: PairView, touch: _Touch, first: bool) -> Patch:
    """The patch of an edge or corner of the `first` part, or the second, on a plane of the other."""
    planes, row = pair.near[1 if first else 0], touch.row
    normal = planes.axes[row]
    outward = np.tile(-normal if first else normal, (len(touch.points), 1))
    shift = float(planes.point_uncertainty[row])
    samples = TouchSamples(
        touch.points - 0.5 * touch.gaps[:, None] * normal,
        outward,
        touch.gaps,
        touch.area,
        axis=touch.axis,
        radii=(0.0, 0.0),
        uncertainty=(float(planes.axis_uncertainty[row]), shift),
        chord=float(planes.chords[row]),
    )
    return touch_patch(pair, touch.surfaces if first else touch.surfaces[::-1], samples, shift)
