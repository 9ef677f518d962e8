"""How far each facet may stand off the smooth surface that its corners lie on, where no analytic surface tells.

A triangle through three points of a surface with the curvature H (2, 2) stands off it by ½ R², where R is the radius of
the smallest circle about its corners, measured by the metric H (Waldron, SIAM J. Numer. Anal. 35, 1998): ½ κ R² on a
ball of the curvature κ, κ w² / 8 on strips of the width w. Facets in one plane are one polygon, (κ₁ w₁² + κ₂ w₂²) / 8
by its widths along the principal directions. H is that of least squares by which the normals of the polygons about it,
at their middles, differ from its own.

Across an edge at which the surface turns by δ, polygons of the widths v and w stand off by no more than a few times
min(v, w) δ / 8, whatever they look like: a flat beside a fillet does not bend as the fillet does. What a cut left of a
facet tells less than the whole did, so that where a surface ends, the polygons beside speak for each other.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot, lengths
from kinform.foundation.constants import STANDOFF_EDGES
from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.edges import shared_edges
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import distinct, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints


def standoffs(vertices: Array, faces: Ints, smooth: float, coplanar: float, rounding: float) -> Array:
    """(m,) m of all facets (m, 3) of one surface, over vertices (V, 3) m, each rounded by `rounding`; facets that turn
    by less than `smooth` (rad) at their edge go on into each other, those that turn by less than `coplanar` are one
    polygon, and so are slivers with what they are beside as far as rounding can tell."""
    used, of = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], of.reshape(-1, 3)
    spans = _spans(vertices[faces])
    edges = shared_edges(faces, len(vertices))
    first, second = edges.sides
    turn = np.arctan2(lengths(cross(spans[first], spans[second])), dot(spans[first], spans[second]))
    flat = np.flatnonzero(turn < coplanar)
    flat = np.concatenate([flat, _slivers(vertices[faces], spans, edges.sides, turn, rounding)])
    polygon = components(first[flat], second[flat], len(faces))
    polygons = _Polygons.of(vertices, faces, spans, polygon)
    on = np.flatnonzero((turn < smooth) & (polygon[first] != polygon[second]))
    sides = polygon[edges.sides[:, on]]
    bound = polygons.bound(sides, lengths(edges.along(vertices)[on]), turn[on])
    one, other = polygons.about(smooth)
    own = np.minimum(polygons.bent(one, other), bound)
    met: Ints = np.bincount(polygon[edges.sides[:, turn < smooth].ravel()], minlength=len(own))
    ends = met < 3 * np.bincount(polygon, minlength=len(own))
    out = own.copy()
    at = np.flatnonzero(ends[one])
    # Times what a polygon tells by itself that it stands off at most where its surface ends, if those beside it do: a
    # cut that leaves half of a facet leaves about a third. Without, 4 of 300 random sockets overlap, of 41; without a
    # limit, fans of long facets hide 0.6 mm of a motor in an arm.
    np.maximum.at(out, one[at], np.minimum(own[other[at]], 3.0 * own[one[at]]))
    return out[polygon]


def _spans(corners: Array) -> Array:
    """(m, 3) normals of triangles (m, 3, 3), of twice their areas."""
    return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _slivers(corners: Array, spans: Array, sides: Ints, turn: Array, rounding: float) -> Ints:
    """(k,) of edges between triangles `sides` (2, n) that turn by `turn` (n,), for each sliver that as far as rounding
    can tell is in a plane with a triangle beside it, the one across which it turns least."""
    along = np.roll(corners, -1, axis=1) - corners
    longest = np.sqrt(np.einsum("mki,mki->mk", along, along).max(axis=1))
    doubled = lengths(spans)
    low = doubled / np.maximum(longest, TINY)
    first, second = sides
    lower = np.where(low[first] <= low[second], first, second)
    # Roundings by which a sliver may leave the plane of the facet beside it and still lie in it: those of its vertices
    # and of the plane. Chosen, not measured.
    rounded = low[lower] * turn < 4.0 * rounding
    # Largest height of such a sliver, as a share of that of the facet beside it. Chosen, not measured.
    at = np.flatnonzero(rounded & (low[lower] < 0.1 * np.sqrt(doubled[sides].max(axis=0))))
    at = at[np.lexsort((at, turn[at], lower[at]))]
    return at[heads(lower[at])]


@dataclass(frozen=True, eq=False)
class _Polygons:
    """Facets of one surface, those in one plane together."""

    normal: Array
    """(p, 3) unit."""
    area: Array
    middle: Array
    """(p, 3) where a smooth surface has that normal."""
    triangle: Ints
    """(p, 3) corners of those of one facet, -1 of others."""
    owner: Ints
    corner: Ints
    """(k,) polygons and their vertices, by polygon."""
    vertices: Array

    @classmethod
    def of(cls, vertices: Array, faces: Ints, spans: Array, polygon: Ints) -> _Polygons:
        """Of facets (m, 3) with spans (m, 3), numbered by polygon (m,)."""
        count = int(polygon.max()) + 1
        doubled = lengths(spans)
        total = _sums(polygon, spans, count)
        area: Array = np.bincount(polygon, 0.5 * doubled, count).astype(float)
        weight = np.where(area > 0.0, area, 1.0)
        corners = vertices[faces]
        middle = _sums(polygon, 0.5 * doubled[:, None] * corners.mean(axis=1), count) / weight[:, None]
        alone = np.flatnonzero(np.bincount(polygon)[polygon] == 1)
        middle[polygon[alone]] = _middles(corners[alone])
        triangle = np.full((count, 3), -1)
        triangle[polygon[alone]] = faces[alone]
        keys = distinct(np.sort((polygon[:, None] * np.int64(len(vertices)) + faces).ravel()))
        owner, corner = np.divmod(keys, len(vertices))
        size = lengths(total)
        return cls(total / np.where(size > 0.0, size, 1.0)[:, None], area, middle, triangle, owner, corner, vertices)

    def bound(self, sides: Ints, length: Array, turn: Array) -> Array:
        """(p,) m that each polygon stands off at most, by the edges between polygons `sides` (2, k), of some length (m)
        and turn (rad)."""
        out = np.zeros(len(self.area))
        least = self.area[sides].min(axis=0)
        # a short edge says nothing of how far the polygons reach from it
        width = np.minimum(least / np.maximum(length, TINY), 2.0 * np.sqrt(least))
        np.maximum.at(out, sides.ravel(), np.tile(STANDOFF_EDGES * width * turn / 8.0, 2))
        return out

    def about(self, smooth: float) -> tuple[Ints, Ints]:
        """(k,) pairs of polygons that share a vertex, both ways round, by the first; but for those that only meet where
        very many do."""
        order = np.argsort(self.corner, kind="stable")
        owner, corner = self.owner[order], self.corner[order]
        number = np.bincount(corner)[corner]
        begin = np.cumsum(np.bincount(corner)) - np.bincount(corner)
        # Polygons at a vertex up to which each of them speaks for all others there: pairs grow with the square, and a
        # fan of more is the end of a cylinder. Chosen, not measured.
        few = np.flatnonzero(number <= 300)
        one = np.repeat(owner[few], number[few])
        ends = np.cumsum(number[few])
        other = owner[np.arange(len(one)) + np.repeat(begin[corner[few]] + number[few] - ends, number[few])]
        differ = np.flatnonzero(one != other)
        keys = distinct(np.sort(one[differ] * np.int64(len(self.area)) + other[differ]))
        one, other = np.divmod(keys, len(self.area))
        # two smooth edges meet at a vertex
        near = dot(self.normal[one], self.normal[other]) > np.cos(2.0 * smooth)
        return one[near], other[near]

    def bent(self, one: Ints, other: Ints) -> Array:
        """(p,) m by the curvature of least squares, of pairs of polygons (k,)."""
        count = len(self.area)
        frame, size, reach = self._frames()
        apart = np.einsum("ki,kci->kc", self.middle[other] - self.middle[one], frame[one])
        (u, v), (p, q) = apart.T / size[one], np.einsum("ki,kci->ck", self.normal[other], frame[one])
        # slivers know little of how a surface bends, and what is much farther off than the polygon reaches less
        square = np.einsum("kc,kc->k", apart, apart)
        own = 4.0 * np.einsum("kc,kcd,kd->k", apart, reach[one], apart)
        near = np.minimum(own / np.maximum(square * square, TINY), 1.0) ** 2
        weight = near * np.minimum(self.area[other] / np.maximum(self.area[one], TINY), 1.0)
        products = (u * u, u * v, v * v, u * p, u * q + v * p, v * q)
        uu, uv, vv, up, mixed, vq = (np.bincount(one, weight * values, count) for values in products)
        matrix = np.zeros((count, 3, 3))
        matrix[:, 0, 0], matrix[:, 1, 1], matrix[:, 2, 2] = uu, uu + vv, vv
        matrix[:, 0, 1] = matrix[:, 1, 0] = matrix[:, 1, 2] = matrix[:, 2, 1] = uv
        # Weight of no curvature among the polygons about one, each about one size of it away: what none of them tells
        # of is none, and what they tell is less by a hundredth at most.
        matrix += 0.01 * np.diag([1.0, 2.0, 1.0])
        first, second, third = np.linalg.solve(matrix, np.stack([up, mixed, vq], axis=1)[:, :, None])[:, :, 0].T
        H = np.stack([first, second, second, third], axis=1).reshape(count, 2, 2) / size[:, None, None]
        values, turned = np.linalg.eigh(H)
        principal = np.einsum("nci,ncj->nji", frame, turned)
        saddle = values[:, 0] * values[:, 1] < 0.0
        arcs = np.abs(values) * self._widths(principal) ** 2 / 8.0
        # a saddle stands off most at an edge
        out = np.where(saddle, arcs.max(axis=1), arcs.sum(axis=1))
        alone = np.flatnonzero(self.triangle[:, 0] >= 0)
        corners = self.vertices[self.triangle[alone]]
        along = np.einsum("nki,nji->nkj", np.roll(corners, -1, axis=1) - corners, principal[alone])
        squares = np.abs(np.einsum("nkj,nj->nk", along * along, values[alone]))
        out[alone] = np.where(saddle[alone], squares.max(axis=1) / 8.0, 0.5 * _circles(squares))
        return np.asarray(out)

    def _frames(self) -> tuple[Array, Array, Array]:
        """(p, 2, 3) two directions in each polygon, (p,) m about its narrowest width, and (p, 2, 2) m² the squares of
        how far its corners are from its middle, on average."""
        count = len(self.area)
        frame = np.zeros((count, 2, 3))
        row, axis = np.arange(count), np.argmin(np.abs(self.normal), axis=1)
        frame[row, 0, axis] = 1.0
        frame[:, 0] -= self.normal[row, axis][:, None] * self.normal
        frame[:, 0] /= lengths(frame[:, 0])[:, None]
        frame[:, 1] = cross(self.normal, frame[:, 0])
        off = self.vertices[self.corner] - self.middle[self.owner]
        furthest = np.zeros(count)
        np.maximum.at(furthest, self.owner, lengths(off))
        narrow = self.area / np.maximum(2.0 * furthest, TINY)
        x, y = np.einsum("ki,kci->ck", off, frame[self.owner])
        squares = (np.bincount(self.owner, product, count) for product in (x * x, x * y, x * y, y * y))
        reach = np.stack(list(squares), axis=1).reshape(-1, 2, 2) / np.bincount(self.owner)[:, None, None]
        return frame, np.where(narrow > 0.0, narrow, 1.0), reach

    def _widths(self, frame: Array) -> Array:
        """(p, 2) m along two directions (p, 2, 3)."""
        place = np.einsum("ki,kci->kc", self.vertices[self.corner], frame[self.owner])
        starts = np.searchsorted(self.owner, np.arange(len(self.area)))
        return np.asarray(np.maximum.reduceat(place, starts) - np.minimum.reduceat(place, starts))


def _sums(group: Ints, values: Array, count: int) -> Array:
    """(count, 3) sums of values (m, 3) by group (m,)."""
    return np.stack([np.bincount(group, column, count) for column in values.T], axis=1)


def _circles(squares: Array) -> Array:
    """(n,) squares of the radii of the smallest circles about triangles, of the squares (n, 3) of their sides."""
    total, most = squares.sum(axis=1), squares.max(axis=1)
    sixteen = total * total - 2.0 * (squares * squares).sum(axis=1)
    through = squares.prod(axis=1) / np.where(sixteen > 0.0, sixteen, 1.0)
    # the largest angle of three is 60° at least, and beyond a right angle half of the longest side is enough
    acute: Flags = 2.0 * most < total
    return np.asarray(np.where(acute, np.clip(through, most / 4.0, most / 3.0), most / 4.0))


def _middles(corners: Array) -> Array:
    """(m, 3) of the smallest circles about triangles (m, 3, 3): there a ball has the normals of its facets, and so have
    both halves of a piece of a strip."""
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    squares = np.einsum("nki,nki->nk", opposite, opposite)
    weights = squares * (squares.sum(axis=1)[:, None] - 2.0 * squares)
    wide = weights.min(axis=1) <= 0.0
    # beyond a right angle the middle of the longest side
    weights[wide] = np.arange(3) != np.argmax(squares[wide], axis=1)[:, None]
    return np.asarray(np.einsum("nk,nki->ni", weights / weights.sum(axis=1)[:, None], corners))
