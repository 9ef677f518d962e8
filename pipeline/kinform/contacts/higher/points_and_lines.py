"""Point and line contacts, where two parts share no surface: a ball or a roller on a plane, on another or in a bore.

Such a higher pair has one row a point, with the normal of the plane. It is looked for only between parts
that have no patch at all: beside a real patch, surfaces that merely pass close to each other are many, and
a tangent fillet says nothing that its plane does not say. Those that hold what patches leave are told apart in
`beside_patches`. Area is that of the zone where the two surfaces are within 1 % of the contact tolerance of each other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import MATING_REACH, PARALLEL_SINE, PROBE_SPARE, TOUCH
from kinform.contacts.higher.constants import CAPTIVE, STRAIGHT_COSINE, ZONE
from kinform.contacts.higher.meeting import Meeting
from kinform.contacts.higher.rounds import meeting, on_plane
from kinform.contacts.higher.stations import where_short
from kinform.contacts.higher.touch_patches import TouchSamples, touch_patch
from kinform.contacts.search.narrow_phase import Probes, verify
from kinform.contacts.search.pair_view import CLEARANCE_SHARE, NearSurfaces, PairView, SurfacePair
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.surface_table import CONE, CYLINDER, SPHERE
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

_PLANAR = np.array([kind == "plane" for kind in KINDS])
_ROUNDED = np.array([kind in ("sphere", "cylinder", "torus", "cone") for kind in KINDS])
"""Which kinds of surfaces balls and rollers touch, by their numbers."""


@dataclass(frozen=True, eq=False)
class _Touch:
    """A ball or a roller over a plane, or over another round surface; it is the first of `surfaces`."""

    surfaces: SurfacePair
    first: bool
    """The ball or roller is a's."""
    line: bool
    meeting: Meeting
    tube: bool
    """A ball in a bore or a groove not much wider."""

    @property
    def ids(self) -> tuple[int, int]:
        """Surfaces of a and of b."""
        return self.surfaces.ids if self.first else self.surfaces.ids[::-1]

    def normals(self) -> Array:
        """(n, 3) out of a."""
        return -self.meeting.normals if self.first else self.meeting.normals


def higher_pairs(
    pair: PairView, pieces: tuple[frozenset[int], frozenset[int]] = (frozenset(), frozenset())
) -> list[Patch]:
    """Points and lines in which two parts touch, in the frame of the pair.

    `pieces`: surfaces of a and of b that are pieces of other curves, and are left out against each other.
    """
    overlap = pair.overlap(pair.tolerance)
    if all(pieces):
        overlap &= ~np.outer(*(np.isin(side.ids, sorted(ids)) for side, ids in zip(pair.near, pieces, strict=True)))
    return touches_between(pair, overlap)


def may_touch(pair: PairView, flags: Flags) -> bool:
    """Whether any surfaces flagged in `flags` (s, t) may touch in points or lines, by their kinds, axes and places."""
    return any(
        _candidates(view, asked, first).any()
        for view, asked, first in ((pair, flags, True), (pair.swapped, flags.T, False))
    )


def _candidates(view: PairView, flags: Flags, first: bool) -> Flags:
    """(s, t) which of the flagged are balls, rollers or rings of the first part, and planes or round surfaces of the
    second on which they may lie; of two alike, each is met once, by the `first` part of the pair."""
    (ball, other), out = view.near, np.zeros_like(flags)
    rows = np.flatnonzero(_convex(ball))
    if not len(rows):
        return out
    plane, rounded = _PLANAR[other.kinds], _ROUNDED[other.kinds]
    kinds, hollow = ball.kinds.take(rows)[:, None], other.sides < 0
    apart = np.broadcast_to(rounded, (len(rows), len(rounded))).copy()
    if not first:
        apart &= (other.kinds != kinds) | hollow  # what is hollow comes second
    # a roller in a ring not much wider is a shaft in its bore, a ball in such a bowl that of a joint: they mate, or
    # keep apart
    tube = (kinds == other.kinds) & ((kinds == CYLINDER) | (kinds == SPHERE)) & hollow
    play = MATING_REACH * np.maximum(view.play, CLEARANCE_SHARE * other.radii)
    apart &= ~tube | (other.radii - ball.radii.take(rows)[:, None] > play)
    out[rows] = flags[rows] & (plane | apart)
    if out.any():
        out &= ~_off_planes(view)
    return out


def _convex(near: NearSurfaces) -> Flags:
    """(s,) which are balls and rollers."""
    return np.asarray((near.sides > 0) & ((near.radii > 0) | (near.kinds == CONE)))


