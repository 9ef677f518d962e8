"""Contacts between facets that fit no surface on either side: kind "freeform"; and of surfaces that turn or slide
on themselves in one common way: kinds "torus", "revolution" and "extrusion".

Their normals are those of the facets, which is good enough to say that and where two parts touch, and too
coarse to decide what they may do: such a patch carries the angle by which its facets disagree as the
uncertainty of its direction.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kinform.contacts.mating.coaxial import aligned
from kinform.contacts.mating.mates import EDGE, box_centre, mean_axes, mean_direction
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.narrow import Probes, Verdict, join, verify
from kinform.contacts.search.placed import NearSurfaces, PlacedPart
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.surfaces import KINDS
from kinform.model.tolerances import Tolerances

__all__ = ["freeform_patches"]


LOOSE = ("freeform", "torus", "revolution", "extrusion", "helicoid")
"""Kinds whose contacts are found facet by facet."""
_TURNING = ("torus", "revolution")
"""Of these, those that turn on themselves about an axis."""
_PROBES = 400
"""Greatest number of probes from either side of a pair of surfaces."""
_FACING = 0.93
"""Facets rest on each other when their normals oppose within about 20°."""
_STEADY = 0.1
"""Scatter of the gap, in contact tolerances, of profiles that lie along each other."""
_LEAST = 4.0
"""Least area of a patch, in squared tolerances: less is a stray touch of two rounded edges."""


def freeform_patches(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    overlap: Flags,
    tolerance: float,
    tolerances: Tolerances,
) -> list[Patch]:
    """Patches between freeform surfaces flagged in `overlap` (s, t), in the frame of the pair."""
    rows, columns = near[0].of_kind(*LOOSE), near[1].of_kind(*LOOSE)
    found, probes, areas = [], [], []
    for i, j in np.argwhere(overlap[np.ix_(rows, columns)]):
        row, column = int(rows[i]), int(columns[j])
        own, shares = _probes(a, b, near, row, column, tolerance)
        if len(own.points):
            found.append((row, column))
            probes.append(own)
            areas.append(shares)
    if not found:
        return []
    asked = join(probes)
    verdict = verify(a, b, asked, tolerances.opposed, 0.01 * tolerance, _FACING)
    ends = np.cumsum([len(shares) for shares in areas])
    patches = []
    for (row, column), shares, end in zip(found, areas, ends, strict=True):
        here = np.arange(end - len(shares), end)
        here = here[verdict.holds[here] & (np.abs(verdict.along_b - verdict.along_a)[here] <= EDGE * tolerance)]
        weights = shares[here - end + len(shares)]
        if weights.sum() >= _LEAST * tolerance**2:
            patch = _patch(a, b, near, (row, column), asked, verdict, here, weights, tolerance)
            patch = _turning(patch, near, (row, column), tolerance, tolerances)
            patches.append(_drawn(patch, near, (row, column), tolerance, tolerances))
    return patches


def _probes(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    row: int,
    column: int,
    tolerance: float,
) -> tuple[Probes, Array]:
    """Probes at the middles of facets of both surfaces, and half the area (m²) each stands for."""
    middle, size = box_centre(near[0], near[1], row, column)
    low, high = middle - 0.5 * size - EDGE * tolerance, middle + 0.5 * size + EDGE * tolerance
    points, normals, shares = [], [], []
    for part, side, number, sense in ((a, near[0], row, 1.0), (b, near[1], column, -1.0)):
        facets = side.facets[number]
        centres = part.vertices[part.faces[facets]].mean(axis=1)
        within = np.nonzero(((centres >= low) & (centres <= high)).all(axis=1))[0]
        chosen = within[:: max(1, math.ceil(len(within) / _PROBES))]
        areas = part.index.areas(facets[chosen])
        total = float(part.index.areas(facets[within]).sum())
        points.append(centres[chosen])
        normals.append(sense * part.normals(facets[chosen]))
        shares.append(0.5 * areas * total / max(float(areas.sum()), 1e-300))
    count = len(points[0]) + len(points[1])
    ids = np.array([near[0].ids[row], near[1].ids[column]])
    probes = Probes(
        points=np.concatenate(points),
        normals=np.concatenate(normals),
        gaps=np.zeros(count),
        reach=np.full(count, EDGE * tolerance),
        surfaces=np.tile(ids, (count, 1)),
    )
    return probes, np.concatenate(shares)


def _patch(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    rows: tuple[int, int],
    probes: Probes,
    verdict: Verdict,
    here: NDArray[np.int64],
    weights: Array,
    tolerance: float,
) -> Patch:
    gaps = (verdict.along_b - verdict.along_a)[here]
    middle = 0.5 * (verdict.along_a + verdict.along_b)[here]
    points = probes.points[here] + middle[:, None] * probes.normals[here]
    area = float(weights.sum())
    chord = float(near[0].chords[rows[0]] + near[1].chords[rows[1]])
    disagreement = float(weights @ np.arccos(np.clip(-verdict.cosine[here], -1.0, 1.0)) / area)
    return Patch(
        parts=(a.part.name, b.part.name),
        surfaces=(int(near[0].ids[rows[0]]), int(near[1].ids[rows[1]])),
        kind="freeform",
        one_sided=True,
        points=points,
        normals=probes.normals[here],
        gaps=gaps,
        weights=weights,
        area=area,
        gap=float(weights @ gaps / area),
        axis=np.zeros(3),
        point=weights @ points / area,
        radii=(0.0, 0.0),
        misalignment=disagreement,
        offset=0.0,
        uncertainty=(max(disagreement, math.radians(1.0)), chord),
        chord=chord,
        fit=classify_fit(gaps, chord, 0.0, tolerance),
    )


def _turning(
    patch: Patch, near: tuple[NearSurfaces, NearSurfaces], rows: tuple[int, int], tolerance: float,
    tolerances: Tolerances,
) -> Patch:  # fmt: skip
    """The patch as one of two surfaces that turn about one axis, where they do: its normals then leave that turn
    exactly free."""
    kinds = [KINDS[side.kinds[row]] for side, row in zip(near, rows, strict=True)]
    if not set(kinds) <= set(_TURNING):
        return patch
    axes = mean_axes(*near, *rows, patch.point)
    length = float(np.ptp(patch.points @ axes.axis))
    if not aligned(axes, patch.gap, max(length, float(near[0].radii[rows[0]])), tolerance, tolerances):
        return patch
    velocity = np.cross(axes.axis, patch.points - axes.point)
    speed = np.linalg.norm(velocity, axis=1)
    along = velocity / np.maximum(speed, 1e-300)[:, None]
    normals = patch.normals - np.einsum("ij,ij->i", patch.normals, along)[:, None] * along
    return replace(
        patch,
        kind="torus" if kinds == ["torus", "torus"] else "revolution",
        one_sided=False,
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
        axis=axes.axis,
        point=axes.point,
        radii=(float(near[0].radii[rows[0]]), float(near[1].radii[rows[1]])),
        misalignment=axes.misalignment,
        offset=axes.offset,
        uncertainty=axes.uncertainty,
    )


def _encloses(normals: Array, axis: Array) -> bool:
    """Whether normals (n, 3) across the axis point to all sides."""
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    azimuth = np.sort(np.arctan2(normals @ np.cross(axis, u), normals @ u))
    return bool(np.diff(np.append(azimuth, azimuth[0] + 2.0 * np.pi)).max() < 0.95 * np.pi)


def _drawn(
    patch: Patch, near: tuple[NearSurfaces, NearSurfaces], rows: tuple[int, int], tolerance: float,
    tolerances: Tolerances,
) -> Patch:  # fmt: skip
    """The patch as one of two extrusions in one direction, where they are that: a spline in its hub, a dovetail of
    curved profile. Its normals then leave the slide along it exactly free."""
    if any(KINDS[side.kinds[row]] != "extrusion" for side, row in zip(near, rows, strict=True)):
        return patch
    own, other = (side.axes[row] for side, row in zip(near, rows, strict=True))
    spread = tuple(float(side.axis_uncertainty[row]) for side, row in zip(near, rows, strict=True))
    axis, angle, uncertainty = mean_direction(own, other if own @ other > 0.0 else -other, (spread[0], spread[1]))
    if max(spread) > tolerances.alignment or angle > tolerances.alignment + 2.0 * uncertainty:
        return patch
    scatter = math.sqrt(float(patch.weights @ (patch.gaps - patch.gap) ** 2) / patch.area)
    if scatter > max(_STEADY * tolerance, 0.3 * patch.chord) and not _encloses(patch.normals, axis):
        # two cams: they curve away from each other, and touch along a line
        return patch
    normals = patch.normals - (patch.normals @ axis)[:, None] * axis
    return replace(
        patch,
        kind="extrusion",
        one_sided=False,
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
        axis=axis,
        misalignment=angle,
        uncertainty=(uncertainty, patch.chord),
    )
