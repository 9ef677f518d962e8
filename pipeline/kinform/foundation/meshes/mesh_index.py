"""What is asked of the facets of one mesh: boxes, borders, shells, nearness, inside; made when first asked for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import fcl
import numpy as np

from kinform.foundation.algebra.vectors import cross_columns, dot
from kinform.foundation.constants import EPS32, KEPT_FACETS
from kinform.foundation.graphs.components import components
from kinform.foundation.meshes.ball_cover import Balls
from kinform.foundation.meshes.boxes import FacetBoxes, facet_boxes
from kinform.foundation.meshes.chordal_deviation import standoffs
from kinform.foundation.meshes.closest_facets import Triangles
from kinform.foundation.meshes.depths import Depths
from kinform.foundation.meshes.edges import SharedEdges, shared_edges
from kinform.foundation.meshes.fcl_adapter import fcl_model, partial_model
from kinform.foundation.meshes.near_facets import near_boxes
from kinform.foundation.meshes.outline_bulges import bulge_of
from kinform.foundation.meshes.probes import KEPT_TRIANGLES, Region
from kinform.foundation.meshes.ray_parity import Inside
from kinform.foundation.meshes.rings import Ring, RingRow, ring_rows
from kinform.foundation.meshes.surface_table import SurfaceTable
from kinform.foundation.sorting import distinct
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances

LARGE_MESH = 1_000_000
"""Facets from which on a model of all of them, half a gigabyte, is made only where a model of some does not do."""


class MeshIndex:
    """One mesh with what is asked of its facets; its BVH and their boxes are made when first asked for."""

    def __init__(self, mesh: Mesh):
        self.mesh = mesh
        self._bvh: fcl.BVHModel | None = None
        self._about: Flags | None = None
        self._local: fcl.BVHModel | None = None
        self._spans: Array | None = None
        self._normals: Array | None = None
        self._asked = 0
        self._edges: SharedEdges | None = None
        self._single: bool | None = None
        self._borders: Ints | None = None
        self._neighbours: dict[int, frozenset[int]] = {}
        self._shells: Ints | None = None
        self._boxes: FacetBoxes | None = None
        self._triangles: Triangles | None = None
        self._inside: Inside | None = None
        self._balls: Balls | None = None
        self._depths: Depths | None = None
        self._table: SurfaceTable | None = None
        self._rows: tuple[RingRow, ...] | None = None
        self._bulge: float | None = None
        self._standoffs: dict[int, Array] = {}
        self.low, self.high = mesh.box
        """(3,) m, in the part frame."""

    def spans(self, facets: Ints) -> Array:
        """(n, 3) cross products of two edges of each facet: outward, of twice its area (m²)."""
        if self._spans is None and len(self.mesh.faces) <= KEPT_FACETS:
            self._spans = _spans(self.triangles.corners)
        return (
            _spans(self.mesh.vertices.take(self.mesh.faces[facets], axis=0))
            if self._spans is None
            else self._spans.take(facets, axis=0)
        )

    def areas(self, facets: Ints) -> Array:
        """(n,) m²."""
        spans = self.spans(facets)
        return np.asarray(0.5 * np.sqrt(dot(spans, spans)))

    def normals(self, facets: Ints) -> Array:
        """(n, 3) unit, outward, part frame; zero for facets without area; of many facets kept once as many were
        asked for as there are."""
        if self._normals is not None:
            return self._normals.take(facets, axis=0)
        self._asked += len(facets)
        count = len(self.mesh.faces)
        if count <= KEPT_TRIANGLES or (self._asked > count and count <= KEPT_FACETS):
            self._normals = _normals(self.spans(np.arange(count)))
            return self._normals.take(facets, axis=0)
        return _normals(self.spans(facets))

    @property
    def boxes(self) -> FacetBoxes:
        """Boxes of the facets in the part frame."""
        if self._boxes is None:
            mesh = self.mesh
            few = len(mesh.faces) <= KEPT_TRIANGLES
            self._boxes = FacetBoxes(*(self.triangles.boxes if few else facet_boxes(mesh.vertices, mesh.faces)))
        return self._boxes

    def table(self, surfaces: MeshSurfaces) -> SurfaceTable:
        """The mesh's surfaces as arrays."""
        if self._table is None:
            self._table = SurfaceTable.of(surfaces, self.rims(surfaces))
        return self._table

    @property
    def bvh(self) -> fcl.BVHModel:
        """FCL's model of the mesh in the part frame (m)."""
        if self._bvh is None:
            self._local = None
            self._bvh = fcl_model(self.mesh.vertices, self.mesh.faces)
        return self._bvh

    @property
    def triangles(self) -> Triangles:
        """The facets, kept where they are not very many."""
        if self._triangles is not None:
            return self._triangles
        triangles = Triangles(self.mesh.vertices.take(self.mesh.faces, axis=0))
        if len(self.mesh.faces) <= KEPT_TRIANGLES:
            self._triangles = triangles
        return triangles

    @property
    def is_large(self) -> bool:
        """Whether a model of all of it takes much memory."""
        return len(self.mesh.faces) > LARGE_MESH

    def expect(self, low: Array, high: Array) -> None:
        """What follows is asked about facets beside these boxes (n, 3) of the part frame: a model will be of them."""
        # Distance from another part, in diagonals of a large mesh, within which its facets are expected to be asked
        # for: motions that are tried stay within it. Chosen, not measured.
        boxes, apart = self.boxes, 0.02 * self.mesh.diagonal
        about, _ = near_boxes(boxes.low, boxes.high, low, high, apart)
        if self._about is None or not self._about[about].all():
            self._about, self._local = about, None

    def model_near(self, low: Array, high: Array) -> tuple[fcl.BVHModel, Ints | None]:
        """FCL's model of facets, all that boxes (n, 3) of the part frame meet among them, and which facets it is of
        (None: all).

        Of a large mesh it is of those that were expected, as long as they are enough: half a kilobyte each.
        """
        if self._bvh is not None or self._about is None or not self._suffice(self._about, low, high):
            return self.bvh, None
        facets = np.flatnonzero(self._about)
        if self._local is None:
            self._local = partial_model(self.mesh.vertices, self.mesh.faces[facets])
        return self._local, facets

    def _suffice(self, some: Flags, low: Array, high: Array) -> bool:
        """Whether these boxes (n, 3) meet none but some facets (F,), which are not nearly all."""
        # Share of the facets above which a model of all is made instead, which serves all other parts too. Chosen, not
        # measured.
        if not 0.0 < np.count_nonzero(some) <= 0.8 * len(some):
            return False
        boxes, others = self.boxes, np.flatnonzero(~some)
        meeting = (boxes.low[others] <= high.max(axis=0)) & (boxes.high[others] >= low.min(axis=0))
        others = others[meeting.all(axis=1)]
        return not near_boxes(boxes.low[others], boxes.high[others], low, high, 0.0)[0].any()

    def region(self, facets: Ints) -> Region:
        """These facets (ascending) as something to cast probes against: few meshes have more than one neighbour that
        comes near most of them, and a model of all would not be asked for twice."""
        if len(facets) == len(self.mesh.faces):
            return self.whole()
        return Region(self, facets)

    def whole(self) -> Region:
        """All facets."""
        return Region(self, None)

    @property
    def edges(self) -> SharedEdges:
        """The shared edges by corner, kept of meshes that are not large."""
        if self._edges is not None:
            return self._edges
        edges = shared_edges(self.mesh.faces, len(self.mesh.vertices), by_corner=True)
        if len(self.mesh.faces) <= KEPT_FACETS:
            self._edges = edges
        return edges

    def meeting_facets(self, chosen: Flags) -> Ints | None:
        """(2, k) facets among those flagged in `chosen` (F,) that follow each other in a shared edge, as `shared_edges`
        by corner of these alone has them; None where the edges of all are not kept, or some have more than two."""
        kept = self._kept_among(chosen)
        return None if kept is None else np.asarray(self.edges.sides.take(kept, axis=1))

    def edges_among(self, chosen: Flags) -> SharedEdges:
        """The shared edges, by corner, of the facets flagged in `chosen` (F,) alone, in half-edges of the mesh."""
        kept = self._kept_among(chosen)
        if kept is not None:
            return self.edges.where(kept)
        facets = np.flatnonzero(chosen)
        edges = shared_edges(self.mesh.faces.take(facets, axis=0), len(self.mesh.vertices), by_corner=True)
        return replace(edges, first=_of_facets(edges.first, facets), second=_of_facets(edges.second, facets))

    def _kept_among(self, chosen: Flags) -> Ints | None:
        """Rows of the edges, where they are kept and none has more than two facets, of which both are chosen."""
        if len(self.mesh.faces) > KEPT_FACETS:
            return None
        if self._single is None:
            low, high = self.edges.ends.T
            self._single = not ((low[1:] == low[:-1]) & (high[1:] == high[:-1])).any()
        if not self._single:
            return None
        one, two = self.edges.sides
        kept = chosen.take(one)
        kept &= chosen.take(two)
        return np.flatnonzero(kept)

    def borders(self, surfaces: MeshSurfaces) -> Ints:
        """(k, 2) pairs of surfaces that share an edge, both ways round, sorted."""
        if self._borders is None:
            first, second = surfaces.labels.take(self.edges.sides)
            apart = (first != second).nonzero()[0]
            first, second = first.take(apart), second.take(apart)
            count = np.int64(max(len(surfaces.surfaces), 1))
            first, second = np.divmod(distinct(np.minimum(first, second) * count + np.maximum(first, second)), count)
            keys = np.sort(np.concatenate([first * count + second, second * count + first]))
            self._borders = np.stack(np.divmod(keys, count), axis=1)
        return self._borders

    def neighbours(self, surfaces: MeshSurfaces, surface: int) -> frozenset[int]:
        """Surfaces that share an edge with this one."""
        known = self._neighbours.get(surface)
        if known is None:
            borders = self.borders(surfaces)
            first, last = borders[:, 0].searchsorted([surface, surface + 1])
            known = self._neighbours[surface] = frozenset(borders[first:last, 1].tolist())
        return known

    def ring_rows(self, surfaces: MeshSurfaces) -> tuple[RingRow, ...]:
        """Rows of flats that may be rings, as they look at first sight."""
        if self._rows is None:
            self._rows = ring_rows(self.mesh, surfaces, self.table(surfaces), self.edges, self.borders(surfaces))
        return self._rows

    def rings(self, surfaces: MeshSurfaces) -> tuple[Ring, ...]:
        """Rings of flats, which may be meant as round."""
        return tuple(row.ring for row in self.ring_rows(surfaces) if row.ring is not None)

    def bulge(self, surfaces: MeshSurfaces, exact: Flags, smooth: float) -> float:
        """m by which smooth curves through its outlines may stand off its facets; `exact` (s,) surfaces need none, and
        edges are smooth below `smooth` (rad)."""
        if self._bulge is None:
            self._bulge = bulge_of(self.triangles.corners, surfaces.labels, self.table(surfaces), exact, smooth)
        return self._bulge

    def standoffs(self, surfaces: MeshSurfaces, number: int, tolerances: Tolerances) -> Array:
        """(m,) m by which each facet of a surface may stand off it, estimated by how the facets bend."""
        if number not in self._standoffs:
            mesh, facets = self.mesh, surfaces.surfaces[number].faces
            rounding = max(EPS32 * float(np.abs(mesh.vertices).max()), mesh.resolution)
            edges = tolerances.smooth_edge, tolerances.coplanar
            self._standoffs[number] = standoffs(mesh.vertices, mesh.faces[facets], *edges, rounding)
        return self._standoffs[number]

    @property
    def shells(self) -> Ints:
        """The lowest facet of each connected shell of the mesh."""
        if self._shells is None and self.mesh.health.shells == 1:
            # what hangs together by edges does by vertices
            self._shells = np.zeros(1, np.int64)
        if self._shells is None:
            faces, count = self.mesh.faces, len(self.mesh.vertices)
            edges = np.concatenate([faces[:, :2], faces[:, 1:]])
            shell = components(edges[:, 0], edges[:, 1], count)
            self._shells = np.unique(shell[faces[:, 0]], return_index=True)[1]
        return self._shells

    def rims(self, surfaces: MeshSurfaces) -> Array:
        """For each surface, the greatest chord error of the surfaces that share an edge with it (m).

        By so much the outline of a plane face may be off the curve that it stands for.
        """
        chords = np.array([surface.chord for surface in surfaces.surfaces])
        rims = np.zeros(len(chords))
        surface, other = self.borders(surfaces).T
        np.maximum.at(rims, surface, chords[other])
        return rims

    def depths(self, points: Array) -> Array:
        """(n,) m distances of points (n, 3) of the part frame from the mesh: as of `whole`, without a model of it."""
        return self._measured().of(points)

    def depths_up_to(self, points: Array, enough: float | Array) -> Array:
        """(n,) the same where that is less than `enough` (m), of all or each (n,), else this: of many points sooner."""
        return self._measured().up_to(points, enough)

    def _measured(self) -> Depths:
        if self._depths is None:
            self._depths = Depths(self.mesh)
        return self._depths

    def away(self, points: Array) -> Array:
        """(n,) m that points (n, 3) of the part frame keep from the mesh at least: less than their distance, and
        quickly."""
        if self._balls is None:
            self._balls = Balls(self.mesh)
        return self._balls.away(points)

    def contains(self, points: Array) -> Flags:
        """(n,) whether points (n, 3) of the part frame lie inside, as `Inside` has it."""
        if self._inside is None:
            self._inside = Inside(self.mesh)
        return self._inside.contains(points)


