"""Contacts that are analytic on one side only.

An analytic surface against facets that fit no surface: the facets that lie within the tolerance of the
surface and face it are overlaid with it, and the normals are those of the surface. Two planes that oppose
each other within a few degrees but not within the alignment touch without mating: kind "other", with the
normal of the larger plane. Balls and cylinders on planes, and other line and point contacts, are higher
pairs with rows of their own: they are not made into patches here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kinform.contacts.constants import FACING_OPPOSED, FLUSH_ANGLE, MATING_REACH, PATCH_AREA
from kinform.contacts.mating.charts import Chart, ConeChart, CylinderChart, PlaneChart, SphereChart, perpendicular
from kinform.contacts.mating.mate import Mate
from kinform.contacts.search.pair_view import PairView, SurfacePair, boxes_of
from kinform.foundation.algebra.vectors import dot, lengths
from kinform.foundation.meshes.box_pairs import Boxes, meeting_boxes
from kinform.foundation.meshes.boxes import meeting_box, middles
from kinform.foundation.meshes.surface_table import CONE, PLANE, SPHERE, TORUS
from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.foundation.sorting import heads
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS

ANALYTIC_KINDS = ("plane", "cylinder", "cone", "sphere")
"""Kinds of surfaces that give normals to others."""


_ANALYTIC = np.array([kind in ANALYTIC_KINDS for kind in KINDS])
"""Which kinds of surfaces have equations, by their numbers."""


def one_sided_mates(pair: PairView, overlap: Flags) -> list[Mate]:
    """One-sided mates among the pairs of surfaces flagged in `overlap` (s, t)."""
    mates: list[Mate] = []
    # a gives the normals, then b
    for view, flags, first in ((pair, overlap, True), (pair.swapped, overlap.T, False)):
        for row, column, facets in _beside(view, _givers_and_takers(view, flags, first)):
            mate = _mate(view, view.surfaces(row, column), facets, first)
            if mate is not None:
                mates.append(mate)
    return mates


def _beside(view: PairView, wanted: Flags) -> Iterator[tuple[int, int, Ints]]:
    """The pairs of a giver with a taker flagged in `wanted` (s, t), sorted, of which facets of the taker lie in the
    giver's box, and face it where it is plane, with these, where any of them may rest on it: all at once, for most of
    them have none there."""
    giver, taker = view.near
    if not wanted.any():
        return
    rows, columns = np.flatnonzero(wanted.any(axis=1)), np.flatnonzero(wanted.any(axis=0))
    every = np.concatenate([taker.facets[column] for column in columns.tolist()])
    of_column = np.repeat(columns, [len(taker.facets[column]) for column in columns.tolist()])
    reach = view.tolerance
    boxes = giver.lows.take(rows, axis=0) - reach, giver.highs.take(rows, axis=0) + reach
    one, two = _meeting(boxes, boxes_of(view.b, every))
    row, column = rows.take(one), of_column.take(two)
    kept = (wanted[row, column]).nonzero()[0]
    row, column, facets = row.take(kept), column.take(kept), every.take(two.take(kept))
    normals = view.b.normals(facets)
    flat = giver.kinds.take(row) == PLANE
    outward = giver.sides.take(row)[:, None] * giver.axes.take(row, axis=0)
    kept = (~flat | (dot(outward, normals) < FACING_OPPOSED)).nonzero()[0]
    row, column, facets, normals = row.take(kept), column.take(kept), facets.take(kept), normals.take(kept, axis=0)
    if not len(row):
        return
    may = _may_rest(view, row, facets, normals)
    pair = row * np.int64(len(taker.ids)) + column
    starts = heads(pair).nonzero()[0]
    ends = [*starts[1:].tolist(), len(pair)]
    some = np.logical_or.reduceat(may, starts).tolist()
    for start, end, may_some in zip(starts.tolist(), ends, some, strict=True):
        if may_some:
            yield int(row[start]), int(column[start]), facets[start:end]


def _meeting(first: Boxes, second: Boxes) -> tuple[Ints, Ints]:
    """Indices (k,) of boxes (n, 3) and (m, 3) that meet, by the first, then by the second."""
    met = meeting_boxes(first, second)
    if met is not None:
        return met
    each = [np.flatnonzero(meeting_box(*second, low, high)) for low, high in zip(*first, strict=True)]
    return np.repeat(np.arange(len(each)), [len(found) for found in each]), np.concatenate(each)


def _may_rest(view: PairView, rows: Ints, facets: Ints, normals: Array) -> Flags:
    """(k,) which of these facets of the taker, with their normals (k, 3), may have something within the tolerance of
    the giver's surface in the same row, and face it: what is clearly above, or below, or turned away, has not."""
    giver, taker = view.near[0], view.b
    corners = taker.vertices.take(taker.faces.take(facets, axis=0), axis=0)
    axes, kinds = giver.axes.take(rows, axis=0), giver.kinds.take(rows)
    arms = corners - giver.points.take(rows, axis=0)[:, None]
    heights = along = np.einsum("kij,kj->ki", arms, axes)
    spare = SOLVED * (np.abs(arms).max(initial=0.0) + giver.radii.max(initial=0.0))
    out = np.ones(len(rows), bool)
    curved = np.flatnonzero(kinds != PLANE)
    if len(curved):
        rows, kinds, axes, along = rows.take(curved), kinds.take(curved), axes.take(curved, axis=0), along[curved]
        along[kinds == SPHERE] = 0.0
        across = arms[curved] - along[..., None] * axes[:, None]
        conical = kinds == CONE
        half = np.where(conical, giver.half_angles.take(rows), 0.0)
        cosine, sine = np.cos(half), np.sin(half)
        radius = np.where(conical, 0.0, giver.radii.take(rows))
        heights[curved] = lengths(across) * cosine[:, None] - along * sine[:, None] - radius[:, None]
        radial = middles(across)
        radial /= np.maximum(lengths(radial), TINY)[:, None]
        outward = cosine[:, None] * radial - sine[:, None] * axes
        facing = giver.sides.take(rows) * dot(outward, normals.take(curved, axis=0))
        # of a middle that is nearly on the axis nothing is clear
        out[curved] = (facing < FACING_OPPOSED + SINGLE) | (lengths(middles(across)) <= 1e3 * spare)
    limit = MATING_REACH * view.tolerance + spare
    return np.asarray(out & (heights.min(axis=1) <= limit) & (heights.max(axis=1) >= -limit))


