"""Places along a roller at which it may lie on a plane: evenly over all of it, or, where the plane is short, there.

A pin that is long beside the wall that holds it would else be looked at beside the wall alone.
"""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import TOUCH
from kinform.contacts.higher.constants import ROLLER_SAMPLES
from kinform.contacts.search.pair_view import PairView, SurfacePair
from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array


def evenly(low: float, high: float) -> Array:
    """(n,) m: middles of equal shares of an extent."""
    return low + (high - low) * (np.arange(ROLLER_SAMPLES) + 0.5) / ROLLER_SAMPLES


def where_short(view: PairView, surfaces: SurfacePair) -> tuple[Array, float] | None:
    """Places (n,) m along the axis of a roller, the first of `surfaces`, evenly over what facets of a plane are under
    it, and how far apart they are (m); None where these are under most of it, or under none."""
    axis, normal = surfaces.axes
    low, high = surfaces.extents[0]
    across = cross(normal, axis)
    size = float(np.linalg.norm(across))
    arms = view.b.vertices[view.b.faces[surfaces.facets[1]]] - surfaces.points[0]
    along, aside = arms @ axis, arms @ (across / size)
    within = TOUCH * view.tolerance
    first, last = _in_strip(along, aside, within)
    first, last = np.clip(first, low, high), np.clip(last, low, high)
    order = np.lexsort((last, first))
    first, last = first[order], last[order]
    # what earlier facets are under already counts once
    first = np.maximum(first, np.concatenate([[low], np.maximum.accumulate(last)[:-1]]))
    lengths = np.maximum(last - first, 0.0)
    covered = float(lengths.sum())
    # samples of a plane under less than half of a roller stand only where the plane is
    if not 0.0 < covered < 0.5 * (high - low):
        return None
    ends = np.cumsum(lengths)
    at = evenly(0.0, covered)
    facet = np.minimum(ends.searchsorted(at, side="right"), len(ends) - 1)
    return first[facet] + at - (ends - lengths)[facet], covered / ROLLER_SAMPLES


def _in_strip(along: Array, aside: Array, within: float) -> tuple[Array, Array]:
    """(n,) m: least and greatest `along` of triangles (n, 3), of their corners' coordinates, where `aside` is `within`
    of zero; empty ones are the wrong way round."""
    inside = np.abs(aside) <= within
    least, most = np.where(inside, along, np.inf).min(axis=1), np.where(inside, along, -np.inf).max(axis=1)
    for k in range(3):
        a, b, t, u = aside[:, k], aside[:, k - 1], along[:, k], along[:, k - 1]
        for edge in (-within, within):
            crosses = (a - edge) * (b - edge) < 0.0
            place = t + (u - t) * (edge - a) / np.where(crosses, b - a, 1.0)
            least = np.minimum(least, np.where(crosses, place, np.inf))
            most = np.maximum(most, np.where(crosses, place, -np.inf))
    return least, most
