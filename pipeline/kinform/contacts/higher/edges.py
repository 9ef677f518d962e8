"""Sharp edges and corners that stand on planes: knife edges, a cube on its edge, points.

The normal is that of the plane. An edge counts where both faces beside it rise from the plane, a corner where all
its edges do; of a rim, which is an edge that bends, only the lowest place counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.placed import NearSurfaces, PlacedPart, near_facets
from kinform.foundation.meshes.edges import shared_edges
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

__all__ = ["edge_contacts"]


_TOUCH = 0.12
"""Share of the contact tolerance within which a point or a line touches: the band of full weight."""
_ZONE = 0.01
"""Share of the contact tolerance that bounds the zone whose area is stated."""
_ALONG = 9
"""Samples along an edge."""
_RISE = math.sin(math.radians(3.0))
"""Faces beside an edge rise at least this steeply; flatter ones lie on the plane badly."""
_LEAST = 4.0
"""A plane counts from this area on, in squared tolerances."""
_MOST = 64
"""More edges and corners than these on one plane are a rough surface."""


@dataclass(frozen=True, eq=False)
class _Edges:
    """Sharp convex edges of a part (e, 2) by vertices, the facets beside them (e, 2), and whether they bend on."""

    ends: Ints
    facets: Ints
    bends: Flags


def edge_contacts(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    tolerance: float,
    tolerances: Tolerances,
    known: frozenset[tuple[int, int]] = frozenset(),
) -> list[Patch]:
    """Edges and corners of either part on planes of the other, in the frame of the pair; `known`: pairs of surfaces
    whose contact is known already."""
    if not len(near[0].ids) or not len(near[1].ids):
        return []
    low = np.maximum(near[0].lows.min(axis=0), near[1].lows.min(axis=0)) - tolerance
    high = np.minimum(near[0].highs.max(axis=0), near[1].highs.max(axis=0)) + tolerance
    out = []
    for sharp, flat, side, first in ((a, b, near[1], True), (b, a, near[0], False)):
        edges = _sharp(sharp, near_facets(sharp, low, high)[0], tolerances)
        for row in np.flatnonzero((side.kinds == KINDS.index("plane")) & (side.areas >= _LEAST * tolerance**2)):
            out += _standing(sharp, flat, edges, side, int(row), first, tolerance, tolerances, known)
    return out


def _sharp(part: PlacedPart, facets: Ints, tolerances: Tolerances) -> _Edges:
    """Those among the facets (ascending) between which the part is sharp and convex."""
    edges = shared_edges(part.faces[facets], len(part.vertices), by_corner=True)
    edges = edges.where(edges.opposed)
    one, two = (part.normals(facets[side]) for side in edges.facets.T)
    convex = edges.convexity(part.vertices, one, two) > 0.0
    edges = edges.where((np.einsum("ij,ij->i", one, two) < math.cos(tolerances.smooth_edge)) & convex)
    ends, beside, along = edges.ends, facets[edges.facets], edges.along(part.vertices)
    unit = along / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    bends = np.zeros(len(ends), dtype=bool)
    meeting: dict[int, list[int]] = {}
    for k, pair in enumerate(ends.tolist()):
        for vertex in pair:
            meeting.setdefault(vertex, []).append(k)
    for group in meeting.values():
        for i, k in enumerate(group):
            for m in group[:i]:
                turn = math.acos(min(1.0, abs(float(unit[k] @ unit[m]))))
                if tolerances.coplanar < turn < tolerances.smooth_edge:
                    bends[[k, m]] = True
    return _Edges(ends, beside, bends)


def _standing(
    sharp: PlacedPart,
    flat: PlacedPart,
    edges: _Edges,
    side: NearSurfaces,
    row: int,
    first: bool,
    tolerance: float,
    tolerances: Tolerances,
    known: frozenset[tuple[int, int]],
) -> list[Patch]:
    """Edges and corners that stand on one plane."""
    normal, origin = side.axes[row], side.points[row]
    if not len(edges.ends) or float(side.point_uncertainty[row]) > _TOUCH * tolerance:
        return []
    height = (sharp.vertices - origin) @ normal
    inside = np.abs(height[edges.ends]) <= _TOUCH * tolerance
    if not inside.any():
        return []
    vectors = sharp.vertices[edges.ends[:, 1]] - sharp.vertices[edges.ends[:, 0]]
    length = np.linalg.norm(vectors, axis=1)
    level = np.abs(np.ptp(height[edges.ends], axis=1)) <= math.sin(tolerances.alignment) * length
    rise = _rises(sharp, edges, height)
    lying = inside.all(axis=1) & level & rise
    corners = np.setdiff1d(edges.ends[inside], edges.ends[inside.all(axis=1) & level])
    corners = corners[_lowest(sharp, corners, height, math.sin(tolerances.alignment))]
    lines = np.flatnonzero(lying)
    if not 0 < len(lines) + len(corners) <= _MOST:
        return []
    out = []
    spots = [
        (edges.facets[k, 0], _between(sharp, edges.ends[k], 1 if edges.bends[k] else _ALONG), vectors[k] / length[k])
        for k in lines
    ]
    beside = {int(v): int(f[0]) for pair, f in zip(edges.ends, edges.facets, strict=True) for v in pair}
    spots += [(beside[int(v)], sharp.vertices[[v]], np.zeros(3)) for v in corners]
    for facet, points, axis in spots:
        ids = (int(sharp.surfaces.labels[facet]), int(side.ids[row]))
        if (ids if first else ids[::-1]) in known:
            continue
        gaps = (points - origin) @ normal
        holds = _over(flat, points - gaps[:, None] * normal, normal, ids[1], tolerance)
        if holds.any():
            line = len(points) > 1
            each = 2.0 * _ZONE * tolerance * float(np.linalg.norm(points[1] - points[0])) if line else 0.0
            spot = (points[holds], gaps[holds], axis if line else np.zeros(3), each)
            out.append(_patch(sharp, flat, side, row, ids, first, spot, tolerance))
    return out


def _rises(sharp: PlacedPart, edges: _Edges, height: Array) -> Flags:
    """Whether both faces beside each edge rise from it, and not as good as flat."""
    out = np.ones(len(edges.ends), dtype=bool)
    base = height[edges.ends].mean(axis=1)
    for column in (0, 1):
        corners = sharp.faces[edges.facets[:, column]]
        third = corners.sum(axis=1) - edges.ends.sum(axis=1)
        reach = sharp.vertices[third] - sharp.vertices[edges.ends[:, 0]]
        along = sharp.vertices[edges.ends[:, 1]] - sharp.vertices[edges.ends[:, 0]]
        along = along / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
        away = np.linalg.norm(reach - np.einsum("ij,ij->i", reach, along)[:, None] * along, axis=1)
        out &= height[third] - base > _RISE * away
    return out


def _lowest(sharp: PlacedPart, corners: Ints, height: Array, slope: float) -> Flags:
    """Whether everything around each corner rises from it, at least at this slope; rims rise slowly."""
    out = np.zeros(len(corners), dtype=bool)
    for k, vertex in enumerate(corners):
        around = np.setdiff1d(sharp.faces[(sharp.faces == vertex).any(axis=1)], [vertex])
        away = np.linalg.norm(sharp.vertices[around] - sharp.vertices[vertex], axis=1)
        out[k] = bool((height[around] - height[vertex] > slope * away).all())
    return out


def _between(sharp: PlacedPart, ends: Ints, count: int) -> Array:
    share = (np.arange(count) + 0.5) / count
    start, stop = sharp.vertices[ends]
    return np.asarray(start + share[:, None] * (stop - start))


def _over(flat: PlacedPart, points: Array, normal: Array, surface: int, tolerance: float) -> Flags:
    """Whether points on a plane are on the facets of that surface."""
    reach = np.full(len(points), 0.05 * tolerance + flat.surfaces.surfaces[surface].chord)
    directions = np.tile(normal, (len(points), 1))
    hits = flat.region.cast(flat.to_part(points), flat.turn_to_part(directions), reach)
    out = np.zeros(len(points), dtype=bool)
    out[hits.probe[flat.surfaces.labels[hits.facet] == surface]] = True
    return out


def _patch(
    sharp: PlacedPart,
    flat: PlacedPart,
    side: NearSurfaces,
    row: int,
    ids: tuple[int, int],
    first: bool,
    spot: tuple[Array, Array, Array, float],
    tolerance: float,
) -> Patch:
    points, gaps, axis, each = spot
    line = bool(np.any(axis))
    area = each if line else math.pi * (_ZONE * tolerance) ** 2
    normal = -side.axes[row] if first else side.axes[row]
    uncertainty = (float(side.axis_uncertainty[row]), float(side.point_uncertainty[row]))
    names = (sharp.part.name, flat.part.name)
    return Patch(
        parts=names if first else names[::-1],
        surfaces=ids if first else ids[::-1],
        kind="line" if line else "point",
        one_sided=False,
        points=points - 0.5 * gaps[:, None] * side.axes[row],
        normals=np.tile(normal, (len(points), 1)),
        gaps=gaps,
        weights=np.full(len(points), area),
        area=area * len(points),
        gap=float(gaps.mean()),
        axis=axis,
        point=points.mean(axis=0),
        radii=(0.0, 0.0),
        misalignment=0.0,
        offset=0.0,
        uncertainty=uncertainty,
        chord=float(side.chords[row]),
        fit=classify_fit(gaps, float(side.chords[row]), uncertainty[1], tolerance),
    )
