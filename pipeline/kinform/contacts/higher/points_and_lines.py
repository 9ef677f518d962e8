"""Point and line contacts, where two parts share no surface: a ball or a roller on a plane, on another or in a bore.

Such a higher pair has one row a point, with the normal of the plane. It is looked for only between parts
that have no patch at all: beside a real patch, surfaces that merely pass close to each other are many, and
a tangent fillet says nothing that its plane does not say. Area is that of the zone where the two surfaces
are within 1 % of the contact tolerance of each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinform.contacts.higher.rounds import meeting
from kinform.contacts.mating.mates import box_overlap
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.narrow import Probes, join, verify
from kinform.contacts.search.placed import NearSurfaces, PlacedPart
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

__all__ = ["higher_pairs", "pins_in_slots"]


_TOUCH = 0.12
"""Share of the contact tolerance within which a point or a line touches: the band of full weight."""
_CAPTIVE = 0.42
"""Share within which a pin in a slot, or a ball in a groove, counts as held by both sides: their play."""
_ZONE = 0.01
"""Share of the contact tolerance that bounds the zone whose area is stated."""
_ROUND = [KINDS.index("sphere"), KINDS.index("cylinder"), KINDS.index("torus")]
_ALONG = 17
"""Samples along a line."""


@dataclass(frozen=True, eq=False)
class _Touch:
    """A ball or a roller over a plane, or over another. `points` (n, 3) on the line or at the point; `normals` (n, 3)
    from the other surface towards the ball or the roller."""

    rows: tuple[int, int]
    first: bool
    """The round surface is a's."""
    kind: str
    points: Array
    normals: Array
    gaps: Array
    axis: Array
    radius: float
    spacing: float
    slack: float
    uncertainty: tuple[float, float]
    chord: float
    tube: bool = False
    """A ball in a bore or a groove not much wider."""


def higher_pairs(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    tolerance: float,
    tolerances: Tolerances,
    pieces: tuple[frozenset[int], frozenset[int]] = (frozenset(), frozenset()),
) -> list[Patch]:
    """Points and lines in which two parts touch, in the frame of the pair.

    `pieces`: surfaces of a and of b that are pieces of other curves, and are left out against each other.
    """
    overlap = box_overlap(*near, tolerance)
    overlap &= ~np.outer(*(np.isin(side.ids, sorted(own)) for side, own in zip(near, pieces, strict=True)))
    touches: list[_Touch] = []
    for first, flags in ((True, overlap), (False, overlap.T)):
        round_side, flat_side = near if first else near[::-1]
        convex = np.nonzero((round_side.sides > 0) & (round_side.radii > 0))[0]
        for row in convex:
            for column in np.nonzero(flags[row] & (flat_side.kinds == KINDS.index("plane")))[0]:
                touch = _touch(round_side, flat_side, int(row), int(column), first, tolerance, tolerances)
                if touch is not None:
                    touches.append(touch)
            for column in np.nonzero(flags[row] & np.isin(flat_side.kinds, _ROUND))[0]:
                if not first and round_side.kinds[row] == flat_side.kinds[column]:
                    continue
                touch = _round_touch(round_side, flat_side, int(row), int(column), first, tolerance, tolerances)
                if touch is not None:
                    touches.append(touch)
    touches = _held(touches, tolerance)
    if not touches:
        return []
    probes = [_probes(touch, near, tolerance) for touch in touches]
    verdict = verify(a, b, join(probes), tolerances.opposed, 0.01 * tolerance)
    ends = np.cumsum([len(touch.points) for touch in touches])[:-1]
    return [
        _patch(a, b, near, touch, holds, tolerance)
        for touch, holds in zip(touches, np.split(verdict.holds, ends), strict=True)
        if holds.any()
    ]


def _touch(
    ball: NearSurfaces,
    flat: NearSurfaces,
    row: int,
    column: int,
    first: bool,
    tolerance: float,
    tolerances: Tolerances,
) -> _Touch | None:
    """The touch of one convex sphere or cylinder with one plane, if they come close enough."""
    kind, radius, normal = KINDS[ball.kinds[row]], float(ball.radii[row]), flat.axes[column]
    turns = (float(ball.axis_uncertainty[row]), float(flat.axis_uncertainty[column]))
    along = np.zeros(1)
    if kind == "cylinder":
        tilt = math.asin(min(1.0, abs(float(ball.axes[row] @ normal))))
        if tilt > tolerances.alignment + sum(turns):
            return None
        low, high = ball.extents[row]
        along = low + (high - low) * (np.arange(_ALONG) + 0.5) / _ALONG
    elif kind != "sphere":
        return None
    centres = ball.points[row] + along[:, None] * ball.axes[row]
    gaps = (centres - flat.points[column]) @ normal - radius
    shift = float(ball.point_uncertainty[row] + flat.point_uncertainty[column])
    close = np.abs(gaps) <= _CAPTIVE * tolerance
    if shift > _TOUCH * tolerance or not close.any():
        return None
    return _Touch(
        rows=(row, column) if first else (column, row),
        first=first,
        kind="line" if kind == "cylinder" else "point",
        points=centres[close] - (radius + 0.5 * gaps[close])[:, None] * normal,
        normals=np.tile(normal, (int(close.sum()), 1)),
        gaps=gaps[close],
        axis=ball.axes[row],
        radius=radius,
        spacing=float(along[1] - along[0]) if len(along) > 1 else 0.0,
        slack=float(ball.slacks[row] + flat.slacks[column]),
        uncertainty=(max(turns), shift),
        chord=float(ball.chords[row] + flat.chords[column]),
    )


