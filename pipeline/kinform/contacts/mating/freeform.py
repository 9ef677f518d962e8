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

from kinform.contacts.constants import FACING_OPPOSED, MATING_REACH, PATCH_AREA, SAMPLES
from kinform.contacts.mating.constants import FREEFORM_ANGLE
from kinform.contacts.mating.mate import aligned, mean_axes, mean_direction
from kinform.contacts.mating.patches import GAP_SCATTER, SCATTER_CHORDS, classify_fit
from kinform.contacts.search.narrow_phase import Probes, verify
from kinform.contacts.search.pair_view import PairView, SurfacePair
from kinform.foundation.algebra.vectors import cross, dot, widest_gap
from kinform.foundation.constants import SLIVER_WIDTH
from kinform.foundation.meshes.box_pairs import meeting_boxes
from kinform.foundation.meshes.boxes import meeting_box, middles, triangle_boxes
from kinform.foundation.rounding import SINGLE, TINY
from kinform.foundation.sorting import among, distinct
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.surfaces import SurfaceKind

FREEFORM_KINDS: tuple[SurfaceKind, ...] = ("freeform", "torus", "revolution", "extrusion", "helicoid")
"""Kinds whose contacts are found facet by facet."""
TURNING_KINDS = ("torus", "revolution")
"""Of these, those that turn on themselves about an axis."""


def freeform_patches(pair: PairView, overlap: Flags) -> list[Patch]:
    """Patches between freeform surfaces flagged in `overlap` (s, t), in the frame of the pair."""
    rows, columns, flags = pair.of_kinds(overlap, *FREEFORM_KINDS)
    probed = []
    for i, j, facing in _may_face(pair, rows, columns, flags):
        surfaces = pair.surfaces(rows[i], columns[j])
        probes, shares = _probes(pair, surfaces, facing)
        if len(probes.points):
            probed.append((surfaces, probes, shares))
    if not probed:
        return []
    verdict = verify(pair, [probes for _, probes, _ in probed], -FACING_OPPOSED)
    patches = []
    for (surfaces, probes, shares), holds, along_a, along_b, cosine in zip(
        probed, verdict.holds, verdict.along_a, verdict.along_b, verdict.cosine, strict=True
    ):
        here = np.flatnonzero(holds & (np.abs(along_b - along_a) <= MATING_REACH * pair.tolerance))
        weights = shares[here]
        if weights.sum() >= PATCH_AREA * pair.tolerance**2:
            gaps, middle = (along_b - along_a)[here], 0.5 * (along_a + along_b)[here]
            points = probes.points[here] + middle[:, None] * probes.normals[here]
            disagreement = float(weights @ np.arccos(np.clip(-cosine[here], -1.0, 1.0)) / float(weights.sum()))
            patch = _patch(pair, surfaces, points, probes.normals[here], gaps, weights, disagreement)
            patch = _turning(patch, pair, surfaces)
            patches.append(_sliding(patch, pair, surfaces))
    return patches


_Facing = tuple[Ints, Ints] | None
"""Facets of a and of b whose probes may hold; None: all."""


def _may_face(pair: PairView, rows: Ints, columns: Ints, flags: Flags) -> list[tuple[int, int, _Facing]]:
    """Those of near surfaces at `rows` (s,) of a and `columns` (t,) of b, flagged in `flags` (s, t), of which any facet
    has one of the other in the box of its probe, that it faces, with such facets: no other probe meets anything."""
    if not flags.any():
        return []
    reach = MATING_REACH * pair.tolerance
    facets, owners, slivers, boxes, normals = [], [], [], [], []
    some = flags.any(axis=1), flags.any(axis=0)
    for part, near, chosen, flagged in zip(pair.parts, pair.near, (rows, columns), some, strict=True):
        own = np.flatnonzero(flagged)
        of_each = [near.facets[k] for k in chosen[own].tolist()]
        every = np.concatenate(of_each)
        corners = part.vertices.take(part.faces.take(every, axis=0), axis=0)
        centres, outward = middles(corners), part.normals(every)
        half = reach * (np.abs(outward) + 2.0 * SLIVER_WIDTH)
        facets.append(every)
        owners.append(np.repeat(own, [len(each) for each in of_each]))
        normals.append(outward)
        slivers.append((centres - half, centres + half))
        boxes.append(triangle_boxes(corners))
    keys, able = [], []
    for side, met in enumerate((meeting_boxes(slivers[0], boxes[1]), meeting_boxes(boxes[0], slivers[1]))):
        if met is None:
            return [(int(i), int(j), None) for i, j in np.argwhere(flags)]
        one, two = met
        opposed = dot(normals[0].take(one, axis=0), normals[1].take(two, axis=0))
        kept = (opposed < SINGLE + FACING_OPPOSED) & flags[owners[0][one], owners[1][two]]
        keys.append((owners[0][one] * flags.shape[1] + owners[1][two])[kept])
        able.append(facets[side].take(met[side][kept]))
    out: list[tuple[int, int, _Facing]] = []
    for key in distinct(np.concatenate(keys)).tolist():
        first, second = (distinct(of_side[own == key]) for own, of_side in zip(keys, able, strict=True))
        out.append((*divmod(key, flags.shape[1]), (first, second)))
    return out


