"""Contacts that are analytic on one side only.

An analytic surface against facets that fit no surface: the facets that lie within the tolerance of the
surface and face it are overlaid with it, and the normals are those of the surface. Two planes that oppose
each other within a few degrees but not within the alignment touch without mating: kind "other", with the
normal of the larger plane. Balls and cylinders on planes, and other line and point contacts, are higher
pairs with rows of their own: they are not made into patches here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinform.contacts.mating.charts import Chart, ConeChart, CylinderChart, PlaneChart, SphereChart, perpendicular
from kinform.contacts.mating.mates import EDGE, Mate, box_centre
from kinform.contacts.search.placed import NearSurfaces, PlacedPart
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

__all__ = ["one_sided_mates", "without_continuations"]


_ANALYTIC = ("plane", "cylinder", "cone", "sphere")
_OPPOSED = -0.93
"""Greatest cosine between the surface's normal and a facet that rests on it."""
_TILTED = math.radians(3.0)
"""Planes that oppose each other within this lie on each other badly; beyond, they meet at an edge."""
_LEAST = 4.0
"""An analytic surface gives normals to others from this area on, in squared tolerances."""


@dataclass(frozen=True, eq=False)
class _Side:
    """The part that gives the normals, or the one that rests on it."""

    placed: PlacedPart
    near: NearSurfaces


def one_sided_mates(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    overlap: Flags,
    tolerance: float,
    tolerances: Tolerances,
) -> list[Mate]:
    """One-sided mates among the pairs of surfaces flagged in `overlap` (s, t)."""
    sides = (_Side(a, near[0]), _Side(b, near[1]))
    mates: list[Mate] = []
    for first, flags in ((0, overlap), (1, overlap.T)):
        giver, taker = sides[first], sides[1 - first]
        for row, column in _pairs(giver.near, taker.near, flags, tolerance, tolerances, first == 0):
            mate = _mate(giver, taker, row, column, tolerance, first == 0)
            if mate is not None:
                mates.append(mate)
    return mates


def without_continuations(patches: list[Patch], a: PlacedPart, b: PlacedPart) -> list[Patch]:
    """The patches without those one-sided ones that only continue a two-sided one.

    A fillet beside a face that lies on a plane says nothing that the face does not say: a one-sided patch
    goes if its surface on one side is that of a two-sided patch, and those on the other share an edge.
    """
    if not any(patch.one_sided for patch in patches):
        return patches
    firm = {patch.surfaces for patch in patches if not patch.one_sided}
    kept = []
    for patch in patches:
        i, j = patch.surfaces
        continues = patch.one_sided and (
            any((k, j) in firm for k in a.index.neighbours(a.surfaces, i))
            or any((i, k) in firm for k in b.index.neighbours(b.surfaces, j))
        )
        if not continues:
            kept.append(patch)
    return kept


def _pairs(
    giver: NearSurfaces,
    taker: NearSurfaces,
    overlap: Flags,
    tolerance: float,
    tolerances: Tolerances,
    first: bool,
) -> list[tuple[int, int]]:
    """Analytic surfaces with freeform ones, and planes with larger planes that they lie on askew."""
    analytic = np.isin(giver.kinds, [KINDS.index(kind) for kind in _ANALYTIC])
    large = giver.areas >= _LEAST * tolerance**2
    loose = ~np.isin(taker.kinds, [KINDS.index(kind) for kind in _ANALYTIC])
    flags = (analytic & large)[:, None] & loose[None]
    # a ball touches the groove of a ring along a circle or at a point, as `rounds` knows, and does not rest in it
    flags &= ~((giver.kinds == KINDS.index("sphere"))[:, None] & (taker.kinds == KINDS.index("torus"))[None])
    plane = KINDS.index("plane")
    planes = (giver.kinds == plane)[:, None] & (taker.kinds == plane)[None]
    angle = np.arccos(np.clip(-(giver.axes @ taker.axes.T), -1.0, 1.0))
    spread = giver.axis_uncertainty[:, None] + taker.axis_uncertainty[None]
    larger = giver.areas[:, None] > taker.areas[None]
    if first:
        larger |= giver.areas[:, None] == taker.areas[None]
    askew = planes & (angle > tolerances.alignment + spread) & (angle < _TILTED) & larger
    return [(int(i), int(j)) for i, j in np.argwhere(overlap & (flags | (askew & large[:, None])))]