def tubes_for_facets(pair: PairView, patches: list[Patch]) -> list[Patch]:
    """The patches, where all of them are of facets of convex tubes, which lie on nothing but a facet or two: the points
    and lines in which the tubes touch, if these say all that the facets say."""
    loose = frozenset(patch.surfaces for patch in patches)
    if not loose or not all(patch.one_sided and _of_tube(pair, patch) for patch in patches):
        return patches
    flags = pair.overlap(pair.tolerance)
    for k, side in enumerate(pair.near):
        flags &= np.expand_dims(np.isin(side.ids, [ids[k] for ids in loose]), 1 - k)
    found = [patch for patch in touches_between(pair, flags) if patch.surfaces in loose]
    all_said = loose == {patch.surfaces for patch in found if not patch.one_sided}
    return found if all_said else patches


def _of_tube(pair: PairView, patch: Patch) -> bool:
    """Whether one of its surfaces is a convex torus."""
    surfaces = [part.surfaces.surfaces[k] for part, k in zip(pair.parts, patch.surfaces, strict=True)]
    return any(surface.kind == "torus" and surface.side > 0 for surface in surfaces)


def touches_between(
    pair: PairView, overlap: Flags, wanted: Callable[[Array, Array], Flags] | None = None, *, play: bool = False
) -> list[Patch]:
    """Points and lines in which surfaces flagged in `overlap` (s, t) touch, in the frame of the pair. None where
    `wanted`, of points (n, 3) m and normals (n, 3), flags none, which may say less of some of them than of all. With
    `play` also those that keep apart by no more than the tolerance, on whatever side."""
    touches: list[_Touch] = []
    for view, flags, first in ((pair, overlap, True), (pair.swapped, overlap.T, False)):
        candidates, plane = _candidates(view, flags, first), _PLANAR[view.near[1].kinds]
        for row in np.flatnonzero(candidates.any(axis=1)):
            for column in [*np.flatnonzero(candidates[row] & plane), *np.flatnonzero(candidates[row] & ~plane)]:
                touch = _touch(view, view.surfaces(int(row), int(column)), first, 1.0 if play else CAPTIVE)
                if touch is not None:
                    touches.append(touch)
    touches = touches if play else _held(touches, pair.tolerance)
    if not touches:
        return []
    if wanted is not None:
        points, normals = zip(*((touch.meeting.points, touch.normals()) for touch in touches), strict=True)
        if not wanted(np.concatenate(points), np.concatenate(normals)).any():
            return []
    views = pair.swapped, pair
    touches = [close for touch in touches for close in [_at_wall(views[touch.first], touch)] if close is not None]
    if not touches:
        return []
    verdict = verify(pair, [_probes(touch, pair.tolerance) for touch in touches])
    held = zip(touches, verdict.holds, strict=True)
    return [_patch(pair, touch, holds) for touch, holds in held if holds.any()]


def _off_planes(view: PairView) -> Flags:
    """(s, t) which are rollers of the first part and planes of the second that they clearly do not lie along, or keep
    clear of: most are, and `_touch` asks one by one."""
    roller, flat = view.near
    out = np.zeros((len(roller.ids), len(flat.ids)), dtype=bool)
    rows, columns = roller.of_kind("cylinder"), flat.of_kind("plane")
    if not len(rows) or not len(columns):
        return out
    axes, normals = roller.axes.take(rows, axis=0), flat.axes.take(columns, axis=0)
    sine = np.sum(axes[:, None] * normals, axis=2)
    turns = roller.axis_uncertainty.take(rows)[:, None] + flat.axis_uncertainty.take(columns)
    parallel = np.minimum(view.tolerances.alignment + turns, 0.5 * math.pi)
    arms = roller.points.take(rows, axis=0)[:, None] - flat.points.take(columns, axis=0)
    gaps = np.sum(arms * normals, axis=2) - roller.radii.take(rows)[:, None]
    ends = roller.extents.take(rows, axis=0)[:, :, None] * sine[:, None]
    limit = CAPTIVE * view.tolerance + SOLVED * (np.abs(arms).max(axis=2) + np.abs(ends).max(axis=1))
    clear = (gaps + ends.min(axis=1) > limit) | (gaps + ends.max(axis=1) < -limit)
    out[rows[:, None], columns] = clear | (np.abs(sine) > np.sin(parallel) + SOLVED)
    return out


def parallel_within(surfaces: SurfacePair, tolerances: Tolerances) -> float:
    """rad up to which two surfaces lie along each other: a right angle at most, where nobody knows their axes."""
    return min(tolerances.alignment + sum(surfaces.turns), 0.5 * math.pi)


