"""What facets and their edges say before anything is recovered: normals, areas, neighbours, and the scatter
of the vertices.

The scatter is read from edges between facets that should be coplanar. The four vertices of such an edge lie
off a common plane by a signed distance: on a clean mesh it is nought on planes and of one sign around
each vertex of a convex or concave surface; scattered vertices mix both signs everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.components import components
from kinform.model.arrays import Array, Flags, Ints

__all__ = ["Fabric", "angles", "departures", "fabric", "scatter"]

SHARE = 0.25
"""Share of the area, from the calmest vertices up, at which the scatter is read: saddles are rarely more
than the rest."""
SHARE_OF_RIPPLE, RIPPLE = 0.1, 0.05
"""Where scattered vertices differ from their neighbours by this much of what they show, saddles do by less
(0.12 to 0.4 against 0.01 to 0.02 where tried)."""

RUN = 1 << 16
"""Edges that are worked on at a time, to keep memory small."""

PER_SIGMA = 1.2
"""What is read there, in standard deviations of one coordinate (tried on noisy copies of robots' parts)."""


@dataclass(frozen=True, eq=False)
class Fabric:
    """F facets and E edges of a mesh in unit coordinates."""

    vertices: Array
    faces: Ints
    area: Array
    normal: Array
    """(F, 3) outward; zero for facets without area."""
    altitude: Array
    """(F,) the least."""
    f0: Ints
    f1: Ints
    """(E,) facets of each edge; f1 is -1 at open edges and where more than two facets meet."""
    ends: Ints
    """(E, 2) vertices as f0 runs them."""
    length: Array
    inner: Flags
    """(E,) two facets that run the edge oppositely."""


def angles(n0: Array, n1: Array) -> Array:
    """Angle between unit vectors (n, 3), good for small ones too (rad)."""
    across = cross(n0, n1)
    return np.asarray(np.arctan2(np.sqrt(np.einsum("ij,ij->i", across, across)), np.einsum("ij,ij->i", n0, n1)))


def fabric(vertices: Array, faces: Ints) -> Fabric:
    """Facets and edges of a welded mesh."""
    corners = vertices[faces]
    sides = corners - corners[:, [1, 2, 0]]
    across = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice = np.sqrt(np.einsum("ij,ij->i", across, across))
    longest = np.sqrt(np.einsum("ijk,ijk->ij", sides, sides).max(axis=1, initial=0.0))
    f0, f1, ends, opposed = _edges(faces, len(vertices))
    along = vertices[ends[:, 0]] - vertices[ends[:, 1]]
    return Fabric(
        vertices=vertices,
        faces=faces,
        area=twice / 2,
        normal=across / np.maximum(twice, 1e-300)[:, None],
        altitude=twice / np.maximum(longest, 1e-300),
        f0=f0,
        f1=f1,
        ends=ends,
        length=np.sqrt(np.einsum("ij,ij->i", along, along)),
        inner=(f1 >= 0) & opposed,
    )


def _edges(faces: Ints, vertex_count: int) -> tuple[Ints, Ints, Ints, Flags]:
    """(f0, f1 or -1, directed ends as f0 runs them, whether both run them oppositely) of every edge.

    Edges with more than two facets are given as open edges, one for each facet.
    """
    count = len(faces)
    half = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(count), 3)
    low, high = np.minimum(half[:, 0], half[:, 1]), np.maximum(half[:, 0], half[:, 1])
    key = low * np.int64(vertex_count) + high
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = np.flatnonzero(np.r_[True, key[1:] != key[:-1]]) if len(key) else np.zeros(0, np.int64)
    size = np.diff(np.r_[first, len(key)])
    pairs = first[size == 2]
    f0, f1 = owner[order[pairs]], owner[order[pairs + 1]]
    ends = half[order[pairs]]
    opposed = half[order[pairs], 0] != half[order[pairs + 1], 0]
    single = np.ones(len(key), bool)
    single[pairs] = single[pairs + 1] = False
    rest = order[single]
    return (
        np.r_[f0, owner[rest]],
        np.r_[f1, np.full(len(rest), -1)],
        np.concatenate([ends, half[rest]]),
        np.r_[opposed, np.ones(len(rest), bool)],
    )


