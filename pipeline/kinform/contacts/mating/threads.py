"""A screw in its nut: helicoids of one axis, pitch and hand, flank to flank.

In the coordinates of a screw motion, distance from the axis and height less advance times azimuth, a thread is its
profile, whatever its tessellation: each facet is a piece of a line there. Two threads touch where such pieces of
either side lie against each other and both have facets at that place along the helix; the normals are those of the
profiles, and so the common screw motion is left exactly free.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinform.contacts.mating.charts import perpendicular
from kinform.contacts.mating.coaxial import aligned
from kinform.contacts.mating.mates import Axes, box_centre, mean_axes, radial_limit
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.placed import NearSurfaces, PlacedPart
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.tolerances import Tolerances

__all__ = ["threaded_patches"]


_SAME = 2e-3
"""Relative difference of two pitches that are meant as one; less where the engagement is long."""
_VAGUE = 0.02
"""rad: what is known no better than this about its axis is no thread that mates."""
_FACETS = 400
"""Greatest number of facets of either side that give samples."""
_ALONG = np.array([1.0, 3.0, 5.0]) / 6.0
"""Where samples lie on the profile of a facet."""
_NEIGHBOURS = 24
"""Samples of the other side that are held against each."""
_FLAT = 0.1
"""Weight of the distance along the helix in looking for these."""
_FACING = -0.7
"""Greatest cosine between the normals of two flanks that lie on each other."""
_PLAY = 0.15
"""Greatest gap of two flanks, in pitches: beyond, neither is the other's."""
_LEAST = 4.0
"""Least area of a patch, in squared tolerances."""


