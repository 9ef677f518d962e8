"""A screw in its nut: helicoids of one axis, pitch and hand, flank to flank.

In the coordinates of a screw motion, distance from the axis and height less advance times azimuth, a thread is its
profile, whatever its tessellation: each facet is a piece of a line there. Two threads touch where such pieces of
either side lie against each other and both have facets at that place along the helix; the normals are those of the
profiles, and so the common screw motion is left exactly free.

A crest or a root is a cylinder about the axis: it holds the threads radially, says nothing along the axis and carries
no axial load. So its facets are patches of their own, of the kind cylinder, and those of the helicoid are flanks alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import MATING_REACH, PATCH_AREA, SAMPLES
from kinform.contacts.mating.charts import plane_basis
from kinform.contacts.mating.mate import Axes, aligned, mean_axes, radial_limit
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.pair_view import PairView, PartView, SurfacePair
from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch

PITCH_SAME = 2e-3
"""Relative difference of two leads that are meant as one; less where the engagement is long. Chosen, not measured."""
THREAD_AXIS_VAGUE = 0.02
"""rad: uncertainty of its axis from which on a surface is no thread that mates. Chosen, not measured."""
PROFILE_SHARES = np.array([1.0, 3.0, 5.0]) / 6.0
"""Where samples lie on the profile of a facet: the middles of its thirds."""
FLANK_GAP = 0.15
"""Largest gap of two flanks, in leads: beyond, neither is the other's. Chosen, not measured."""
COAXIAL_SLOPE = math.tan(math.radians(15.0))
"""Largest rise of a crest or root from the axis, over its length along it. Where a plane cuts a thread a facet of its
crest has a corner on a chord, a few degrees off; flanks of standard threads rise by 45° at least (saw threads)."""


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

    def coaxial(self, tolerance: float) -> Flags:
        """(n,) which facets are of a crest or a root: of a cylinder about the axis to within `tolerance` (m)."""
        rise, length = np.abs(self.end - self.start).T
        return np.asarray((rise <= COAXIAL_SLOPE * length) & (rise <= tolerance))


def threaded_patches(pair: PairView, overlap: Flags) -> list[Patch]:
    """Patches between the helicoids flagged in `overlap` (s, t), in the frame of the pair."""
    rows, columns, flags = pair.of_kinds(overlap, "helicoid")
    return [patch for i, j in np.argwhere(flags) for patch in _patches(pair, pair.surfaces(rows[i], columns[j]))]


def _fit(pair: PairView, surfaces: SurfacePair) -> tuple[Axes, float, float] | None:
    """Common axis, pitch and greatest gap of flanks (m) of two threads; None where they are no screw and its nut."""
    first, second = surfaces.both("pitches")
    middle, size = surfaces.box()
    axes = mean_axes(surfaces, middle)
    engaged = float(size @ np.abs(axes.axis))
    turns = engaged / max(abs(first), ARITHMETIC)
    apart = abs(first - second)
    pitch = 0.5 * (first + second)
    limit = FLANK_GAP * abs(pitch)
    if max(surfaces.turns) > THREAD_AXIS_VAGUE:
        return None
    if apart > PITCH_SAME * abs(first) or apart * max(turns, 1.0) > limit:
        return None
    return (axes, pitch, limit) if aligned(pair, axes, limit, engaged) else None


def _patches(pair: PairView, surfaces: SurfacePair) -> list[Patch]:
    """The patches of two threads, of samples of either that lie on the other: of their flanks, then of crests on roots;
    none where no flanks touch."""
    fit = _fit(pair, surfaces)
    if fit is None:
        return []
    axes, pitch, limit = fit
    profiles = [
        _profile(part, facets, axes, pitch / (2 * math.pi))
        for part, facets in zip(pair.parts, surfaces.facets, strict=True)
    ]
    coaxial = [side.coaxial(pair.tolerance) for side in profiles]
    flanks = [side.select(np.flatnonzero(~of)) for side, of in zip(profiles, coaxial, strict=True)]
    found = _Touching.of(flanks, pitch, limit)
    if found.area < PATCH_AREA * pair.tolerance**2:
        return []
    patches = [_patch(pair, surfaces, axes, found, pitch)]
    middle = float(found.weights @ found.points[:, 0]) / found.area
    cylinders = [side.select(np.flatnonzero(of)) for side, of in zip(profiles, coaxial, strict=True)]
    for outer in (False, True):
        rounds = [side.select(np.flatnonzero((side.start[:, 0] > middle) == outer)) for side in cylinders]
        if not all(len(side.area) for side in rounds):
            continue
        radii = [float(side.area @ (side.start + side.end)[:, 0] / (2.0 * side.area.sum())) for side in rounds]
        play = radial_limit(pair.play, min(radii))
        found = _Touching.of(rounds, pitch, play)
        if found.area >= PATCH_AREA * pair.tolerance**2:
            patches.append(_round_patch(pair, surfaces, axes, found, (radii[0], radii[1]), play))
    return patches