def departures(of: Fabric, edges: Ints) -> Array:
    """Signed distance of the four vertices of each edge from a common plane, positive where convex.

    It is their one linear combination that vanishes on planes, of length one: vertices that scatter by σ
    scatter it by σ, whatever the shape of the two facets.
    """
    out = np.empty(len(edges))
    for start in range(0, len(edges), RUN):
        out[start : start + RUN] = _departures(of.vertices[_corners(of, edges[start : start + RUN])])
    return out


def _corners(of: Fabric, edges: Ints) -> Ints:
    """(4, n) both ends of each edge, and the third vertices of its facets."""
    ends = of.ends[edges]
    shared = ends.sum(axis=1)
    opposite = [of.faces[f[edges]].sum(axis=1) - shared for f in (of.f0, of.f1)]
    return np.stack([ends[:, 0], ends[:, 1], *opposite])


def _departures(points: Array) -> Array:
    a, b, c, d = points
    u, v, w = b - a, c - a, d - a
    uv, uw, vw, opposite = cross(u, v), cross(u, w), cross(v, w), cross(c - b, d - b)
    squares = np.zeros(len(a))
    for x in (uv, uw, vw, opposite):
        squares += np.einsum("ij,ij->i", x, x)
    return np.asarray(-np.einsum("ij,ij->i", uv, w) / np.sqrt(np.maximum(squares, 1e-300)))


REPEATED, ROW = 1e-2, 12
"""Relative difference of what neighbours show that is no accident, in rows of so many."""


def scatter(of: Fabric, smooth_edge: float) -> float:
    """Standard deviation of the vertices about their surfaces in one coordinate, as far as it can be read.

    Saddles mix signs too, but smoothly: what one vertex shows, its neighbours show as well.
    """
    inner = np.flatnonzero(of.inner)
    near = inner[np.einsum("ij,ij->i", of.normal[of.f0[inner]], of.normal[of.f1[inner]]) > np.cos(smooth_edge)]
    if not len(near):
        return 0.0
    off, count = departures(of, near), len(of.vertices)
    above, below, seen = np.zeros(count), np.zeros(count), np.zeros(count, np.int64)
    for row in _corners(of, near):
        np.maximum.at(above, row, off)
        np.maximum.at(below, row, -off)
        seen += np.bincount(row, minlength=count)
    mixed = _calmest(of, np.minimum(above, below), seen >= 4, SHARE)
    a, b = of.ends[near].T
    spokes = np.maximum(np.bincount(a, minlength=count) + np.bincount(b, minlength=count), 1)
    mean = (np.bincount(a, off, count) + np.bincount(b, off, count)) / spokes
    around = (np.bincount(a, mean[b], count) + np.bincount(b, mean[a], count)) / spokes
    ripple = _calmest(of, np.abs(mean - around), spokes >= 3, SHARE_OF_RIPPLE)
    if mixed <= 0.0 or ripple <= RIPPLE * mixed:
        return 0.0
    return _calmest(of, _irregular(of, inner, above, below), seen >= 4, SHARE) / PER_SIGMA


def _irregular(of: Fabric, inner: Ints, above: Array, below: Array) -> Array:
    """What mixes at each vertex; nothing where a long row of neighbours does so alike: flanks of a thread that is one
    strip of skew facets mix signs, but all in one way, and scatter repeats nothing."""
    a, b = of.ends[inner].T
    alike = np.ones(len(a), bool)
    for value in (above, below):
        alike &= np.abs(value[a] - value[b]) <= REPEATED * np.maximum(value[a], value[b])
    # an edge shows at its four vertices: so few are alike anyway
    label = components(a[alike], b[alike], len(above))
    return np.where(np.bincount(label)[label] >= ROW, 0.0, np.minimum(above, below))


def _calmest(of: Fabric, value: Array, known: Flags, share: float) -> float:
    """The value of vertices that is reached on so large a share of the area, from the smallest up."""
    each = np.median(value[of.faces], axis=1)
    weight = np.where(known[of.faces].all(axis=1), of.area, 0.0)
    order = np.argsort(each, kind="stable")
    reached = np.cumsum(weight[order])
    return float(each[order][np.searchsorted(reached, share * reached[-1])]) if reached[-1] > 0 else 0.0
