"""From mates to patches: overlap in the chart, probes against both meshes, and the fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import EXACT_GAP, MATING_REACH, PATCH_AREA, PROBE_SPARE
from kinform.contacts.mating.cells import Cells, probed, quadratures
from kinform.contacts.mating.mate import Mate
from kinform.contacts.mating.overlay import overlays
from kinform.contacts.search.narrow_phase import Probes, verify_all
from kinform.contacts.search.pair_view import PairView
from kinform.model.arrays import Array, freeze
from kinform.model.contacts import Fit, Patch

GAP_SCATTER = 0.1
"""Scatter, in contact tolerances, of the measured gap of a face that rests on a plane, and of profiles that lie along
each other. Chosen, not measured."""
SCATTER_CHORDS = 0.3
"""The same on curved surfaces, as a share of the chordal deviation, where that is more. Chosen, not measured."""


def mated_patches(pair: PairView, mates: list[Mate]) -> list[Patch]:
    """The patches of those mates that really touch, in the frame of the pair."""
    return mated_patches_of([(pair, mates)])[0]


def mated_patches_of(asked: Sequence[tuple[PairView, list[Mate]]]) -> list[list[Patch]]:
    """The same of several pairs at once: what comes of one does not depend on the others."""
    every = [(k, mate) for k, (_, mates) in enumerate(asked) for mate in mates]
    cells = _cells([(asked[k][0], mate) for k, mate in every])
    laid = [(k, mate, own) for (k, mate), own in zip(every, cells, strict=True) if own is not None]
    out: list[list[Patch]] = [[] for _ in asked]
    if not laid:
        return out
    probes: dict[int, list[Probes]] = {}
    for (k, mate, _), flat in zip(laid, probed([own for *_, own in laid]), strict=True):
        probes.setdefault(k, []).append(_probes(mate, flat, asked[k][0].tolerance))
    verdicts = verify_all([(asked[k][0], sets) for k, sets in probes.items()])
    told = [pair for verdict in verdicts for pair in zip(verdict.holds, verdict.gaps, strict=True)]
    touching = []
    for (k, mate, own), (holds, gaps) in zip(laid, told, strict=True):
        if mate.corners is not None:
            holds = holds & (np.abs(gaps) <= mate.limit)
        if not holds.any():
            continue
        kept, there = (own, gaps) if holds.all() else (own.kept(holds[own.bins]), gaps[holds])
        if mate.corners is None or _rests(mate, kept, there, asked[k][0].tolerance):
            touching.append((k, mate, kept, there))
    if touching:
        weighed = quadratures([kept for *_, kept, _ in touching])
        for (k, mate, kept, gaps), (flat, weights) in zip(touching, weighed, strict=True):
            measured = None if mate.corners is None else gaps
            out[k].append(_patch(asked[k][0], mate, kept.narrow, measured, flat, weights))
    return out


def _rests(mate: Mate, cells: Cells, gaps: Array, tolerance: float) -> bool:
    """Whether measured gaps, one a bin, are those of a face that rests on another.

    Facets that curve away from a plane touch it at a point or along a line, whatever area is within the
    tolerance. On curved surfaces, gaps also scatter by the tessellation.
    """
    shares = np.bincount(cells.bins, weights=cells.areas)
    area = float(shares.sum())
    mean = float(shares @ gaps) / area
    scatter = math.sqrt(float(shares @ (gaps - mean) ** 2) / area)
    allowed = GAP_SCATTER * tolerance
    if mate.kind not in ("plane", "other"):
        allowed = max(allowed, SCATTER_CHORDS * mate.surfaces.chord)
    return area >= PATCH_AREA * tolerance**2 and (mate.kind == "other" or scatter <= allowed)


def _cells(mates: Sequence[tuple[PairView, Mate]]) -> list[Cells | None]:
    """Overlap of the two surfaces of each mate of a pair where their gap is within its limit."""
    asked = []
    for pair, mate in mates:
        first, second = mate.corners or (
            part.vertices.take(part.faces.take(facets, axis=0), axis=0)
            for part, facets in zip(pair.parts, mate.surfaces.facets, strict=True)
        )
        asked.append((mate.chart, first, second, pair.tolerance, mate.thin))
    every = overlays(asked)
    return [cells and _within(mate, cells) for (_, mate), cells in zip(mates, every, strict=True)]


def _within(mate: Mate, cells: Cells) -> Cells | None:
    """What of the cells is where the gap is within the limit."""
    if not mate.slopes:
        return cells if abs(mate.gap) <= mate.limit else None
    within = np.abs(mate.gaps(mate.chart.lift(cells.centroids))) <= mate.limit
    if within.all():
        return cells
    return cells.kept(within) if within.any() else None


def _probes(mate: Mate, flat: Array, tolerance: float) -> Probes:
    """At points (n, 2) of the chart, on the surface half-way between the two."""
    points = mate.chart.lift(flat)
    gaps = mate.gaps(points)
    reach = 0.5 * np.abs(gaps) + mate.slack + PROBE_SPARE * tolerance
    return Probes.of(points, mate.sign * mate.chart.normals(points), gaps, reach, mate.surfaces)


def classify_fit(gaps: Array, chord: float, uncertainty: float, tolerance: float) -> Fit:
    """Fit of a patch by its signed gaps (n,) m.

    Beyond chord errors and uncertainty: clearance, or interference. No gap at all, as far as the surfaces
    are known: touch. Everything between, and patches with both: transition.
    """
    exact = uncertainty + EXACT_GAP * tolerance
    low, high = float(gaps.min()), float(gaps.max())
    if low >= -exact and high <= exact:
        return "touch"
    if low > chord + exact:
        return "clearance"
    if high < -(chord + exact):
        return "interference"
    return "transition"


def _patch(pair: PairView, mate: Mate, narrow: bool, measured: Array | None, flat: Array, weights: Array) -> Patch:
    """A patch of points (n, 2) in the mate's chart and the areas (n,) that they stand for; `measured` gaps of the bins,
    the first of them, where the mate does not know them."""
    points = mate.chart.lift(flat)
    gaps = mate.gaps(points)
    if measured is not None:
        # A point of the rim takes the gap of the nearest bin.
        bins = flat[: len(measured)]
        gaps = measured[np.argmin(np.linalg.norm(flat[:, None] - bins[None], axis=2), axis=1)]
    area = float(weights.sum())
    middle = weights @ points / area
    if mate.kind in ("plane", "other"):
        point = middle
    elif mate.kind == "sphere":
        point = mate.point
    else:
        point = mate.point + ((middle - mate.point) @ mate.axis) * mate.axis
    chord = mate.surfaces.chord
    return Patch(
        parts=pair.names,
        surfaces=mate.surfaces.ids,
        kind=mate.kind,
        one_sided=measured is not None,
        points=points,
        normals=mate.sign * mate.chart.normals(points),
        gaps=gaps,
        weights=weights,
        area=area,
        gap=float(weights @ gaps / area),
        axis=mate.axis,
        point=point,
        radii=mate.radii,
        misalignment=mate.misalignment,
        offset=mate.offset,
        uncertainty=mate.uncertainty,
        mismatch=mate.mismatch,
        chord=chord,
        fit=classify_fit(gaps, chord, mate.uncertainty[1], pair.tolerance),
        tolerance=mate.limit / MATING_REACH,
        narrow=narrow,
    )


def in_world(patch: Patch, X_WF: Array) -> Patch:
    """The same patch in the world, with read-only arrays; `X_WF` (4, 4) is the frame of the pair."""
    R_WF, p_WF = X_WF[:3, :3], X_WF[:3, 3]

    def fixed(array: Array) -> Array:
        return np.asarray(freeze(np.ascontiguousarray(array, dtype=np.float64)))

    return replace(
        patch,
        points=fixed(patch.points @ R_WF.T + p_WF),
        normals=fixed(patch.normals @ R_WF.T),
        gaps=fixed(patch.gaps),
        weights=fixed(patch.weights),
        axis=fixed(R_WF @ patch.axis),
        point=fixed(R_WF @ patch.point + p_WF),
    )
