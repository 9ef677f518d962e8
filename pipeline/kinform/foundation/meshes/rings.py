"""Rings of flats: prisms whose corners lie on one circle, as a coarse tessellation of a shaft or a bore does, and a
hexagon as well.

A mesh does not tell which of the two was meant. So flats stay planes, and beside them a ring says which of them stand
about one axis, how far off it their corners and their middles are, and to which side the material lies. Who compares
two parts decides what that means there.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross, dot, lengths, normalised, perpendicular, widest_gap
from kinform.foundation.constants import SCATTERED
from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.edges import SharedEdges
from kinform.foundation.meshes.surface_table import PLANE, SurfaceTable
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import distinct, heads, median, numbered
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces

RING_FEW = 6
"""Up to so many directions of its flats a ring is round only where ..."""
RING_EVEN = 0.05
"""... their distances from the axis differ by no more than this share of that of the corners: those of a box do not."""
RING_SIDES = 3
"""Fewest flats of a ring: a triangle."""
RING_TURN = (np.radians(20.0), np.radians(125.0))
"""rad between two neighbours of a ring: of a triangle they differ by 120°; below 32° strips are found to be round, but
not where three of them are left."""
RING_ALIKE = np.radians(10.0)
"""rad: flats whose normals differ by less face one way: neighbours of a ring turn by twice as much. The steps of a long
bar do, and their corners, at both of its ends, are on one circle whatever they are."""
RING_ROUND = 5e-3
"""Largest relative difference of the distances from the axis of the corners of one ring: far above rounding, far below
the corners of a rectangle. Chosen, not measured."""
RING_OPEN = np.radians(200.0)
"""rad: widest angle about the axis without a flat: half a ring, as of a half-bearing, goes round enough, with 20° to
spare."""
RING_SPARE = 1e-3
"""Relative margin by which a row of flats must miss a limit before it is left out at first sight: sums about a common
middle are exact to far less."""


@dataclass(frozen=True, eq=False)
class Ring:
    """Flats about an axis, in the part frame (m, rad)."""

    axis: Array
    """(3,) unit."""
    point: Array
    """(3,) on the axis."""
    corner: float
    """Distance of the corners from the axis."""
    flats: tuple[float, float]
    """Distances of the nearest and of the farthest flat from the axis."""
    side: int
    """+1: material inside (a bar); −1: material outside (a socket)."""
    sides: int
    """How many ways the flats face."""
    extent: tuple[float, float]
    """Range along `axis` from `point`."""
    surfaces: Ints
    """The planes that the flats belong to, ascending."""
    facets: Ints
    """Ascending."""
    turn: float
    """Standard uncertainty of the axis (rad)."""
    shift: float
    """Standard uncertainty of the point across the axis (m)."""


@dataclass(frozen=True, eq=False)
class _Ridges:
    """Edges between flats, that run along the line in which the two planes meet."""

    pieces: Ints
    """(e, 2) connected pieces of planes."""
    ends: Ints
    """(e, 2) vertices."""
    direction: Array
    """(e, 3) unit."""
    length: Array
    convex: Flags

    def where(self, rows: Flags | Ints) -> _Ridges:
        """Some of them."""
        rows = rows.nonzero()[0] if rows.dtype == bool else rows
        return _Ridges(
            self.pieces.take(rows, axis=0),
            self.ends.take(rows, axis=0),
            self.direction.take(rows, axis=0),
            self.length.take(rows),
            self.convex.take(rows),
        )


@dataclass(frozen=True, eq=False)
class RingRow:
    """A row of flats that may be a ring, as it looks at first sight: distances to a share of `RING_SPARE` of that of
    the corners."""

    surfaces: Ints
    """The planes that the flats belong to, ascending."""
    side: int
    """As of the ring."""
    axis: Array
    """(3,) unit, of either sign."""
    corner: float
    """m, of the corners from the axis."""
    flat: float
    """m, of the farthest flat from the axis."""
    look: Callable[[], Ring | None]

    @cached_property
    def ring(self) -> Ring | None:
        """The ring; None where it is none after all."""
        return self.look()


def ring_rows(
    mesh: Mesh, surfaces: MeshSurfaces, table: SurfaceTable, edges: SharedEdges, borders: Ints
) -> tuple[RingRow, ...]:
    """The rows of flats that may be rings among the planes of a mesh with the table of its surfaces, these shared edges
    (by corner), and surfaces (k, 2) that share some, by direction, sense and lowest facet."""
    plane = table.kinds == PLANE
    if plane.sum() < RING_SIDES or not _any_bent(table, borders, plane):
        return ()
    piece, ridges = _ridges(mesh, surfaces, table, edges, plane)
    family = _families(ridges)
    shared = (family >= 0).nonzero()[0]
    ridges, family = ridges.where(shared), family.take(shared)
    if len(family) < RING_SIDES - 1:
        return ()
    label = np.zeros(int(piece.max()) + 1, np.int64)
    label[piece] = surfaces.labels
    rows = _rows_of_flats(ridges, family)
    if not rows:
        return ()
    sights = _first_sights(mesh, table, rows, label)
    out = []
    for k in np.flatnonzero(_may_be_round(sights, surfaces.noise)).tolist():
        planes, circles = sights.planes[k], sights.circles
        look = partial(_ring, mesh, surfaces, piece, rows[k], planes)
        corner, flat = float(circles.radius[k]), float(sights.reach[1][k])
        out.append(RingRow(planes, int(sights.sides[k]), circles.axis[k], corner, flat, look))
    return tuple(out)


def _bent(sine: Array, cosine: Array) -> Flags:
    """(n,) whether planes turn by an angle of that sine and cosine as flats of a ring do."""
    angle = np.arctan2(sine, cosine)
    return np.asarray((angle > RING_TURN[0]) & (angle < RING_TURN[1]))


def _any_bent(table: SurfaceTable, borders: Ints, plane: Flags) -> bool:
    """Whether any planes among the surfaces that share edges do."""
    first, second = borders[plane[borders].all(axis=1)].T
    one, two = table.axes[first], table.axes[second]
    return bool(_bent(lengths(cross(one, two)), dot(one, two)).any())


def _ridges(
    mesh: Mesh, surfaces: MeshSurfaces, table: SurfaceTable, edges: SharedEdges, plane: Flags
) -> tuple[Ints, _Ridges]:
    """(F,) connected piece of its plane of each facet, and the ridges between pieces."""
    labels, vertices, (first, second) = surfaces.labels, mesh.vertices, edges.sides
    of_first, of_second = labels.take(first), labels.take(second)
    flat = plane.take(of_first)
    flat &= plane.take(of_second)
    alike = of_first == of_second
    inside = (flat & alike).nonzero()[0]
    piece = components(first.take(inside), second.take(inside), len(labels))
    between = (flat & ~alike & edges.opposed).nonzero()[0]
    one, two = (table.axes.take(side.take(between), axis=0) for side in (of_first, of_second))
    across = cross(one, two)
    sine = lengths(across)
    bent = _bent(sine, dot(one, two)).nonzero()[0]
    edges, one, two = edges.where(between.take(bent)), one.take(bent, axis=0), two.take(bent, axis=0)
    along = edges.along(vertices)
    length, direction = lengths(along), across.take(bent, axis=0) / np.maximum(sine.take(bent), TINY)[:, None]
    # rad: largest angle between the edge of two flats and the intersection of their planes: scattered vertices turn
    # short edges.
    straight = np.abs(dot(along, direction)) > np.cos(np.radians(5.0)) * length
    kept = (straight & (length > 0.0)).nonzero()[0]
    convex = edges.convexity(vertices, one, two) > 0.0
    ridges = _Ridges(piece.take(edges.sides).T, edges.ends, direction, length, convex)
    return piece, ridges.where(kept)


def _families(ridges: _Ridges) -> Ints:
    """(e,) number of the direction and the sense (convex ones first) that each ridge has, the longest first; −1 of
    those that too few share."""
    out = np.full(len(ridges.length), -1)
    left = np.argsort(-ridges.length, kind="stable")
    # Directions of ridges that are looked at, the longest first: parts have a few, crumpled meshes have thousands.
    for number in range(24):
        if len(left) < RING_SIDES:
            break
        directions = ridges.direction.take(left, axis=0)
        # rad: largest angle between the ridges of one ring: far above what vertices scatter by. Chosen, not measured.
        along = np.abs(directions @ directions[0]) > np.cos(np.radians(1.0))
        out[left[along]] = 2 * number
        left = left[~along]
    out[(out >= 0) & ~ridges.convex] += 1
    return out


@dataclass(frozen=True, eq=False)
class _Row:
    """Flats of one family that hang together."""

    pieces: Ints
    """Ascending."""
    every: _Ridges
    """Those of all rows."""
    edges: Ints
    """Those of them that are of this one, ascending."""

    @property
    def ridges(self) -> _Ridges:
        """Its own."""
        return self.every.where(self.edges)


def _rows_of_flats(ridges: _Ridges, family: Ints) -> list[_Row]:
    """Flats that meet in ridges of one family (e,), where they are enough for a ring, by family and lowest facet."""
    count = np.int64(ridges.pieces.max() + 1)
    nodes, number = numbered((family[:, None] * count + ridges.pieces).ravel(), int(count) * (int(family.max()) + 1))
    number = number.reshape(-1, 2)
    group = components(number[:, 0], number[:, 1], len(nodes))
    of_edge = group.take(number[:, 0])
    total = int(group.max()) + 1
    of_family = np.zeros(total, np.int64)
    of_family[of_edge] = family
    weight = np.bincount(of_edge, ridges.length, total)
    wide = np.flatnonzero(np.bincount(group, minlength=total) >= RING_SIDES)
    wide = wide[np.lexsort((-weight[wide], of_family[wide]))]
    # the longest of each family
    first = np.searchsorted(of_family[wide], of_family[wide])
    wide = np.sort(wide[np.arange(len(wide)) - first < 64])
    wide = wide[_closed(number, of_edge, len(nodes))[wide]]
    edges, pieces = _members(of_edge, wide), _members(group, wide)
    return [_Row(nodes[p] % count, ridges, e) for e, p in zip(edges, pieces, strict=True)]


def _members(group: Ints, wanted: Ints) -> list[Ints]:
    """Which are of each wanted group, ascending; the groups are numbered from 0."""
    order = np.argsort(group, kind="stable")
    ends = np.cumsum(np.bincount(group))
    return [order[end - size : end] for end, size in zip(ends[wanted], np.bincount(group)[wanted], strict=True)]


def _closed(number: Ints, of_edge: Ints, count: int) -> Flags:
    """(groups,) whether so many pieces of each group meet, by the pairs (e, 2) that do, that their corners can tell a
    circle: two lines are on many circles, and three of an open row are on one whatever they are."""
    key = np.sort(number.min(axis=1) * np.int64(count) + number.max(axis=1))
    group = np.zeros(count, np.int64)
    group[number[:, 0]] = group[number[:, 1]] = of_edge
    total = int(of_edge.max()) + 1
    met = np.bincount(group[key[heads(key)] // count], minlength=total)
    size = np.bincount(group, minlength=total)
    return np.asarray((met > 3) | ((met == 3) & (size <= 3)))


@dataclass(frozen=True, eq=False)
class _Circles:
    """Circles through the corners of rows of flats, nearly."""

    axis: Array
    """(r, 3) unit, of either sign."""
    centre: Array
    """(r, 3) m."""
    radius: Array
    """(r,) m; not a number where the corners are on a line."""
    off: Array
    """(r,) m: the farthest corner's distance from the circle."""


