"""From mates to patches: overlap in the chart, probes against both meshes, and the fit."""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.mating.mates import Mate
from kinform.contacts.mating.overlay import Cells, overlay
from kinform.contacts.search.narrow import Probes, join, verify
from kinform.contacts.search.placed import NearSurfaces, PlacedPart
from kinform.model.arrays import Array, freeze
from kinform.model.contacts import Patch
from kinform.model.names import PartName
from kinform.model.tolerances import Tolerances

__all__ = ["classify_fit", "mated_patches", "placed_in_world"]


_EXACT = 1e-3
"""Share of the contact tolerance below which a gap is none."""
_EVEN = 0.1
"""Scatter of the measured gap, in contact tolerances, of a face that rests on a plane."""
_LEAST = 4.0
"""Least area of a one-sided patch, in squared tolerances."""


def mated_patches(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    mates: list[Mate],
    tolerance: float,
    tolerances: Tolerances,
) -> list[Patch]:
    """The patches of those mates that really touch, in the frame of the pair."""
    laid, probes = [], []
    for mate in mates:
        cells = _cells(a, b, near, mate, tolerance)
        if cells is not None:
            laid.append((mate, cells))
            probes.append(_probes(mate, cells, near, tolerance))
    if not laid:
        return []
    verdict = verify(a, b, join(probes), tolerances.opposed, 0.01 * tolerance)
    measured = verdict.along_b - verdict.along_a
    ends = np.cumsum([len(p.points) for p in probes])[:-1]
    patches = []
    for (mate, cells), holds, gaps in zip(laid, np.split(verdict.holds, ends), np.split(measured, ends), strict=True):
        if mate.corners is not None:
            holds = holds & (np.abs(gaps) <= mate.limit)
        if not holds.any():
            continue
        ids = (int(near[0].ids[mate.rows[0]]), int(near[1].ids[mate.rows[1]]))
        kept = cells.kept(holds[cells.bins])
        if mate.corners is None:
            patches.append(_patch(a, b, ids, mate, kept, None, tolerance))
        elif _rests(mate, kept, gaps[holds], tolerance):
            patches.append(_patch(a, b, ids, mate, kept, gaps[holds], tolerance))
    return patches


def _rests(mate: Mate, cells: Cells, gaps: Array, tolerance: float) -> bool:
    """Whether measured gaps, one a bin, are those of a face that rests on another.

    Facets that curve away from a plane touch it at a point or along a line, whatever area is within the
    tolerance. On curved surfaces, gaps also scatter by the tessellation.
    """
    shares = np.bincount(cells.bins, weights=cells.areas)
    area = float(shares.sum())
    mean = float(shares @ gaps) / area
    scatter = math.sqrt(float(shares @ (gaps - mean) ** 2) / area)
    allowed = _EVEN * tolerance
    if mate.kind not in ("plane", "other"):
        allowed = max(allowed, 0.3 * mate.chord)
    return area >= _LEAST * tolerance**2 and (mate.kind == "other" or scatter <= allowed)


def _cells(
    a: PlacedPart, b: PlacedPart, near: tuple[NearSurfaces, NearSurfaces], mate: Mate, tolerance: float
) -> Cells | None:
    """Overlap of the mate's two surfaces where their gap is within its limit."""
    first, second = mate.corners or (
        part.vertices[part.faces[side.facets[row]]] for part, side, row in zip((a, b), near, mate.rows, strict=True)
    )
    cells = overlay(mate.chart, first, second, tolerance, mate.thin)
    if cells is None:
        return None
    within = np.abs(mate.gaps(mate.chart.lift(cells.centroids))) <= mate.limit
    return cells.kept(within) if within.any() else None


def _probes(mate: Mate, cells: Cells, near: tuple[NearSurfaces, NearSurfaces], tolerance: float) -> Probes:
    points = mate.chart.lift(cells.probes())
    gaps = mate.gaps(points)
    ids = np.array([side.ids[row] for side, row in zip(near, mate.rows, strict=True)])
    return Probes(
        points=points,
        normals=mate.sign * mate.chart.normals(points),
        gaps=gaps,
        reach=0.5 * np.abs(gaps) + mate.slack + 0.05 * tolerance,
        surfaces=np.tile(ids, (len(points), 1)),
    )


def classify_fit(gaps: Array, chord: float, uncertainty: float, tolerance: float) -> str:
    """Fit of a patch by its signed gaps (n,) m.

    Beyond chord errors and uncertainty: clearance, or interference. No gap at all, as far as the surfaces
    are known: touch. Everything between, and patches with both: transition.
    """
    exact = uncertainty + _EXACT * tolerance
    low, high = float(gaps.min()), float(gaps.max())
    if low >= -exact and high <= exact:
        return "touch"
    if low > chord + exact:
        return "clearance"
    if high < -(chord + exact):
        return "interference"
    return "transition"


def _patch(
    a: PlacedPart,
    b: PlacedPart,
    ids: tuple[int, int],
    mate: Mate,
    cells: Cells,
    measured: Array | None,
    tolerance: float,
) -> Patch:
    """A patch from the cells that hold; `measured` gaps of the bins where the mate does not know them."""
    flat, weights = cells.quadrature()
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
    return Patch(
        parts=(a.part.name, b.part.name),
        surfaces=ids,
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
        chord=mate.chord,
        fit=classify_fit(gaps, mate.chord, mate.uncertainty[1], tolerance),
    )


def placed_in_world(patch: Patch, X_WF: Array) -> Patch:
    """The same patch in the world, with read-only arrays; `X_WF` (4, 4) is the frame of the pair."""
    R_WF, p_WF = X_WF[:3, :3], X_WF[:3, 3]

    def fixed(array: Array) -> Array:
        return np.asarray(freeze(np.ascontiguousarray(array, dtype=np.float64)))

    names: tuple[PartName, PartName] = patch.parts
    return Patch(
        parts=names,
        surfaces=patch.surfaces,
        kind=patch.kind,
        one_sided=patch.one_sided,
        points=fixed(patch.points @ R_WF.T + p_WF),
        normals=fixed(patch.normals @ R_WF.T),
        gaps=fixed(patch.gaps),
        weights=fixed(patch.weights),
        area=patch.area,
        gap=patch.gap,
        axis=fixed(R_WF @ patch.axis),
        point=fixed(R_WF @ patch.point + p_WF),
        radii=patch.radii,
        misalignment=patch.misalignment,
        offset=patch.offset,
        uncertainty=patch.uncertainty,
        chord=patch.chord,
        fit=patch.fit,
        pitch=patch.pitch,
    )
