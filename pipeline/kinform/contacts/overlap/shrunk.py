"""Solids that share nothing once one of them is made thinner by very little, which is quicker to see than what they
share.

Move the vertices of B inwards, none by more than `least`, and the facets with them, to a B' that has nothing in common
with A. A point of A's surface is not in B'; where it is in B, the surface of B has passed it on its way, and is no
farther from it than `least`. A point of B's surface that is in A has left it on its way, and is no farther from the
surface of A. No ball of a radius above `least` is in both solids, as none is in what B has lost. So faces that lie on
each other, with rounding of either sign, and also to both sides of a slot, are seen not to overlap without a cut, by
asking facets that are near each other whether they cross.
"""

from __future__ import annotations

import numpy as np

from kinform.contacts.search.pair_view import PartView
from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.meshes.boxes import facet_boxes, meeting_box, middles
from kinform.foundation.meshes.slivers import crossing
from kinform.model.arrays import Array, Ints

SHELL_TRIED = 16
"""Facets of a shell that are tried for one that is not at the surface of another solid: one tells whether the shell is
in it. Chosen, not measured."""


def are_within(a: PartView, b: PartView, least: float) -> bool:
    """Whether two closed solids are sure to have no point of their surfaces deeper than `least` (m) in each other, and
    to share no ball of a greater radius. Of solids that do, and of some that do not, it is not sure."""
    first, second = a, b
    low, high = np.maximum(a.low, b.low) - least, np.minimum(a.high, b.high) + least
    facets_a, facets_b = _beside(a, low, high), _beside(b, low, high)
    if len(facets_a) > len(facets_b):
        a, b, facets_a, facets_b = b, a, facets_b, facets_a
    told: bool | None = False
    if len(facets_a) and len(facets_b):
        thinner = a.corners(facets_a) - least * outward(a, facets_a)
        told = None if a.region.is_large or b.region.is_large else crossing(thinner, b.corners(facets_b))
    # mostly some cross, which is seen sooner than where shells are
    if told or not (_outside(first, second, least) and _outside(second, first, least)):
        return False
    return told is False or not b.region.meets(b.to_part(thinner))


def _outside(inner: PartView, outer: PartView, least: float) -> bool:
    """Whether it is sure that no shell of `inner` is inside `outer` unless their facets cross, also where those of one
    are moved by up to `least` (m)."""
    tried, spare = inner.index.shells, 2.0 * least
    low, high = outer.low - spare, outer.high + spare
    one = len(tried) == 1
    if one:
        if ((inner.low < low) | (inner.high > high)).any():
            return True
        tried = np.arange(0, len(inner.faces), -(-len(inner.faces) // SHELL_TRIED))
    points = middles(inner.vertices.take(inner.faces[tried], axis=0))
    points = points[((points > low) & (points < high)).all(axis=1)]
    if not len(points) or (one and len(points) < len(tried)):
        return True
    clear = outer.depths(points)[0] > spare
    if not (clear.any() if one else clear.all()):
        return False
    return not outer.index.contains(outer.to_part(points[clear])).any()


def _beside(part: PartView, low: Array, high: Array) -> Ints:
    """Facets near the other part that come into the box from `low` to `high` (3,)."""
    facets = part.probed
    return facets[meeting_box(*facet_boxes(part.vertices, part.faces[facets]), low, high)]


def outward(part: PartView, facets: Ints, some: Ints | None = None) -> Array:
    """(n, 3, 3) unit, or zero: at each corner of facets (n,) the mean of the normals of those of them, or of those at
    the places `some` (k,), that meet in its vertex, weighted by their angles there, so that it does not hang on how
    faces are cut into triangles."""
    faces, chosen = part.faces[facets], facets if some is None else facets[some]
    corners = part.corners(chosen)
    sides = [corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)]
    weights = np.concatenate([_angle(sides[k], -sides[k - 1]) for k in range(3)])
    vertex, normals = part.faces[chosen].T.ravel(), part.normals(chosen)
    sums = [np.bincount(vertex, weights * np.tile(column, 3), len(part.vertices)) for column in normals.T]
    mean = np.stack([column.take(faces) for column in sums], axis=2)
    length = np.sqrt((mean * mean).sum(axis=2, keepdims=True))
    return np.asarray(mean / np.where(length > 0.0, length, 1.0))


def _angle(one: Array, two: Array) -> Array:
    """(n,) rad between vectors (n, 3)."""
    across = cross(one, two)
    return np.arctan2(np.sqrt(dot(across, across)), dot(one, two))