def _circles(mesh: Mesh, rows: list[_Row]) -> _Circles:
    """The circles of all rows at once, by sums over their corners about their middles."""
    count = len(rows)
    row = np.repeat(np.arange(count), [len(r.edges) for r in rows])
    ridges = rows[0].every.where(np.concatenate([r.edges for r in rows]))
    direction, length, ends = ridges.direction, ridges.length, ridges.ends
    lead = direction[np.flatnonzero(heads(row))]
    sense = np.sign(dot(direction, lead.take(row, axis=0)))
    axis = normalised(np.add.reduceat((sense * length)[:, None] * direction, np.flatnonzero(heads(row))))
    vertices = np.int64(len(mesh.vertices))
    row, vertex = np.divmod(distinct((row[:, None] * vertices + ends).ravel()), vertices)
    starts = np.flatnonzero(heads(row))
    number = np.bincount(row, minlength=count)
    corners = mesh.vertices.take(vertex, axis=0)
    middle = np.add.reduceat(corners, starts) / number[:, None]
    least = np.eye(3)[np.abs(axis).argmin(axis=1)]
    u = normalised(cross(least, axis))
    v = cross(axis, u)
    arm = corners - middle.take(row, axis=0)
    x, y = dot(arm, u.take(row, axis=0)), dot(arm, v.take(row, axis=0))
    square = x * x + y * y
    sums = np.add.reduceat(np.stack([x * x, x * y, y * y, x * square, y * square, square], axis=1), starts)
    xx, xy, yy, xs, ys, s = sums.T
    determinant = xx * yy - xy * xy
    # Corners whose spread across their length is no more than the root of this share of it are on a line at first
    # sight: beyond, sums about their middle keep eight digits.
    determinant[determinant <= 1e-8 * (xx + yy) ** 2] = np.nan
    one, two = 0.5 * (yy * xs - xy * ys) / determinant, 0.5 * (xx * ys - xy * xs) / determinant
    radius = np.sqrt(s / number + one * one + two * two)
    apart = np.hypot(x - one.take(row), y - two.take(row))
    off = np.maximum.reduceat(np.abs(apart - radius.take(row)), starts)
    return _Circles(axis, middle + one[:, None] * u + two[:, None] * v, radius, off)


