"""Rings of flats: prisms whose corners lie on one circle, as a coarse tessellation of a shaft or a bore does, and a
hexagon as well.

A mesh does not tell which of the two was meant. So flats stay planes, and beside them a ring says which of them stand
about one axis, how far off it their corners and their middles are, and to which side the material lies. Who compares
two parts decides what that means there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation import constants
from kinform.foundation.algebra.vectors import canonical, cross, dot, perpendicular, widest_gap
from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.edges import shared_edges
from kinform.foundation.sorting import median
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces


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
    """How many flats."""
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
        return _Ridges(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def rings_of(mesh: Mesh, surfaces: MeshSurfaces) -> tuple[Ring, ...]:
    """The rings among the planes of a mesh, by axis and lowest facet."""
    plane = np.array([surface.kind == "plane" for surface in surfaces.surfaces], dtype=bool)
    if plane.sum() < constants.RING_SIDES:
        return ()
    piece, ridges = _ridges(mesh, surfaces, plane)
    rings: list[Ring] = []
    left = np.argsort(-ridges.length, kind="stable")
    for _ in range(constants.RING_DIRECTIONS):
        if len(left) < constants.RING_SIDES:
            break
        along = np.abs(ridges.direction[left] @ ridges.direction[left[0]]) > np.cos(constants.RING_PARALLEL)
        for convex in (True, False):
            chosen = np.sort(left[along & (ridges.convex[left] == convex)])
            rings += _along(mesh, surfaces, piece, ridges.where(chosen))
        left = left[~along]
    return tuple(rings)


def _ridges(mesh: Mesh, surfaces: MeshSurfaces, plane: Flags) -> tuple[Ints, _Ridges]:
    """(F,) connected piece of its plane of each facet, and the ridges between pieces."""
    labels, vertices = surfaces.labels, mesh.vertices
    edges = shared_edges(mesh.faces, len(vertices), by_corner=True)
    first, second = edges.facets.T
    flat = plane[labels[first]] & plane[labels[second]]
    inside = flat & (labels[first] == labels[second])
    piece = components(first[inside], second[inside], len(labels))
    edges = edges.where(flat & ~inside & edges.opposed)
    first, second = edges.facets.T
    axes = np.array([surface.axis for surface in surfaces.surfaces]).reshape(-1, 3)
    one, two = axes[labels[first]], axes[labels[second]]
    across, along = cross(one, two), edges.along(vertices)
    sine, length = np.linalg.norm(across, axis=1), np.linalg.norm(along, axis=1)
    angle = np.arctan2(sine, dot(one, two))
    bent = (angle > constants.RING_TURN[0]) & (angle < constants.RING_TURN[1])
    direction = across / np.maximum(sine, 1e-300)[:, None]
    straight = np.abs(dot(along, direction)) > np.cos(constants.RING_ASKEW) * length
    ridges = _Ridges(
        np.stack([piece[first], piece[second]], axis=1),
        edges.ends,
        direction,
        length,
        edges.convexity(vertices, one, two) > 0.0,
    )
    return piece, ridges.where(bent & straight & (length > 0.0))


def _along(mesh: Mesh, surfaces: MeshSurfaces, piece: Ints, ridges: _Ridges) -> list[Ring]:
    """The rings about one direction, of ridges of one sense."""
    if len(ridges.length) < constants.RING_SIDES - 1:
        return []
    pieces, number = np.unique(ridges.pieces, return_inverse=True)
    number = number.reshape(-1, 2)
    group = components(number[:, 0], number[:, 1], len(pieces))
    of_edge = group[number[:, 0]]
    wide = np.flatnonzero(np.bincount(group) >= constants.RING_SIDES)
    weight = np.bincount(of_edge, ridges.length, int(group.max()) + 1)[wide]
    wide = wide[np.argsort(-weight, kind="stable")[: constants.MOST_RINGS]]
    wide = np.sort(wide)
    wide = wide[_closed(number, of_edge, len(pieces))[wide]]
    of_ring, of_piece = (
        np.split(np.argsort(g, kind="stable"), np.cumsum(np.bincount(g))[:-1]) for g in (of_edge, group)
    )
    found = (_ring(mesh, surfaces, piece, pieces[of_piece[k]], ridges.where(of_ring[k])) for k in wide.tolist())
    return [ring for ring in found if ring is not None]


def _closed(number: Ints, of_edge: Ints, count: int) -> Flags:
    """(groups,) whether so many pieces of each group meet, by the pairs (e, 2) that do, that their corners can tell a
    circle: two lines are on many circles, and three of an open row are on one whatever they are."""
    key = np.sort(number.min(axis=1) * np.int64(count) + number.max(axis=1))
    first = np.ones(len(key), bool)
    np.not_equal(key[1:], key[:-1], out=first[1:])
    group = np.zeros(count, np.int64)
    group[number[:, 0]] = group[number[:, 1]] = of_edge
    total = int(of_edge.max()) + 1
    met = np.bincount(group[key[first] // count], minlength=total)
    size = np.bincount(group, minlength=total)
    return np.asarray((met > 3) | ((met == 3) & (size <= 3)))


def _ring(mesh: Mesh, surfaces: MeshSurfaces, piece: Ints, pieces: Ints, ridges: _Ridges) -> Ring | None:
    """The ring of these pieces of planes, unless their corners are on no circle or do not go round it."""
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
    if off > constants.RING_ROUND * corner + constants.RING_NOISES * surfaces.noise:
        return None
    facets = np.flatnonzero(np.isin(piece, pieces))
    labels = np.unique(surfaces.labels[facets])
    planes = [surfaces.surfaces[k] for k in labels]
    normals = np.array([plane.axis for plane in planes])
    if widest_gap(normals, axis) > constants.RING_OPEN:
        return None
    point = middle + x * u + y * v
    side = 1 if ridges.convex[0] else -1
    reach = np.array([side * float((plane.point - point) @ plane.axis) for plane in planes])
    if reach.min() <= 0.0:
        # the walls and the rims of a hole make a ring too, inside out
        return None
    if len(planes) <= constants.RING_FEW and reach.max() - reach.min() > constants.RING_EVEN * corner:
        # the corners of every box are on a circle
        return None
    heights = (mesh.vertices[np.unique(mesh.faces[facets])] - point) @ axis
    return Ring(
        axis=axis,
        point=point,
        corner=corner,
        flats=(float(reach.min()), float(reach.max())),
        side=side,
        sides=len(labels),
        extent=(float(heights.min()), float(heights.max())),
        surfaces=labels,
        facets=facets,
        turn=median([plane.axis_uncertainty for plane in planes]),
        shift=max(off / constants.RING_NOISES, median([plane.point_uncertainty for plane in planes])),
    )