def _probes(pair: PairView, surfaces: SurfacePair, facing: _Facing) -> tuple[Probes, Array]:
    """Probes at the middles of facets of both surfaces, and half the area (m²) each stands for, but those whose facets
    are not `facing`."""
    reach = MATING_REACH * pair.tolerance
    middle, size = surfaces.box()
    low, high = middle - 0.5 * size - reach, middle + 0.5 * size + reach
    points, normals, shares = [], [], []
    for k, (part, facets, sense) in enumerate(zip(pair.parts, surfaces.facets, (1.0, -1.0), strict=True)):
        if facing is not None and not len(facing[k]):
            continue
        centres = middles(part.vertices.take(part.faces[facets], axis=0))
        inside = meeting_box(centres, centres, low, high)
        # facets without area have no normal
        within = np.nonzero(inside & (part.index.areas(facets) > 0.0))[0]
        chosen = within[:: max(1, math.ceil(len(within) / SAMPLES))]
        areas = part.index.areas(facets[chosen])
        total = float(part.index.areas(facets[within]).sum())
        able = slice(None) if facing is None else np.flatnonzero(among(facets[chosen], facing[k]))
        points.append(centres[chosen][able])
        normals.append(sense * part.normals(facets[chosen])[able])
        shares.append((0.5 * areas * total / max(float(areas.sum()), TINY))[able])
    place = np.concatenate(points)
    gaps, reaches = np.zeros(len(place)), np.full(len(place), reach)
    return Probes.of(place, np.concatenate(normals), gaps, reaches, surfaces), np.concatenate(shares)


def _patch(
    pair: PairView,
    surfaces: SurfacePair,
    points: Array,
    normals: Array,
    gaps: Array,
    weights: Array,
    disagreement: float,
) -> Patch:
    """The patch of these samples, whose facets disagree by that angle (rad)."""
    area = float(weights.sum())
    return Patch(
        parts=pair.names,
        surfaces=surfaces.ids,
        kind="freeform",
        one_sided=True,
        points=points,
        normals=normals,
        gaps=gaps,
        weights=weights,
        area=area,
        gap=float(weights @ gaps / area),
        axis=np.zeros(3),
        point=weights @ points / area,
        radii=(0.0, 0.0),
        misalignment=disagreement,
        offset=0.0,
        uncertainty=(max(disagreement, FREEFORM_ANGLE), surfaces.chord),
        chord=surfaces.chord,
        fit=classify_fit(gaps, surfaces.chord, 0.0, pair.tolerance),
    )


def _turning(patch: Patch, pair: PairView, surfaces: SurfacePair) -> Patch:
    """The patch as one of two surfaces that turn about one axis, where they do: its normals then leave that turn
    exactly free."""
    if not set(surfaces.kinds) <= set(TURNING_KINDS):
        return patch
    axes = mean_axes(surfaces, patch.point)
    length = float(np.ptp(patch.points @ axes.axis))
    if not aligned(pair, axes, patch.gap, max(length, surfaces.radii[0])):
        return patch
    velocity = cross(axes.axis, patch.points - axes.point)
    speed = np.linalg.norm(velocity, axis=1)
    along = velocity / np.maximum(speed, TINY)[:, None]
    normals = patch.normals - dot(patch.normals, along)[:, None] * along
    return replace(
        patch,
        kind="torus" if surfaces.kinds == ("torus", "torus") else "revolution",
        one_sided=False,
        normals=normals / np.linalg.norm(normals, axis=1)[:, None],
        axis=axes.axis,
        point=axes.point,
        radii=surfaces.radii,
        misalignment=axes.misalignment,
        offset=axes.offset,
        uncertainty=axes.uncertainty,
        mismatch=axes.mismatch,
    )


def _sliding(patch: Patch, pair: PairView, surfaces: SurfacePair) -> Patch:
    """The patch as one of two extrusions in one direction, where they are that: a spline in its hub, a dovetail of
    curved profile. Its normals then leave the slide along it exactly free."""
    if surfaces.kinds != ("extrusion", "extrusion"):
        return patch
    (first, second), spread, alignment = surfaces.axes, surfaces.turns, pair.tolerances.alignment
    axis, angle, uncertainty = mean_direction(first, second if first @ second > 0.0 else -second, spread)
    if max(spread) > alignment or angle > alignment + 2.0 * uncertainty:
        return patch
    scatter = math.sqrt(float(patch.weights @ (patch.gaps - patch.gap) ** 2) / patch.area)
    # normals about an axis with no gap of half a turn point to all sides
    encloses = widest_gap(patch.normals, axis) < (0.95 * math.pi)
    if scatter > max(GAP_SCATTER * pair.tolerance, SCATTER_CHORDS * patch.chord) and not encloses:
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