@dataclass(frozen=True, eq=False)
class _Sights:
    """How rows of flats look at first sight."""

    circles: _Circles
    planes: list[Ints]
    """The planes of each, ascending."""
    sides: Array
    """(r,) 1 convex, −1 concave."""
    reach: tuple[Array, Array]
    """(r,) m of the nearest and the farthest flat from the axis, negative where they look the other way."""
    open: Array
    """(r,) rad: the widest angle about the axis without a flat."""
    ways: Ints
    """(r,) how many ways the flats face, at most."""


def _first_sights(mesh: Mesh, table: SurfaceTable, rows: list[_Row], label: Ints) -> _Sights:
    """Of all rows at once. `label` (pieces,) tells the plane of each piece."""
    with np.errstate(invalid="ignore"):
        circles = _circles(mesh, rows)
        below = np.int64(len(table.kinds))
        of = np.repeat(np.arange(len(rows)), [len(r.pieces) for r in rows])
        row, every = np.divmod(distinct(of * below + label.take(np.concatenate([r.pieces for r in rows]))), below)
        starts = np.flatnonzero(heads(row))
        planes = np.split(every, starts[1:])
        axes, points = table.axes[every], table.points[every]
        sides = np.where(rows[0].every.convex.take([r.edges[0] for r in rows]), 1.0, -1.0)
        reach = sides[row] * dot(points - circles.centre[row], axes)
        low, high = np.minimum.reduceat(reach, starts), np.maximum.reduceat(reach, starts)
        return _Sights(circles, planes, sides, (low, high), *_round_about(axes, circles.axis, row, starts))