def _of_facets(half_edges: Ints, facets: Ints) -> Ints:
    """Half-edges (k,) of some facets (n,), by their places among them, in those of the mesh."""
    place, corner = np.divmod(half_edges, 3)
    return np.asarray(3 * facets.take(place) + corner)


def _spans(corners: Array) -> Array:
    """(n, 3) of facets (n, 3, 3)."""
    first, second, third = np.ascontiguousarray(corners.transpose(1, 2, 0))
    return np.ascontiguousarray(cross_columns((second - first).T, (third - first).T))


def _normals(spans: Array) -> Array:
    """(n, 3) of spans (n, 3) of facets."""
    length = np.sqrt(dot(spans, spans))
    return np.asarray(spans / np.where(length > 0.0, length, 1.0)[:, None])


@dataclass
class MeshStore:
    """The indices of all distinct meshes, by digest."""

    indices: dict[str, MeshIndex] = field(default_factory=dict)

    def index(self, mesh: Mesh) -> MeshIndex:
        """The index of a mesh; meshes of one digest share it."""
        known = self.indices.get(mesh.digest)
        if known is None:
            known = self.indices[mesh.digest] = MeshIndex(mesh)
        return known

    def forget(self, digest: str) -> None:
        """What is known of a mesh that is asked no more."""
        self.indices.pop(digest, None)