def without_continuations(pair: PairView, patches: list[Patch]) -> list[Patch]:
    """The patches without those one-sided ones that only continue a two-sided one.

    A fillet beside a face that lies on a plane says nothing that the face does not say: a one-sided patch
    goes if its surface on one side is that of a two-sided patch, and those on the other share an edge.
    """
    if not any(patch.one_sided for patch in patches):
        return patches
    a, b = pair.parts
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


def _givers_and_takers(view: PairView, overlap: Flags, first: bool) -> Flags:
    """(s, t) of those flagged in `overlap`: analytic surfaces of the part that gives the normals with freeform ones of
    the other that rests on it, and planes with larger planes that they lie on askew; of planes of one size that of the
    `first` part gives."""
    giver, taker = view.near
    large = giver.areas >= PATCH_AREA * view.tolerance**2
    resting = _ANALYTIC[giver.kinds][:, None] & ~_ANALYTIC[taker.kinds]
    flat = (giver.kinds == PLANE)[:, None] & (taker.kinds == PLANE)
    rows, columns = np.nonzero(overlap & large[:, None] & (resting | flat))
    flags = np.zeros(overlap.shape, bool)
    if not len(rows):
        return flags
    kinds = giver.kinds[rows], taker.kinds[columns]
    resting = resting[rows, columns]
    # a ball touches the groove of a ring along a circle or at a point, as `rounds` knows, and does not rest in it
    resting &= (kinds[0] != SPHERE) | (kinds[1] != TORUS)
    angle = np.arccos(np.clip(-dot(giver.axes[rows], taker.axes[columns]), -1.0, 1.0))
    spread = giver.axis_uncertainty[rows] + taker.axis_uncertainty[columns]
    areas = giver.areas[rows], taker.areas[columns]
    larger = areas[0] >= areas[1] if first else areas[0] > areas[1]
    askew = flat[rows, columns] & larger
    askew &= (angle > view.tolerances.alignment + spread) & (angle < FLUSH_ANGLE)
    flags[rows, columns] = resting | askew
    return flags