def _may_be_round(sights: _Sights, noise: float) -> Flags:
    """(r,) rows that are not left out at first sight: most are boxes, pockets and steps."""
    circles, (low, high) = sights.circles, sights.reach
    few = sights.ways <= RING_FEW
    spare = 1.0 + RING_SPARE
    with np.errstate(invalid="ignore"):
        out = ~(circles.off > spare * (RING_ROUND * circles.radius + SCATTERED * noise))
        out &= ~(low < -RING_SPARE * circles.radius)
        out &= ~(few & (high - low > spare * RING_EVEN * circles.radius))
        out &= ~(sights.open > RING_OPEN + RING_SPARE)
    return np.asarray(out)


def _round_about(vectors: Array, axes: Array, row: Ints, starts: Ints) -> tuple[Array, Ints]:
    """(r,) rad: `widest_gap` about unit axes (r, 3) of vectors (n, 3), those of a row after each other, from `starts`
    (r,) on; `row` (n,). And how many ways they point, at most."""
    u = normalised(cross(np.eye(3)[np.abs(axes).argmin(axis=1)], axes))
    v = cross(axes, u)
    azimuth = np.arctan2(dot(vectors, v[row]), dot(vectors, u[row]))
    azimuth = azimuth[np.lexsort((azimuth, row))]
    gaps = np.diff(azimuth, prepend=0.0)
    gaps[starts] = azimuth[starts] + 2.0 * np.pi - azimuth[np.append(starts[1:], len(row)) - 1]
    ways = np.add.reduceat((gaps > (1.0 - RING_SPARE) * RING_ALIKE).astype(np.int64), starts)
    return np.asarray(np.maximum.reduceat(gaps, starts)), ways


