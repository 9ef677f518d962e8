"""How far vertices scatter about their surfaces, and the lengths that follow from it.

The scatter is read from edges between facets that should be coplanar. The four vertices of such an edge lie
off a common plane by a signed distance: on a clean mesh it is nought on planes and of one sign around
each vertex of a convex or concave surface; scattered vertices mix both signs everywhere. Saddles mix them too, but
smoothly, and threads of skew facets do it all in one way: both are told apart below. What cannot be told apart is
scatter that repeats itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross_columns, dot
from kinform.foundation.constants import SCATTERED
from kinform.foundation.graphs.components import components
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.tolerances import Tolerances
from kinform.surfaces.constants import ROWS
from kinform.surfaces.groups import columns_of
from kinform.surfaces.polygons.facets import Facets

FITS_PER_NOISE = 10
"""The tolerance of fits, in noises that are expected of vertices, and the noise as such a part of the tolerance.
Chosen, not measured."""
SCATTER_SHOWS = 2
"""Vertices scatter where twice the standard deviation that is read exceeds the expected noise."""
FIT_SIGMAS = 5
"""Standard deviations of scattered vertices that a fit allows: one more than those that count as scatter."""
CALM_SHARE = 0.25
"""Share of the area, from the calmest vertices up, at which the scatter is read: saddles are rarely more
than the rest."""
CALM_SHARE_OF_RIPPLE = 0.1
"""The same for the difference from the neighbours, which is smaller on saddles too."""
RIPPLE = 0.05
"""Where scattered vertices differ from their neighbours by this much of what they show, saddles do by less
(0.12 to 0.4 against 0.01 to 0.02 where tried)."""
MIXED_PER_SIGMA = 1.2
"""What is read there, in standard deviations of one coordinate (tried on noisy copies of robots' parts)."""


@dataclass(frozen=True)
class Scale:
    """Lengths that decide, relative to the mesh's span."""

    rounding: float
    """What storing coordinates in single precision loses, or the scatter that the mesh shows, if larger."""
    scatter: float
    """Standard deviation of vertices that scatter more than they were rounded, else 0."""
    noise: float
    """Scatter of vertices that is expected anyway."""
    fit: float
    """Distance up to which a vertex belongs to a surface."""

    @classmethod
    def of(cls, mesh: Facets, rounding: float, tolerances: Tolerances) -> Scale:
        """Those of a mesh that was stored with this rounding: vertices that scatter more widen everything to four
        standard deviations."""
        # Noise in roundings of the largest coordinate: a vertex is off by half of one in each of three directions.
        noise = max(tolerances.fit / FITS_PER_NOISE, 1.5 * rounding)
        sigma = scatter(mesh, tolerances.smooth_edge, noise / SCATTER_SHOWS)
        fit = max(tolerances.fit, FITS_PER_NOISE * noise)
        if SCATTER_SHOWS * sigma > noise:
            return cls(
                max(rounding, sigma),
                sigma,
                noise=SCATTERED * sigma,
                fit=max(fit, FIT_SIGMAS * sigma),
            )
        return cls(rounding, 0.0, noise=noise, fit=fit)


@dataclass(frozen=True, eq=False)
class Scales:
    """The lengths of `Scale` that decide about several meshes, or regions, (n,) each."""

    rounding: Array
    noise: Array
    fit: Array

    @classmethod
    def of(cls, scales: Sequence[Scale]) -> Scales:
        """Those of several meshes."""
        rounding, noise, fit = np.array([(s.rounding, s.noise, s.fit) for s in scales]).reshape(-1, 3).T
        return cls(rounding, noise, fit)

    def at(self, numbers: Ints | slice) -> Scales:
        """Those of the meshes of these numbers, in this order."""
        return Scales(self.rounding[numbers], self.noise[numbers], self.fit[numbers])

    def wider(self, factor: float) -> Scales:
        """With so many times the noise, and fits as much looser."""
        return Scales(self.rounding, factor * self.noise, factor * self.fit)


def departures(mesh: Facets, edges: Ints) -> Array:
    """Signed distance of the four vertices of each edge from a common plane, positive where convex.

    It is their one linear combination that vanishes on planes, of length one: vertices that scatter by σ
    scatter it by σ, whatever the shape of the two facets.
    """
    out = np.empty(len(edges))
    for start in range(0, len(edges), ROWS):
        run = slice(start, start + ROWS)
        a, b, c, d = (mesh.at(corner) for corner in _corners(mesh, edges[run]))
        u, v, w = b - a, c - a, d - a
        uv = cross_columns(u, v)
        squares = np.zeros(len(a))
        for minor in (uv, cross_columns(u, w), cross_columns(v, w), cross_columns(c - b, d - b)):
            squares += dot(minor, minor)
        out[run] = -dot(uv, w) / np.sqrt(np.maximum(squares, TINY))
    return out


def _corners(mesh: Facets, edges: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """(n,) each: both ends of each edge, and the third vertices of its facets."""
    return mesh.starts(edges), mesh.finishes(edges), *mesh.opposite(edges)


def scatter(mesh: Facets, smooth_edge: float, least: float = 0.0) -> float:
    """Standard deviation of the vertices about their surfaces in one coordinate, as far as it can be read; 0 where
    it is plainly no more than `least`, which most meshes show at the first look.

    Saddles mix signs too, but smoothly: what one vertex shows, its neighbours show as well.
    """
    inner = np.flatnonzero(mesh.inner)
    facing = dot(columns_of(mesh.normal, mesh.f0[inner]), columns_of(mesh.normal, mesh.f1[inner]))
    near = inner[np.flatnonzero(facing > np.cos(smooth_edge))]
    if not len(near):
        return 0.0
    off, count = departures(mesh, near), len(mesh.vertices)
    above, below, seen = np.zeros(count), np.zeros(count), np.zeros(count, np.int64)
    for row in _corners(mesh, near):
        np.maximum.at(above, row, off)
        np.maximum.at(below, row, -off)
        seen += np.bincount(row, minlength=count)
    # a vertex mixes signs where at least four edges show something
    mixing, readable = np.minimum(above, below), seen >= 4
    # what is left of it at the end, in standard deviations, is no more than what there is here
    if _is_calm(mesh, mixing, readable, CALM_SHARE, MIXED_PER_SIGMA * least):
        return 0.0
    mixed = _calmest(mesh, mixing, readable, CALM_SHARE)
    a, b = mesh.ends[near].T
    spokes = np.maximum(np.bincount(a, minlength=count) + np.bincount(b, minlength=count), 1)
    mean = (np.bincount(a, off, count) + np.bincount(b, off, count)) / spokes
    around = (np.bincount(a, mean[b], count) + np.bincount(b, mean[a], count)) / spokes
    # a vertex differs from its neighbours where it has at least three
    ripple = _calmest(mesh, np.abs(mean - around), spokes >= 3, CALM_SHARE_OF_RIPPLE)
    if mixed <= 0.0 or ripple <= RIPPLE * mixed:
        return 0.0
    irregular = _irregular(mesh, inner, above, below)
    return _calmest(mesh, irregular, readable, CALM_SHARE) / MIXED_PER_SIGMA


def _irregular(mesh: Facets, inner: Ints, above: Array, below: Array) -> Array:
    """What mixes at each vertex; nothing where a long row of neighbours does so alike: flanks of a thread that is one
    strip of skew facets mix signs, but all in one way, and scatter repeats nothing."""
    a, b = mesh.ends[inner].T
    alike = np.ones(len(a), bool)
    for value in (above, below):
        # Relative difference of what neighbours show that is no accident in a long row of them. Chosen, not measured.
        alike &= np.abs(value[a] - value[b]) <= 1e-2 * np.maximum(value[a], value[b])
    # an edge shows at its four vertices: so few are alike anyway
    label = components(a[alike], b[alike], len(above))
    # a row of a dozen equal values is no accident
    return np.where(np.bincount(label)[label] >= 12, 0.0, np.minimum(above, below))


def _calmest(mesh: Facets, value: Array, readable: Flags, share: float) -> float:
    """The value of vertices that is reached on so large a share of the area, from the smallest up."""
    each, weight = _of_facets(mesh, value, readable)
    order = np.argsort(each, kind="stable")
    reached = np.cumsum(weight[order])
    return float(each[order][np.searchsorted(reached, share * reached[-1])]) if reached[-1] > 0 else 0.0


def _is_calm(mesh: Facets, value: Array, readable: Flags, share: float, limit: float) -> bool:
    """Whether `_calmest` is plainly within the limit, without an order."""
    each, weight = _of_facets(mesh, value, readable)
    return bool(weight[each <= limit].sum() >= (1.0 + SOLVED) * share * weight.sum())


def _of_facets(mesh: Facets, value: Array, readable: Flags) -> tuple[Array, Array]:
    """(F,) the middle value at the corners of each facet, and the area that it counts with."""
    first, second, third = (value.take(mesh.faces[:, k]) for k in range(3))
    each = np.maximum(np.minimum(first, second), np.minimum(np.maximum(first, second), third))
    whole = readable[mesh.faces[:, 0]] & readable[mesh.faces[:, 1]] & readable[mesh.faces[:, 2]]
    return each, np.where(whole, mesh.area, 0.0)