def _chart(surfaces: SurfacePair) -> Chart:
    """The chart of the first surface, looking towards the second."""
    kind, axis, point = surfaces.kinds[0], surfaces.axes[0], surfaces.points[0]
    if kind == "plane":
        return PlaneChart(axis, point)
    towards, _ = surfaces.box()
    if kind == "sphere":
        return SphereChart.seen_from(point, surfaces.radii[0], towards)
    arm = towards - point
    base = perpendicular(axis, arm)
    if kind == "cylinder":
        return CylinderChart(axis, point, base, surfaces.radii[0])
    half = surfaces.both("half_angles")[0]
    middle = max(float(arm @ axis), 0.5 * float(surfaces.extents[0].sum())) * math.tan(half)
    return ConeChart(axis, point, base, half, middle)


def _mate(view: PairView, surfaces: SurfacePair, facets: Ints, first: bool) -> Mate | None:
    """The mate of a surface of the giver, which is the `first` part of the pair or not, with what of these facets of
    the taker rests on it."""
    chart, side = _chart(surfaces), surfaces.sides[0]
    resting = _resting(view, surfaces, chart, facets)
    if not len(resting):
        return None
    giver = view.a.vertices.take(view.a.faces[surfaces.facets[0]], axis=0)
    kind, other = surfaces.kinds
    axis = surfaces.axes[0]
    radius = surfaces.both("half_angles")[0] if kind == "cone" else surfaces.radii[0]
    sign = side if first else -side
    limit = MATING_REACH * view.tolerance
    return Mate(
        surfaces if first else surfaces.swapped,
        kind="other" if other in ANALYTIC_KINDS else kind,
        chart=chart,
        sign=sign,
        axis=sign * axis if kind == "plane" else axis,
        point=surfaces.points[0],
        radii=(radius, 0.0) if first else (0.0, radius),
        limit=limit,
        slack=limit + surfaces.both("slacks")[0],
        uncertainty=(surfaces.turns[0], surfaces.shifts[0]),
        mismatch=(sum(surfaces.turns), sum(surfaces.shifts)),
        corners=(giver, resting) if first else (resting, giver),
    )


def _resting(view: PairView, surfaces: SurfacePair, chart: Chart, facets: Ints) -> Array:
    """Those (n, 3, 3) of facets of the taker's surface that face the giver's, cut to what is within the tolerance."""
    taker = view.b
    corners = taker.vertices.take(taker.faces[facets], axis=0)
    normals = surfaces.sides[0] * chart.normals(middles(corners))
    corners = corners[dot(normals, taker.normals(facets)) < FACING_OPPOSED]
    if not len(corners):
        return np.zeros((0, 3, 3))
    heights = chart.heights(corners.reshape(-1, 3)).reshape(-1, 3)
    corners, heights = _below(corners, heights, MATING_REACH * view.tolerance)
    return _below(corners, -heights, MATING_REACH * view.tolerance)[0]


def _below(corners: Array, values: Array, limit: float) -> tuple[Array, Array]:
    """The parts of triangles (n, 3, 3) where values (n, 3), linear between the corners, are ≤ limit."""
    inside = values <= limit
    if inside.all():
        return corners, values
    count = inside.sum(axis=1)
    whole, whole_values = corners[count == 3], values[count == 3]
    pieces, piece_values = [whole], [whole_values]
    for number in (1, 2):
        rows = np.nonzero(count == number)[0]
        if not len(rows):
            continue
        # Turn each triangle until its odd corner is the first.
        odd = np.argmax(inside[rows] if number == 1 else ~inside[rows], axis=1)
        order = (odd[:, None] + np.arange(3)) % 3
        p, v = corners[rows[:, None], order], values[rows[:, None], order]
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