@dataclass(frozen=True, eq=False)
class _Touching:
    """Samples of two threads that lie on each other."""

    points: Array
    """(n, 2) on the profile."""
    normals: Array
    """(n, 3) as of `_Profile`, out of the first."""
    azimuth: Array
    height: Array
    gaps: Array
    weights: Array
    """(n,) m²."""

    @staticmethod
    def of(sides: Sequence[_Profile], pitch: float, limit: float) -> _Touching:
        """Those of two profiles, at most `limit` (m) apart."""
        first, second = _resting(sides[0], sides[1], pitch, limit), _resting(sides[1], sides[0], pitch, limit)
        points, azimuth, height, gaps, area = (
            np.concatenate([getattr(side, name) for side in (first, second)])
            for name in ("points", "azimuth", "height", "gaps", "area")
        )
        return _Touching(points, np.concatenate([first.normal, -second.normal]), azimuth, height, gaps, area)

    @property
    def area(self) -> float:
        """m²."""
        return float(self.weights.sum())


def _patch(pair: PairView, surfaces: SurfacePair, axes: Axes, found: _Touching, pitch: float) -> Patch:
    """The patch of two threads whose flanks touch."""
    base, aside = plane_basis(axes.axis)
    radial = np.cos(found.azimuth)[:, None] * base + np.sin(found.azimuth)[:, None] * aside
    return Patch(
        parts=pair.names,
        surfaces=surfaces.ids,
        kind="helicoid",
        one_sided=False,
        points=axes.point + found.points[:, :1] * radial + found.height[:, None] * axes.axis,
        normals=_turned(found.normals, radial, axes.axis),
        gaps=found.gaps,
        weights=found.weights,
        area=found.area,
        gap=float(found.weights @ found.gaps / found.area),
        axis=axes.axis,
        point=axes.point + float(found.weights @ found.height / found.area) * axes.axis,
        radii=surfaces.radii,
        misalignment=axes.misalignment,
        offset=axes.offset,
        uncertainty=axes.uncertainty,
        mismatch=axes.mismatch,
        chord=surfaces.chord,
        fit=classify_fit(found.gaps, surfaces.chord, axes.uncertainty[1], pair.tolerance),
        pitch=pitch,
    )


def _round_patch(
    pair: PairView, surfaces: SurfacePair, axes: Axes, found: _Touching, radii: tuple[float, float], limit: float
) -> Patch:
    """The patch of a crest in a root of two threads, cylinders of these radii (m), at most `limit` (m) apart."""
    outward = np.zeros_like(found.normals)
    outward[:, 0] = np.sign(found.normals[:, 0])
    gap = (radii[1] - radii[0]) * float(np.sign(found.weights @ outward[:, 0]))
    on = replace(found, normals=outward, gaps=np.full(len(found.gaps), gap))
    on.points[:, 0] = 0.5 * sum(radii)
    patch = _patch(pair, surfaces, axes, on, 0.0)
    return replace(patch, kind="cylinder", radii=radii, gap=gap, tolerance=limit / MATING_REACH)


def _turned(vectors: Array, radial: Array, axis: Array) -> Array:
    """(n, 3) vectors given by what they are away from the axis, along the azimuth and along the axis."""
    around = cross(axis, radial)
    return np.asarray(vectors[:, :1] * radial + vectors[:, 1:2] * around + vectors[:, 2:] * axis)


