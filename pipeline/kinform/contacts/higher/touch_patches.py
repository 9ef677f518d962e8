"""Patches of points and lines, which have no area: stated is that of the zone where the two surfaces are within a small
share of the contact tolerance of each other."""

from __future__ import annotations

import numpy as np

from kinform.contacts.higher.constants import STRAIGHT_COSINE
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.search.pair_view import PairView
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.contacts import Patch


@dataclass(frozen=True, eq=False)
class TouchSamples:
    """Samples of a point or a line in which two parts touch."""

    points: Array
    """(n, 3) m."""
    normals: Array
    """(n, 3) out of a."""
    gaps: Array
    """(n,) m."""
    area: float
    """m² that each stands for."""
    axis: Array | None
    """(3,) along a line; None: a point."""
    radii: tuple[float, float]
    """m, of a and b."""
    uncertainty: tuple[float, float]
    """rad, of the normal; m, of the place."""
    chord: float
    bends: bool = False
    """Whether the surfaces bend into each other along the line, and hold more than it says."""
    flat: bool = False
    """Whether one of them is a plane."""


def touch_patch(pair: PairView, surfaces: tuple[int, int], touch: TouchSamples, exact: float) -> Patch:
    """The patch of a surface of a and one of b that touch so; `exact` (m) is how well the gap is known."""
    points, gaps = touch.points, touch.gaps
    straight = bool((touch.normals @ touch.normals[0] > STRAIGHT_COSINE).all())
    return Patch(
        parts=pair.names,
        surfaces=surfaces,
        kind="point" if touch.axis is None else "line",
        one_sided=touch.bends and not straight,
        points=points,
        normals=touch.normals,
        gaps=gaps,
        weights=np.full(len(points), touch.area),
        area=touch.area * len(points),
        gap=float(gaps.mean()),
        axis=np.zeros(3) if touch.axis is None else touch.axis,
        point=points.mean(axis=0),
        radii=touch.radii,
        misalignment=0.0,
        offset=0.0,
        uncertainty=touch.uncertainty,
        chord=touch.chord,
        fit=classify_fit(gaps, touch.chord, exact, pair.tolerance),
        flat=touch.flat,
        bends=touch.bends,
    )