def _round_touch(
    ball: NearSurfaces,
    other: NearSurfaces,
    row: int,
    column: int,
    first: bool,
    tolerance: float,
    tolerances: Tolerances,
) -> _Touch | None:
    """The touch of a convex sphere or cylinder with another round surface, if they come close enough."""
    turns = (float(ball.axis_uncertainty[row]), float(other.axis_uncertainty[column]))
    found = meeting(ball, other, row, column, tolerances.alignment + sum(turns))
    if found is None:
        return None
    shift = float(ball.point_uncertainty[row] + other.point_uncertainty[column])
    close = np.abs(found.gaps) <= _CAPTIVE * tolerance
    if shift > _TOUCH * tolerance or not close.any():
        return None
    return _Touch(
        rows=(row, column) if first else (column, row),
        first=first,
        kind="line" if found.line and close.sum() > 1 else "point",
        points=found.points[close],
        normals=found.normals[close],
        gaps=found.gaps[close],
        axis=ball.axes[row] if KINDS[ball.kinds[row]] == "cylinder" else other.axes[column],
        radius=float(ball.radii[row]),
        spacing=found.spacing,
        slack=float(ball.slacks[row] + other.slacks[column]),
        uncertainty=(max(turns), shift),
        chord=float(ball.chords[row] + other.chords[column]),
        tube=found.clearance is not None and found.clearance <= _CAPTIVE * tolerance,
    )


def _held(touches: list[_Touch], tolerance: float) -> list[_Touch]:
    """Those that touch, and those with some play that are held from the other side too."""
    out = []
    for touch in touches:
        captive = touch.tube or any(_opposes(touch, other) for other in touches)
        close = np.abs(touch.gaps) <= _TOUCH * tolerance
        if captive or close.all():
            out.append(touch)
        elif close.any():
            kept = {name: getattr(touch, name)[close] for name in ("points", "normals", "gaps")}
            out.append(replace(touch, kind=touch.kind if close.sum() > 1 else "point", **kept))
    return out


def _opposes(touch: _Touch, other: _Touch) -> bool:
    """Whether the other surface holds the same ball or pin from the opposite side."""
    same = touch.first == other.first and touch.rows[not touch.first] == other.rows[not other.first]
    return same and float((touch.normals @ other.normals.T).min()) < -0.999


def pins_in_slots(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    patches: list[Patch],
    tolerance: float,
    tolerances: Tolerances,
) -> list[Patch]:
    """Pins that run in slots beside `patches` of faces across them, which leave them free: both sides of the slot hold
    the pin. Other points and lines beside patches are many and say little."""
    axis = patches[0].axis if patches else np.zeros(3)
    if not all(p.kind == "plane" and float(np.linalg.norm(np.cross(p.axis, axis))) < 1e-3 for p in patches):
        return []
    lines = [p for p in higher_pairs(a, b, near, tolerance, tolerances) if p.kind == "line"] if patches else []
    lines = [p for p in lines if float(np.linalg.norm(np.cross(p.axis, axis))) < 1e-3]
    return [p for p in lines if any(_faces(p, other) for other in lines)]


def _faces(patch: Patch, other: Patch) -> bool:
    side = 0 if patch.radii[0] > 0.0 else 1
    same = other.radii[side] > 0.0 and patch.surfaces[side] == other.surfaces[side]
    return same and float((patch.normals @ other.normals.T).min()) < -0.999


def _normals(touch: _Touch) -> Array:
    """(n, 3) out of a."""
    return -touch.normals if touch.first else touch.normals


def _probes(touch: _Touch, near: tuple[NearSurfaces, NearSurfaces], tolerance: float) -> Probes:
    ids = np.array([side.ids[row] for side, row in zip(near, touch.rows, strict=True)])
    return Probes(
        points=touch.points,
        normals=_normals(touch),
        gaps=touch.gaps,
        reach=0.5 * np.abs(touch.gaps) + touch.slack + 0.05 * tolerance,
        surfaces=np.tile(ids, (len(touch.points), 1)),
    )


def _patch(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    touch: _Touch,
    holds: NDArray[np.bool_],
    tolerance: float,
) -> Patch:
    points, gaps, zone = touch.points[holds], touch.gaps[holds], _ZONE * tolerance
    each = 2.0 * math.pi * touch.radius * zone
    if touch.kind == "line":
        each = 2.0 * math.sqrt(2.0 * touch.radius * zone) * touch.spacing
    ids = [int(side.ids[row]) for side, row in zip(near, touch.rows, strict=True)]
    return Patch(
        parts=(a.part.name, b.part.name),
        surfaces=(ids[0], ids[1]),
        kind=touch.kind,
        one_sided=False,
        points=points,
        normals=_normals(touch)[holds],
        gaps=gaps,
        weights=np.full(len(points), each),
        area=each * len(points),
        gap=float(gaps.mean()),
        axis=touch.axis if touch.kind == "line" else np.zeros(3),
        point=points.mean(axis=0),
        radii=(touch.radius, 0.0) if touch.first else (0.0, touch.radius),
        misalignment=0.0,
        offset=0.0,
        uncertainty=touch.uncertainty,
        chord=touch.chord,
        fit=classify_fit(gaps, touch.chord, touch.uncertainty[1], tolerance),
    )