@dataclass(frozen=True, eq=False)
class _Profile:
    """Facets of one thread as pieces of its profile. Lengths in m."""

    start: Array
    """(n, 2) distance from the axis, and height less advance times azimuth."""
    end: Array
    normal: Array
    """(n, 3) unit, out of the material: away from the axis, along the azimuth, along the axis; at the middle."""
    azimuth: Array
    """(n,) of the middle."""
    height: Array
    """(n,) of the middle."""
    reach: Array
    """(n,) half of the height of the facet."""
    area: Array

    def at(self, share: Array) -> Array:
        """(n, 2) points of the profile."""
        return np.asarray(self.start + share[:, None] * (self.end - self.start))

    def select(self, rows: Ints) -> _Profile:
        """Some of the facets."""
        return _Profile(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def threaded_patches(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    overlap: Flags,
    tolerance: float,
    tolerances: Tolerances,
) -> list[Patch]:
    """Patches between the helicoids flagged in `overlap` (s, t), in the frame of the pair."""
    rows, columns = near[0].of_kind("helicoid"), near[1].of_kind("helicoid")
    patches = []
    for i, j in np.argwhere(overlap[np.ix_(rows, columns)]):
        patch = _patch(a, b, near, (int(rows[i]), int(columns[j])), tolerance, tolerances)
        if patch is not None:
            patches.append(patch)
    return patches


def _patch(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    rows: tuple[int, int],
    tolerance: float,
    tolerances: Tolerances,
) -> Patch | None:
    first, second = (float(side.pitches[row]) for side, row in zip(near, rows, strict=True))
    middle, size = box_centre(*near, *rows)
    axes = mean_axes(*near, *rows, middle)
    engaged = float(size @ np.abs(axes.axis))
    turns = engaged / max(abs(first), 1e-12)
    apart = abs(first - second)
    pitch = 0.5 * (first + second)
    limit = radial_limit(tolerance, min(float(side.radii[row]) for side, row in zip(near, rows, strict=True)))
    limit = min(limit, _PLAY * abs(pitch))
    if max(float(side.axis_uncertainty[row]) for side, row in zip(near, rows, strict=True)) > _VAGUE:
        return None
    if apart > _SAME * abs(first) or apart * max(turns, 1.0) > limit:
        return None
    if not aligned(axes, limit, engaged, tolerance, tolerances):
        return None
    sides = [
        _profile(part, side.facets[row], axes, pitch / (2 * math.pi))
        for part, side, row in zip((a, b), near, rows, strict=True)
    ]
    samples = [_resting(own, other, pitch, limit) for own, other in ((sides[0], sides[1]), (sides[1], sides[0]))]
    chosen = np.concatenate([found.points for found in samples])
    if not len(chosen):
        return None
    areas = np.concatenate([found.area for found in samples])
    if areas.sum() < _LEAST * tolerance**2:
        return None
    normal = np.concatenate([samples[0].normal, -samples[1].normal])
    azimuth, height = (np.concatenate([getattr(found, name) for found in samples]) for name in ("azimuth", "height"))
    gaps = np.concatenate([found.gaps for found in samples])
    base = perpendicular(axes.axis)
    aside = np.cross(axes.axis, base)
    radial = np.cos(azimuth)[:, None] * base + np.sin(azimuth)[:, None] * aside
    around = np.cross(axes.axis, radial)
    area = float(areas.sum())
    points = axes.point + chosen[:, :1] * radial + height[:, None] * axes.axis
    chord = float(near[0].chords[rows[0]] + near[1].chords[rows[1]])
    return Patch(
        parts=(a.part.name, b.part.name),
        surfaces=(int(near[0].ids[rows[0]]), int(near[1].ids[rows[1]])),
        kind="helicoid",
        one_sided=False,
        points=points,
        normals=normal[:, :1] * radial + normal[:, 1:2] * around + normal[:, 2:] * axes.axis,
        gaps=gaps,
        weights=areas,
        area=area,
        gap=float(areas @ gaps / area),
        axis=axes.axis,
        point=axes.point + float(areas @ height / area) * axes.axis,
        radii=(float(near[0].radii[rows[0]]), float(near[1].radii[rows[1]])),
        misalignment=axes.misalignment,
        offset=axes.offset,
        uncertainty=axes.uncertainty,
        chord=chord,
        fit=classify_fit(gaps, chord, axes.uncertainty[1], tolerance),
        pitch=pitch,
    )


def _profile(part: PlacedPart, facets: Ints, axes: Axes, advance: float) -> _Profile:
    """The facets in the coordinates of the screw about the axes."""
    corners = part.vertices[part.faces[facets]]
    base = perpendicular(axes.axis)
    arm = corners - axes.point
    height, x, y = arm @ axes.axis, arm @ base, arm @ np.cross(axes.axis, base)
    distance = np.hypot(x, y)
    azimuth = np.arctan2(y, x)
    azimuth = azimuth[:, :1] + _wrapped(azimuth - azimuth[:, :1])
    flat = np.stack([distance, height - advance * azimuth], axis=2)
    # the two corners that are farthest apart there span the profile
    pairs = np.array([[0, 1], [1, 2], [2, 0]])
    spans = np.linalg.norm(flat[:, pairs[:, 1]] - flat[:, pairs[:, 0]], axis=2)
    chosen = pairs[np.argmax(spans, axis=1)]
    each = np.arange(len(facets))
    start, end = flat[each, chosen[:, 0]], flat[each, chosen[:, 1]]
    along = end - start
    middle = 0.5 * (start + end)
    centre = azimuth.mean(axis=1)
    normal = np.stack([-along[:, 1], -advance / np.maximum(middle[:, 0], 1e-300) * along[:, 0], along[:, 0]], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    radial = np.cos(centre)[:, None] * base + np.sin(centre)[:, None] * np.cross(axes.axis, base)
    outward = normal[:, :1] * radial + normal[:, 1:2] * np.cross(axes.axis, radial) + normal[:, 2:] * axes.axis
    sense = np.sign(np.einsum("ij,ij->i", outward, part.normals(facets)))
    found = _Profile(
        start, end, normal * sense[:, None], centre, middle[:, 1] + advance * centre,
        0.5 * np.ptp(height, axis=1), part.index.areas(facets),
    )  # fmt: skip
    return found.select(np.flatnonzero((spans.max(axis=1) > 1e-9 * distance.max(initial=0.0)) & (sense != 0)))


def _wrapped(angle: Array) -> Array:
    return np.asarray(angle - 2 * math.pi * np.round(angle / (2 * math.pi)))


@dataclass(frozen=True, eq=False)
class _Samples:
    points: Array
    """(n, 2) on the profile."""
    normal: Array
    """(n, 3) as of `_Profile`, at the sample."""
    azimuth: Array
    height: Array
    gaps: Array
    area: Array


def _places(profile: _Profile, pitch: float) -> tuple[Ints, Array, Array, Array, Array]:
    """Facet, point (2,), normal (3,), azimuth and height of the samples of every facet."""
    facet = np.repeat(np.arange(len(profile.area)), len(_ALONG))
    share = np.tile(_ALONG, len(profile.area))
    points = profile.select(facet).at(share)
    azimuth = profile.azimuth[facet]
    normal = profile.normal[facet].copy()
    # the slope of the helix changes with the distance from the axis
    normal[:, 1] = -pitch / (2 * math.pi) * normal[:, 2] / np.maximum(points[:, 0], 1e-300)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return facet, points, normal, azimuth, points[:, 1] + pitch / (2 * math.pi) * azimuth


def _resting(own: _Profile, other: _Profile, pitch: float, limit: float) -> _Samples:
    """Samples of one side that lie within `limit` (m) of the other side's profile, and half their areas."""
    from scipy.spatial import cKDTree

    kept = np.arange(0, len(own.area), max(1, math.ceil(len(own.area) / _FACETS)))
    share = len(own.area) / max(len(kept), 1)
    facet, points, normal, azimuth, height = _places(own.select(kept), pitch)
    if not len(facet) or not len(other.area):
        return _Samples(points[:0], normal[:0], azimuth[:0], height[:0], np.zeros(0), np.zeros(0))
    theirs, their_points, their_normal, _, their_height = _places(other, pitch)
    lead = abs(pitch)
    far = 1e6 * (lead + float(own.start.max() + other.start.max() + np.ptp(height) + np.ptp(their_height)))
    low = min(float(height.min()), float(their_height.min()))

    def embedded(places: Array, heights: Array) -> Array:
        turn = np.mod(places[:, 1], lead)
        return np.stack([places[:, 0], np.where(turn >= lead, 0.0, turn), _FLAT * (heights - low)], axis=1)

    tree = cKDTree(embedded(their_points, their_height), boxsize=[far, lead, far])
    count = min(_NEIGHBOURS, len(their_points))
    _, near = tree.query(embedded(points, height), k=count)
    near = near.reshape(len(points), count)
    line = theirs[near]
    offset = points[:, None] - their_points[near]
    turns = np.round(offset[..., 1] / lead)
    offset[..., 1] -= turns * lead
    mine, opposite = normal[:, None], their_normal[near]
    gap = offset[..., 0] * opposite[..., 0] + offset[..., 1] * opposite[..., 2]
    along = other.end[line] - other.start[line]
    length = np.maximum(np.linalg.norm(along, axis=2), 1e-300)
    from_start = their_points[near] - other.start[line] + offset
    foot = np.einsum("ijk,ijk->ij", from_start, along) / length**2
    beside = np.abs(height[:, None] - their_height[near]) - other.reach[line] - own.reach[kept][facet][:, None]
    good = (
        (np.einsum("ijk,ijk->ij", np.broadcast_to(mine, opposite.shape), opposite) < _FACING)
        & (np.abs(gap) <= limit)
        & (foot >= -1e-6)
        & (foot <= 1.0 + 1e-6)
        & (beside <= limit)
    )
    best = np.argmin(np.where(good, np.abs(gap), np.inf), axis=1)
    holds = np.flatnonzero(good.any(axis=1))
    area = 0.5 * share * own.area[kept][facet] / len(_ALONG)
    return _Samples(points[holds], normal[holds], azimuth[holds], height[holds], gap[holds, best[holds]], area[holds])