def _chart(near: NearSurfaces, row: int, towards: Array) -> Chart:
    """The chart of one analytic surface, looking towards a point."""
    kind, axis, point = KINDS[near.kinds[row]], near.axes[row], near.points[row]
    if kind == "plane":
        return PlaneChart(axis, point)
    arm = towards - point
    if kind == "sphere":
        distance = float(np.linalg.norm(arm))
        far = distance > 1e-3 * near.radii[row]
        return SphereChart(point, float(near.radii[row]), arm / distance if far else np.array([0.0, 0.0, 1.0]))
    base = perpendicular(axis, arm)
    if kind == "cylinder":
        return CylinderChart(axis, point, base, float(near.radii[row]))
    half = float(near.half_angles[row])
    middle = max(float(arm @ axis), 0.5 * float(near.extents[row].sum())) * math.tan(half)
    return ConeChart(axis, point, base, half, middle)


def _mate(giver: _Side, taker: _Side, row: int, column: int, tolerance: float, first: bool) -> Mate | None:
    near = giver.near
    towards, _ = box_centre(near, taker.near, row, column)
    chart = _chart(near, row, towards)
    side = float(near.sides[row])
    resting = _resting(chart, side, taker, near, (row, column), tolerance)
    if not len(resting):
        return None
    own = giver.placed.vertices[giver.placed.faces[near.facets[row]]]
    other = KINDS[taker.near.kinds[column]]
    axis, uncertainty = (
        near.axes[row],
        (float(near.axis_uncertainty[row]), float(near.point_uncertainty[row])),
    )
    radius = float(near.half_angles[row] if KINDS[near.kinds[row]] == "cone" else near.radii[row])
    sign = side if first else -side
    return Mate(
        rows=(row, column) if first else (column, row),
        kind="other" if other in _ANALYTIC else KINDS[near.kinds[row]],
        chart=chart,
        sign=sign,
        axis=sign * axis if KINDS[near.kinds[row]] == "plane" else axis,
        point=near.points[row],
        radii=(radius, 0.0) if first else (0.0, radius),
        gap=0.0,
        gradient=np.zeros(3),
        limit=EDGE * tolerance,
        slack=EDGE * tolerance + float(near.slacks[row]),
        misalignment=0.0,
        offset=0.0,
        uncertainty=uncertainty,
        chord=float(near.chords[row] + taker.near.chords[column]),
        corners=(own, resting) if first else (resting, own),
    )


def _resting(
    chart: Chart, side: float, taker: _Side, near: NearSurfaces, rows: tuple[int, int], tolerance: float
) -> Array:
    """Facets (n, 3, 3) of the taker's surface that face the giver's, cut to what is within the tolerance."""
    facets = taker.near.facets[rows[1]]
    corners = taker.placed.vertices[taker.placed.faces[facets]]
    low, high = near.lows[rows[0]] - tolerance, near.highs[rows[0]] + tolerance
    within = ((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)).all(axis=1)
    facets, corners = facets[within], corners[within]
    normals = side * chart.normals(corners.mean(axis=1))
    facing = np.einsum("ij,ij->i", normals, taker.placed.normals(facets)) < _OPPOSED
    corners = corners[facing]
    if not len(corners):
        return np.zeros((0, 3, 3))
    heights = chart.heights(corners.reshape(-1, 3)).reshape(-1, 3)
    corners, heights = _below(corners, heights, EDGE * tolerance)
    return _below(corners, -heights, EDGE * tolerance)[0]


def _below(corners: Array, values: Array, limit: float) -> tuple[Array, Array]:
    """The parts of triangles (n, 3, 3) where values (n, 3), linear between the corners, are ≤ limit."""
    inside = values <= limit
    count = inside.sum(axis=1)
    whole, whole_values = corners[count == 3], values[count == 3]
    pieces, piece_values = [whole], [whole_values]
    for number in (1, 2):
        rows = np.nonzero(count == number)[0]
        # Turn each triangle until its odd corner is the first.
        odd = np.argmax(inside[rows] if number == 1 else ~inside[rows], axis=1)
        order = (odd[:, None] + np.arange(3)) % 3
        p = np.take_along_axis(corners[rows], order[..., None], axis=1)
        v = np.take_along_axis(values[rows], order, axis=1)
        cuts = []
        for k in (1, 2):
            share = (limit - v[:, 0]) / (v[:, k] - v[:, 0])
            cuts.append(p[:, 0] + share[:, None] * (p[:, k] - p[:, 0]))
        edge = np.full(len(rows), limit)
        if number == 1:
            pieces.append(np.stack([p[:, 0], cuts[0], cuts[1]], axis=1))
            piece_values.append(np.stack([v[:, 0], edge, edge], axis=1))
        else:
            pieces += [
                np.stack([cuts[0], p[:, 1], p[:, 2]], axis=1),
                np.stack([cuts[0], p[:, 2], cuts[1]], axis=1),
            ]
            piece_values += [
                np.stack([edge, v[:, 1], v[:, 2]], axis=1),
                np.stack([edge, v[:, 2], edge], axis=1),
            ]
    return np.concatenate(pieces), np.concatenate(piece_values)