def _ring(mesh: Mesh, surfaces: MeshSurfaces, piece: Ints, row: _Row, labels: Ints) -> Ring | None:
    """The ring of a row of flats, pieces of the planes `labels` (ascending), unless their corners are on no circle or
    do not go round it."""
    ridges = row.ridges
    sense = np.sign(ridges.direction @ ridges.direction[0])
    axis = canonical((sense * ridges.length) @ ridges.direction)
    corners = mesh.vertices[np.unique(ridges.ends)]
    middle = corners.mean(axis=0)
    u, v = perpendicular(axis)
    flat = np.stack([(corners - middle) @ u, (corners - middle) @ v], axis=1)
    matrix = np.column_stack([2.0 * flat, np.ones(len(flat))])
    (x, y, rest), *_ = np.linalg.lstsq(matrix, dot(flat, flat), rcond=None)
    corner = float(np.sqrt(max(rest + x * x + y * y, 0.0)))
    off = float(np.abs(np.hypot(flat[:, 0] - x, flat[:, 1] - y) - corner).max())
    if off > RING_ROUND * corner + SCATTERED * surfaces.noise:
        return None
    planes = [surfaces.surfaces[k] for k in labels]
    normals = np.array([plane.axis for plane in planes])
    if widest_gap(normals, axis) > RING_OPEN:
        return None
    point = middle + x * u + y * v
    side = 1 if ridges.convex[0] else -1
    reach = np.array([side * float((plane.point - point) @ plane.axis) for plane in planes])
    if reach.min() <= 0.0:
        # the walls and the rims of a hole make a ring too, inside out
        return None
    ways = _ways(normals @ u, normals @ v)
    if ways <= RING_FEW and reach.max() - reach.min() > RING_EVEN * corner:
        # the corners of every box are on a circle
        return None
    across = reach < np.cos(0.5 * RING_TURN[1]) * corner
    if across.any() and _ways(normals[across] @ u, normals[across] @ v) > 1:
        # both sides of a bar whose ends have bevels; a shaft has one flat that deep
        return None
    facets = np.flatnonzero(np.isin(piece, row.pieces))
    heights = (mesh.vertices[np.unique(mesh.faces[facets])] - point) @ axis
    return Ring(
        axis=axis,
        point=point,
        corner=corner,
        flats=(float(reach.min()), float(reach.max())),
        side=side,
        sides=ways,
        extent=(float(heights.min()), float(heights.max())),
        surfaces=labels,
        facets=facets,
        turn=median([plane.axis_uncertainty for plane in planes]),
        shift=max(off / SCATTERED, median([plane.point_uncertainty for plane in planes])),
    )


def _ways(x: Array, y: Array) -> int:
    """How many ways vectors (n,) point that are seen along the axis."""
    azimuth = np.sort(np.arctan2(y, x))
    gaps = np.append(azimuth[1:], azimuth[0] + 2.0 * np.pi) - azimuth
    return int(np.count_nonzero(gaps > RING_ALIKE))
