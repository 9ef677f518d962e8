"""Where two sets of facets lie over each other on one analytic surface, as points with areas.

Both sets are drawn in the surface's chart, intersected as polygons (manifold3d's cross-sections), and
the result is cut into triangles, which `cells` gathers into bins of a grid. The rim of the patch, which
bounds the cone of separating motions, stays as points of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from manifold3d import CrossSection, FillRule, triangulate

from kinform.contacts.constants import RIM_POINTS
from kinform.contacts.mating.cells import Cells, Cut, gathered, signed_areas
from kinform.contacts.mating.charts import Chart
from kinform.contacts.mating.regions import regions
from kinform.foundation.algebra.vectors import lengths
from kinform.foundation.concatenation import concatenated
from kinform.foundation.meshes.boxes import triangle_boxes
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array

GRID = 1e-6
"""Step, in contact tolerances, of the coordinates of outlines: a ten-thousandth of what is thin, and a million times
what doubles of parts of a metre are rounded by."""
REGION_THIN = 0.01
"""Width, in contact tolerances, below which a region is a line, not a patch. Chosen, not measured."""


def _perimeter(polygons: list[Array]) -> float:
    """m of all outlines."""
    edges = [np.concatenate([p[:1] - p[-1:], p[1:] - p[:-1]]) for p in polygons]
    return float(sum(lengths(along).sum() for along in edges))


def _resampled(polygon: Array, step: Array) -> Array:
    """The polygon (n, 2) with points added so that no edge is longer than `step` (2,) in any coordinate."""
    ends = np.concatenate([polygon[1:], polygon[:1]])
    if step[0] == step[1] == math.inf:
        return np.asarray(polygon + 0.0 * (ends - polygon))
    counts = np.maximum(np.ceil((np.abs(ends - polygon) / step).max(axis=1) - SOLVED), 1).astype(np.int64)
    rows = np.repeat(np.arange(len(polygon)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(len(rows)) - first) / counts[rows]
    return np.asarray(polygon[rows] + share[:, None] * (ends[rows] - polygon[rows]))


def _overlaps(asked: Sequence[tuple[Chart, Array, Array, float, float]]) -> list[CrossSection | None]:
    """The region of each, in units of its tolerance, that both sets of facets cover."""
    flats = [(chart.flatten(first), chart.flatten(second)) for chart, first, second, *_ in asked]
    some = [k for k, (one, two) in enumerate(flats) if len(one) and len(two)]
    out: list[CrossSection | None] = [None] * len(asked)
    if not some:
        return out
    sets = [flat for k in some for flat in flats[k]]
    counts = [len(flat) for flat in sets]
    flat, starts = concatenated(sets), np.cumsum([0, *counts[:-1]])
    # rounded far below what is thin, so that the last digits do not decide how outlines are cut into triangles
    grid = np.repeat([GRID * asked[k][3] for k in some for _ in (0, 1)], counts)[:, None, None]
    flat = np.rint(flat / grid) * grid
    low, high = triangle_boxes(flat)
    least, most = np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)
    least, most = np.maximum(least[0::2], least[1::2]), np.minimum(most[0::2], most[1::2])
    meets = (least < most).all(axis=1)
    of_set = np.repeat(np.arange(len(sets)), counts)
    pair = of_set // 2
    within = meets.take(pair)
    within &= (low <= most.take(pair, axis=0)).all(axis=1)
    within &= (high >= least.take(pair, axis=0)).all(axis=1)
    if not within.all():
        flat, of_set = flat[within], of_set[within]
    left = np.searchsorted(of_set, np.arange(len(sets) + 1)).tolist()
    kept = [k for k in range(len(some)) if left[2 * k] < left[2 * k + 1] < left[2 * k + 2]]
    both = [(flat[left[k] : left[k + 1]], asked[some[k // 2]][3]) for n in kept for k in (2 * n, 2 * n + 1)]
    found = regions([own for own, _ in both], [unit for _, unit in both])
    for n, k in enumerate(kept):
        chart, _, _, unit, _ = asked[some[k]]
        region, window = found[2 * n] ^ found[2 * n + 1], chart.window()
        out[some[k]] = region if window is None else region ^ CrossSection([window / unit], FillRule.Positive)
    return out


def _pieces(region: CrossSection, thin: float) -> list[list[Array]]:
    """The connected pieces of a region that are neither points nor narrower than `thin`, as polygons."""
    pieces = []
    for piece in region.decompose():
        # corners that are off by a tenth of a thin region are left out
        polygons = [np.asarray(p) for p in piece.simplify(REGION_THIN * 0.1).to_polygons()]
        area = piece.area()
        # Area, in squared contact tolerances, below which a region is a point, not a patch. Chosen, not measured.
        if polygons and area >= 0.02 and 2.0 * area >= thin * _perimeter(polygons):
            pieces.append(polygons)
    return pieces


def _rim(polygons: list[Array], flat: bool) -> Array:
    """Points that bound the region: of a plane the corners of its hull, else all corners; thinned evenly."""
    corners = np.concatenate(polygons)
    if flat:
        corners = np.concatenate([np.asarray(p) for p in CrossSection.hull_points(corners).to_polygons()])
    every = math.ceil(len(corners) / RIM_POINTS)
    return np.asarray(corners[::every])


def overlays(asked: Sequence[tuple[Chart, Array, Array, float, float]]) -> list[Cells | None]:
    """Overlaps of facets (n, 3, 3) and (m, 3, 3) in charts, each of (chart, first, second, tolerance, thin); None of
    those where there is none.

    The tolerance (m) sets what is too thin or too small to be a patch, `thin` (m) what is thin in any case: pieces that
    are narrower than this are left out beside others, and are `narrow` where there are no others.
    """
    cuts = [
        None if region is None else _cut(region, chart, tolerance, thin)
        for region, (chart, _, _, tolerance, thin) in zip(_overlaps(asked), asked, strict=True)
    ]
    cells = iter(gathered([cut for cut in cuts if cut is not None]))
    return [None if cut is None else next(cells) for cut in cuts]


def _cut(region: CrossSection, chart: Chart, tolerance: float, thin: float) -> Cut | None:
    """One of them, whose region is in units of the tolerance, not yet gathered."""
    wide = max(REGION_THIN, thin / tolerance)
    pieces = _pieces(region, wide)
    narrow = not pieces and wide > REGION_THIN
    if narrow:
        pieces = _pieces(region, REGION_THIN)
    if not pieces:
        return None
    step = np.array(chart.step) / tolerance
    flat = bool(np.isinf(step).all())
    triangles = []
    for number, polygons in enumerate(pieces):
        pieces[number] = [_resampled(polygon, step) for polygon in polygons]
        triangles.append(np.concatenate(pieces[number])[triangulate(pieces[number])])
    corners = np.concatenate(triangles)
    area = float(np.abs(signed_areas(corners)).sum())
    # Fewest bins of a patch, so that a blocked part of it can be told. Chosen, not measured.
    size = np.minimum(step, math.sqrt(area / 24))
    rim = _rim([polygon for polygons in pieces for polygon in polygons], flat)
    return Cut(corners, size, rim, tolerance, narrow)