def _touch(view: PairView, surfaces: SurfacePair, first: bool, share: float) -> _Touch | None:
    """The touch of a convex ball or roller with a plane or another round surface, if they come as close as this share
    of the tolerance."""
    limit = share * view.tolerance
    met = meeting(surfaces, parallel_within(surfaces, view.tolerances), limit)
    if met is None:
        return None
    close = np.abs(met.gaps) <= limit
    if sum(surfaces.shifts) > TOUCH * view.tolerance or not close.any():
        return None
    # a roller on a plane lies along it, however little of it is close
    line = met.line and (surfaces.kinds[1] == "plane" or bool(close.sum() > 1))
    tube = met.clearance is not None and met.clearance <= CAPTIVE * view.tolerance
    return _Touch(surfaces, first, line, met.chosen(close), tube)


def _at_wall(view: PairView, touch: _Touch) -> _Touch | None:
    """The touch of a roller with a plane that is short beside it, looked at where that is; None where they keep apart
    there."""
    if touch.surfaces.kinds != ("cylinder", "plane"):
        return touch
    short = where_short(view, touch.surfaces)
    if short is None:
        return touch
    met = on_plane(touch.surfaces, parallel_within(touch.surfaces, view.tolerances), short)
    assert met is not None
    band = TOUCH * view.tolerance
    if float(np.abs(touch.meeting.gaps).max()) > band:
        band = CAPTIVE * view.tolerance
    close = np.abs(met.gaps) <= band
    return replace(touch, meeting=met.chosen(close)) if close.any() else None


def _held(touches: list[_Touch], tolerance: float) -> list[_Touch]:
    """Those that touch, and those with some play that are held from the other side too."""
    out = []
    for touch in touches:
        captive = touch.tube or any(_opposes(touch, other) for other in touches)
        close = np.abs(touch.meeting.gaps) <= TOUCH * tolerance
        if captive or close.all():
            out.append(touch)
        elif close.any():
            out.append(replace(touch, line=touch.line and close.sum() > 1, meeting=touch.meeting.chosen(close)))
    return out


def _opposes(touch: _Touch, other: _Touch) -> bool:
    """Whether the other surface holds the same ball or pin from the opposite side."""
    same = touch.first == other.first and touch.surfaces.row == other.surfaces.row
    return same and float((touch.meeting.normals @ other.meeting.normals.T).min()) < -STRAIGHT_COSINE


def pins_in_slots(pair: PairView, patches: list[Patch]) -> list[Patch]:
    """Pins that run in slots beside `patches` of faces across them, which leave them free: both sides of the slot hold
    the pin. Other points and lines beside patches are many and say little."""
    axis = patches[0].axis if patches else np.zeros(3)

    def parallel(patch: Patch) -> bool:
        return float(np.linalg.norm(cross(patch.axis, axis))) < PARALLEL_SINE

    if not patches or not all(patch.kind == "plane" and parallel(patch) for patch in patches):
        return []
    lines = [patch for patch in higher_pairs(pair) if patch.kind == "line" and parallel(patch)]
    return [patch for patch in lines if any(_faces(patch, other) for other in lines)]


def _faces(patch: Patch, other: Patch) -> bool:
    """Whether another line holds the same pin from the opposite side."""
    side = 0 if patch.radii[0] > 0.0 else 1
    same = other.radii[side] > 0.0 and patch.surfaces[side] == other.surfaces[side]
    return same and float((patch.normals @ other.normals.T).min()) < -STRAIGHT_COSINE


def _probes(touch: _Touch, tolerance: float) -> Probes:
    """One at each point."""
    met, surfaces = touch.meeting, touch.surfaces if touch.first else touch.surfaces.swapped
    reach = 0.5 * np.abs(met.gaps) + surfaces.slack + PROBE_SPARE * tolerance
    return Probes.of(met.points, touch.normals(), met.gaps, reach, surfaces)


def _patch(pair: PairView, touch: _Touch, holds: Flags) -> Patch:
    """The patch of the points that hold."""
    met, surfaces = touch.meeting, touch.surfaces
    radius, zone = met.radius or surfaces.radii[0], ZONE * pair.tolerance
    area = 2.0 * math.pi * radius * zone
    if touch.line:
        area = 2.0 * math.sqrt(2.0 * radius * zone) * met.spacing
    axis = surfaces.axes[0] if surfaces.kinds[0] == "cylinder" else surfaces.axes[1]
    shift = sum(surfaces.shifts)
    samples = TouchSamples(
        met.points[holds],
        touch.normals()[holds],
        met.gaps[holds],
        area,
        axis=(axis if met.along is None else met.along) if touch.line else None,
        radii=(radius, 0.0) if touch.first else (0.0, radius),
        uncertainty=(max(surfaces.turns), shift),
        chord=surfaces.chord,
        bends=met.bends,
        flat=surfaces.kinds[1] == "plane",
    )
    return touch_patch(pair, touch.ids, samples, shift)
