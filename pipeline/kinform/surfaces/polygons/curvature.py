"""Curvature of every polygon from the turning across its edges, and what it says of tangent surfaces.

Method: normal cycles (Cohen-Steiner and Morvan 2003): an edge of length l, direction t and turning θ adds
θ l t tᵀ, half to each polygon; divided by the area, eigenvectors are directions and eigenvalues the
curvature *across* them. A cylinder has one, along its generators. It is an estimate that guides the search;
whether polygons belong to a surface is decided by their vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import ascending
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import columns_of
from kinform.surfaces.polygons.patchwork import Patchwork

SIMPLE_RATIO = 0.12
"""Ratio of the two curvatures below which a polygon bends one way only. Chosen, not measured."""
TURNED_ALONG = 0.03
"""rad between the generators of neighbours on one surface that bends one way, besides that of their normals. Chosen,
not measured."""


_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Rows and columns of the six entries of a symmetric 3 × 3 matrix."""


@dataclass(frozen=True, eq=False)
class Links:
    """Smooth edges (L,) between polygons, and which of them join polygons of like width."""

    edge: Ints
    a: Ints
    b: Ints
    alike: Flags


@dataclass(frozen=True, eq=False)
class Curvature:
    """Of each polygon (P,), in unit coordinates."""

    strong: Array
    """The larger principal curvature by size, positive where convex."""
    weak: Array
    """The other one."""
    along: Array
    """(P, 3) direction across which the strong one bends: that of a cylinder's generators."""

    @cached_property
    def ratio(self) -> Array:
        """|weak| / |strong|: 0 on cylinders and cones, 1 on spheres; 1 where nothing bends."""
        strong = np.abs(self.strong)
        return np.where(strong > 0, np.abs(self.weak) / np.maximum(strong, TINY), 1.0)


def links(work: Patchwork, free: Flags) -> Links:
    """Smooth edges between free polygons."""
    edge = np.flatnonzero(work.smooth)
    edge = edge[free[work.a[edge]] & free[work.b[edge]]]
    a, b = work.a[edge], work.b[edge]
    key = np.minimum(a, b) * np.int64(work.count) + np.maximum(a, b)
    order = ascending(key, work.count * work.count)
    first = np.r_[True, np.diff(key[order]) != 0] if len(key) else np.zeros(0, bool)
    number = np.empty(len(key), np.int64)
    number[order] = np.cumsum(first) - 1
    shared = np.maximum(np.bincount(number, work.length[edge])[number] if len(key) else np.zeros(0), TINY)
    wide = np.maximum(work.area[a], work.area[b]) / shared
    narrow = np.minimum(work.area[a], work.area[b]) / shared
    # Ratio of widths up to which neighbours look like facets of one surface. Chosen, not measured.
    return Links(edge, a, b, wide < 3.0 * narrow)


def curvature(work: Patchwork, link: Links) -> Curvature:
    """Curvature of every polygon, averaged over it and its neighbours of like width."""
    edge, a, b = link.edge, link.a, link.b
    along = work.along(edge).T
    amount = work.angle[edge] * work.sign[edge] / np.maximum(work.length[edge], TINY) / 2
    rows = np.flatnonzero(link.alike)
    near_a, near_b = a.take(rows), b.take(rows)

    def with_neighbours(value: Array) -> Array:
        of_b = np.bincount(near_a, value[near_b], work.count)
        return np.asarray(value + of_b + np.bincount(near_b, value[near_a], work.count))

    area = np.maximum(with_neighbours(work.area.astype(float)), TINY)
    tensor = []
    for i, j in _PAIRS:
        term = amount * along[i] * along[j]
        turning: Array = (np.bincount(a, term, work.count) + np.bincount(b, term, work.count)).astype(float)
        tensor.append(with_neighbours(turning) / area)
    return Curvature(*principal(tensor))


def principal(tensor: Sequence[Array]) -> tuple[Array, Array, Array]:
    """(strong, weak, along) of symmetric 3 × 3 matrices, given as their six entries (n,) in the order of `_PAIRS`: the
    eigenvalues of the largest and the second size, and the first one's eigenvector (n, 3).

    Eigenvalues by the angle of the characteristic polynomial (Smith, Comm. ACM 4, 1961), all matrices at once, because
    LAPACK takes a microsecond for each. The strong one has full precision where it stands alone, the weak one half of
    the digits where it is nearly double: enough for an estimate.
    """
    xx, yy, zz, xy, xz, yz = tensor
    mean = (xx + yy + zz) / 3
    x, y, z = xx - mean, yy - mean, zz - mean
    size = np.sqrt((x * x + y * y + z * z + 2 * (xy * xy + xz * xz + yz * yz)) / 6)
    determinant = x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz)
    angle = np.arccos(np.clip(determinant / np.maximum(2 * size**3, TINY), -1.0, 1.0)) / 3
    high, low = mean + 2 * size * np.cos(angle), mean + 2 * size * np.cos(angle + 2 * np.pi / 3)
    middle = 3 * mean - high - low
    above = np.abs(high) > np.abs(low)
    strong, other = np.where(above, high, low), np.where(above, low, high)
    weak = np.where(np.abs(other) >= np.abs(middle), other, middle)
    rows = ((xx - strong, xy, xz), (xy, yy - strong, yz), (xz, yz, zz - strong))
    best, along = np.zeros(len(mean)), np.zeros((3, len(mean)))
    along[0] = 1.0
    for i, j in ((0, 1), (0, 2), (1, 2)):
        across = [rows[i][k] * rows[j][m] - rows[i][m] * rows[j][k] for k, m in ((1, 2), (2, 0), (0, 1))]
        square = across[0] ** 2 + across[1] ** 2 + across[2] ** 2
        larger = square > best
        np.copyto(best, square, where=larger)
        for out, value in zip(along, across, strict=True):
            np.copyto(out, value, where=larger)
    along /= np.sqrt(np.where(best > 0, best, 1.0))
    return strong, weak, along.T


def bends_like(bent: Curvature, link: Links) -> Flags:
    """Whether the two polygons of each link have like curvatures."""
    strong_a, strong_b = bent.strong[link.a], bent.strong[link.b]
    larger = np.maximum(np.abs(strong_a), np.abs(strong_b))
    # Difference of the larger principal curvatures of neighbours on one surface, as a share of the largest: what coarse
    # facets of unequal width make of equal ones.
    like = np.abs(strong_a - strong_b) <= 0.35 * larger
    # Of the smaller principal curvatures it may be less. Chosen, not measured.
    return np.asarray(like & (np.abs(bent.weak[link.a] - bent.weak[link.b]) <= 0.3 * larger))


def continues(work: Patchwork, bent: Curvature, link: Links) -> Flags:
    """Whether the two polygons of each link, if they bend one way and alike, seem to lie on one surface: directions
    that turn no more than the normals do when going across, and not at all when going along."""
    a, b = link.a, link.b
    simple = np.maximum(bent.ratio[a], bent.ratio[b]) < SIMPLE_RATIO
    along_a, along_b = columns_of(bent.along, a), columns_of(bent.along, b)
    cosine = dot(along_a, along_b)
    step = work.middles(b) - work.middles(a)
    square = step * step
    size = np.maximum(np.sqrt(square[:, 0] + (square[:, 1] + square[:, 2])), TINY)
    going = np.abs(dot(step, along_a + along_b * np.sign(cosine)[:, None])) / 2 / size
    turn = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    # a step to the neighbour within 45° of the generators goes along them
    allowed = np.where(going > 0.7, TURNED_ALONG, TURNED_ALONG + work.angle[link.edge])
    return np.asarray(~simple | (turn <= allowed))