def _profile(part: PartView, facets: Ints, axes: Axes, advance: float) -> _Profile:
    """The facets in the coordinates of the screw about the axes."""
    corners = part.vertices.take(part.faces[facets], axis=0)
    base, aside = plane_basis(axes.axis)
    arm = corners - axes.point
    height, x, y = arm @ axes.axis, arm @ base, arm @ aside
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
    normal = np.stack([-along[:, 1], -advance / np.maximum(middle[:, 0], TINY) * along[:, 0], along[:, 0]], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), TINY)[:, None]
    radial = np.cos(centre)[:, None] * base + np.sin(centre)[:, None] * aside
    sense = np.sign(dot(_turned(normal, radial, axes.axis), part.normals(facets)))
    profile = _Profile(
        start, end, normal * sense[:, None], centre, middle[:, 1] + advance * centre,
        0.5 * np.ptp(height, axis=1), part.index.areas(facets),
    )  # fmt: skip
    return profile.select(np.flatnonzero((spans.max(axis=1) > SOLVED * distance.max(initial=0.0)) & (sense != 0)))


def _wrapped(angle: Array) -> Array:
    """Angles (…) less whole turns, within half a turn of 0."""
    return np.asarray(angle - 2 * math.pi * np.round(angle / (2 * math.pi)))


@dataclass(frozen=True, eq=False)
class _Samples:
    """Samples of one thread that lie on the other."""

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
    facet = np.repeat(np.arange(len(profile.area)), len(PROFILE_SHARES))
    share = np.tile(PROFILE_SHARES, len(profile.area))
    points = profile.select(facet).at(share)
    azimuth = profile.azimuth[facet]
    normal = profile.normal[facet].copy()
    # the slope of the helix changes with the distance from the axis
    normal[:, 1] = -pitch / (2 * math.pi) * normal[:, 2] / np.maximum(points[:, 0], TINY)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return facet, points, normal, azimuth, points[:, 1] + pitch / (2 * math.pi) * azimuth


def _resting(mine: _Profile, other: _Profile, pitch: float, limit: float) -> _Samples:
    """Samples of one side that lie within `limit` (m) of the other side's profile, and half their areas."""
    from scipy.spatial import cKDTree

    kept = np.arange(0, len(mine.area), max(1, math.ceil(len(mine.area) / SAMPLES)))
    share = len(mine.area) / max(len(kept), 1)
    facet, points, normal, azimuth, height = _places(mine.select(kept), pitch)
    if not len(facet) or not len(other.area):
        return _Samples(points[:0], normal[:0], azimuth[:0], height[:0], np.zeros(0), np.zeros(0))
    theirs, their_points, their_normal, _, their_height = _places(other, pitch)
    lead = abs(pitch)
    far = 1e6 * (lead + float(mine.start.max() + other.start.max() + np.ptp(height) + np.ptp(their_height)))
    low = min(float(height.min()), float(their_height.min()))

    def embedded(places: Array, heights: Array) -> Array:
        turn = np.mod(places[:, 1], lead)
        # distances along the helix count a tenth in looking for neighbours
        return np.stack([places[:, 0], np.where(turn >= lead, 0.0, turn), 0.1 * (heights - low)], axis=1)

    tree = cKDTree(embedded(their_points, their_height), boxsize=[far, lead, far])
    # samples of the other side that are held against each
    count = min(24, len(their_points))
    _, near = tree.query(embedded(points, height), k=count)
    near = near.reshape(len(points), count)
    line = theirs[near]
    offset = points[:, None] - their_points[near]
    turns = np.round(offset[..., 1] / lead)
    offset[..., 1] -= turns * lead
    opposite = their_normal[near]
    gap = offset[..., 0] * opposite[..., 0] + offset[..., 1] * opposite[..., 2]
    along = other.end[line] - other.start[line]
    length = np.maximum(np.linalg.norm(along, axis=2), TINY)
    from_start = their_points[near] - other.start[line] + offset
    foot = np.einsum("ijk,ijk->ij", from_start, along) / length**2
    beside = np.abs(height[:, None] - their_height[near]) - other.reach[line] - mine.reach[kept][facet][:, None]
    # normals of flanks on each other oppose within 45°
    good = (
        (np.einsum("ijk,ijk->ij", np.broadcast_to(normal[:, None], opposite.shape), opposite) < -0.7)
        & (np.abs(gap) <= limit)
        & (foot >= -SINGLE)
        & (foot <= 1.0 + SINGLE)
        & (beside <= limit)
    )
    best = np.argmin(np.where(good, np.abs(gap), np.inf), axis=1)
    holds = np.flatnonzero(good.any(axis=1))
    area = 0.5 * share * mine.area[kept][facet] / len(PROFILE_SHARES)
    return _Samples(points[holds], normal[holds], azimuth[holds], height[holds], gap[holds, best[holds]], area[holds])
